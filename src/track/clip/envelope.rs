//! A symmetric matrix of 3 × 3 blocks that are zero beyond some distance from the diagonal: its Cholesky factor, and the
//! diagonal blocks of its inverse.
//!
//! A row's blocks begin at its first one that is not zero. A factor has blocks only where the matrix has them, and so has the part
//! of the inverse that leads to its diagonal (Takahashi, Fagan, Chen: "Formation of a sparse bus impedance matrix", 1973).

use crate::geometry::{Mat3, Vec3};

/// The lower triangle of a symmetric matrix.
#[derive(Clone, Debug)]
pub(super) struct Envelope {
    rows: Vec<Row>,
}

/// The blocks of a row from its first one up to the diagonal.
#[derive(Clone, Debug)]
struct Row {
    first: usize,
    blocks: Vec<Mat3>,
}

impl Envelope {
    /// A matrix of zeros whose rows begin at these columns.
    pub fn zeros(first: &[usize]) -> Self {
        let row = |(row, first): (usize, &usize)| Row { first: *first, blocks: vec![Mat3::zeros(); row + 1 - first] };
        Self { rows: first.iter().enumerate().map(row).collect() }
    }

    pub fn len(&self) -> usize {
        self.rows.len()
    }

    /// A block at or below the diagonal, within its row.
    pub fn block_mut(&mut self, row: usize, column: usize) -> &mut Mat3 {
        let Row { first, blocks } = &mut self.rows[row];
        &mut blocks[column - *first]
    }

    fn block(&self, row: usize, column: usize) -> &Mat3 {
        let Row { first, blocks } = &self.rows[row];
        &blocks[column - first]
    }

    fn has(&self, row: usize, column: usize) -> bool {
        self.rows[row].first <= column
    }

    /// The factor L of L Lᵀ; none where the matrix is not positive definite.
    pub fn factored(mut self) -> Option<Factor> {
        let mut inverse_diagonal = Vec::with_capacity(self.len());
        for row in 0..self.len() {
            let (done, rest) = self.rows.split_at_mut(row);
            let Row { first, blocks } = &mut rest[0];
            for column in *first..row {
                let other = &done[column];
                let from = (*first).max(other.first);
                let mut block = blocks[column - *first];
                for k in from..column {
                    block -= blocks[k - *first] * other.blocks[k - other.first].transpose();
                }
                let inverse: &Mat3 = &inverse_diagonal[column];
                blocks[column - *first] = block * inverse.transpose();
            }
            let mut diagonal = blocks[row - *first];
            for block in &blocks[..row - *first] {
                diagonal -= block * block.transpose();
            }
            let lower = diagonal.cholesky()?.l();
            blocks[row - *first] = lower;
            inverse_diagonal.push(lower.try_inverse()?);
        }
        Some(Factor { lower: self, inverse_diagonal })
    }
}

/// A lower triangle L with A = L Lᵀ.
#[derive(Clone, Debug)]
pub(super) struct Factor {
    lower: Envelope,
    inverse_diagonal: Vec<Mat3>,
}

impl Factor {
    /// x of A x = right.
    pub fn solve(&self, right: &[Vec3]) -> Vec<Vec3> {
        let mut x = right.to_vec();
        for row in 0..x.len() {
            let Row { first, blocks } = &self.lower.rows[row];
            let mut value = x[row];
            for (block, before) in blocks[..row - first].iter().zip(&x[*first..row]) {
                value -= block * before;
            }
            x[row] = self.inverse_diagonal[row] * value;
        }
        for row in (0..x.len()).rev() {
            let Row { first, blocks } = &self.lower.rows[row];
            let value = self.inverse_diagonal[row].transpose() * x[row];
            x[row] = value;
            for (block, before) in blocks[..row - first].iter().zip(&mut x[*first..row]) {
                *before -= block.transpose() * value;
            }
        }
        x
    }

    /// The diagonal blocks of the inverse of A.
    pub fn inverse_diagonal_blocks(&self) -> Vec<Mat3> {
        let count = self.lower.len();
        let first: Vec<usize> = self.lower.rows.iter().map(|row| row.first).collect();
        let mut inverse = Envelope::zeros(&first);
        // The rows below the diagonal in which each column has a block.
        let mut below: Vec<Vec<usize>> = vec![Vec::new(); count];
        for row in 0..count {
            for column in &mut below[first[row]..row] {
                column.push(row);
            }
        }
        for column in (0..count).rev() {
            let scale = &self.inverse_diagonal[column];
            let rows = &below[column];
            let factors: Vec<Mat3> = rows.iter().map(|&row| self.lower.block(row, column) * scale).collect();
            for &row in rows {
                let mut value = Mat3::zeros();
                for (&k, factor) in rows.iter().zip(&factors) {
                    if row >= k {
                        value -= inverse.block(row, k) * factor;
                    } else {
                        value -= inverse.block(k, row).transpose() * factor;
                    }
                }
                *inverse.block_mut(row, column) = value;
            }
            let mut diagonal = scale.transpose() * scale;
            for (&k, factor) in rows.iter().zip(&factors) {
                debug_assert!(inverse.has(k, column));
                diagonal -= inverse.block(k, column).transpose() * factor;
            }
            *inverse.block_mut(column, column) = (diagonal + diagonal.transpose()) * 0.5;
        }
        (0..count).map(|row| *inverse.block(row, row)).collect()
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use nalgebra::{DMatrix, DVector};

    const FIRST: [usize; 7] = [0, 0, 1, 0, 3, 5, 4];

    /// A positive definite matrix with these rows' first blocks, as an envelope and dense.
    fn matrix() -> (Envelope, DMatrix<f64>) {
        let mut envelope = Envelope::zeros(&FIRST);
        let mut dense = DMatrix::zeros(21, 21);
        for (row, &first) in FIRST.iter().enumerate() {
            for column in first..=row {
                let value = Mat3::from_fn(|i, j| (7.0 * (row + 3 * column) as f64 + 2.3 * i as f64 + j as f64).sin());
                let symmetric = value + value.transpose() + Mat3::identity() * 30.0;
                let value = if row == column { symmetric } else { value };
                *envelope.block_mut(row, column) = value;
                dense.fixed_view_mut::<3, 3>(3 * row, 3 * column).copy_from(&value);
                dense.fixed_view_mut::<3, 3>(3 * column, 3 * row).copy_from(&value.transpose());
            }
        }
        (envelope, dense)
    }

    #[test]
    fn it_solves_as_a_dense_matrix_does() {
        let (envelope, dense) = matrix();
        let right: Vec<Vec3> = (0..7).map(|at| Vec3::new(1.0, f64::from(at), -0.5)).collect();
        let solved = envelope.factored().unwrap().solve(&right);
        let flat = DVector::from_iterator(21, right.iter().flat_map(|block| block.iter().copied()));
        let expected = dense.cholesky().unwrap().solve(&flat);
        for (row, block) in solved.iter().enumerate() {
            assert!((block - expected.fixed_rows::<3>(3 * row)).norm() < 1e-12);
        }
    }

    #[test]
    fn the_diagonal_of_the_inverse_is_that_of_the_dense_one() {
        let (envelope, dense) = matrix();
        let inverse = dense.try_inverse().unwrap();
        let blocks = envelope.factored().unwrap().inverse_diagonal_blocks();
        for (row, block) in blocks.iter().enumerate() {
            assert!((block - inverse.fixed_view::<3, 3>(3 * row, 3 * row)).norm() < 1e-12, "row {row}");
        }
    }

    #[test]
    fn what_is_not_positive_definite_has_no_factor() {
        let (mut envelope, _) = matrix();
        *envelope.block_mut(4, 4) = Mat3::zeros();
        assert!(envelope.factored().is_none());
    }
}
