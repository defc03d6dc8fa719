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
    refine_until(base, start, observations, loss, prior, ENOUGH)
}

/// [`refine`], ended by the first step (rad, rad, log f) below `enough`: a robust loss comes nearer by the same factor with
/// each step, and the last digits cost most.
#[must_use]
pub fn refine_until(
    base: &CameraBase,
    start: Ptz,
    observations: &[Observation],
    loss: Loss,
    prior: Option<&PtzPrior>,
    enough: f64,
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
        if length < if better { enough } else { ENOUGH_IF_WORSE.max(enough) } {
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
    /// What Cauchy's loss takes the logarithm of, for as many observations as a number can hold: logarithms take long.
    product: f64,
}

/// A product is taken the logarithm of before it grows beyond this.
const LARGE: f64 = 1e200;

impl NormalEquations {
    fn at(base: &CameraBase, ptz: Ptz, observations: &[Observation], loss: Loss, prior: Option<&PtzPrior>) -> Self {
        let camera = PtzCamera::new(*base, ptz);
        let mut normal = Self { matrix: Mat3::zeros(), gradient: Vec3::zeros(), cost: 0.0, product: 1.0 };
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
        if let Loss::Cauchy { c } = loss {
            normal.add_product(c);
        }
        normal
    }

    /// The loss of a squared residual in sigmas, added to the cost; the weight.
    fn add_loss(&mut self, z_squared: f64, loss: Loss) -> f64 {
        let Loss::Cauchy { c } = loss else {
            let (cost, weight) = loss.of(z_squared);
            self.cost += cost;
            return weight;
        };
        let factor = 1.0 + z_squared / (c * c);
        self.product *= factor;
        if !(self.product < LARGE) {
            self.add_product(c);
        }
        1.0 / factor
    }

    /// Cauchy's loss of all observations in the product.
    fn add_product(&mut self, c: f64) {
        self.cost += c * c * self.product.ln();
        self.product = 1.0;
    }

    fn add<const ROWS: usize>(
        &mut self,
        focal_px: f64,
        residual: SMatrix<f64, ROWS, 1>,
        mut by_ptz: SMatrix<f64, ROWS, 3>,
        loss: Loss,
    ) {
        by_ptz.column_mut(2).scale_mut(focal_px);
        let weight = self.add_loss(residual.norm_squared(), loss);
        let weighted = by_ptz.transpose() * weight;
        self.matrix += weighted * by_ptz;
        self.gradient += weighted * residual;
    }

    fn add_without_image(&mut self, loss: Loss) {
        self.add_loss(NO_IMAGE_SIGMAS * NO_IMAGE_SIGMAS, loss);
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

#[cfg(test)]
mod tests {
    use super::*;
    use crate::geometry::ImagePoint;

    #[test]
    fn the_cost_of_many_observations_is_the_sum_of_their_losses_and_the_last_digits_need_not_be_waited_for() {
        let base = CameraBase::new(Vec3::zeros(), Mat3::identity(), ImagePoint::new(640.0, 360.0));
        let truth = Ptz::from_degrees(4.0, -9.0, 2300.0);
        let camera = PtzCamera::new(base, truth);
        // Noise, and every fourth far off, one without an image: products beyond what a number holds many times over.
        let observations: Vec<Observation> = (0..2000u32)
            .map(|i| {
                let (x, y) = (f64::from(i * 7919 % 1280), f64::from(i * 104_729 % 720));
                let target = camera.world_direction_from_image(ImagePoint::new(x, y)).unwrap();
                let off = if i % 4 == 0 { 300.0 } else { f64::from(i % 13) / 13.0 };
                let target = Target::Landmark(if i == 1001 { -target } else { target });
                Observation {
                    image: ImagePoint::new(x + off, y - off / 2.0),
                    sigma_px: 0.5,
                    target,
                    click: 0,
                    check: false,
                }
            })
            .collect();
        let loss = Loss::Cauchy { c: 2.4 };
        let start = Ptz::from_degrees(4.01, -9.02, 2305.0);
        let refined = refine(&base, start, &observations, loss, None);
        let summed = cost(&PtzCamera::new(base, refined.ptz), &observations, loss);
        assert!((refined.cost - summed).abs() < 1e-9 * summed, "{} is not {summed}", refined.cost);
        let sooner = refine_until(&base, start, &observations, loss, None, 1e-8);
        assert!(sooner.iterations < refined.iterations);
        assert!((sooner.ptz.pan - refined.ptz.pan).radians().abs() < 1e-8);
        assert!((sooner.ptz.focal_px / refined.ptz.focal_px - 1.0).abs() < 1e-8);
    }
}
