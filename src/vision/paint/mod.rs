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
//! * `turf`, what is ground: `surface.rs` (its colours), `ground_area.rs` (its extent),
//!   `turf_levels.rs` (its brightness), `even_areas.rs` (where it is in full view).
//! * `ridges`, across one line: `ridge.rs` and `floor_ridge.rs` search (geometry: `profile.rs`) on a
//!   profile (`profile.rs`, `colours.rs`).
//! * `camera_alignment`, with a camera: `sightings.rs` searches across all lines. `check.rs`,
//!   `search.rs`, `alignment.rs`, `snap.rs`, `lens.rs` and `places.rs` use that.
//! * `markings`, without a camera: `marking_pixels` finds markings; `evidence.rs` and
//!   `agreement.rs` compare them with many cameras for `find.rs`; `persistent.rs` combines frames.
//! * `click_snapping`, at a click: `point.rs` with `crossing.rs`, and `spot.rs` with
//!   `drawn_spot.rs`.
//!
//! # Lengths
//!
//! A constant in px at 1920 px width is multiplied by `ImageSize::scale_from_1920`. One in plain px
//! is not: blur by optics and encoder, and the distances that keep clear of it, are about as many
//! pixels in pictures of every width.

mod camera_alignment;
mod click_snapping;
#[cfg(test)]
mod drawn;
mod error;
mod find;
mod markings;
mod ridges;
mod turf;

pub use camera_alignment::check::LineCheck;
pub use camera_alignment::snap::{SnapOptions, Snapped, snap};
pub use error::SnapError;
pub use find::{FindError, FindOptions, PaintSearchResult, find_camera};
pub use markings::agreement::Agreement;
pub use turf::ground::GroundPicture;
pub use turf::surface::Surface;
// For the crates above alone: no promise to other programs.
#[doc(hidden)]
pub use {
    camera_alignment::check::{check_lines, lines_on_paint, overlays_apart_px},
    camera_alignment::places::{PaintPlace, observations_of_paint, paint_places},
    click_snapping::point::snap_point,
    click_snapping::{PointSnapOptions, SnappedPoint},
    markings::marking_pixels::{MarkingPixel, MarkingPixels, PixelContent, Tone},
    markings::persistent::{GroundDirections, PersistentPoint, persistent_paint},
    markings::straight_lines::{StraightLine, straight_lines},
    ridges::contrast::LineContrast,
    turf::even_areas::EvenAreas,
};
