//! Landmarks in the picture.

use crate::camera::PtzCamera;
use crate::field::FieldModel;
use crate::geometry::{ImagePoint, ImageSize};

/// A landmark that is visible in the picture.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ProjectedLandmark {
    /// Which landmark: index into [`FieldModel::landmarks`].
    pub landmark: usize,
    /// Its image, px.
    pub image: ImagePoint,
}

/// Projects all landmarks that lie within the picture enlarged by a margin, px, in the field's
/// order.
pub fn project_landmarks(
    field: &FieldModel,
    camera: &PtzCamera,
    size: ImageSize,
    margin_px: f64,
) -> Vec<ProjectedLandmark> {
    field
        .landmarks
        .iter()
        .enumerate()
        .filter_map(|(landmark, of)| {
            let image = camera.image_from_world(field.landmark_in_world(of)).ok()?;
            is_within_margin(image, size, margin_px)
                .then_some(ProjectedLandmark { landmark, image })
        })
        .collect()
}

/// Whether a point lies in the picture enlarged by a margin, px, the border included.
fn is_within_margin(point: ImagePoint, size: ImageSize, margin_px: f64) -> bool {
    point.x >= -margin_px
        && point.y >= -margin_px
        && point.x <= f64::from(size.width) + margin_px
        && point.y <= f64::from(size.height) + margin_px
}
