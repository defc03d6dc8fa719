//! Bundle adjustment: the base and every frame's pan, tilt and focal length together.
//!
//! Frames are coupled only through the shared parameters, so their own three parameters are
//! eliminated (see [`BorderedEquations`]).

use super::base_click::{BaseClick, FrameView};
use super::parameters::{Shared, clear_fixed};
use super::scatter::Scatter;
use super::shared_prior::SharedPrior;
use crate::camera::Ptz;
use crate::geometry::median;
use crate::solve::optimiser::least_squares::{
    BlockEquations, BorderedEquations, BorderedStep, Minimum, Problem, Stopping, minimise,
};
use crate::solve::{Loss, refine};
use nalgebra::SMatrix;

/// A bundle adjustment with `SHARED` shared parameters.
pub(super) struct Bundle<const SHARED: usize> {
    /// The clicks of each frame.
    pub frames: Vec<Vec<BaseClick>>,
    pub priors: Vec<SharedPrior>,
    /// Which of the shared parameters are free.
    pub free: [bool; SHARED],
    /// The robust loss of the clicks.
    pub loss: Loss,
}

/// The values of all parameters.
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

    fn apply_step(&self, from: &BundleState, step: &BorderedStep<SHARED, 3>) -> BundleState {
        let ptz = from
            .ptz
            .iter()
            .zip(&step.own)
            .map(|(ptz, step)| refine::apply_step(ptz, step))
            .collect();
        BundleState {
            shared: from.shared.apply_step(&step.shared),
            ptz,
        }
    }
}

/// Only the frames whose clicks determine their own parameters; the others carry no information
/// about the base.
pub(super) fn keep_determined<const SHARED: usize>(
    mut equations: BorderedEquations<SHARED, 3>,
) -> BorderedEquations<SHARED, 3> {
    equations
        .blocks
        .retain(|block| block.own_inverse().is_some());
    equations
}

/// The normal equations of one frame's clicks.
pub(in crate::solve) fn frame_equations<const SHARED: usize>(
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
    /// Minimises the cost from a start.
    pub fn minimum(&self, start: BundleState, max_iterations: usize) -> Minimum<Self> {
        /// A step that lowers the cost by less than this fraction is the last.
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

    /// The ratio of the clicks' variance to the stated one, at least 1: the median over the clicks
    /// of χ² divided by its expected median. The median is robust against wrong names.
    ///
    /// Residuals are smaller than the noise, because parameters were fitted to them: in a frame of
    /// n equations, the expected χ² is reduced by the factor (n − 3 − s) / n, where 3 are the
    /// frame's own parameters and s is its part of the free shared parameters, in proportion to its
    /// equations. For three landmarks (n = 6) the factor is at most one half. The median of a paint
    /// sample's single equation is a third of that of a landmark's two.
    pub fn noise_scale(&self, at: &BundleState) -> f64 {
        /// Medians of χ² with one and two degrees of freedom.
        const MEDIANS: [f64; 2] = [0.455, 1.386];
        let all: f64 = self
            .frames
            .iter()
            .map(|clicks| count_equations(clicks))
            .sum();
        let free = self.free.iter().filter(|free| **free).count() as f64;
        let mut scales: Vec<f64> = Vec::new();
        for (clicks, ptz) in self.frames.iter().zip(&at.ptz) {
            let view = FrameView::new(&at.shared, *ptz);
            // The factor of the doc comment, with the free shared parameters divided among frames
            // by equations.
            let own = count_equations(clicks);
            let left = (own - 3.0 - free * own / all) / own;
            if left <= 0.0 {
                // Without surplus equations the residuals are zero, whatever the noise.
                continue;
            }
            scales.extend(clicks.iter().filter_map(|click| {
                let expected = left * MEDIANS[click.equations().clamp(1, 2) - 1];
                Some(click.squared_sigmas(&view)? / expected)
            }));
        }
        median(&mut scales).map_or(1.0, |scale| scale.max(1.0))
    }

    /// Covariance of the shared parameters, from click noise scaled by `noise_scale` and from
    /// landmarks displaced in all frames (see [`Scatter`]). Infinite if singular.
    pub fn covariance(&self, at: &BundleState, noise_scale: f64) -> SMatrix<f64, SHARED, SHARED> {
        // One frame that its clicks leave open must not make the base look undetermined.
        let equations = self.equations(at);
        let inverse = keep_determined(equations.clone())
            .eliminate_blocks(0.0)
            .and_then(|(matrix, _)| matrix.try_inverse());
        let Some(inverse) = inverse else {
            return SMatrix::from_diagonal_element(f64::INFINITY);
        };

        // Each click's own normal equations, grouped by the landmark or line that it shows.
        let mut scatter = Scatter::default();
        let BundleState { shared, ptz } = at;
        for ((clicks, ptz), block) in self.frames.iter().zip(ptz).zip(&equations.blocks) {
            let alone = clicks.iter().map(|click| {
                let element = click.flat.element;
                let own = frame_equations(shared, *ptz, std::slice::from_ref(click), self.loss);
                (element, click.equations(), own)
            });
            scatter.add_frame(block, alone);
        }
        let free = self.free.iter().filter(|free| **free).count();
        let mut covariance = scatter.covariance(&inverse, noise_scale, free, shared.crown.width_m);
        clear_fixed(&mut covariance, &self.free);
        covariance
    }
}

/// The number of equations that some clicks give.
fn count_equations(clicks: &[BaseClick]) -> f64 {
    clicks.iter().map(BaseClick::equations).sum::<usize>() as f64
}
