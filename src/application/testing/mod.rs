//! What tests of the application share, here and above it.
#![allow(
    clippy::unwrap_used,
    clippy::panic,
    clippy::missing_panics_doc,
    clippy::must_use_candidate,
    missing_docs,
    reason = "for tests alone"
)]

pub mod proposed;

use touchline_core::camera::{CameraBase, PtzCamera};
use touchline_core::geometry::ImagePoint;
use touchline_core::testing::{SIZE, base_at, soccer};
use touchline_documents::document::Document;

/// The document without the counts of its frames' edits: what undo brings back counts as another
/// edit.
pub fn without_counts(document: &Document) -> Document {
    let mut document = document.clone();
    document
        .frames
        .iter_mut()
        .for_each(|frame| frame.revision = 0);
    document
}

/// The base of the drawn truth.
pub fn base() -> CameraBase {
    base_at([1.0, -62.0, 17.0], SIZE)
}

/// Where a camera sees a landmark of the soccer field.
pub fn landmark_in(camera: &PtzCamera, landmark: &str) -> ImagePoint {
    touchline_core::testing::landmark_in(camera, &soccer(), landmark)
}
