//! Bundle adjustment: the base and every frame's pan, tilt and focal length together.
//!
//! Frames see each other only through what they share, so their own three parameters are eliminated
//! (see
//! [`BorderedEquations`]).

use super::base_click::{BaseClick, FrameView};
use super::parameters::Shared;
use super::scatter::Scatter;
use super::shared_prior::SharedPrior;
use crate::camera::Ptz;
use crate::geometry::median;
use crate::solve::Loss;
use crate::solve::least_squares::{
    BlockEquations, BorderedEquations, BorderedStep, Minimum, Problem, Stopping, minimise,
};
use crate::solve::refine;
use crate::solve::residual::Residual;
use nalgebra::SMatrix;

/// Everything that does not change while the base and its frames are adjusted, for `SHARED` shared
/// parameters.
pub(super) struct Bundle<const SHARED: usize> {
    /// The clicks of each frame.
    pub frames: Vec<Vec<BaseClick>>,
    pub priors: Vec<SharedPrior>,
    /// Which of the shared parameters are free.
    pub free: [bool; SHARED],
    /// How strongly far-off clicks still pull.
    pub loss: Loss,
}

/// All parameters.
#[derive(Clone, Debug)]
pub(super) struct BundleState {
    pub shared: Shared,
    /// Pan, tilt, focal length of each frame.
    pub ptz: Vec<Ptz>,
}

impl<const SHARED: usize> Problem for Bundle<SHARED> {
    type State = BundleState;
    type Equations = BorderedEquations<SHARED, 3>;

    fn equations(&self, at: &BundleState) -> BorderedEquations<SHARED, 3> {
        let mut priors = BlockEquations::zero();
        for prior in &self.priors {
            priors.add(prior, &at.shared, self.loss);
        }
        let frames = self.frames.iter().zip(&at.ptz);
        let blocks = frames
            .map(|(clicks, ptz)| frame_equations(&at.shared, *ptz, clicks, self.loss))
            .collect();
        BorderedEquations {
            priors,
            blocks,
            free: self.free,
        }
    }

    fn stepped(&self, from: &BundleState, step: &BorderedStep<SHARED, 3>) -> BundleState {
        let ptz = from
            .ptz
            .iter()
            .zip(&step.own)
            .map(|(ptz, step)| refine::stepped(ptz, step))
            .collect();
        BundleState {
            shared: from.shared.stepped(&step.shared),
            ptz,
        }
    }
}

/// The equations of the frames that their clicks determine: one whose own parameters they leave
/// open says nothing about the base.
pub(super) fn determined<const SHARED: usize>(
    mut equations: BorderedEquations<SHARED, 3>,
) -> BorderedEquations<SHARED, 3> {
    equations
        .blocks
        .retain(|block| block.own.try_inverse().is_some());
    equations
}

/// The normal equations of one frame's clicks.
pub(super) fn frame_equations<const SHARED: usize>(
    shared: &Shared,
    ptz: Ptz,
    clicks: &[BaseClick],
    loss: Loss,
) -> BlockEquations<SHARED, 3> {
    let view = FrameView::new(shared, ptz);
    let mut equations = BlockEquations::zero();
    for click in clicks {
        equations.add(click, &view, loss);
    }
    equations
}

impl<const SHARED: usize> Bundle<SHARED> {
    /// Walks from a start to the best fit.
    pub fn minimum(&self, start: BundleState, max_iterations: usize) -> Minimum<Self> {
        /// A step that lowers the cost by less than this share of it is the last.
        const SMALL_GAIN: f64 = 1e-10;
        minimise(
            self,
            start,
            Stopping {
                max_iterations,
                short_step: 0.0,
                small_gain: SMALL_GAIN,
            },
        )
    }

    /// By how much the clicks' variance exceeds what is stated, at least 1: the median of their χ²,
    /// each over what it should be.
    ///
    /// A residual should be smaller than the noise, since its frame's three numbers and its share
    /// of what all frames share were fitted to it: in a frame of n equations by (n − 3 − its share)
    /// / n. With three landmarks that is half, and a paint's single equation has a third of the
    /// median that a landmark's two have.
    pub fn noise_scale(&self, at: &BundleState) -> f64 {
        /// Medians of χ² with one and two degrees of freedom.
        const MEDIANS: [f64; 2] = [0.455, 1.386];
        let equations =
            |clicks: &[BaseClick]| clicks.iter().map(BaseClick::equations).sum::<usize>() as f64;
        let all: f64 = self.frames.iter().map(|clicks| equations(clicks)).sum();
        let free = self.free.iter().filter(|free| **free).count() as f64;
        let mut scales: Vec<f64> = Vec::new();
        for (clicks, ptz) in self.frames.iter().zip(&at.ptz) {
            let view = FrameView::new(&at.shared, *ptz);
            let own = equations(clicks);
            let left = (own - 3.0 - free * own / all) / own;
            if left <= 0.0 {
                // A frame that its clicks just determine says nothing about their noise.
                continue;
            }
            let scale = |click: &BaseClick| {
                Some(
                    click.squared_sigmas(&view)?
                        / (left * MEDIANS[click.equations().clamp(1, 2) - 1]),
                )
            };
            scales.extend(clicks.iter().filter_map(scale));
        }
        median(&mut scales).map_or(1.0, |scale| scale.max(1.0))
    }

    /// Covariance of the shared parameters: of clicks that scatter so much more than stated, and of
    /// landmarks that lie off their places. Infinite if singular.
    pub fn covariance(&self, at: &BundleState, noise_scale: f64) -> SMatrix<f64, SHARED, SHARED> {
        let equations = self.equations(at);
        let inverse = determined(equations.clone())
            .reduced(0.0)
            .and_then(|(matrix, _)| matrix.try_inverse());
        let Some(inverse) = inverse else {
            return SMatrix::from_diagonal_element(f64::INFINITY);
        };
        let mut scatter = Scatter::default();
        let BundleState { shared, ptz } = at;
        for ((clicks, ptz), block) in self.frames.iter().zip(ptz).zip(&equations.blocks) {
            let alone = |click: &BaseClick| {
                let equations =
                    frame_equations(shared, *ptz, std::slice::from_ref(click), self.loss);
                (
                    Residual::<2, SHARED, 3>::element(click),
                    click.equations(),
                    equations,
                )
            };
            scatter.add_frame(block, clicks.iter().map(alone));
        }
        let free = self.free.iter().filter(|free| **free).count();
        let mut covariance = scatter.covariance(&inverse, noise_scale, free, shared.crown.width_m);
        // What is held is exact, and goes with nothing.
        for held in (0..SHARED).filter(|&parameter| !self.free[parameter]) {
            covariance.row_mut(held).fill(0.0);
            covariance.column_mut(held).fill(0.0);
        }
        covariance
    }
}
