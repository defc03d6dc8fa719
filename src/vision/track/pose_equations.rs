//! The normal equations of frames that are adjusted together: three unknowns per frame (pan rad,
//! tilt rad, ln f), two per point (its direction).
//!
//! The points are eliminated by the Schur complement (Triggs, McLauchlan, Hartley, Fitzgibbon:
//! "Bundle adjustment – a modern synthesis", 2000, section 6). With the frames' block U, the
//! points' block V, their coupling W and the gradients g and h:
//!
//! ```text
//! (U − W V⁻¹ Wᵀ) δ = −(g − W V⁻¹ h)        ε = −V⁻¹ (h + Wᵀ δ)
//! ```
//!
//! V is block diagonal, so the elimination costs one 2 × 2 inverse per point.

use super::envelope::{CholeskyFactor, Envelope};
use nalgebra::{Matrix2, Matrix2x3, Matrix3x2};
use touchline_core::geometry::{Mat3, Vec2, Vec3};
use touchline_core::solve::{Equations, Loss, NO_VALUE_SIGMAS};

/// The part of the normal equations that the observations of one point contribute.
#[derive(Clone, Debug)]
pub(super) struct PointEquations {
    /// For each frame that shows it: the frame's row, its part of U and of g, and its part of W.
    frames: Vec<(usize, Mat3, Vec3, Matrix3x2<f64>)>,
    /// Its block of V.
    point: Matrix2<f64>,
    gradient: Vec2,
    cost: f64,
}

impl PointEquations {
    /// No observation yet, with memory for this many.
    pub fn with_room(sightings: usize) -> Self {
        Self {
            frames: Vec::with_capacity(sightings),
            point: Matrix2::zeros(),
            gradient: Vec2::zeros(),
            cost: 0.0,
        }
    }

    /// Adds an observation that the state cannot predict: a constant cost, so that a step that
    /// causes it is rejected, and no gradient.
    pub fn beyond_the_lens(&mut self, loss: Loss) {
        self.cost += loss.evaluate(NO_VALUE_SIGMAS * NO_VALUE_SIGMAS).0;
    }

    /// Adds an observation: its residual, px, and the derivatives of the residual.
    pub fn add(
        &mut self,
        row: usize,
        value: Vec2,
        by_frame: &Matrix2x3<f64>,
        by_point: &Matrix2<f64>,
        precision: f64,
        loss: Loss,
    ) {
        // The robust loss as iteratively reweighted least squares: with the weight of this state,
        // Jᵀ J is added to the blocks U, V and W, and Jᵀ r to the gradients g and h.
        let (cost, weight) = loss.evaluate(value.norm_squared() * precision);
        self.cost += cost;
        let frame_weighted = by_frame.transpose() * (weight * precision);
        let point_weighted = by_point.transpose() * (weight * precision);
        self.frames.push((
            row,
            frame_weighted * by_frame,
            frame_weighted * value,
            frame_weighted * by_point,
        ));
        self.point += point_weighted * by_point;
        self.gradient += point_weighted * value;
    }

    /// V⁻¹ with Marquardt damping; `None` if the observations do not determine the point. One
    /// observation does, so that this is a point without any.
    fn inverse(&self, damping: f64) -> Option<Matrix2<f64>> {
        let mut point = self.point;
        point[(0, 0)] *= 1.0 + damping;
        point[(1, 1)] *= 1.0 + damping;
        point
            .try_inverse()
            .filter(|inverse| inverse.iter().all(|value| value.is_finite()))
    }

    /// The step ε = −V⁻¹ (h + Wᵀ δ) of the point's direction, rad, given the steps δ of all frames;
    /// zero if the observations do not determine the point.
    fn back_substitute(&self, frame_steps: &[Vec3], damping: f64) -> Vec2 {
        let Some(inverse) = self.inverse(damping) else {
            return Vec2::zeros();
        };
        let along = self
            .frames
            .iter()
            .map(|(row, _, _, cross)| cross.transpose() * frame_steps[*row]);
        -(inverse * (self.gradient + along.sum::<Vec2>()))
    }
}

/// The off-diagonal block of U that couples two frames.
#[derive(Clone, Debug)]
struct PairBlock {
    /// The row of the later frame, and that of the earlier one.
    row: usize,
    column: usize,
    block: Mat3,
}

/// A residual between two frames and its derivatives.
pub(super) struct PairResidual {
    pub value: Vec3,
    /// The frames' rows.
    pub rows: [usize; 2],
    /// By (pan rad, tilt rad, ln f) of each frame.
    pub by_frame: [Mat3; 2],
    pub precision: f64,
}

/// The equations of all frames and points.
#[derive(Clone, Debug)]
pub(super) struct PoseEquations {
    /// The first column of each row's envelope.
    first: Vec<usize>,
    /// The diagonal blocks of U and g, without the parts that points contribute.
    frames: Vec<(Mat3, Vec3)>,
    /// The off-diagonal blocks of U, from matches between two frames.
    pairs: Vec<PairBlock>,
    points: Vec<PointEquations>,
    cost: f64,
}

/// An update of all frames and points.
pub(super) struct PoseStep {
    /// (pan rad, tilt rad, ln f).
    pub frames: Vec<Vec3>,
    /// Along the two tangent directions of the point's direction, rad.
    pub directions: Vec<Vec2>,
}

impl PoseEquations {
    pub fn new(first: Vec<usize>, points: Vec<PointEquations>) -> Self {
        let cost = points.iter().map(|point| point.cost).sum();
        let frames = vec![(Mat3::zeros(), Vec3::zeros()); first.len()];
        Self {
            first,
            frames,
            pairs: Vec::new(),
            points,
            cost,
        }
    }

    /// Adds a residual that has no value in this state: a constant cost, and no gradient.
    pub fn add_without_value(&mut self, loss: Loss) {
        self.cost += loss.evaluate(NO_VALUE_SIGMAS * NO_VALUE_SIGMAS).0;
    }

    /// Adds a residual between two frames.
    pub fn add_pair(&mut self, residual: &PairResidual, loss: Loss) {
        let PairResidual {
            value,
            rows: [one, other],
            by_frame: [by_one, by_other],
            precision,
        } = residual;
        let (cost, weight) = loss.evaluate(value.norm_squared() * precision);
        self.cost += cost;
        for (row, by) in [(one, by_one), (other, by_other)] {
            let weighted = by.transpose() * (weight * precision);
            let (block, gradient) = &mut self.frames[*row];
            *block += weighted * by;
            *gradient += weighted * value;
        }
        // The envelope stores the lower triangle only: the later frame is the row. Matches of one
        // pair come in succession, so comparing with the last block suffices to accumulate them.
        let ((row, by_row), (column, by_column)) = if one > other {
            ((*one, by_one), (*other, by_other))
        } else {
            ((*other, by_other), (*one, by_one))
        };
        let block = by_row.transpose() * (weight * precision) * by_column;
        match self
            .pairs
            .last_mut()
            .filter(|last| (last.row, last.column) == (row, column))
        {
            Some(last) => last.block += block,
            None => self.pairs.push(PairBlock { row, column, block }),
        }
    }

    /// Adds a prior of a single frame: offset and information in (pan rad, tilt rad, ln f).
    pub fn add_prior(&mut self, row: usize, offset: &Vec3, information: &Mat3, loss: Loss) {
        let by_information = information * offset;
        let (cost, weight) = loss.evaluate(offset.dot(&by_information));
        self.cost += cost;
        let (block, gradient) = &mut self.frames[row];
        *block += information * weight;
        *gradient += by_information * weight;
    }

    /// The Cholesky factor of U − W V⁻¹ Wᵀ, and g − W V⁻¹ h. `None` if the matrix is not positive
    /// definite.
    fn eliminate_points(&self, damping: f64) -> Option<(CholeskyFactor, Vec<Vec3>)> {
        // U and g: priors and pairwise residuals first, then the parts of the points.
        let mut matrix = Envelope::zeros(&self.first);
        let mut gradient: Vec<Vec3> = self.frames.iter().map(|(_, gradient)| *gradient).collect();
        // All lie in the envelope, which the caller has built from the same points and pairs.
        for (row, (block, _)) in self.frames.iter().enumerate() {
            *matrix.block_mut(row, row) += block;
        }
        for (row, block, own, _) in self.points.iter().flat_map(|point| &point.frames) {
            *matrix.block_mut(*row, *row) += block;
            gradient[*row] += own;
        }
        for PairBlock { row, column, block } in &self.pairs {
            *matrix.block_mut(*row, *column) += block;
        }
        // Marquardt's damping scales the diagonal of U, as it scales that of V in `inverse`; it has
        // to come before the elimination.
        for row in 0..matrix.len() {
            let block = matrix.block_mut(row, row);
            for at in 0..3 {
                block[(at, at)] *= 1.0 + damping;
            }
        }
        for point in &self.points {
            // An undetermined point has no observation, hence nothing in U to eliminate it from;
            // its own step is zero.
            let Some(inverse) = point.inverse(damping) else {
                continue;
            };
            // Subtract W V⁻¹ Wᵀ and W V⁻¹ h. A point lists its frames in ascending order, so the
            // frames up to this one are the lower triangle.
            for (place, (row, _, _, cross)) in point.frames.iter().enumerate() {
                let gain = cross * inverse;
                gradient[*row] -= gain * point.gradient;
                for (other, _, _, other_cross) in &point.frames[..=place] {
                    *matrix.block_mut(*row, *other) -= gain * other_cross.transpose();
                }
            }
        }
        Some((matrix.cholesky()?, gradient))
    }

    /// The covariance of each frame's (pan rad, tilt rad, ln f), with the points marginalised;
    /// `None` if a parameter is undetermined.
    pub fn covariances(&self) -> Option<Vec<Mat3>> {
        /// A parameter is undetermined if elimination leaves less than this share of its diagonal
        /// entry. Rounding leaves about 1e-16.
        const OPEN: f64 = 1e-12;
        // Undamped: damping would add information that no observation has.
        let (factor, _) = self.eliminate_points(0.0)?;
        (factor.least_pivot_share() >= OPEN).then(|| factor.diagonal_blocks_of_inverse())
    }
}

impl Equations for PoseEquations {
    type Step = PoseStep;

    fn cost(&self) -> f64 {
        self.cost
    }

    fn step(&self, damping: f64) -> Option<PoseStep> {
        // Solve for the frames, then substitute back for each point.
        let (factor, gradient) = self.eliminate_points(damping)?;
        let frames: Vec<Vec3> = factor
            .solve(&gradient)
            .into_iter()
            .map(|step| -step)
            .collect();
        let directions = self
            .points
            .iter()
            .map(|point| point.back_substitute(&frames, damping))
            .collect();
        Some(PoseStep { frames, directions })
    }

    fn length(step: &PoseStep) -> f64 {
        // The largest step of any frame: the mean would let one frame that still moves pass
        // unnoticed among many at rest.
        step.frames.iter().map(Vec3::norm).fold(0.0, f64::max)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use nalgebra::{DMatrix, DVector};

    #[test]
    fn residuals_between_frames_and_priors_give_the_step_and_the_covariances_of_the_dense_system() {
        let entry = |row: usize, column: usize, seed: f64| {
            (1.3 + seed
                + (1.7 * row as f64 + 0.4).powi(2)
                + 2.9 * row as f64 * column as f64
                + column as f64)
                .sin()
        };
        let mut equations = PoseEquations::new(vec![0, 0, 0], Vec::new());
        let (mut matrix, mut gradient) = (DMatrix::<f64>::zeros(9, 9), DVector::<f64>::zeros(9));
        for (number, rows) in [[0, 1], [0, 1], [2, 0], [1, 2]].into_iter().enumerate() {
            let seed = number as f64;
            let by_one = Mat3::from_fn(|row, column| entry(row, column, seed));
            let by_frame = [by_one, -by_one];
            let value = Vec3::new(0.3 - seed, 0.2, 0.1 * seed);
            equations.add_pair(
                &PairResidual {
                    value,
                    rows,
                    by_frame,
                    precision: 4.0,
                },
                Loss::Squared,
            );
            let mut by = DMatrix::<f64>::zeros(3, 9);
            for (row, by_one) in rows.into_iter().zip(by_frame) {
                by.view_mut((0, 3 * row), (3, 3)).copy_from(&by_one);
            }
            matrix += by.transpose() * &by * 4.0;
            gradient += by.transpose() * value * 4.0;
        }
        assert!(
            equations.covariances().is_none(),
            "nothing says where all of them look"
        );
        let (offset, information) = (
            Vec3::new(0.1, -0.2, 0.3),
            Mat3::from_diagonal(&Vec3::new(2.0, 3.0, 4.0)),
        );
        equations.add_prior(0, &offset, &information, Loss::Squared);
        let mut own = matrix.view_mut((0, 0), (3, 3));
        own += information;
        let mut own = gradient.rows_mut(0, 3);
        own += information * offset;
        let expected = -matrix.clone().cholesky().unwrap().solve(&gradient);
        let covariance = matrix.cholesky().unwrap().inverse();
        let (step, covariances) = (
            equations.step(0.0).unwrap(),
            equations.covariances().unwrap(),
        );
        for (frame, own) in covariances.iter().enumerate() {
            assert!((step.frames[frame] - expected.rows(3 * frame, 3)).norm() < 1e-9);
            assert!((own - covariance.view((3 * frame, 3 * frame), (3, 3))).norm() < 1e-9);
        }
    }
}
