//! Painted markings in pixels: detects them, tests a camera against them, aligns a camera to them.
//!
//! | what | where |
//! |---|---|
//! | [`GroundPicture`] | a prepared picture: brightness, the colours of its ground, masks |
//! | [`check_lines`], [`LineCheck`] | a test of a camera against the paint that it predicts |
//! | [`snap`], [`Snapped`] | pan, tilt and focal length aligned to the paint, or the reason why not |
//! | [`paint_places`], [`PaintPlace`] | where a picture shows the paint that a camera predicts, for the joint adjustment of many frames |
//! | [`find_camera`], [`PaintSearchResult`] | the camera of one picture from its lines alone, with a known base |
//! | [`MarkingPixels`] | marking pixels of a picture, found without any camera |
//! | [`snap_point`], [`SnappedPoint`] | a placed point moved to the painted corner, crossing or point marking that it names |
//!
//! All functions work on one picture with a known base, and none is randomised. The exception is
//! [`persistent_paint`], which combines the pictures of one rotating camera.
//!
//! # Files, from the pixels up
//!
//! * What is ground: `surface.rs` (its colours), `ground_area.rs` (its extent), `turf_levels.rs`
//!   (its brightness).
//! * With a camera: `ridge.rs` and `floor_ridge.rs` search across one line (geometry: `across.rs`)
//!   on a profile (`profile.rs`, `colours.rs`). `sightings.rs` does it for all lines. `check.rs`,
//!   `search.rs`, `alignment.rs`, `snap.rs`, `lens.rs` and `places.rs` use that.
//! * Without a camera: `marking_pixels` finds markings; `evidence.rs` and `agreement.rs` compare
//!   them with many cameras for `find.rs`; `persistent.rs` combines frames.
//! * At a click: `point.rs` with `crossing.rs`, and `spot.rs` with `drawn_spot.rs`.
//!
//! # Lengths
//!
//! A constant in px at 1920 px width is multiplied by `ImageSize::scale_from_1920`. One in plain px
//! is not: blur by optics and encoder, and the distances that keep clear of it, are about as many
//! pixels in pictures of every width.

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
pub use snap::{SnapOptions, Snapped, snap};
pub use surface::Surface;
