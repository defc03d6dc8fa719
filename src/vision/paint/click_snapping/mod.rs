//! Click snapping: a placed point moves to the painted corner, crossing or point marking that it
//! means. The place is found by least squares over the ridges nearby, with its sigma. Whole cameras
//! are aligned in `camera_alignment`.

mod crossing;
mod drawn_spot;
pub mod point;
mod spot;

use touchline_core::field::{FieldModel, Landmark};
use touchline_core::geometry::ImagePoint;

/// Settings of click snapping. Lengths are px at 1920 px width.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct PointSnapOptions {
    /// Maximum distance by which a point is moved. 8 by default.
    pub reach_px: f64,
    /// Maximum 1-σ of a result along each axis. 1.5 by default.
    pub max_sigma_px: f64,
}

impl Default for PointSnapOptions {
    fn default() -> Self {
        Self {
            reach_px: 8.0,
            max_sigma_px: 1.5,
        }
    }
}

/// A point that was moved onto the paint.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct SnappedPoint {
    /// Painted position of the landmark, px.
    pub image: ImagePoint,
    /// 1-σ along each axis, px.
    pub sigma_px: f64,
}

/// 1-σ of the error that all ridges of a line share, px at 1920 px width.
pub(in crate::paint) const LINE_SIGMA_PX: f64 = 0.35;

/// Maximum distance between a landmark and a line that passes through it, m.
const THROUGH_M: f64 = 0.02;

/// Indices of the painted lines that pass through a landmark or end there.
fn lines_through(field: &FieldModel, landmark: &Landmark) -> Vec<usize> {
    let lines = field.lines.iter().enumerate();
    let through = lines
        .filter(|(_, line)| line.painted && line.curve.distance_m(landmark.nominal_m) <= THROUGH_M);
    through.map(|(index, _)| index).collect()
}
