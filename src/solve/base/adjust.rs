//! Bundle adjustment: the base and every frame's pan, tilt and focal length together.
//!
//! Levenberg–Marquardt with analytic Jacobians and robust loss. Frames see each other only through the base, so their own
//! three parameters are eliminated (Schur complement) and one small system is solved per step.

use super::frame_block::{FrameBlock, NominalClick};
use super::parameters::{
    CROWN, K1, PRINCIPAL_POINT, ROTATION, SHARED, SLOPE, Shared, SharedMatrix, SharedVector, free_parameters,
};
use super::scatter::Scatter;
use super::{BaseModel, FrameClicks, LensModel};
use crate::camera::{BaseSigma, CameraBase, FocalCurve, Ptz};
use crate::field::FieldModel;
use crate::geometry::{Angle, Mat3, Vec3};
use crate::solve::Loss;

/// What is known of a broadcast camera before its clicks are looked at: weak, and decisive only where the clicks are few.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct BasePriors {
    /// 1-σ of the base's pitch: camera heads are levelled, along the view less well than across it.
    pub pitch: Angle,
    /// 1-σ of the base's roll.
    pub roll: Angle,
    /// k₁ at a focal length of 2000 px of a frame 1920 px wide, and its 1-σ.
    pub k1: (f64, f64),
    /// The change of k₁ per 1000 px of such a frame, and its 1-σ.
    pub k1_slope: (f64, f64),
    /// The crown, m, and its 1-σ.
    pub crown_m: (f64, f64),
    /// 1-σ of the principal point, px of a frame 1920 px wide.
    pub principal_point_px: f64,
}

impl Default for BasePriors {
    /// Measured: rolls of 0.1 to 0.4° and pitches of up to 1.6° on three matches; on nine, k₁ ≈ −0.02 + 0.21 (f − 2000) / 1000, crowns of 0.05 to 0.25 m.
    fn default() -> Self {
        Self {
            pitch: Angle::from_degrees(1.0),
            roll: Angle::from_degrees(0.4),
            k1: (-0.02, 0.04),
            k1_slope: (0.21, 0.1),
            crown_m: (0.13, 0.07),
            principal_point_px: 10.0,
        }
    }
}

/// How to adjust.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct AdjustOptions {
    /// How strongly far-off clicks still pull.
    pub loss: Loss,
    /// What is known beforehand.
    pub priors: BasePriors,
    /// Steps at most.
    pub max_iterations: usize,
}

impl Default for AdjustOptions {
    fn default() -> Self {
        Self { loss: Loss::Cauchy { c: 3.0 }, priors: BasePriors::default(), max_iterations: 60 }
    }
}

/// A base fitted to many frames.
#[derive(Clone, Debug, PartialEq)]
pub struct AdjustedBase {
    /// The base, in the pan gauge of the conventions, with its own sigma.
    pub base: CameraBase,
    /// The crown of the pitch, m.
    pub crown_m: f64,
    /// Pan, tilt, focal length of every frame; none where the start had none.
    pub ptz: Vec<Option<Ptz>>,
    /// Covariance of the position, m².
    pub position_covariance: Mat3,
    /// How much larger than stated the clicks' variance is, at least 1; the covariance has it in.
    pub noise_scale: f64,
    /// The minimised robust cost.
    pub cost: f64,
    /// Steps tried.
    pub iterations: usize,
}

/// Adjusts a base and its frames from a start. Frames without `ptz` take no part.
///
/// The clicks are those of `field`; its crown is the start's. `image_width_px` scales the priors.
#[must_use]
pub fn adjust_base(
    field: &FieldModel,
    frames: &[FrameClicks],
    start: &CameraBase,
    start_ptz: &[Option<Ptz>],
    image_width_px: u32,
    model: &BaseModel,
    options: &AdjustOptions,
) -> AdjustedBase {
    let per_1920 = f64::from(image_width_px) / 1920.0;
    let active: Vec<(Vec<NominalClick>, Ptz)> = frames
        .iter()
        .zip(start_ptz)
        .filter_map(|(frame, ptz)| {
            let clicks = frame.used().map(|observation| NominalClick::of(observation, field)).collect();
            Some((clicks, (*ptz)?))
        })
        .collect();
    let (clicks, ptz): (Vec<_>, Vec<_>) = active.into_iter().unzip();
    let mut state = State { shared: starting(field, start, per_1920, model), ptz };
    let problem = Problem { clicks, model, options, per_1920, free: free_parameters(model) };

    let mut blocks = problem.blocks(&state);
    let mut cost = problem.cost(&state, &blocks);
    let mut damping = 1e-4;
    let mut iterations = 0;
    while iterations < options.max_iterations && damping < 1e12 {
        iterations += 1;
        let Some(next) = problem.step(&state, &blocks, damping) else {
            damping *= 10.0;
            continue;
        };
        let next_blocks = problem.blocks(&next);
        let next_cost = problem.cost(&next, &next_blocks);
        if next_cost < cost {
            let gain = (cost - next_cost) / cost;
            (state, blocks, cost) = (next, next_blocks, next_cost);
            damping = (damping * 0.1).max(1e-12);
            if gain < 1e-10 {
                break;
            }
        } else {
            damping *= 10.0;
        }
    }

    let noise_scale = problem.noise_scale(&state);
    let covariance = problem.shared_covariance(&state, &blocks, noise_scale);
    let deviation = |index: usize| covariance[(index, index)].max(0.0).sqrt();
    let (mut base, added) = state.shared.base.in_pan_gauge();
    base.sigma = BaseSigma {
        position_m: Vec3::from_fn(|axis, _| deviation(axis)),
        rotation: Vec3::new(deviation(ROTATION), deviation(ROTATION + 1), 0.0),
    };
    let mut solved = state.ptz.into_iter().map(|ptz| Ptz { pan: (ptz.pan + added).wrapped(), ..ptz });
    AdjustedBase {
        base,
        crown_m: state.shared.crown_m,
        ptz: start_ptz.iter().map(|ptz| ptz.and_then(|_| solved.next())).collect(),
        noise_scale,
        position_covariance: covariance.fixed_view::<3, 3>(0, 0).into_owned(),
        cost,
        iterations,
    }
}

/// The start's shared parameters as the model has them.
fn starting(field: &FieldModel, start: &CameraBase, per_1920: f64, model: &BaseModel) -> Shared {
    let at_focal_px = 2000.0 * per_1920;
    let distortion = match model.lens {
        LensModel::Pinhole => FocalCurve { at_focal_px, ..FocalCurve::NONE },
        LensModel::K1 => FocalCurve { at_focal_px, value: start.distortion.at(at_focal_px), per_1000_px: 0.0 },
        LensModel::K1Focal => {
            let value = start.distortion.at(at_focal_px);
            FocalCurve { at_focal_px, value, per_1000_px: start.distortion.per_1000_px }
        }
    };
    let crown_m = model.crown.fixed_m().unwrap_or(field.crown_m);
    Shared { base: CameraBase { distortion, ..*start }, crown_m, width_m: field.width_m }
}

/// All parameters.
#[derive(Clone, Debug)]
struct State {
    shared: Shared,
    ptz: Vec<Ptz>,
}

/// What does not change during the adjustment.
struct Problem<'a> {
    clicks: Vec<Vec<NominalClick>>,
    model: &'a BaseModel,
    options: &'a AdjustOptions,
    per_1920: f64,
    free: [bool; SHARED],
}

impl Problem<'_> {
    fn blocks(&self, state: &State) -> Vec<FrameBlock> {
        self.clicks
            .iter()
            .zip(&state.ptz)
            .map(|(clicks, ptz)| FrameBlock::at(&state.shared, *ptz, clicks, self.options.loss, &self.free))
            .collect()
    }

    fn cost(&self, state: &State, blocks: &[FrameBlock]) -> f64 {
        let prior: f64 = self.priors(state).iter().map(|(_, residual, _)| residual * residual).sum();
        prior + blocks.iter().map(|block| block.cost).sum::<f64>()
    }

    /// The priors: which parameter, its residual in sigmas, and 1 / sigma.
    fn priors(&self, state: &State) -> Vec<(usize, f64, f64)> {
        let (priors, shared) = (&self.options.priors, &state.shared);
        let down = shared.base.base_from_world.row(1).transpose();
        let (pitch, roll) = (priors.pitch.radians(), priors.roll.radians());
        // Turning by (ω_x, ω_y) moves the base's downward axis by (ω_y, −ω_x) in world.
        let mut found = vec![(ROTATION, -down.y / pitch, 1.0 / pitch), (ROTATION + 1, down.x / roll, 1.0 / roll)];
        let curve = shared.base.distortion;
        if self.model.lens != LensModel::Pinhole {
            found.push((K1, (curve.value - priors.k1.0) / priors.k1.1, 1.0 / priors.k1.1));
        }
        if self.model.lens == LensModel::K1Focal {
            let (mean, sigma) = (priors.k1_slope.0 / self.per_1920, priors.k1_slope.1 / self.per_1920);
            found.push((SLOPE, (curve.per_1000_px - mean) / sigma, 1.0 / sigma));
        }
        if self.free[CROWN] {
            let (mean, sigma) = priors.crown_m;
            found.push((CROWN, (shared.crown_m - mean) / sigma, 1.0 / sigma));
        }
        if let Some(nominal) = self.model.principal_point {
            let sigma = priors.principal_point_px * self.per_1920;
            let offset = shared.base.principal_point.offset_from(nominal);
            found.push((PRINCIPAL_POINT, offset.x / sigma, 1.0 / sigma));
            found.push((PRINCIPAL_POINT + 1, offset.y / sigma, 1.0 / sigma));
        }
        found
    }

    /// The Schur complement of the shared parameters and its gradient, damped.
    fn reduced(&self, state: &State, blocks: &[FrameBlock], damping: f64) -> Option<(SharedMatrix, SharedVector)> {
        let mut matrix = SharedMatrix::zeros();
        let mut gradient = SharedVector::zeros();
        for block in blocks {
            matrix += block.shared;
            gradient += block.shared_gradient;
        }
        for (parameter, residual, inverse_sigma) in self.priors(state) {
            matrix[(parameter, parameter)] += inverse_sigma * inverse_sigma;
            gradient[parameter] += residual * inverse_sigma;
        }
        for (parameter, free) in self.free.iter().enumerate() {
            let diagonal = &mut matrix[(parameter, parameter)];
            *diagonal = if *free { *diagonal * (1.0 + damping) } else { 1.0 };
        }
        for block in blocks {
            let inverse = damped(&block.own, damping).try_inverse()?;
            let gain = block.cross * inverse;
            matrix -= gain * block.cross.transpose();
            gradient -= gain * block.own_gradient;
        }
        Some((matrix, gradient))
    }

    fn step(&self, state: &State, blocks: &[FrameBlock], damping: f64) -> Option<State> {
        let (matrix, gradient) = self.reduced(state, blocks, damping)?;
        let shared_step = -matrix.cholesky()?.solve(&gradient);
        let ptz = state.ptz.iter().zip(blocks).map(|(ptz, block)| {
            let right = block.own_gradient + block.cross.transpose() * shared_step;
            let step = -(damped(&block.own, damping).try_inverse()? * right);
            Some(Ptz {
                pan: ptz.pan + Angle::from_radians(step.x),
                tilt: ptz.tilt + Angle::from_radians(step.y),
                focal_px: ptz.focal_px * step.z.clamp(-0.5, 0.5).exp(),
            })
        });
        Some(State { shared: state.shared.stepped(&shared_step), ptz: ptz.collect::<Option<Vec<_>>>()? })
    }

    /// Covariance of the shared parameters: of clicks that scatter so much more than stated, and of landmarks that lie off
    /// their places. Infinite if singular.
    fn shared_covariance(&self, state: &State, blocks: &[FrameBlock], noise_scale: f64) -> SharedMatrix {
        // A frame whose own parameters its clicks leave open says nothing about the base.
        let determined: Vec<FrameBlock> =
            blocks.iter().filter(|block| block.own.try_inverse().is_some()).cloned().collect();
        let Some(inverse) = self.reduced(state, &determined, 0.0).and_then(|(matrix, _)| matrix.try_inverse()) else {
            return SharedMatrix::from_diagonal_element(f64::INFINITY);
        };
        let mut scatter = Scatter::default();
        for ((clicks, ptz), block) in self.clicks.iter().zip(&state.ptz).zip(blocks) {
            let alone = |click: &NominalClick| {
                let one = std::slice::from_ref(click);
                (*click, FrameBlock::at(&state.shared, *ptz, one, self.options.loss, &self.free))
            };
            scatter.add_frame(block, clicks.iter().map(alone));
        }
        let free = self.free.iter().filter(|free| **free).count();
        scatter.covariance(&inverse, noise_scale, free, state.shared.width_m)
    }

    /// χ² of the inner half of the clicks over what it should be, at least 1.
    fn noise_scale(&self, state: &State) -> f64 {
        /// Median of χ² with two degrees of freedom.
        const MEDIAN: f64 = 1.386;
        let mut squares: Vec<f64> = Vec::new();
        for (clicks, ptz) in self.clicks.iter().zip(&state.ptz) {
            let camera = crate::camera::PtzCamera::new(state.shared.base, *ptz);
            squares.extend(clicks.iter().filter_map(|click| {
                let observation = click.observation(&state.shared, 0);
                Some((crate::solve::refine::distance_px(&camera, &observation)? / click.sigma_px).powi(2))
            }));
        }
        squares.sort_by(f64::total_cmp);
        squares.get(squares.len() / 2).map_or(1.0, |median| (median / MEDIAN).max(1.0))
    }
}

fn damped(own: &Mat3, damping: f64) -> Mat3 {
    let mut own = *own;
    for i in 0..3 {
        own[(i, i)] *= 1.0 + damping;
    }
    own
}
