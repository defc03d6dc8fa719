//! Least-squares refinement of one frame with a known base: pan, tilt and log focal length over all
//! its observations.
//!
//! A landmark gives two residuals, a point on a line one, a prior three; all in sigmas, with
//! analytic Jacobians. Nothing is allocated.

use super::{Loss, Observation, PtzPrior};
use crate::camera::{CameraBase, Ptz, PtzCamera};
use crate::geometry::{Angle, Vec3};
use crate::solve::optimiser::least_squares::{
    BlockEquations, NO_VALUE_SIGMAS, Problem, Stopping, minimise,
};
use crate::solve::optimiser::residual::Residual;

/// Maximum number of iterations.
const MAX_ITERATIONS: usize = 60;

/// A step in (rad, rad, log f) shorter than this ends the search.
const SHORT_STEP: f64 = 1e-12;

/// The result of a refinement.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Refined {
    /// Pan, tilt, focal length.
    pub ptz: Ptz,
    /// The minimised sum: of squares in sigmas under [`Loss::Squared`].
    pub cost: f64,
    /// Steps tried.
    pub iterations: usize,
}

/// Refines pan, tilt and focal length over all given observations. Held-out ones are not skipped;
/// the caller removes them.
pub fn refine(
    base: &CameraBase,
    start: Ptz,
    observations: &[Observation],
    loss: Loss,
    prior: Option<&PtzPrior>,
) -> Refined {
    refine_until(base, start, observations, loss, prior, SHORT_STEP)
}

/// [`refine`], ended by the first step (rad, rad, log f) shorter than `enough`. Under a robust loss
/// the convergence is linear, so the last digits take most of the steps.
pub fn refine_until(
    base: &CameraBase,
    start: Ptz,
    observations: &[Observation],
    loss: Loss,
    prior: Option<&PtzPrior>,
    enough: f64,
) -> Refined {
    let until = Stopping {
        max_iterations: MAX_ITERATIONS,
        short_step: enough,
        small_gain: 0.0,
    };
    let found = minimise(
        &FrameProblem {
            base,
            residuals: observations,
            loss,
            prior,
        },
        start,
        until,
    );
    // Steps add to the pan without a bound; the result is a direction again.
    let ptz = Ptz {
        pan: found.state.pan.wrap(),
        ..found.state
    };
    Refined {
        ptz,
        cost: found.equations.cost(),
        iterations: found.iterations,
    }
}

/// The pan, tilt and focal length of one frame, from residuals of one kind and a prior.
struct FrameProblem<'a, R> {
    base: &'a CameraBase,
    residuals: &'a [R],
    loss: Loss,
    prior: Option<&'a PtzPrior>,
}

impl<R: Residual<2, 0, 3, State = PtzCamera>> Problem for FrameProblem<'_, R> {
    type State = Ptz;
    type Equations = BlockEquations<0, 3>;

    #[inline]
    fn equations(&self, ptz: &Ptz) -> BlockEquations<0, 3> {
        let camera = PtzCamera::new(*self.base, *ptz);
        let mut equations = BlockEquations::zero();
        for residual in self.residuals {
            equations.add(residual, &camera, self.loss);
        }
        if let Some(prior) = self.prior {
            equations.add(prior, &camera, self.loss);
        }
        equations
    }

    #[inline]
    fn apply_step(&self, ptz: &Ptz, step: &Vec3) -> Ptz {
        apply_step(ptz, step)
    }
}

/// Pan, tilt and focal length after a step in (rad, rad, log f).
pub(super) fn apply_step(ptz: &Ptz, step: &Vec3) -> Ptz {
    // At most a factor of three per step: a Gauss–Newton step from a distant start may be far too
    // long.
    let log_focal = step.z.clamp(-1.1, 1.1);
    Ptz::new(
        ptz.pan + Angle::from_radians(step.x),
        ptz.tilt + Angle::from_radians(step.y),
        ptz.focal_px * log_focal.exp(),
    )
}

/// The cost of a camera without refining it.
pub(super) fn cost(camera: &PtzCamera, observations: &[Observation], loss: Loss) -> f64 {
    observations
        .iter()
        .map(|observation| {
            let distance_px = observation.distance_px(camera);
            loss.evaluate(squared_sigmas(distance_px, observation.sigma_px))
                .0
        })
        .sum()
}

/// The square of a distance in sigmas; a large constant where there is no image.
pub(super) fn squared_sigmas(distance_px: Option<f64>, sigma_px: f64) -> f64 {
    distance_px.map_or(NO_VALUE_SIGMAS * NO_VALUE_SIGMAS, |distance| {
        (distance / sigma_px).powi(2)
    })
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::camera::FocalCurve;
    use crate::field::builtin;
    use crate::geometry::{ImagePoint, ImageSize, Mat3};
    use crate::solve::fixtures;
    use crate::testing::check_derivatives;
    use std::collections::BTreeMap;

    #[test]
    fn the_cost_of_many_observations_is_the_sum_of_their_losses_and_the_last_digits_need_not_be_waited_for()
     {
        let base = CameraBase::new(
            Vec3::zeros(),
            Mat3::identity(),
            ImagePoint::new(640.0, 360.0),
        );
        let truth = Ptz::from_degrees(4.0, -9.0, 2300.0);
        let camera = PtzCamera::new(base, truth);
        // Noise, and every fourth far off, one without an image: products beyond what a number
        // holds many times over.
        let observations: Vec<Observation> = (0..2000u32)
            .map(|i| {
                let (x, y) = (f64::from(i * 7919 % 1280), f64::from(i * 104_729 % 720));
                let direction = camera
                    .world_direction_from_image(ImagePoint::new(x, y))
                    .unwrap();
                let off = if i % 4 == 0 {
                    300.0
                } else {
                    f64::from(i % 13) / 13.0
                };
                let at = if i == 1001 { -direction } else { direction };
                Observation::from_point(at, ImagePoint::new(x + off, y - off / 2.0), 0.5, 0)
            })
            .collect();
        let loss = Loss::Cauchy { c: 2.4 };
        let start = Ptz::from_degrees(4.01, -9.02, 2305.0);
        let refined = refine(&base, start, &observations, loss, None);
        let summed = cost(&PtzCamera::new(base, refined.ptz), &observations, loss);
        assert!(
            (refined.cost - summed).abs() < 1e-9 * summed,
            "{} is not {summed}",
            refined.cost
        );
        let sooner = refine_until(&base, start, &observations, loss, None, 1e-8);
        assert!(sooner.iterations < refined.iterations);
        assert!((sooner.ptz.pan - refined.ptz.pan).radians().abs() < 1e-8);
        assert!((sooner.ptz.focal_px / refined.ptz.focal_px - 1.0).abs() < 1e-8);
    }

    #[test]
    fn clicks_and_priors_change_with_pan_tilt_and_focal_length_as_their_jacobians_say() {
        let base = CameraBase {
            distortion: FocalCurve {
                at_focal_px: 2000.0,
                value: -0.05,
                per_1000_px: 0.2,
                ..FocalCurve::NONE
            },
            ..fixtures::base()
        };
        let ptz = Ptz::from_degrees(-4.0, -15.0, 1910.0);
        let stepped = |_: &nalgebra::SVector<f64, 0>, step: &Vec3| {
            PtzCamera::new(base, apply_step(&ptz, step))
        };
        let field = builtin("soccer")
            .unwrap()
            .model(&BTreeMap::new(), 0.15)
            .unwrap();
        let (image, size) = (ImagePoint::new(880.0, 400.0), ImageSize::new(1920, 1080));
        for name in ["centre_mark", "centre_circle_left", "post_far_left_top"] {
            let click = Observation::from_landmark(&field, name, image, size, 0).unwrap();
            check_derivatives(&click, stepped).expect(name);
        }
        for name in ["halfway_line", "touchline_far", "centre_circle"] {
            let click = Observation::from_line(&field, name, image, size, 0).unwrap();
            check_derivatives(&click, stepped).expect(name);
        }
        let prior = PtzPrior {
            ptz: Ptz::from_degrees(-4.5, -14.0, 2000.0),
            sigma_pan: Angle::from_degrees(3.0),
            sigma_tilt: Angle::from_degrees(2.0),
            sigma_focal_share: 0.02,
            by_base: nalgebra::SMatrix::zeros(),
        };
        check_derivatives(&prior, stepped).expect("prior");
    }
}
