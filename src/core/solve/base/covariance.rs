//! The covariance of a base whose model fixes parameters that are not exact in reality.
//!
//! A model without distortion, with a level pitch or with its principal point in the middle fixes
//! parameters that a real camera does not have exactly. Each of them is uncertain by its prior, and
//! its error propagates to all adjusted parameters.

use super::bundle::{Bundle, BundleState, keep_determined};
use super::parameters::{OF_BASE, PRINCIPAL_POINT, free_parameters};
use super::shared_prior::SharedPrior;
use super::{BaseModel, CrownModel, LensModel, Prescribed};
use crate::camera::SharedCovariance;
use crate::field::FieldModel;
use crate::solve::optimiser::least_squares::Problem as _;
use nalgebra::{SMatrix, Vector2};

/// The result of an adjustment, with what its covariance depends on.
pub(super) struct Adjusted<'a> {
    pub state: &'a BundleState,
    pub model: &'a BaseModel,
    pub field: &'a FieldModel,
    pub noise_scale: f64,
    pub prescribed: Prescribed,
    /// The 1-σ of a principal point about the middle, px.
    pub principal_point_px: f64,
}

impl Adjusted<'_> {
    /// The covariance of the shared parameters. `priors` gives those of the parameters that a model
    /// leaves free.
    ///
    /// Lens and crown were fixed because the clicks do not determine them: their posterior is
    /// computed as if they were free. The principal point is fixed whatever the clicks show, so its
    /// whole prior is an error that the adjustment did not compensate (a "considered" parameter;
    /// Schmidt 1966, Tapley, Schutz and Born, Statistical Orbit Determination, chapter 6).
    pub fn covariance(
        &self,
        mut bundle: Bundle<OF_BASE>,
        priors: &dyn Fn(&BaseModel) -> Vec<SharedPrior>,
    ) -> SharedCovariance {
        // Free the lens and the crown unless the user prescribed them.
        let lens = if self.prescribed.lens {
            self.model.lens
        } else {
            LensModel::K1Focal
        };
        let is_level = self.prescribed.crown || !self.field.may_be_crowned();
        let crown = if is_level {
            self.model.crown
        } else {
            CrownModel::Free
        };
        let uncertain = BaseModel {
            lens,
            crown,
            ..*self.model
        };
        bundle.free = free_parameters(&uncertain);
        bundle.priors = priors(&uncertain);
        let covariance = bundle.covariance(self.state, self.noise_scale);
        if self.model.principal_point.is_some() || self.prescribed.principal_point {
            return covariance;
        }

        // The principal point as a considered parameter: H of the parameters that are free, and the
        // coupling B of the principal point with them.
        let mut equations = keep_determined(bundle.equations(self.state));
        let held = equations
            .eliminate_blocks(0.0)
            .and_then(|(matrix, _)| matrix.try_inverse());
        let middle = Some(self.state.shared.base.principal_point);
        equations.free = free_parameters(&BaseModel {
            principal_point: middle,
            ..uncertain
        });
        let with_all = equations.eliminate_blocks(0.0);
        // Singular equations made the covariance infinite already; nothing is to be added to that.
        let (Some(inverse), Some((information, _))) = (held, with_all) else {
            return covariance;
        };
        // All other parameters change by −H⁻¹ B per px of error of the principal point.
        let mut mixed = information.fixed_columns::<2>(PRINCIPAL_POINT).into_owned();
        mixed.fixed_rows_mut::<2>(PRINCIPAL_POINT).fill(0.0);
        let mut moved: SMatrix<f64, OF_BASE, 2> = -inverse * mixed;
        moved
            .fixed_rows_mut::<2>(PRINCIPAL_POINT)
            .fill_diagonal(1.0);
        let variance =
            SMatrix::<f64, 2, 2>::from_diagonal(&Vector2::repeat(self.principal_point_px.powi(2)));
        covariance + moved * variance * moved.transpose()
    }
}
