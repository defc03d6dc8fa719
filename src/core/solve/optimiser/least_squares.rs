//! The one optimiser: damped Gauss–Newton (Levenberg–Marquardt) over residuals with a robust loss.
//!
//! [`minimise`] controls the damping and accepts or rejects steps; [`Equations`] compute them.
//! [`BlockEquations`] are the normal equations of one block, such as a frame: of fixed size,
//! without allocation. [`BorderedEquations`] are many blocks that are coupled only through shared
//! parameters, such as the frames of one camera. Each block's own parameters are eliminated (Schur
//! complement; Hartley & Zisserman, Multiple View Geometry, appendix 6.3), one small system is
//! solved for the shared ones, and the blocks' steps follow by back-substitution.

use super::loss::LossSum;
use super::residual::{Linearised, Residual};
use crate::solve::Loss;
use nalgebra::{SMatrix, SVector};

/// The size, in sigmas, with which a residual that has no value enters the cost.
pub const NO_VALUE_SIGMAS: f64 = 1e3;

/// Initial damping, its minimum, and the value at which the search gives up; as a fraction of the
/// diagonal of the normal equations.
const DAMPING: f64 = 1e-6;
const MIN_DAMPING: f64 = 1e-15;
const MAX_DAMPING: f64 = 1e12;

/// A rejected step shorter than this failed because of rounding: the minimum is reached.
const SHORT_IF_WORSE: f64 = 1e-8;

/// A least-squares problem with robust losses.
pub trait Problem {
    /// The parameters.
    type State;
    /// The normal equations that yield a step.
    type Equations: Equations;

    /// The normal equations at some parameters.
    fn equations(&self, at: &Self::State) -> Self::Equations;

    /// The parameters after a step.
    fn apply_step(
        &self,
        from: &Self::State,
        step: &<Self::Equations as Equations>::Step,
    ) -> Self::State;
}

/// Normal equations with the cost that they belong to.
pub trait Equations {
    /// A change of all parameters.
    type Step;

    /// The cost, robust losses included.
    fn cost(&self) -> f64;

    /// The damped Gauss–Newton step; none where the equations are singular.
    fn step(&self, damping: f64) -> Option<Self::Step>;

    /// How long a step is.
    fn length(step: &Self::Step) -> f64;
}

/// Stopping criteria of a minimisation.
#[derive(Clone, Copy, Debug)]
pub struct Stopping {
    /// Maximum number of steps tried.
    pub max_iterations: usize,
    /// An accepted step shorter than this is the last.
    pub short_step: f64,
    /// An accepted step that lowers the cost by less than this fraction is the last.
    pub small_gain: f64,
}

/// The result of a minimisation.
pub struct Minimum<P: Problem> {
    /// The parameters.
    pub state: P::State,
    /// The normal equations there.
    pub equations: P::Equations,
    /// Steps tried.
    pub iterations: usize,
}

/// Minimises the cost from a start by the Levenberg–Marquardt method. Never returns a state of
/// higher cost than the start's.
pub fn minimise<P: Problem>(problem: &P, start: P::State, until: Stopping) -> Minimum<P> {
    let mut state = start;
    let mut equations = problem.equations(&state);
    let mut cost = equations.cost();
    let (mut damping, mut iterations) = (DAMPING, 0);
    while iterations < until.max_iterations && damping < MAX_DAMPING {
        iterations += 1;

        // Nearly singular equations become regular with enough damping. Damping scales the diagonal
        // (Marquardt 1963), so a parameter without any information stays without a step: then the
        // search ends at MAX_DAMPING, and the start is returned.
        let Some(step) = equations.step(damping) else {
            damping *= 10.0;
            continue;
        };
        let length = P::Equations::length(&step);
        if !length.is_finite() {
            break;
        }

        // Accept a step that does not raise the cost and trust the quadratic model more; otherwise
        // keep the state and damp ten times as much. A cost of NaN compares as higher.
        let next = problem.apply_step(&state, &step);
        let tried = problem.equations(&next);
        let tried_cost = tried.cost();
        if tried_cost <= cost {
            let gain = cost - tried_cost;
            let enough = length < until.short_step || gain < until.small_gain * cost;
            (state, equations, cost) = (next, tried, tried_cost);
            damping = (damping * 0.1).max(MIN_DAMPING);
            if enough {
                break;
            }
        } else {
            damping *= 10.0;
            if length < SHORT_IF_WORSE.max(until.short_step) {
                break;
            }
        }
    }
    Minimum {
        state,
        equations,
        iterations,
    }
}

/// Jᵀ W J and Jᵀ W r of one block's residuals, partitioned into shared and own parameters.
#[derive(Clone, Debug)]
pub struct BlockEquations<const SHARED: usize, const OWN: usize> {
    /// Shared by shared.
    pub shared: SMatrix<f64, SHARED, SHARED>,
    /// Shared by own.
    pub cross: SMatrix<f64, SHARED, OWN>,
    /// Own by own.
    pub own: SMatrix<f64, OWN, OWN>,
    /// Jᵀ W r of the shared parameters.
    pub shared_gradient: SVector<f64, SHARED>,
    /// Jᵀ W r of the block's own parameters.
    pub own_gradient: SVector<f64, OWN>,
    /// The weighted squares of the residuals, in sigmas.
    pub squares: f64,
    losses: LossSum,
}

impl<const SHARED: usize, const OWN: usize> BlockEquations<SHARED, OWN> {
    /// No residual yet.
    #[inline]
    pub fn zero() -> Self {
        Self {
            shared: SMatrix::zeros(),
            cross: SMatrix::zeros(),
            own: SMatrix::zeros(),
            shared_gradient: SVector::zeros(),
            own_gradient: SVector::zeros(),
            squares: 0.0,
            losses: LossSum::ZERO,
        }
    }

    /// Adds a residual at some parameters.
    #[inline]
    pub fn add<const ROWS: usize, R>(&mut self, residual: &R, at: &R::State, loss: Loss)
    where
        R: Residual<ROWS, SHARED, OWN>,
    {
        // A point behind the camera, for example, has no residual. It adds a large constant cost,
        // so that a step that hides it is rejected, but no gradient.
        let loss = residual.loss(loss);
        let Some(Linearised {
            value,
            by_shared,
            by_own,
        }) = residual.linearise(at)
        else {
            self.losses.add(NO_VALUE_SIGMAS * NO_VALUE_SIGMAS, loss);
            return;
        };

        // Iteratively reweighted least squares: the weight is the derivative of the loss by z²,
        // evaluated at the current parameters.
        let sigma = residual.sigma();
        let precision = 1.0 / (sigma * sigma);
        let z_squared = value.norm_squared() * precision;
        let weight = self.losses.add(z_squared, loss);
        self.squares += weight * z_squared;
        let own_weighted = by_own.transpose() * (weight * precision);
        self.own += own_weighted * by_own;
        self.own_gradient += own_weighted * value;
        if SHARED > 0 {
            let shared_weighted = by_shared.transpose() * (weight * precision);
            self.shared += shared_weighted * by_shared;
            self.cross += shared_weighted * by_own;
            self.shared_gradient += shared_weighted * value;
        }
    }

    /// The cost of its residuals.
    pub fn cost(&self) -> f64 {
        self.losses.total()
    }

    /// The inverse of the equations of the block's own parameters; none where its residuals leave
    /// a combination of these open.
    pub(in crate::solve) fn own_inverse(&self) -> Option<SMatrix<f64, OWN, OWN>> {
        /// A parameter is open if the parameters before it leave less than this share of its
        /// information.
        const OPEN: f64 = 1e-12;
        // Rounding makes the matrix of too few residuals regular, and its inverse noise. Scaled to
        // a unit diagonal, the squared pivots of the Cholesky factor are those shares.
        let scale = SVector::<f64, OWN>::from_fn(|i, _| self.own[(i, i)].sqrt().recip());
        let scaled = SMatrix::<f64, OWN, OWN>::from_fn(|row, column| {
            self.own[(row, column)] * scale[row] * scale[column]
        });
        let factor = scaled.cholesky()?;
        if (0..OWN).any(|i| factor.l_dirty()[(i, i)].powi(2) < OPEN) {
            return None;
        }
        self.own.try_inverse()
    }

    /// Whether none of its residuals has a value: it says nothing, and its parameters stay.
    fn is_empty(&self) -> bool {
        self.own.iter().all(|entry| *entry == 0.0)
    }

    /// The Schur complement: the equations of the shared parameters after elimination of the
    /// block's own. None where the residuals do not determine the own parameters.
    pub fn eliminate_own(&self) -> Option<(SMatrix<f64, SHARED, SHARED>, SVector<f64, SHARED>)> {
        // S − C O⁻¹ Cᵀ and g_s − C O⁻¹ g_o.
        let gain = self.cross * self.own_inverse()?;
        Some((
            self.shared - gain * self.cross.transpose(),
            self.shared_gradient - gain * self.own_gradient,
        ))
    }

    /// The step of the block's own parameters, given the step of the shared ones
    /// (back-substitution).
    fn own_step(
        &self,
        damping: f64,
        shared_step: &SVector<f64, SHARED>,
    ) -> Option<SVector<f64, OWN>> {
        if self.is_empty() {
            return Some(SVector::zeros());
        }
        // From the block's rows of the system: O x + Cᵀ s = −g_o, with the same damping of O as in
        // the elimination.
        let right = self.own_gradient + self.cross.transpose() * shared_step;
        Some(-(add_damping(&self.own, damping).try_inverse()? * right))
    }
}

impl<const OWN: usize> Equations for BlockEquations<0, OWN> {
    type Step = SVector<f64, OWN>;

    #[inline]
    fn cost(&self) -> f64 {
        self.losses.total()
    }

    #[inline]
    fn step(&self, damping: f64) -> Option<Self::Step> {
        Some(-(add_damping(&self.own, damping).try_inverse()? * self.own_gradient))
    }

    #[inline]
    fn length(step: &Self::Step) -> f64 {
        step.norm()
    }
}

/// Blocks that are coupled only through shared parameters.
#[derive(Clone, Debug)]
pub(crate) struct BorderedEquations<const SHARED: usize, const OWN: usize> {
    /// The equations of the priors of the shared parameters.
    pub priors: BlockEquations<SHARED, OWN>,
    pub blocks: Vec<BlockEquations<SHARED, OWN>>,
    /// Shared parameters that are not free keep their values.
    pub free: [bool; SHARED],
}

/// A step of the shared parameters and of the own parameters of every block.
pub(crate) struct BorderedStep<const SHARED: usize, const OWN: usize> {
    pub shared: SVector<f64, SHARED>,
    pub own: Vec<SVector<f64, OWN>>,
}

impl<const SHARED: usize, const OWN: usize> BorderedEquations<SHARED, OWN> {
    /// The equations of the shared parameters after elimination of all blocks' own (Schur
    /// complement of the damped system). Rows and columns of parameters that are not free are those
    /// of the identity, so that their step is zero. Blocks without a value are left out. None where
    /// another block's residuals do not determine its own parameters.
    pub fn eliminate_blocks(
        &self,
        damping: f64,
    ) -> Option<(SMatrix<f64, SHARED, SHARED>, SVector<f64, SHARED>)> {
        let (mut matrix, mut gradient) = (self.priors.shared, self.priors.shared_gradient);
        for block in &self.blocks {
            matrix += block.shared;
            gradient += block.shared_gradient;
        }

        // Damp before the elimination: damping the Schur complement instead would not be the damped
        // step of the whole system.
        matrix = add_damping(&matrix, damping);
        for block in self.blocks.iter().filter(|block| !block.is_empty()) {
            let gain = block.cross * add_damping(&block.own, damping).try_inverse()?;
            matrix -= gain * block.cross.transpose();
            gradient -= gain * block.own_gradient;
        }

        // Fixed parameters: identity row, zero gradient.
        for parameter in (0..SHARED).filter(|&parameter| !self.free[parameter]) {
            matrix.row_mut(parameter).fill(0.0);
            matrix.column_mut(parameter).fill(0.0);
            matrix[(parameter, parameter)] = 1.0;
            gradient[parameter] = 0.0;
        }
        Some((matrix, gradient))
    }
}

impl<const SHARED: usize, const OWN: usize> Equations for BorderedEquations<SHARED, OWN> {
    type Step = BorderedStep<SHARED, OWN>;

    fn cost(&self) -> f64 {
        self.priors.cost() + self.blocks.iter().map(BlockEquations::cost).sum::<f64>()
    }

    fn step(&self, damping: f64) -> Option<Self::Step> {
        let (matrix, gradient) = self.eliminate_blocks(damping)?;
        let shared = -matrix.cholesky()?.solve(&gradient);
        let own = self
            .blocks
            .iter()
            .map(|block| block.own_step(damping, &shared))
            .collect::<Option<_>>()?;
        Some(BorderedStep { shared, own })
    }

    fn length(step: &Self::Step) -> f64 {
        // The largest of the parts, so that the limit on a step does not depend on the number of
        // blocks.
        step.own
            .iter()
            .map(SVector::norm)
            .fold(step.shared.norm(), f64::max)
    }
}

/// The matrix with each diagonal entry raised by a share of itself.
fn add_damping<const N: usize>(matrix: &SMatrix<f64, N, N>, damping: f64) -> SMatrix<f64, N, N> {
    let mut matrix = *matrix;
    for i in 0..N {
        matrix[(i, i)] *= 1.0 + damping;
    }
    matrix
}

#[cfg(test)]
mod tests {
    use super::*;
    use nalgebra::{Matrix1, Matrix1x2, Matrix2x3, Vector1};

    /// A height over a plane: shared are its two slopes, each block has an offset of its own.
    struct Height {
        x: f64,
        y: f64,
        z: f64,
    }

    impl Residual<1, 2, 1> for Height {
        type State = (SVector<f64, 2>, f64);

        fn sigma(&self) -> f64 {
            0.5
        }

        fn value(&self, (slopes, offset): &Self::State) -> Option<Vector1<f64>> {
            (self.x >= 0.0)
                .then(|| Vector1::new(slopes[0] * self.x + slopes[1] * self.y + offset - self.z))
        }

        fn linearise(&self, at: &Self::State) -> Option<Linearised<1, 2, 1>> {
            let by_shared = Matrix1x2::new(self.x, self.y);
            Some(Linearised {
                value: self.value(at)?,
                by_shared,
                by_own: Matrix1::new(1.0),
            })
        }
    }

    struct Planes(Vec<Vec<Height>>);

    impl Problem for Planes {
        type State = (SVector<f64, 2>, Vec<f64>);
        type Equations = BorderedEquations<2, 1>;

        fn equations(&self, (slopes, offsets): &Self::State) -> BorderedEquations<2, 1> {
            let block = |(heights, offset): (&Vec<Height>, &f64)| {
                let mut block = BlockEquations::zero();
                for height in heights {
                    block.add(height, &(*slopes, *offset), Loss::Cauchy { c: 2.0 });
                }
                block
            };
            let blocks = self.0.iter().zip(offsets).map(block).collect();
            BorderedEquations {
                priors: BlockEquations::zero(),
                blocks,
                free: [true; 2],
            }
        }

        fn apply_step(
            &self,
            (slopes, offsets): &Self::State,
            step: &BorderedStep<2, 1>,
        ) -> Self::State {
            (
                slopes + step.shared,
                offsets
                    .iter()
                    .zip(&step.own)
                    .map(|(offset, step)| offset + step[0])
                    .collect(),
            )
        }
    }

    const LIMITS: Stopping = Stopping {
        max_iterations: 60,
        short_step: 1e-12,
        small_gain: 0.0,
    };

    fn planes(outlier: f64) -> Planes {
        let heights = |offset: f64| {
            let at = |i: u32| {
                let (x, y) = (f64::from(i % 3), f64::from(i / 3));
                let z = 0.7 * x - 0.2 * y + offset;
                Height {
                    x,
                    y,
                    z: if i == 4 { z + outlier } else { z },
                }
            };
            (0..9).map(at).collect()
        };
        Planes(vec![heights(1.0), heights(-3.0), heights(0.5)])
    }

    #[test]
    fn blocks_share_what_they_have_in_common_and_keep_their_own() {
        let found = minimise(&planes(0.0), (SVector::zeros(), vec![0.0; 3]), LIMITS);
        let (slopes, offsets) = found.state;
        assert!(
            (slopes - SVector::<f64, 2>::new(0.7, -0.2)).norm() < 1e-9,
            "{slopes}"
        );
        for (offset, truth) in offsets.iter().zip([1.0, -3.0, 0.5]) {
            assert!((offset - truth).abs() < 1e-9);
        }
    }

    #[test]
    fn a_robust_loss_hardly_follows_what_is_far_off_and_a_minimum_has_no_gradient() {
        let found = minimise(&planes(100.0), (SVector::zeros(), vec![0.0; 3]), LIMITS);
        assert!(
            (found.state.0 - SVector::<f64, 2>::new(0.7, -0.2)).norm() < 0.01,
            "{}",
            found.state.0
        );
        for block in &found.equations.blocks {
            assert!(block.own_gradient.norm() < 1e-6);
        }
    }

    #[test]
    fn the_schur_complement_gives_the_step_of_the_whole_system() {
        let problem = planes(3.0);
        let at = (SVector::<f64, 2>::new(0.3, 0.1), vec![0.2, 0.0, -0.4]);
        let (equations, damping) = (problem.equations(&at), 0.01);
        let step = equations.step(damping).unwrap();
        let mut matrix = SMatrix::<f64, 5, 5>::zeros();
        let mut gradient = SVector::<f64, 5>::zeros();
        for (index, block) in equations.blocks.iter().enumerate() {
            for i in 0..2 {
                for j in 0..2 {
                    matrix[(i, j)] += block.shared[(i, j)];
                }
                matrix[(i, 2 + index)] += block.cross[i];
                matrix[(2 + index, i)] += block.cross[i];
                gradient[i] += block.shared_gradient[i];
            }
            matrix[(2 + index, 2 + index)] = block.own[0];
            gradient[2 + index] = block.own_gradient[0];
        }
        let whole = -(add_damping(&matrix, damping).try_inverse().unwrap() * gradient);
        assert!((step.shared - whole.fixed_rows::<2>(0)).norm() < 1e-12);
        for (index, own) in step.own.iter().enumerate() {
            assert!((own[0] - whole[2 + index]).abs() < 1e-12);
        }
    }

    #[test]
    fn a_block_without_a_value_stays_and_stops_no_other() {
        let mut problem = planes(0.0);
        problem.0.push(vec![Height {
            x: -1.0,
            y: 0.0,
            z: 0.0,
        }]);
        let found = minimise(
            &problem,
            (SVector::zeros(), vec![0.0, 0.0, 0.0, 7.0]),
            LIMITS,
        );
        let (slopes, offsets) = found.state;
        assert!(
            (slopes - SVector::<f64, 2>::new(0.7, -0.2)).norm() < 1e-6,
            "{slopes}"
        );
        assert_eq!(offsets[3], 7.0);
    }

    #[test]
    fn one_point_does_not_determine_three_parameters_and_two_do() {
        let by_point = |x: f64, y: f64| Matrix2x3::new(-2000.0, 0.1 * y, x, -0.1 * x, 2100.0, y);
        for step in 0..40 {
            let (x, y) = (17.3 * f64::from(step) - 340.7, 9.1 * f64::from(step) + 0.3);
            let [one, two] = [by_point(x, y), by_point(x + 50.0, y)];
            let mut block = BlockEquations::<0, 3>::zero();
            block.own = one.transpose() * one * 0.25;
            assert_eq!(block.own_inverse(), None, "{x} {y}");
            block.own += two.transpose() * two * 0.25;
            assert!(block.own_inverse().is_some(), "{x} {y}");
        }
    }

    #[test]
    fn a_parameter_that_is_not_free_stays_and_a_residual_without_a_value_only_costs() {
        let mut equations = planes(0.0).equations(&(SVector::zeros(), vec![0.0; 3]));
        equations.free = [true, false];
        assert_eq!(equations.step(0.0).unwrap().shared[1], 0.0);
        let mut block = BlockEquations::<2, 1>::zero();
        block.add(
            &Height {
                x: -1.0,
                y: 0.0,
                z: 0.0,
            },
            &(SVector::zeros(), 0.0),
            Loss::Squared,
        );
        assert_eq!(
            (block.cost(), block.own[0]),
            (NO_VALUE_SIGMAS * NO_VALUE_SIGMAS, 0.0)
        );
    }
}
