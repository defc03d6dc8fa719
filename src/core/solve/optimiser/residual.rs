//! The residuals of least-squares problems: one trait for clicks, priors and other measurements.
//!
//! A new kind of measurement is one type with one implementation of [`Residual`].
//! [`BlockEquations::add`] takes it, and
//! [`check_derivatives`](crate::solve::check_derivatives) tests its Jacobian.
//!
//! [`BlockEquations::add`]: super::least_squares::BlockEquations::add

use crate::solve::Loss;
use nalgebra::{SMatrix, SVector};

/// A measurement as `ROWS` numbers that are zero for the true parameters without noise.
///
/// The parameters come in two groups: `SHARED` ones that all pictures have in common (none where
/// the base is known), and `OWN` ones of one picture (pan in rad, tilt in rad, logarithm of the
/// focal length).
pub trait Residual<const ROWS: usize, const SHARED: usize, const OWN: usize> {
    /// What it is evaluated at, such as a camera.
    type State;

    /// 1-σ of each of its numbers, in their unit.
    fn sigma(&self) -> f64;

    /// Its numbers; none where the state predicts nothing to compare with, such as a point behind
    /// the camera.
    fn value(&self, at: &Self::State) -> Option<SVector<f64, ROWS>>;

    /// Its numbers and their derivatives by the parameters.
    fn linearise(&self, at: &Self::State) -> Option<Linearised<ROWS, SHARED, OWN>>;

    /// The loss of this residual, where `usual` is the loss of the problem's clicks.
    fn loss(&self, usual: Loss) -> Loss {
        usual
    }
}

/// A residual and its Jacobian.
#[derive(Clone, Copy, Debug)]
pub struct Linearised<const ROWS: usize, const SHARED: usize, const OWN: usize> {
    /// Its numbers, in their unit.
    pub value: SVector<f64, ROWS>,
    /// Their derivatives by the shared parameters.
    pub by_shared: SMatrix<f64, ROWS, SHARED>,
    /// Their derivatives by the block's own parameters.
    pub by_own: SMatrix<f64, ROWS, OWN>,
}

impl<const ROWS: usize, const SHARED: usize, const OWN: usize> Linearised<ROWS, SHARED, OWN> {
    /// A residual that does not depend on the shared parameters.
    pub fn without_shared(value: SVector<f64, ROWS>, by_own: SMatrix<f64, ROWS, OWN>) -> Self {
        Self {
            value,
            by_shared: SMatrix::zeros(),
            by_own,
        }
    }
}
