//! The parameters of the fit, and what is assumed about them before paint is seen.
//!
//! The equations always have all ten parameters. A number that is not fitted, such as the length of
//! a field of known size, has a prior that is tight enough to hold it. Thus the fit has one form,
//! whatever is known.

use super::super::pose::{PanoramaPose, UPRIGHT_SIGMA};
use crate::autocalibrate::field_prior::{FieldPrior, OpenLength};
use crate::autocalibrate::frames::rotations_by_focal_scale::FocalScale;
use nalgebra::{SMatrix, SVector, Vector1};
use touchline_core::field::FieldModel;
use touchline_core::solve::base::BasePriors;
use touchline_core::solve::{Linearised, Loss, Residual};

/// Number of parameters, and their indices: position (m) and rotation vector (rad) in `world`, log
/// focal scale, crown height (m), length and width of the field (m).
pub(super) const NUM_PARAMETERS: usize = 10;
pub(super) const POSITION: usize = 0;
pub(super) const ROTATION: usize = 3;
const LEAN_ABOUT_X: usize = ROTATION;
const LEAN_ABOUT_Y: usize = ROTATION + 1;
pub(super) const LOG_SCALE: usize = 6;
pub(super) const CROWN: usize = 7;
pub(super) const LENGTHS: usize = 8;

/// 1-σ of a parameter that is not fitted: all ten stay in the equations, and a tight prior holds
/// this one.
const HELD_SIGMA: f64 = 1e-6;

/// The fitted parameters.
#[derive(Clone, Copy)]
pub(super) struct Parameters {
    pub pose: PanoramaPose,
    pub log_scale: f64,
    pub crown_m: f64,
    /// Length and width of the field, m; only the first [`FieldFamily::open_lengths`] count.
    pub lengths_m: [f64; 2],
}

/// The fields that the fit chooses from: one field with other crowns and, where its size is open,
/// other lengths.
pub(super) struct FieldFamily<'a> {
    field: &'a FieldModel,
    size_prior: Option<&'a FieldPrior>,
    /// The lengths to fit: at most two, none without a size prior.
    open_lengths: Vec<OpenLength>,
}

impl<'a> FieldFamily<'a> {
    pub fn new(field: &'a FieldModel, size_prior: Option<&'a FieldPrior>) -> Self {
        let open_lengths = size_prior.map_or_else(Vec::new, |prior| prior.open_lengths(field));
        Self {
            field,
            size_prior,
            open_lengths,
        }
    }

    /// The lengths that the fit begins with; zero for those that are not open.
    pub fn start_lengths_m(&self) -> [f64; 2] {
        [0, 1].map(|index| {
            self.open_lengths
                .get(index)
                .map_or(0.0, |length| length.value_m)
        })
    }

    /// The field with other lengths and another crown. Lengths that are not open are ignored.
    pub fn field_at(&self, lengths_m: [f64; 2], crown_m: f64) -> FieldModel {
        let open_lengths_m = &lengths_m[..self.open_lengths.len()];
        let resized = self
            .size_prior
            .and_then(|prior| prior.with_lengths(open_lengths_m));
        FieldModel {
            crown_m,
            ..resized.unwrap_or_else(|| self.field.clone())
        }
    }
}

/// The priors: the pan axis is vertical (camera heads are levelled), the focal scale is near
/// `scale_prior`, the crown is that of an ordinary pitch, and open lengths are near what the
/// document assumes.
pub(super) fn priors(scale_prior: FocalScale, family: &FieldFamily<'_>) -> Vec<Prior> {
    // Fields that are never crowned keep a crown of zero.
    let (crown_m, crown_sigma_m) = if family.field.may_be_crowned() {
        BasePriors::default().crown_m
    } else {
        (0.0, HELD_SIGMA)
    };
    let mut priors = vec![
        Prior {
            parameter: LEAN_ABOUT_X,
            value: 0.0,
            sigma: UPRIGHT_SIGMA.radians(),
        },
        Prior {
            parameter: LEAN_ABOUT_Y,
            value: 0.0,
            sigma: UPRIGHT_SIGMA.radians(),
        },
        Prior {
            parameter: LOG_SCALE,
            value: scale_prior.log_scale,
            sigma: scale_prior.sigma,
        },
        Prior {
            parameter: CROWN,
            value: crown_m,
            sigma: crown_sigma_m,
        },
    ];
    // Lengths that are not open are held at zero: without a prior the equations would be singular.
    for index in 0..2 {
        let open = family.open_lengths.get(index);
        let (value, sigma) = open.map_or((0.0, HELD_SIGMA), |length| {
            (length.assumed_m, length.sigma_m)
        });
        priors.push(Prior {
            parameter: LENGTHS + index,
            value,
            sigma,
        });
    }
    priors
}

/// A Gaussian prior on one parameter.
pub(super) struct Prior {
    parameter: usize,
    value: f64,
    sigma: f64,
}

impl Prior {
    fn parameter_at(&self, at: &Parameters) -> f64 {
        // The lean is read off the pan axis: a small rotation by ε about x takes (0, 0, 1) to (0,
        // −ε, 1), one about y to (ε, 0, 1).
        let pan_axis = at.pose.world_from_panorama.column(2);
        match self.parameter {
            axis @ POSITION..ROTATION => at.pose.position_m[axis],
            LEAN_ABOUT_X => -pan_axis[1],
            LEAN_ABOUT_Y => pan_axis[0],
            LOG_SCALE => at.log_scale,
            CROWN => at.crown_m,
            length => at.lengths_m[length - LENGTHS],
        }
    }
}

impl Residual<1, 0, NUM_PARAMETERS> for Prior {
    type State = Parameters;

    fn sigma(&self) -> f64 {
        self.sigma
    }

    fn value(&self, at: &Parameters) -> Option<SVector<f64, 1>> {
        Some(Vector1::new(self.parameter_at(at) - self.value))
    }

    fn linearise(&self, at: &Parameters) -> Option<Linearised<1, 0, NUM_PARAMETERS>> {
        let mut by_own = SMatrix::<f64, 1, NUM_PARAMETERS>::zeros();
        by_own[self.parameter] = 1.0;
        Some(Linearised::without_shared(self.value(at)?, by_own))
    }

    fn loss(&self, _: Loss) -> Loss {
        Loss::Squared
    }
}
