//! What is usual of a camera of which one picture is known.
//!
//! One picture determines the combination of distance and focal length well, each of them badly:
//! moving away and zooming in changes only the perspective. Without a prior of the focal length one
//! picture in eight ends at focal length zero, where all residuals in px vanish. The priors are
//! weak observations: they decide what the lines leave open, and the stated covariance contains
//! them.

use super::LinePicture;
use crate::camera::Ptz;
use crate::field::FieldModel;
use crate::geometry::{Angle, ImageSize, Vec3};
use crate::solve::Loss;
use crate::solve::base::BasePriors;
use crate::solve::base::parameters::{OF_BASE, Shared};
use crate::solve::optimiser::residual::{Linearised, Residual};
use nalgebra::{SMatrix, SVector};

/// Priors of the camera of one picture.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct PicturePriors {
    /// The usual position, `world`, m, on a field 68 m wide; it scales with the field's width.
    pub position_m: Vec3,
    /// Its 1-σ along each axis, m, on a field 68 m wide. Beyond two σ the cost grows with the
    /// logarithm of the distance, so that it forbids no place.
    pub sigma_position_m: Vec3,
    /// The usual focal length, in widths of a 16:9 picture.
    pub focal_widths: f64,
    /// 1-σ of its logarithm.
    pub sigma_log_focal: f64,
    /// The priors of roll, pitch, lens, crown and principal point; that of the position is not
    /// used.
    pub base: BasePriors,
}

impl Default for PicturePriors {
    /// Two published programs place the cameras of 400 broadcast pictures at x 0 ± 4 m, y −65 ± 13
    /// m, z 15 ± 5 m, with focal lengths of 2.7 widths, 16 to 84 % 2.0 to 3.5, and rolls of ±0.4°.
    /// Here all are taken wider.
    fn default() -> Self {
        Self {
            position_m: Vec3::new(0.0, -65.0, 15.5),
            sigma_position_m: Vec3::new(8.0, 15.0, 6.0),
            focal_widths: 2.7,
            sigma_log_focal: 0.5,
            base: BasePriors {
                roll: Angle::from_degrees(0.8),
                ..BasePriors::default()
            },
        }
    }
}

/// The field width to which the positions refer, m.
const WIDTH_M: f64 = 68.0;

impl PicturePriors {
    /// The prior of the position beside a field.
    pub(super) fn place(&self, field: &FieldModel) -> PlacePrior {
        let scale = scale_of(field);
        PlacePrior {
            position_m: self.position_m * scale,
            sigma_m: self.sigma_position_m * scale,
        }
    }

    /// The priors of roll, pitch, lens, crown and principal point of a picture, with its lens where
    /// it is stated.
    pub(super) fn of_base(&self, picture: &LinePicture<'_>) -> BasePriors {
        self.base.with_lens(&picture.lens, picture.image_size)
    }

    /// The prior of the focal length in pictures of a size.
    pub(super) fn focal(&self, image_size: ImageSize) -> FocalPrior {
        FocalPrior {
            focal_px: self.focal_widths * image_size.reference_width_px(),
            sigma_log: self.sigma_log_focal,
        }
    }
}

/// The size of a field as a multiple of the one to which the usual positions refer.
pub(super) fn scale_of(field: &FieldModel) -> f64 {
    field.width_m / WIDTH_M
}

/// The usual place of a camera.
#[derive(Clone, Copy, Debug)]
pub(super) struct PlacePrior {
    position_m: Vec3,
    sigma_m: Vec3,
}

/// The loss of an unusual place.
const PLACE_LOSS: Loss = Loss::Cauchy { c: 2.0 };

impl PlacePrior {
    /// A position's distance from the usual one, sigmas.
    fn off(&self, position_m: Vec3) -> Vec3 {
        (position_m - self.position_m).component_div(&self.sigma_m)
    }

    /// The cost of a position, sigmas².
    pub fn cost(&self, position_m: Vec3) -> f64 {
        PLACE_LOSS.evaluate(self.off(position_m).norm_squared()).0
    }
}

impl Residual<3, OF_BASE, 3> for PlacePrior {
    type State = Shared;

    fn sigma(&self) -> f64 {
        1.0
    }

    fn value(&self, at: &Shared) -> Option<Vec3> {
        Some(self.off(at.base.position_m))
    }

    fn linearise(&self, at: &Shared) -> Option<Linearised<3, OF_BASE, 3>> {
        let mut by_shared = SMatrix::zeros();
        for axis in 0..3 {
            by_shared[(axis, axis)] = self.sigma_m[axis].recip();
        }
        Some(Linearised {
            value: self.value(at)?,
            by_shared,
            by_own: SMatrix::zeros(),
        })
    }

    fn loss(&self, _: Loss) -> Loss {
        PLACE_LOSS
    }
}

/// The usual focal length.
#[derive(Clone, Copy, Debug)]
pub(super) struct FocalPrior {
    focal_px: f64,
    /// 1-σ of the logarithm.
    pub sigma_log: f64,
}

impl FocalPrior {
    /// The cost of a focal length, sigmas².
    pub fn cost(&self, focal_px: f64) -> f64 {
        ((focal_px / self.focal_px).ln() / self.sigma_log).powi(2)
    }
}

impl Residual<1, OF_BASE, 3> for FocalPrior {
    type State = Ptz;

    fn sigma(&self) -> f64 {
        self.sigma_log
    }

    fn value(&self, at: &Ptz) -> Option<SVector<f64, 1>> {
        Some(SVector::<f64, 1>::new((at.focal_px / self.focal_px).ln()))
    }

    fn linearise(&self, at: &Ptz) -> Option<Linearised<1, OF_BASE, 3>> {
        let mut by_own = SMatrix::zeros();
        by_own[2] = 1.0;
        Some(Linearised::without_shared(self.value(at)?, by_own))
    }

    fn loss(&self, _: Loss) -> Loss {
        Loss::Squared
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::solve::base::parameters::Shared;
    use crate::solve::fixtures::base;
    use crate::solve::refine;
    use crate::testing::check_derivatives;
    use crate::testing::soccer;

    #[test]
    fn each_prior_changes_with_the_parameters_as_its_jacobian_says() {
        let field = soccer();
        let priors = PicturePriors::default();
        let shared = Shared::new(&base(), field.crown());
        let place = priors.place(&field);
        check_derivatives(&place, |step, _| shared.apply_step(step)).unwrap();
        let ptz = Ptz::from_degrees(4.0, -12.0, 1900.0);
        let focal = priors.focal(ImageSize::new(960, 540));
        check_derivatives(&focal, |_, step| refine::apply_step(&ptz, step)).unwrap();
        let value = Residual::<1, OF_BASE, 3>::value(&focal, &ptz).unwrap()[0];
        assert!((focal.cost(1900.0) - (value / focal.sigma_log).powi(2)).abs() < 1e-12);
    }

    #[test]
    fn an_unusual_place_costs_more_and_none_is_forbidden() {
        let field = soccer();
        let place = PicturePriors::default().place(&field);
        let costs = [
            [0.0, -65.0, 15.5],
            [20.0, -80.0, 20.0],
            [0.0, 65.0, 15.5],
            [-95.0, 0.0, 12.0],
        ]
        .map(|position| place.cost(Vec3::from(position)));
        assert_eq!(costs[0], 0.0);
        assert!(costs.is_sorted() && costs[3] < 20.0, "{costs:?}");
    }
}
