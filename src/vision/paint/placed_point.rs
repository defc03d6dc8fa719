//! How placed points are moved onto the paint, and what comes of it.

use touchline_core::field::{FieldModel, Landmark};
use touchline_core::geometry::ImagePoint;

/// How a placed point is moved. Lengths are px at 1920 px width.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct PointSnapOptions {
    /// The point is moved at most this far. 8 by default.
    pub reach_px: f64,
    /// A result that is known less well is none: 1-σ in each direction. 1.5 by default.
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

/// A point on the paint.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct SnappedPoint {
    /// Where the landmark is painted, px.
    pub image: ImagePoint,
    /// 1-σ in each direction, px.
    pub sigma_px: f64,
}

/// 1-σ of what all ridges of a line have in common, px at 1920 px width.
pub(super) const LINE_SIGMA_PX: f64 = 0.35;

/// A line passes through a landmark if it comes as near as this, m.
const THROUGH_M: f64 = 0.02;

/// The painted lines that pass through a landmark or end there.
pub(super) fn lines_through(field: &FieldModel, landmark: &Landmark) -> Vec<usize> {
    let lines = field.lines.iter().enumerate();
    let through = lines
        .filter(|(_, line)| line.painted && line.curve.distance_m(landmark.nominal_m) <= THROUGH_M);
    through.map(|(index, _)| index).collect()
}
