//! Levenberg–Marquardt over pan, tilt and log focal length on every click of a frame.
//!
//! A landmark gives two residuals, a point on a line one (its signed distance), a prior three; all in sigmas, with
//! analytic Jacobians. Nothing is allocated.

use super::line::{line_distance_px, line_residual};
use super::{Loss, Observation, PtzPrior, Target};
use crate::camera::{CameraBase, Ptz, PtzCamera};
use crate::geometry::{Angle, Mat3, Vec3};
use nalgebra::SMatrix;

/// What a click counts for whose target has no image, in sigmas.
pub(super) const NO_IMAGE_SIGMAS: f64 = 1e3;

/// Iterations at most.
const MAX_ITERATIONS: usize = 60;

/// Steps in (rad, rad, log f) below this end the search.
const ENOUGH: f64 = 1e-12;

/// Steps below this that make it worse end it too.
const ENOUGH_IF_WORSE: f64 = 1e-8;

/// Where the search ended.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Refined {
    /// Pan, tilt, focal length.
    pub ptz: Ptz,
    /// The minimised sum: of squares in sigmas under [`Loss::Squared`].
    pub cost: f64,
    /// Steps tried.
    pub iterations: usize,
}

/// Refines pan, tilt and focal length over all observations (held-out ones as well: leave them out before).
#[must_use]
pub fn refine(
    base: &CameraBase,
    start: Ptz,
    observations: &[Observation],
    loss: Loss,
    prior: Option<&PtzPrior>,
) -> Refined {
    let mut ptz = start;
    let mut normal = NormalEquations::at(base, ptz, observations, loss, prior);
    let mut damping = 1e-6;
    let mut iterations = 0;
    while iterations < MAX_ITERATIONS {
        iterations += 1;
        let Some(step) = normal.step(damping) else {
            damping *= 10.0;
            continue;
        };
        let length = step.norm();
        if !length.is_finite() {
            break;
        }
        let next = stepped(ptz, step);
        let tried = NormalEquations::at(base, next, observations, loss, prior);
        let better = tried.cost <= normal.cost;
        if better {
            (ptz, normal) = (next, tried);
            damping = (damping * 0.1).max(1e-15);
        } else {
            damping *= 10.0;
        }
        // A short step that is no gain is rounding.
        if length < if better { ENOUGH } else { ENOUGH_IF_WORSE } {
            break;
        }
    }
    Refined { ptz: Ptz { pan: ptz.pan.wrapped(), ..ptz }, cost: normal.cost, iterations }
}

/// The cost of a camera without refining it.
pub(super) fn cost(camera: &PtzCamera, observations: &[Observation], loss: Loss) -> f64 {
    observations
        .iter()
        .map(|observation| loss.of(squared_sigmas(distance_px(camera, observation), observation.sigma_px)).0)
        .sum()
}

/// The distance of a click from what it shows, px; none where that has no image.
#[must_use]
pub fn distance_px(camera: &PtzCamera, observation: &Observation) -> Option<f64> {
    match observation.target {
        Target::Landmark(at) => Some(camera.image_from_world(at).ok()?.distance_px(observation.image)),
        Target::Line(curve) => Some(line_distance_px(camera, &curve, observation.image)?.abs()),
    }
}

/// The square of a distance in sigmas; a large constant where there is no image.
pub(super) fn squared_sigmas(distance_px: Option<f64>, sigma_px: f64) -> f64 {
    distance_px.map_or(NO_IMAGE_SIGMAS * NO_IMAGE_SIGMAS, |distance| (distance / sigma_px).powi(2))
}

impl Loss {
    /// What z² sigmas² count for, and the derivative of that by z² (the weight).
    #[must_use]
    pub fn of(self, z_squared: f64) -> (f64, f64) {
        match self {
            Self::Squared => (z_squared, 1.0),
            Self::Huber { k } => {
                if z_squared <= k * k {
                    (z_squared, 1.0)
                } else {
                    let z = z_squared.sqrt();
                    (2.0 * k * z - k * k, k / z)
                }
            }
            Self::Cauchy { c } => {
                let ratio = z_squared / (c * c);
                (c * c * ratio.ln_1p(), 1.0 / (1.0 + ratio))
            }
        }
    }
}

fn stepped(ptz: Ptz, step: Vec3) -> Ptz {
    // A factor of three at most: a step from far off must not leave the world.
    let log_focal = step.z.clamp(-1.1, 1.1);
    Ptz {
        pan: ptz.pan + Angle::from_radians(step.x),
        tilt: ptz.tilt + Angle::from_radians(step.y),
        focal_px: ptz.focal_px * log_focal.exp(),
    }
}

/// Jᵀ W J and Jᵀ W r in (pan, tilt, log f), and the cost.
struct NormalEquations {
    matrix: Mat3,
    gradient: Vec3,
    cost: f64,
}

impl NormalEquations {
    fn at(base: &CameraBase, ptz: Ptz, observations: &[Observation], loss: Loss, prior: Option<&PtzPrior>) -> Self {
        let camera = PtzCamera::new(*base, ptz);
        let mut normal = Self { matrix: Mat3::zeros(), gradient: Vec3::zeros(), cost: 0.0 };
        for observation in observations {
            let scale = 1.0 / observation.sigma_px;
            match observation.target {
                Target::Landmark(at) => match camera.image_from_world_by_ptz(at) {
                    Ok((point, by_ptz)) => {
                        let residual = point.offset_from(observation.image) * scale;
                        normal.add(ptz.focal_px, residual, by_ptz * scale, loss);
                    }
                    Err(_) => normal.add_without_image(loss),
                },
                Target::Line(curve) => match line_residual(&camera, &curve, observation.image) {
                    Some(here) => {
                        let residual = SMatrix::<f64, 1, 1>::new(here.distance_px * scale);
                        normal.add(ptz.focal_px, residual, here.by_ptz * scale, loss);
                    }
                    None => normal.add_without_image(loss),
                },
            }
        }
        if let Some(prior) = prior {
            let residual = Vec3::new(
                (ptz.pan - prior.ptz.pan).wrapped().radians() / prior.sigma_pan.radians(),
                (ptz.tilt - prior.ptz.tilt).radians() / prior.sigma_tilt.radians(),
                (ptz.focal_px / prior.ptz.focal_px).ln() / prior.sigma_focal_share,
            );
            let by_ptz = prior.whitening(ptz.focal_px);
            normal.add(ptz.focal_px, residual, by_ptz, Loss::Squared);
        }
        normal
    }

    fn add<const ROWS: usize>(
        &mut self,
        focal_px: f64,
        residual: SMatrix<f64, ROWS, 1>,
        mut by_ptz: SMatrix<f64, ROWS, 3>,
        loss: Loss,
    ) {
        by_ptz.column_mut(2).scale_mut(focal_px);
        let (cost, weight) = loss.of(residual.norm_squared());
        let weighted = by_ptz.transpose() * weight;
        self.matrix += weighted * by_ptz;
        self.gradient += weighted * residual;
        self.cost += cost;
    }

    fn add_without_image(&mut self, loss: Loss) {
        self.cost += loss.of(NO_IMAGE_SIGMAS * NO_IMAGE_SIGMAS).0;
    }

    /// The damped Gauss–Newton step; none if the matrix is singular.
    fn step(&self, damping: f64) -> Option<Vec3> {
        let mut matrix = self.matrix;
        for i in 0..3 {
            matrix[(i, i)] *= 1.0 + damping;
        }
        Some(-(matrix.try_inverse()? * self.gradient))
    }
}

impl PtzPrior {
    /// The rows of the prior by (pan rad, tilt rad, focal px) at a focal length.
    pub(crate) fn whitening(&self, focal_px: f64) -> Mat3 {
        Mat3::from_diagonal(&Vec3::new(
            1.0 / self.sigma_pan.radians(),
            1.0 / self.sigma_tilt.radians(),
            1.0 / (self.sigma_focal_share * focal_px),
        ))
    }
}
