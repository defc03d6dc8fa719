//! The planes that other people's homographies map to: origin, axes and unit.

use super::world_cup_sets::{TEMPLATE_YD, template_from_ground};
use crate::exchange::options::{GroundPlan, MatrixDirection, Pixels};
use touchline_core::field::FieldModel;
use touchline_core::geometry::{Mat3, Vec2};

/// The corners of the court in the first drawing of `ShuttleSet`, px: left, top, right, bottom. The
/// tables state corners in the picture, which tell a later drawing (2.4 px farther right) from it.
pub(super) const SHUTTLE_COURT_PX: [f64; 4] = [25.0, 150.0, 325.0, 810.0];

/// The map from the ground (m, from the middle) to `ShuttleSet`'s drawing with the court's corners
/// at left, top, right and bottom, px.
pub(super) fn shuttle_from_ground(
    [left, top, right, bottom]: [f64; 4],
    field: &FieldModel,
) -> Mat3 {
    // Along the court, away from the camera, is our x; to the left is our y.
    let across = (right - left) / field.width_m;
    let along = (bottom - top) / field.length_m;
    Mat3::new(
        0.0,
        -across,
        f64::midpoint(left, right),
        -along,
        0.0,
        f64::midpoint(top, bottom),
        0.0,
        0.0,
        1.0,
    )
}

impl GroundPlan {
    /// The direction of its matrices, where all of them have one.
    pub(super) const fn usual_direction(self) -> Option<MatrixDirection> {
        match self {
            Self::CentreMetres | Self::CornerMetres => None,
            Self::WorldCup2014 | Self::ShuttleSet => Some(MatrixDirection::PitchFromImage),
        }
    }

    /// How its makers count pixels.
    pub(super) const fn usual_pixels(self) -> Pixels {
        match self {
            Self::WorldCup2014 => Pixels::Centre,
            _ => Pixels::Corner,
        }
    }

    /// The map from the ground (m, from the middle, y away from the camera) to it.
    pub(super) fn plan_from_ground(self, field: &FieldModel) -> Mat3 {
        let half = 0.5 * Vec2::new(field.length_m, field.width_m);
        match self {
            Self::CentreMetres => Mat3::identity(),
            Self::CornerMetres => Mat3::new(1.0, 0.0, half.x, 0.0, -1.0, half.y, 0.0, 0.0, 1.0),
            Self::WorldCup2014 => template_from_ground(TEMPLATE_YD),
            Self::ShuttleSet => shuttle_from_ground(SHUTTLE_COURT_PX, field),
        }
    }
}
