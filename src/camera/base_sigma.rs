//! How well a base is known, and how the errors of its parameters go together.

use crate::geometry::Vec3;
use nalgebra::{Matrix5, Matrix6};
use serde::Serialize;

/// A correlation matrix may be off by this much: rounded digits.
const ROUNDING: f64 = 1e-3;

/// Prior 1-σ of a base; zero means exactly known.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize)]
pub struct BaseSigma {
    /// Of the position, along world x, y, z, m.
    pub position_m: Vec3,
    /// Of the base rotation, about world x, y, z (z is the pan gauge), rad.
    #[serde(rename = "rotation_rad")]
    pub rotation: Vec3,
    /// How these errors go together: a camera that is taken to stand too far off is taken to look too steeply as well, and its
    /// pictures hardly show either.
    pub correlation: BaseCorrelation,
}

/// The correlations between the errors of a base's position (along world x, y, z) and rotation (about world x, y); about z
/// it is the pan gauge and goes with nothing.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize)]
#[serde(transparent)]
pub struct BaseCorrelation {
    /// Below the diagonal, row by row.
    below_diagonal: [f64; 10],
}

impl BaseSigma {
    /// From the covariance of position (m) and rotation about world x and y (rad).
    #[must_use]
    pub fn of_covariance(covariance: &Matrix5<f64>) -> Self {
        let deviation = covariance.diagonal().map(|variance| variance.max(0.0).sqrt());
        let share = |row: usize, column: usize| {
            let share = covariance[(row, column)] / (deviation[row] * deviation[column]);
            if share.is_finite() { share.clamp(-1.0, 1.0) } else { 0.0 }
        };
        Self {
            position_m: deviation.fixed_rows::<3>(0).into_owned(),
            rotation: Vec3::new(deviation[3], deviation[4], 0.0),
            correlation: BaseCorrelation { below_diagonal: below_diagonal(share) },
        }
    }

    /// The same with one more error of the position, which goes with no other: 1-σ along `world` x, y, z, m.
    #[must_use]
    pub fn with_error_along(self, position_m: Vec3) -> Self {
        let correlation = self.correlation.matrix();
        let sigma = |row: usize| if row < 3 { self.position_m[row] } else { self.rotation[row - 3] };
        let error = |row: usize| if row < 3 { position_m[row] } else { 0.0 };
        let covariance = Matrix5::from_fn(|row, column| {
            correlation[(row, column)] * sigma(row) * sigma(column) + error(row) * error(column)
        });
        Self { rotation: self.rotation, ..Self::of_covariance(&covariance) }
    }

    /// A matrix L: L Lᵀ is the covariance of position (m) and of rotation as a vector in `world` (rad).
    #[must_use]
    pub fn root(&self) -> Matrix6<f64> {
        let correlation = self.correlation.matrix();
        let mut root = Matrix6::identity();
        for column in 0..5 {
            let known = |row: usize, root: &Matrix6<f64>| -> f64 {
                (0..column).map(|before| root[(row, before)] * root[(column, before)]).sum()
            };
            // Parameters that are known to go together leave nothing of their own: no division by it.
            let own = correlation[(column, column)] - known(column, &root);
            root[(column, column)] = own.max(0.0).sqrt();
            for row in column + 1..5 {
                let shared = correlation[(row, column)] - known(row, &root);
                root[(row, column)] = if own > 1e-12 { shared / own.sqrt() } else { 0.0 };
            }
        }
        for (row, sigma) in self.position_m.iter().chain(self.rotation.iter()).enumerate() {
            // What is not known at all is infinite where it counts, and nowhere else.
            root.row_mut(row).iter_mut().filter(|entry| **entry != 0.0).for_each(|entry| *entry *= sigma);
        }
        root
    }
}

impl BaseCorrelation {
    /// Errors that have nothing to do with each other.
    pub const NONE: Self = Self { below_diagonal: [0.0; 10] };

    /// From a correlation matrix of position x, y, z and rotation about x, y; none where it is no such matrix: not symmetric, with
    /// another diagonal than ones, or of errors that no numbers can have together.
    #[must_use]
    pub fn new(matrix: &Matrix5<f64>) -> Option<Self> {
        let of_errors = Self { below_diagonal: below_diagonal(|row, column| matrix[(row, column)]) };
        let is_one = (of_errors.matrix() - matrix).iter().all(|off| off.abs() <= ROUNDING);
        let can_be = is_one && of_errors.matrix().symmetric_eigenvalues().min() >= -ROUNDING;
        can_be.then_some(of_errors)
    }

    /// The whole matrix.
    #[must_use]
    pub fn matrix(&self) -> Matrix5<f64> {
        Matrix5::from_fn(|row, column| {
            let (later, earlier) = (row.max(column), row.min(column));
            if row == column { 1.0 } else { self.below_diagonal[later * (later - 1) / 2 + earlier] }
        })
    }
}

fn below_diagonal(at: impl Fn(usize, usize) -> f64) -> [f64; 10] {
    let mut places = (1..5).flat_map(|row| (0..row).map(move |column| (row, column)));
    std::array::from_fn(|_| places.next().map_or(0.0, |(row, column)| at(row, column)))
}

#[cfg(test)]
mod tests {
    use super::*;

    fn covariance() -> Matrix5<f64> {
        let mixed = Matrix5::from_fn(|row, column| ((3 * row + 5 * column) % 7) as f64 - 2.5);
        let scale = Matrix5::from_diagonal(&nalgebra::Vector5::new(0.1, 0.3, 0.2, 1e-3, 2e-3));
        scale * mixed * mixed.transpose() * scale
    }

    #[test]
    fn a_covariance_comes_back_from_its_root() {
        let covariance = covariance();
        let sigma = BaseSigma::of_covariance(&covariance);
        let again = sigma.root() * sigma.root().transpose();
        for (row, column) in (0..5).flat_map(|row| (0..5).map(move |column| (row, column))) {
            let scale = (covariance[(row, row)] * covariance[(column, column)]).sqrt();
            assert!((again[(row, column)] - covariance[(row, column)]).abs() < 1e-12 * scale, "{row} {column}");
        }
        assert_eq!(again.row(5).amax(), 0.0, "the pan gauge is exact");
    }

    #[test]
    fn one_more_error_of_the_position_adds_its_covariance() {
        let along = Vec3::new(0.6, -0.2, 0.0);
        let sigma = BaseSigma::of_covariance(&covariance()).with_error_along(along);
        let mut expected = covariance();
        let mut position = expected.fixed_view_mut::<3, 3>(0, 0);
        position += along * along.transpose();
        let root = sigma.root().fixed_view::<5, 5>(0, 0).into_owned();
        assert!((root * root.transpose() - expected).amax() < 1e-12);
        let unknown = BaseSigma::of_covariance(&Matrix5::from_diagonal_element(f64::INFINITY)).with_error_along(along);
        assert_eq!(unknown.position_m.x, f64::INFINITY);
    }

    #[test]
    fn errors_of_one_cause_have_a_root() {
        let one = nalgebra::Vector5::new(1.0, 2.0, 3.0, 0.1, -0.2);
        let covariance = one * one.transpose();
        let root = BaseSigma::of_covariance(&covariance).root().fixed_view::<5, 5>(0, 0).into_owned();
        assert!((root * root.transpose() - covariance).amax() < 1e-12);
        assert!(root.columns(1, 4).amax() < 1e-6, "{root}");
    }

    #[test]
    fn what_is_not_known_at_all_goes_with_nothing() {
        let sigma = BaseSigma::of_covariance(&Matrix5::from_diagonal_element(f64::INFINITY));
        assert_eq!((sigma.position_m.x, sigma.correlation), (f64::INFINITY, BaseCorrelation::NONE));
        assert_eq!(BaseSigma::default().root(), Matrix6::identity().scale(0.0));
    }

    #[test]
    fn only_correlation_matrices_are_taken() {
        let right = BaseSigma::of_covariance(&covariance()).correlation;
        assert_eq!(BaseCorrelation::new(&right.matrix()), Some(right));
        assert_eq!(BaseCorrelation::new(&Matrix5::identity()), Some(BaseCorrelation::NONE));
        let mut lopsided = Matrix5::identity();
        lopsided[(0, 1)] = 0.5;
        let mut impossible = Matrix5::identity();
        for (row, column, value) in [(0, 1, 0.9), (1, 2, 0.9), (0, 2, -0.9)] {
            (impossible[(row, column)], impossible[(column, row)]) = (value, value);
        }
        for wrong in [Matrix5::identity() * 2.0, lopsided, impossible, Matrix5::from_element(f64::NAN)] {
            assert_eq!(BaseCorrelation::new(&wrong), None, "{wrong}");
        }
    }
}
