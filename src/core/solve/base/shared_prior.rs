//! Priors of the shared parameters, each of one number.

use super::parameters::{CROWN, K1, PRINCIPAL_POINT, ROTATION, SIZE, SLOPE, Shared};
use crate::camera::CameraBase;
use crate::geometry::{Angle, ImagePoint, Mat3, Vec2, Vec3};
use crate::solve::Loss;
use crate::solve::optimiser::residual::{Linearised, Residual};
use nalgebra::{SMatrix, SVector};

/// A Gaussian prior of one number.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(in crate::solve) struct SharedPrior {
    pub of: Expected,
    /// 1-σ, in the number's unit.
    pub sigma: f64,
}

impl SharedPrior {
    /// A prior of a number with its 1-σ.
    pub const fn new(of: Expected, sigma: f64) -> Self {
        Self { of, sigma }
    }
}

/// Which number a prior is about, and its mean.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(in crate::solve) enum Expected {
    /// The base's downward axis has no lean along the direction to the field (unit, `world` x and
    /// y), rad.
    Pitch(Vec2),
    /// The base's downward axis has no lean across that direction, rad.
    Roll(Vec2),
    /// k₁ at the curve's focal length.
    K1(f64),
    /// The change of k₁ per 1000 px.
    Slope(f64),
    /// The height of the crown, m.
    Crown(f64),
    /// The principal point along one axis of the picture, px.
    PrincipalPoint(ImagePoint, usize),
    /// The position along one axis of `world`, m.
    Position(Vec3, usize),
    /// No rotation from another base about one axis of `world`, rad.
    Turn(Mat3, usize),
    /// The difference of one of the field's lengths from that of the clicks' field, m.
    Larger(f64, usize),
}

impl Expected {
    /// The number minus its mean, and its derivatives as (parameter, value).
    fn off(&self, shared: &Shared) -> (f64, [(usize, f64); 2]) {
        let base = &shared.base;
        let down = base.base_from_world.row(1);
        match *self {
            // A rotation by ω (about world x and y) moves the downward axis d by d × ω, whose x and
            // y are −d_z ω_y and d_z ω_x.
            Self::Pitch(view) => {
                let lean = -(view.x * down[0] + view.y * down[1]);
                (
                    lean,
                    [
                        (ROTATION, -view.y * down[2]),
                        (ROTATION + 1, view.x * down[2]),
                    ],
                )
            }
            Self::Roll(view) => {
                let lean = view.y * down[0] - view.x * down[1];
                (
                    lean,
                    [
                        (ROTATION, -view.x * down[2]),
                        (ROTATION + 1, -view.y * down[2]),
                    ],
                )
            }
            Self::K1(expected) => off_in_one(base.distortion.value - expected, K1),
            Self::Slope(expected) => off_in_one(base.distortion.per_1000_px - expected, SLOPE),
            Self::Crown(expected_m) => off_in_one(shared.crown.height_m - expected_m, CROWN),
            Self::PrincipalPoint(expected, axis) => off_in_one(
                base.principal_point.offset_from(expected)[axis],
                PRINCIPAL_POINT + axis,
            ),
            Self::Position(expected_m, axis) => {
                off_in_one(base.position_m[axis] - expected_m[axis], axis)
            }
            // The rotation vector between the two bases, by a further rotation of this one.
            Self::Turn(from, axis) => {
                let other = CameraBase {
                    base_from_world: from,
                    ..*base
                };
                let turn = base.rotation_from(&other);
                let by_turn = rotation_vector_by_turn(turn);
                (
                    turn[axis],
                    [
                        (ROTATION, by_turn[(axis, 0)]),
                        (ROTATION + 1, by_turn[(axis, 1)]),
                    ],
                )
            }
            Self::Larger(expected_m, size) => {
                off_in_one(shared.larger_m[size] - expected_m, SIZE + size)
            }
        }
    }
}

/// The result of [`Expected::off`] for a number that is a parameter itself: the difference, and its
/// derivatives.
const fn off_in_one(value: f64, parameter: usize) -> (f64, [(usize, f64); 2]) {
    (value, [(parameter, 1.0), (parameter, 0.0)])
}

/// The derivative of a rotation vector by a further rotation on its right, for angles below π: the
/// inverse of the right Jacobian of SO(3) (Solà, Deray and Atchuthan, arXiv 1812.01537, eq. 144).
fn rotation_vector_by_turn(vector: Vec3) -> Mat3 {
    // I + ½ [v]ₓ + (1/θ² − (1 + cos θ) / (2 θ sin θ)) [v]ₓ². With the half angle the second
    // fraction is regular at π; the limit of the difference at 0 is 1/12.
    let cross = crate::geometry::rotation::skew(vector);
    let angle = vector.norm();
    let second_order = if angle < 1e-4 {
        1.0 / 12.0
    } else {
        (1.0 - 0.5 * angle / (0.5 * angle).tan()) / (angle * angle)
    };
    Mat3::identity() + cross * 0.5 + cross * cross * second_order
}

impl<const SHARED: usize> Residual<1, SHARED, 3> for SharedPrior {
    type State = Shared;

    fn sigma(&self) -> f64 {
        self.sigma
    }

    fn value(&self, shared: &Shared) -> Option<SVector<f64, 1>> {
        Some(SVector::<f64, 1>::new(self.of.off(shared).0))
    }

    fn linearise(&self, shared: &Shared) -> Option<Linearised<1, SHARED, 3>> {
        let (value, derivatives) = self.of.off(shared);
        let mut by_shared = SMatrix::zeros();
        for (parameter, by) in derivatives {
            by_shared[parameter] += by;
        }
        Some(Linearised {
            value: SVector::<f64, 1>::new(value),
            by_shared,
            by_own: SMatrix::zeros(),
        })
    }

    fn loss(&self, _: Loss) -> Loss {
        Loss::Squared
    }
}

/// Priors that a base equals another one, within a 1-σ of its position (m) and of its rotation
/// about world x and y.
pub(super) fn near(
    base: &CameraBase,
    sigma_m: f64,
    sigma_turn: Angle,
) -> impl Iterator<Item = SharedPrior> + use<> {
    let CameraBase {
        position_m,
        base_from_world,
        ..
    } = *base;
    let position =
        (0..3).map(move |axis| SharedPrior::new(Expected::Position(position_m, axis), sigma_m));
    let turn = (0..2).map(move |axis| {
        SharedPrior::new(Expected::Turn(base_from_world, axis), sigma_turn.radians())
    });
    position.chain(turn)
}

#[cfg(test)]
mod tests {
    use super::super::parameters::{OF_BASE_AND_SIZE, SIZES};
    use super::*;
    use crate::camera::FocalCurve;
    use crate::field::Crown;
    use crate::geometry::rotation::from_rotation_vector;
    use crate::testing::check_derivatives;
    use crate::testing::turned_base;

    #[test]
    fn each_changes_with_the_parameters_as_its_jacobian_says() {
        let base = CameraBase {
            distortion: FocalCurve {
                at_focal_px: 2000.0,
                value: -0.05,
                per_1000_px: 0.2,
                ..FocalCurve::NONE
            },
            ..turned_base(
                [3.0, -62.0, 17.0],
                [0.0, -3.0, 2.0],
                ImagePoint::new(955.0, 543.0),
            )
        };
        let shared = Shared {
            larger_m: [0.5, -0.2],
            width_by_size: [0.0, 1.0],
            ..Shared::new(
                &base,
                Crown {
                    height_m: 0.15,
                    width_m: 68.0,
                },
            )
        };
        let from = base.base_from_world * from_rotation_vector(Vec3::new(0.02, -0.05, 0.03));
        let mut all = vec![
            Expected::K1(0.01),
            Expected::Slope(0.1),
            Expected::Crown(0.1),
        ];
        for view in [Vec2::new(0.0, 1.0), Vec2::new(0.8, -0.6)] {
            all.extend([Expected::Pitch(view), Expected::Roll(view)]);
        }
        all.extend(
            (0..2).map(|axis| Expected::PrincipalPoint(ImagePoint::new(960.0, 540.0), axis)),
        );
        all.extend((0..3).map(|axis| Expected::Position(Vec3::zeros(), axis)));
        all.extend((0..2).map(|axis| Expected::Turn(from, axis)));
        all.extend((0..SIZES).map(|size| Expected::Larger(0.3, size)));
        for of in all {
            let prior = SharedPrior { of, sigma: 0.4 };
            let stepped = |step: &SVector<f64, OF_BASE_AND_SIZE>, _: &Vec3| shared.apply_step(step);
            check_derivatives::<1, OF_BASE_AND_SIZE, 3, _>(&prior, stepped)
                .unwrap_or_else(|error| panic!("{of:?}: {error}"));
        }
    }
}
