//! Block Cholesky factorisation in envelope storage, and the diagonal blocks of the inverse.
//!
//! # Why an envelope
//!
//! The normal equations A of a clip have one row of 3 × 3 blocks per frame. Two frames have a block
//! in common only if they show one point, and a point is followed through neighbouring frames:
//! every row is zero up to some column not far left of the diagonal. A row is stored from that
//! column to the diagonal, zeros in between included; this region is the *envelope* of A. The
//! Cholesky factor has the same envelope (George and Liu: "Computer Solution of Large Sparse
//! Positive Definite Systems", 1981, chapter 4). So it is computed in place, without the
//! reordering, symbolic factorisation and index lists of a general sparse solver. For n frames
//! whose rows are w blocks long this takes about n w²/2 products of blocks; a dense factorisation
//! takes n³/6.
//!
//! # Diagonal of the inverse
//!
//! The covariance of a frame is a diagonal block of Z = A⁻¹. Z is dense, but its blocks inside the
//! envelope follow from each other without the rest (Takahashi, Fagan, Chen: "Formation of a sparse
//! bus impedance matrix and its application to short circuit study", 1973). With A = L Lᵀ, Z L =
//! L⁻ᵀ, whose right side is zero below the diagonal. Column j of this equation, from the last to
//! the first:
//!
//! ```text
//! Z_ij = −Σ_{k>j} Z_ik G_kj                    i > j,   G_kj = L_kj L_jj⁻¹
//! Z_jj = L_jj⁻ᵀ L_jj⁻¹ − Σ_{k>j} Z_kjᵀ G_kj
//! ```
//!
//! The sums run over the rows k whose envelope reaches to column j. So does that of row i, and
//! therefore `Z_ik`, the block between two such rows, lies in the envelope too: nothing outside it
//! is needed.

use touchline_core::geometry::{Mat3, Vec3};

/// The lower triangle of a symmetric matrix of 3 × 3 blocks.
#[derive(Clone, Debug)]
pub(super) struct Envelope {
    rows: Vec<BlockRow>,
}

/// The blocks of a row, from the first column of its envelope to the diagonal.
#[derive(Clone, Debug)]
struct BlockRow {
    first_column: usize,
    blocks: Vec<Mat3>,
}

impl BlockRow {
    fn block(&self, column: usize) -> &Mat3 {
        &self.blocks[column - self.first_column]
    }

    fn block_mut(&mut self, column: usize) -> &mut Mat3 {
        &mut self.blocks[column - self.first_column]
    }

    /// The blocks left of the diagonal; those of columns `first_column..row`.
    fn off_diagonal(&self) -> &[Mat3] {
        &self.blocks[..self.blocks.len() - 1]
    }
}

impl Envelope {
    /// A matrix of zeros, given the first column of each row.
    pub fn zeros(first_columns: &[usize]) -> Self {
        let rows = first_columns
            .iter()
            .enumerate()
            .map(|(row, &first_column)| BlockRow {
                first_column,
                blocks: vec![Mat3::zeros(); row + 1 - first_column],
            });
        Self {
            rows: rows.collect(),
        }
    }

    pub fn len(&self) -> usize {
        self.rows.len()
    }

    /// A block at or left of the diagonal.
    ///
    /// # Panics
    /// If the block lies outside the envelope.
    pub fn block_mut(&mut self, row: usize, column: usize) -> &mut Mat3 {
        self.rows[row].block_mut(column)
    }

    fn block(&self, row: usize, column: usize) -> &Mat3 {
        self.rows[row].block(column)
    }

    /// The Cholesky factor; `None` if the matrix is not positive definite.
    ///
    /// Computed row by row, since row i needs only the rows above it:
    ///
    /// ```text
    /// L_ij = (A_ij − Σ_{k<j} L_ik L_jkᵀ) L_jj⁻ᵀ        j < i
    /// L_ii = chol(A_ii − Σ_{k<i} L_ik L_ikᵀ)
    /// ```
    pub fn cholesky(mut self) -> Option<CholeskyFactor> {
        let mut least_pivot_share = 1.0_f64;
        let mut diagonal_inverses: Vec<Mat3> = Vec::with_capacity(self.len());
        for i in 0..self.len() {
            // Row i is computed in place, left to right: what it has of A right of column j is
            // still needed, what is left of it is L already.
            let (finished, rest) = self.rows.split_at_mut(i);
            let row = &mut rest[0];
            for j in row.first_column..i {
                let upper = &finished[j];
                let mut block = *row.block(j);
                // Left of this column one of the two rows is zero.
                for k in row.first_column.max(upper.first_column)..j {
                    block -= row.block(k) * upper.block(k).transpose();
                }
                *row.block_mut(j) = block * diagonal_inverses[j].transpose();
            }
            let mut diagonal = *row.block(i);
            for block in row.off_diagonal() {
                diagonal -= block * block.transpose();
            }
            // What elimination has left of the diagonal, as a share of what was there; see
            // `least_pivot_share`. The block of A is read before L takes its place.
            let lower = diagonal.cholesky()?.l();
            for axis in 0..3 {
                let share = lower[(axis, axis)].powi(2) / row.block(i)[(axis, axis)];
                least_pivot_share = least_pivot_share.min(share);
            }
            *row.block_mut(i) = lower;
            diagonal_inverses.push(lower.try_inverse()?);
        }
        Some(CholeskyFactor {
            lower: self,
            diagonal_inverses,
            least_pivot_share,
        })
    }
}

/// The lower triangle L with A = L Lᵀ.
#[derive(Clone, Debug)]
pub(super) struct CholeskyFactor {
    lower: Envelope,
    /// `L_jj⁻¹` of each row j.
    diagonal_inverses: Vec<Mat3>,
    least_pivot_share: f64,
}

impl CholeskyFactor {
    /// The least `L_kk² / A_kk`: the share of the information on a parameter that remains after the
    /// parameters before it are eliminated. Nearly 0 if the matrix leaves a direction undetermined.
    pub fn least_pivot_share(&self) -> f64 {
        self.least_pivot_share
    }

    /// Solves A x = b.
    pub fn solve(&self, b: &[Vec3]) -> Vec<Vec3> {
        let mut x = b.to_vec();
        // L y = b, from the first row to the last; y takes the place of b.
        for (i, row) in self.lower.rows.iter().enumerate() {
            let mut value = x[i];
            for (block, above) in row.off_diagonal().iter().zip(&x[row.first_column..i]) {
                value -= block * above;
            }
            x[i] = self.diagonal_inverses[i] * value;
        }
        // Lᵀ x = y, from the last row to the first. Row i of L is column i of Lᵀ: once x_i is
        // known, its part is taken from the rows above.
        for (i, row) in self.lower.rows.iter().enumerate().rev() {
            let value = self.diagonal_inverses[i].transpose() * x[i];
            x[i] = value;
            for (block, above) in row.off_diagonal().iter().zip(&mut x[row.first_column..i]) {
                *above -= block.transpose() * value;
            }
        }
        x
    }

    /// The diagonal blocks of A⁻¹, by Takahashi's recursion.
    pub fn diagonal_blocks_of_inverse(&self) -> Vec<Mat3> {
        // Z has the envelope of L. Its columns are computed from the last to the first; column j
        // needs only blocks of Z between rows that reach to j, which are in columns after j.
        let num_rows = self.lower.len();
        let first_columns: Vec<usize> =
            self.lower.rows.iter().map(|row| row.first_column).collect();
        let rows_reaching = self.rows_reaching_columns();
        let mut inverse = Envelope::zeros(&first_columns);
        for j in (0..num_rows).rev() {
            let diagonal_inverse = &self.diagonal_inverses[j];
            let rows = &rows_reaching[j];
            let gains: Vec<Mat3> = rows
                .iter()
                .map(|&k| self.lower.block(k, j) * diagonal_inverse)
                .collect();
            for &i in rows {
                let mut block = Mat3::zeros();
                for (&k, gain) in rows.iter().zip(&gains) {
                    // Only the lower triangle of Z is stored.
                    if i >= k {
                        block -= inverse.block(i, k) * gain;
                    } else {
                        block -= inverse.block(k, i).transpose() * gain;
                    }
                }
                *inverse.block_mut(i, j) = block;
            }
            let mut diagonal = diagonal_inverse.transpose() * diagonal_inverse;
            for (&k, gain) in rows.iter().zip(&gains) {
                diagonal -= inverse.block(k, j).transpose() * gain;
            }
            // Symmetric but for rounding; made exactly so.
            *inverse.block_mut(j, j) = (diagonal + diagonal.transpose()) * 0.5;
        }
        (0..num_rows).map(|i| *inverse.block(i, i)).collect()
    }

    /// For each column, the rows below the diagonal whose envelope reaches to it, ascending.
    fn rows_reaching_columns(&self) -> Vec<Vec<usize>> {
        let mut rows_reaching = vec![Vec::new(); self.lower.len()];
        for (i, row) in self.lower.rows.iter().enumerate() {
            for reaching in &mut rows_reaching[row.first_column..i] {
                reaching.push(i);
            }
        }
        rows_reaching
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use nalgebra::{DMatrix, DVector};

    /// Rows of different lengths, one of them longer than those around it.
    const FIRST_COLUMNS: [usize; 7] = [0, 0, 1, 0, 3, 5, 4];

    /// A positive definite matrix with this envelope, in envelope storage and dense.
    fn envelope_and_dense() -> (Envelope, DMatrix<f64>) {
        let mut envelope = Envelope::zeros(&FIRST_COLUMNS);
        let mut dense = DMatrix::zeros(21, 21);
        for (row, &first_column) in FIRST_COLUMNS.iter().enumerate() {
            for column in first_column..=row {
                let value = Mat3::from_fn(|i, j| {
                    (7.0 * (row + 3 * column) as f64 + 2.3 * i as f64 + j as f64).sin()
                });
                let symmetric = value + value.transpose() + Mat3::identity() * 30.0;
                let value = if row == column { symmetric } else { value };
                *envelope.block_mut(row, column) = value;
                dense
                    .fixed_view_mut::<3, 3>(3 * row, 3 * column)
                    .copy_from(&value);
                dense
                    .fixed_view_mut::<3, 3>(3 * column, 3 * row)
                    .copy_from(&value.transpose());
            }
        }
        (envelope, dense)
    }

    #[test]
    fn solves_as_a_dense_factorisation_does() {
        let (envelope, dense) = envelope_and_dense();
        let b: Vec<Vec3> = (0..7)
            .map(|at| Vec3::new(1.0, f64::from(at), -0.5))
            .collect();
        let x = envelope.cholesky().unwrap().solve(&b);
        let flat = DVector::from_iterator(21, b.iter().flat_map(|block| block.iter().copied()));
        let expected = dense.cholesky().unwrap().solve(&flat);
        for (row, block) in x.iter().enumerate() {
            assert!((block - expected.fixed_rows::<3>(3 * row)).norm() < 1e-12);
        }
    }

    #[test]
    fn diagonal_blocks_are_those_of_the_dense_inverse() {
        let (envelope, dense) = envelope_and_dense();
        let inverse = dense.try_inverse().unwrap();
        let blocks = envelope.cholesky().unwrap().diagonal_blocks_of_inverse();
        for (row, block) in blocks.iter().enumerate() {
            assert!(
                (block - inverse.fixed_view::<3, 3>(3 * row, 3 * row)).norm() < 1e-12,
                "row {row}"
            );
        }
    }

    #[test]
    fn a_matrix_that_is_not_positive_definite_has_no_factor() {
        let (mut envelope, _) = envelope_and_dense();
        *envelope.block_mut(4, 4) = Mat3::zeros();
        assert!(envelope.cholesky().is_none());
    }
}
