//! Normal equations as one dense matrix, for parameters that are coupled with each other, such as
//! those of frames with pairwise matches.

use super::least_squares::Equations;
use super::loss::LossSum;
use crate::solve::Loss;
use nalgebra::{DMatrix, DVector, SVector};

/// Jᵀ W J and Jᵀ W r of residuals that each depend on a few of many parameters.
#[derive(Clone, Debug)]
pub struct DenseEquations {
    /// The lower triangle of Jᵀ W J.
    matrix: DMatrix<f64>,
    gradient: DVector<f64>,
    losses: LossSum,
}

impl DenseEquations {
    /// No residual yet.
    pub fn zero(parameters: usize) -> Self {
        let (matrix, gradient) = (
            DMatrix::zeros(parameters, parameters),
            DVector::zeros(parameters),
        );
        Self {
            matrix,
            gradient,
            losses: LossSum::ZERO,
        }
    }

    /// Adds a residual: its value, its 1-σ, and its derivatives by the parameters on which it
    /// depends, each parameter once, as (parameter, column).
    pub fn add<const ROWS: usize>(
        &mut self,
        value: &SVector<f64, ROWS>,
        sigma: f64,
        by: &[(usize, SVector<f64, ROWS>)],
        loss: Loss,
    ) {
        let precision = 1.0 / (sigma * sigma);
        let weight = precision * self.losses.add(value.norm_squared() * precision, loss);
        // Each pair of parameters once, in the lower triangle, whatever their order in `by`.
        for (place, &(row, of_row)) in by.iter().enumerate() {
            self.gradient[row] += weight * of_row.dot(value);
            for &(column, of_column) in &by[..=place] {
                self.matrix[(row.max(column), row.min(column))] += weight * of_row.dot(&of_column);
            }
        }
    }

    /// The covariance of all parameters; none where a combination of them is not determined.
    pub fn covariance(&self) -> Option<DMatrix<f64>> {
        /// A parameter is undetermined if its information, given the parameters before it, is less
        /// than this fraction of its information by itself.
        const OPEN: f64 = 1e-12;
        // Scale to a unit diagonal, so that the pivots of the Cholesky factor are relative to each
        // parameter's own information, whatever its unit.
        let mut scale = self.matrix.diagonal();
        if scale.iter().any(|information| !(*information > 0.0)) {
            return None;
        }
        scale.apply(|information| *information = information.sqrt().recip());
        let scaled = DMatrix::from_fn(scale.len(), scale.len(), |row, column| {
            let lower = self.matrix[(row.max(column), row.min(column))];
            lower * scale[row] * scale[column]
        });
        // The square of a pivot is the share of a parameter's information that the parameters
        // before it leave.
        let factor = scaled.cholesky()?;
        if factor
            .l_dirty()
            .diagonal()
            .iter()
            .any(|root| root * root < OPEN)
        {
            return None;
        }
        let inverse = factor.inverse();
        Some(DMatrix::from_fn(scale.len(), scale.len(), |row, column| {
            inverse[(row, column)] * scale[row] * scale[column]
        }))
    }
}

impl Equations for DenseEquations {
    type Step = DVector<f64>;

    fn cost(&self) -> f64 {
        self.losses.total()
    }

    fn step(&self, damping: f64) -> Option<DVector<f64>> {
        // Cholesky reads the lower triangle alone.
        let mut matrix = self.matrix.clone();
        for parameter in 0..matrix.nrows() {
            matrix[(parameter, parameter)] *= 1.0 + damping;
        }
        Some(-matrix.cholesky()?.solve(&self.gradient))
    }

    fn length(step: &DVector<f64>) -> f64 {
        step.norm()
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use nalgebra::Vector1;

    #[test]
    fn the_step_leads_to_the_minimum_of_squares() {
        // Two heights, their difference measured once with 1-σ 0.5 and each of them with 1-σ 1 and
        // 2.
        let mut equations = DenseEquations::zero(2);
        let one = |value: f64| Vector1::new(value);
        equations.add(&one(-3.0), 1.0, &[(0, one(1.0))], Loss::Squared);
        equations.add(&one(-5.0), 2.0, &[(1, one(1.0))], Loss::Squared);
        equations.add(
            &one(-1.0),
            0.5,
            &[(1, one(1.0)), (0, one(-1.0))],
            Loss::Squared,
        );
        let step = equations.step(0.0).unwrap();
        let normal = nalgebra::Matrix2::new(1.0 + 4.0, -4.0, -4.0, 0.25 + 4.0);
        let right = nalgebra::Vector2::new(3.0 - 4.0, 5.0 / 4.0 + 4.0);
        let expected = normal.try_inverse().unwrap() * right;
        assert!((step[0] - expected[0]).abs() < 1e-12 && (step[1] - expected[1]).abs() < 1e-12);
        assert!((equations.cost() - (9.0 + 6.25 + 4.0)).abs() < 1e-12);
    }

    #[test]
    fn the_covariance_is_that_of_what_was_measured() {
        let mut equations = DenseEquations::zero(2);
        let one = |value: f64| Vector1::new(value);
        equations.add(&one(0.3), 2.0, &[(0, one(1.0))], Loss::Squared);
        equations.add(
            &one(0.1),
            1.0,
            &[(1, one(1.0)), (0, one(-1.0))],
            Loss::Squared,
        );
        let covariance = equations.covariance().unwrap();
        assert!(
            (covariance[(0, 0)] - 4.0).abs() < 1e-12 && (covariance[(1, 1)] - 5.0).abs() < 1e-12
        );
        assert!((covariance[(0, 1)] - 4.0).abs() < 1e-12);
    }

    #[test]
    fn a_parameter_that_nothing_measures_has_no_step() {
        let mut equations = DenseEquations::zero(2);
        equations.add(
            &Vector1::new(1.0),
            1.0,
            &[(0, Vector1::new(1.0))],
            Loss::Squared,
        );
        assert!(equations.step(1e-3).is_none() && equations.covariance().is_none());
    }
}
