//! Painted markings in pixels: finding them, judging a camera by them, pulling a camera onto them.
//!
//! | what | where |
//! |---|---|
//! | [`GroundPicture`] | a picture made ready: brightness, the colours of its ground, masks |
//! | [`Sightings`] | the ridges of paint that a picture shows where a camera predicts a line |
//! | [`check_lines`], [`LineCheck`] | a camera judged by the paint that it predicts |
//! | [`snap`], [`Snapped`] | pan, tilt and focal length pulled onto the paint, or the reason why not |
//! | [`paint_places`], [`PaintPlace`] | where a picture shows the paint that a camera predicts, for adjusting many frames together |
//! | [`find_camera`], [`Found`] | a camera found in one picture by its lines alone, its base known |
//! | [`Strokes`] | painted strokes of a picture, found without any camera |
//! | [`snap_point`], [`SnappedPoint`] | a placed point moved to the painted corner, crossing or spot that it names |
//!
//! Everything works on one picture and a known base; nothing is drawn by chance.

mod across;
mod agreement;
mod alignment;
mod check;
mod colours;
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
mod strokes;
mod surface;
mod unexplained;

pub use across::Ridge;
pub use agreement::Agreement;
pub use check::{LineCheck, check_lines, overlays_apart_px};
pub use error::SnapError;
pub use find::{FindError, FindOptions, Found, find_camera};
pub use ground::GroundPicture;
pub use persistent::{PersistentPoint, SeenGround, persistent_paint};
pub use placed_point::{PointSnapOptions, SnappedPoint};
pub use places::{PaintPlace, paint_places};
pub use point::snap_point;
pub use sightings::{Seen, Sightings};
pub use snap::{SnapOptions, Snapped, snap};
pub use strokes::{Shown, StrokePoint, Strokes};
pub use surface::Surface;
