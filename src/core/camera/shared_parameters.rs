//! The parameters that all frames of a camera share: their order in matrices and vectors, and the
//! correlations of their errors.
//!
//! A correlation matrix is stored by its entries below the diagonal, so that it is symmetric with
//! ones on the diagonal whatever they are. One that a document states is checked before it is
//! taken. The sizes of the errors are in `base_sigma.rs`.

use nalgebra::{SMatrix, SVector};
use serde::Serialize;

/// The number of parameters that the frames of a camera share: position along `world` x, y, z (m),
/// rotation about `world` x and y (rad), k₁ at the curve's focal length, its slope per 1000 px, the
/// height of the pitch's crown (m), the principal point (px). All matrices and vectors of them are
/// in this order. Rotation about z is the pan gauge, not an error, and is left out.
pub const SHARED_PARAMETERS: usize = 10;

/// A covariance of the shared parameters.
pub type SharedCovariance = SMatrix<f64, SHARED_PARAMETERS, SHARED_PARAMETERS>;

/// One error of the shared parameters.
pub type SharedError = SVector<f64, SHARED_PARAMETERS>;

/// The number of columns of a Jacobian by what frames share: the shared parameters, with the
/// rotation about z inserted behind the two others, and the length and width of the field, as in
/// `BaseSigma::root`.
pub(crate) const SHARED_COLUMNS: usize = SIZE_COLUMN + 2;

/// The column of the field's length in such a Jacobian; that of its width follows.
pub(crate) const SIZE_COLUMN: usize = SHARED_PARAMETERS + 1;

/// The column of the rotation about z in such a Jacobian.
pub(super) const GAUGE: usize = 5;

/// The index of a shared parameter among the columns of such a Jacobian.
pub(super) const fn place(parameter: usize) -> usize {
    if parameter < GAUGE {
        parameter
    } else {
        parameter + 1
    }
}

/// Tolerance of a stated correlation matrix, because documents round its digits.
const ROUNDING: f64 = 1e-3;

/// The correlations between the errors of the shared parameters, in the order of
/// [`SHARED_PARAMETERS`].
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct BaseCorrelation {
    /// Below the diagonal, row by row.
    below_diagonal: [f64; BELOW_DIAGONAL],
}

const BELOW_DIAGONAL: usize = SHARED_PARAMETERS * (SHARED_PARAMETERS - 1) / 2;

impl Default for BaseCorrelation {
    fn default() -> Self {
        Self::NONE
    }
}

impl BaseCorrelation {
    /// Independent errors.
    pub const NONE: Self = Self {
        below_diagonal: [0.0; BELOW_DIAGONAL],
    };

    /// The correlations in a covariance, given the σ of each parameter.
    pub(super) fn of_covariance(covariance: &SharedCovariance, deviation: &SharedError) -> Self {
        let below_diagonal = below_diagonal(|row, column| {
            correlation(covariance[(row, column)], deviation[row], deviation[column])
        });
        Self { below_diagonal }
    }

    /// From the rows of a correlation matrix of the shared parameters, or of the first five of
    /// them: position x, y, z and rotation about x, y. None where it is not a correlation matrix:
    /// not symmetric, not ones on the diagonal, or not positive semidefinite.
    pub fn from_rows(rows: &[Vec<f64>]) -> Option<Self> {
        let size = rows.len();
        if !(size == GAUGE || size == SHARED_PARAMETERS) || rows.iter().any(|row| row.len() != size)
        {
            return None;
        }
        // Parameters that are not stated have independent errors.
        let stated = SharedCovariance::from_fn(|row, column| {
            if row < size && column < size {
                rows[row][column]
            } else {
                f64::from(u8::from(row == column))
            }
        });
        let of_errors = Self {
            below_diagonal: below_diagonal(|row, column| stated[(row, column)]),
        };
        // The matrix of the entries below the diagonal is symmetric with ones on the diagonal, so
        // the stated one has to be equal to it; NaN is not. Only then eigenvalues have a meaning.
        let is_one = (of_errors.matrix() - stated)
            .iter()
            .all(|off| off.abs() <= ROUNDING);
        let can_be = is_one && of_errors.matrix().symmetric_eigenvalues().min() >= -ROUNDING;
        can_be.then_some(of_errors)
    }

    /// The rows of the whole matrix, or only those of the first five parameters if the others are
    /// uncorrelated.
    pub fn rows(&self) -> Vec<Vec<f64>> {
        let matrix = self.matrix();
        let of_pose = GAUGE * (GAUGE - 1) / 2;
        let is_of_pose_alone = self.below_diagonal[of_pose..]
            .iter()
            .all(|share| *share == 0.0);
        let size = if is_of_pose_alone {
            GAUGE
        } else {
            SHARED_PARAMETERS
        };
        (0..size)
            .map(|row| (0..size).map(|column| matrix[(row, column)]).collect())
            .collect()
    }

    /// The correlations below the diagonal, row by row.
    pub const fn below_diagonal(&self) -> &[f64] {
        &self.below_diagonal
    }

    /// From what [`below_diagonal`](Self::below_diagonal) gives; none of another length.
    pub fn from_below_diagonal(values: &[f64]) -> Option<Self> {
        let below_diagonal = values.try_into().ok()?;
        Some(Self { below_diagonal })
    }

    /// The whole matrix.
    pub fn matrix(&self) -> SharedCovariance {
        SharedCovariance::from_fn(|row, column| {
            let (later, earlier) = (row.max(column), row.min(column));
            if row == column {
                1.0
            } else {
                self.below_diagonal[later * (later - 1) / 2 + earlier]
            }
        })
    }
}

impl Serialize for BaseCorrelation {
    fn serialize<S: serde::Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        self.rows().serialize(serializer)
    }
}

/// The correlation of two errors from their covariance and their σ. Zero where a parameter is
/// exactly known (0 / 0) or unknown (∞ / ∞).
fn correlation(covariance: f64, sigma: f64, other_sigma: f64) -> f64 {
    let correlation = covariance / (sigma * other_sigma);
    if correlation.is_finite() {
        correlation.clamp(-1.0, 1.0)
    } else {
        0.0
    }
}

fn below_diagonal(at: impl Fn(usize, usize) -> f64) -> [f64; BELOW_DIAGONAL] {
    let mut places =
        (1..SHARED_PARAMETERS).flat_map(|row| (0..row).map(move |column| (row, column)));
    std::array::from_fn(|_| places.next().map_or(0.0, |(row, column)| at(row, column)))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn only_correlation_matrices_are_taken() {
        let mixed = SharedCovariance::from_fn(|row, column| {
            ((3 * row + 5 * column + row * column) % 11) as f64 - 4.5
        });
        let covariance = mixed * mixed.transpose() + SharedCovariance::identity();
        let deviation = covariance.diagonal().map(f64::sqrt);
        let right = BaseCorrelation::of_covariance(&covariance, &deviation);
        assert_eq!(BaseCorrelation::from_rows(&right.rows()), Some(right));
        let unit: Vec<Vec<f64>> = BaseCorrelation::NONE.rows();
        assert_eq!(
            (unit.len(), BaseCorrelation::from_rows(&unit)),
            (5, Some(BaseCorrelation::NONE))
        );
        let changed = |changes: &[(usize, usize, f64)]| {
            let mut rows = unit.clone();
            for (row, column, value) in changes {
                rows[*row][*column] = *value;
            }
            rows
        };
        let lopsided = changed(&[(0, 1, 0.5)]);
        let impossible = changed(&[
            (0, 1, 0.9),
            (1, 0, 0.9),
            (1, 2, 0.9),
            (2, 1, 0.9),
            (0, 2, -0.9),
            (2, 0, -0.9),
        ]);
        let no_ones = changed(&[(2, 2, 2.0)]);
        for wrong in [
            lopsided,
            impossible,
            no_ones,
            changed(&[(1, 1, f64::NAN)]),
            unit[..4].to_vec(),
            Vec::new(),
        ] {
            assert_eq!(BaseCorrelation::from_rows(&wrong), None, "{wrong:?}");
        }
    }
}
