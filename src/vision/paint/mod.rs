//! Painted markings in pixels: detects them, tests a camera against them, aligns a camera to them.
//!
//! | what | where |
//! |---|---|
//! | [`GroundPicture`] | a prepared picture: brightness, the colours of its ground, masks |
//! | [`LineObservations`] | the ridges of paint across the lines that a camera predicts |
//! | [`check_lines`], [`LineCheck`] | a test of a camera against the paint that it predicts |
//! | [`snap`], [`Snapped`] | pan, tilt and focal length aligned to the paint, or the reason why not |
//! | [`paint_places`], [`PaintPlace`] | where a picture shows the paint that a camera predicts, for the joint adjustment of many frames |
//! | [`find_camera`], [`PaintSearchResult`] | the camera of one picture from its lines alone, with a known base |
//! | [`MarkingPixels`] | marking pixels of a picture, found without any camera |
//! | [`snap_point`], [`SnappedPoint`] | a placed point moved to the painted corner, crossing or point marking that it names |
//!
//! All functions work on one picture with a known base, and none is randomised. The exception is
//! [`persistent_paint`], which combines the pictures of one rotating camera.

mod across;
mod agreement;
mod alignment;
mod check;
mod colours;
mod contrast;
mod crossing;
mod directions;
#[cfg(test)]
mod drawn;
mod drawn_spot;
mod error;
mod evidence;
mod find;
mod floor_ridge;
mod ground;
mod ground_area;
mod lens;
mod marking_pixels;
mod persistent;
mod placed_point;
mod places;
mod point;
mod profile;
mod ridge;
mod search;
mod sightings;
mod snap;
mod spot;
mod surface;
mod turf_levels;
mod unexplained;

pub use across::Ridge;
pub use agreement::Agreement;
pub use check::{LineCheck, check_lines, overlays_apart_px};
pub use contrast::LineContrast;
pub use error::SnapError;
pub use find::{FindError, FindOptions, PaintSearchResult, find_camera};
pub use ground::GroundPicture;
pub use marking_pixels::{MarkingPixel, MarkingPixels, PixelContent};
pub use persistent::{GroundDirections, PersistentPoint, persistent_paint};
pub use placed_point::{PointSnapOptions, SnappedPoint};
pub use places::{PaintPlace, paint_places};
pub use point::snap_point;
pub use sightings::{LineObservations, SampleContent};
pub use snap::{SnapOptions, Snapped, snap};
pub use surface::Surface;
