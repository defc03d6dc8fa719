//! With noise the stated uncertainty is the scatter, and the scatter is the bound.

use super::{SIZE, error, exact_clicks, known_base, known_clicks, noisy, random_camera};
use nalgebra::{Matrix2, Vector3};
use rand::RngExt;
use rand_pcg::Pcg64Mcg;
use touchline_core::camera::{BaseSigma, CameraBase, Ptz, PtzCamera};
use touchline_core::geometry::rotation::from_rotation_vector;
use touchline_core::geometry::{Angle, ImagePoint, Vec3};
use touchline_core::solve::{Loss, Observation, PtzPrior, SolveContext, WarningCode, solve_frame};
use touchline_core::testing::seeded::{self, normal};

/// Pixels at least 500 px apart and 20 px inside the frame.
fn good_pair(rng: &mut Pcg64Mcg) -> [ImagePoint; 2] {
    loop {
        let inside = |rng: &mut Pcg64Mcg| {
            ImagePoint::new(
                rng.random_range(20.0..1900.0),
                rng.random_range(20.0..1060.0),
            )
        };
        let pair = [inside(rng), inside(rng)];
        if pair[0].distance_px(pair[1]) > 500.0 {
            return pair;
        }
    }
}

#[test]
fn the_covariance_is_the_scatter_and_the_scatter_is_the_bound() {
    let mut rng = seeded::rng("the_covariance_is_the_scatter_and_the_scatter_is_the_bound");
    let context = SolveContext::new(SIZE);
    let (mut mahalanobis, mut count) = (0.0, 0.0);
    let mut efficiencies = Vec::new();
    for _ in 0..40 {
        let camera = random_camera(&mut rng);
        let clicks: Vec<Observation> = exact_clicks(&camera, &good_pair(&mut rng))
            .into_iter()
            .map(|click| Observation {
                sigma_px: 1.0,
                ..click
            })
            .collect();
        let bound = solve_frame(camera.base(), &clicks, &context)
            .unwrap()
            .covariance;
        let (mut squares, draws) = (Vector3::zeros(), 500);
        for _ in 0..draws {
            let solution = solve_frame(camera.base(), &noisy(&clicks, &mut rng), &context).unwrap();
            let error = error(&solution.ptz, &camera.ptz());
            squares += error.component_mul(&error) / f64::from(draws);
            mahalanobis += error.dot(&(solution.covariance.try_inverse().unwrap() * error));
            count += 1.0;
        }
        efficiencies.push(bound.diagonal().component_div(&squares));
    }
    // Mahalanobis distances squared average 3 with three parameters; 20,000 draws know it to 0.6 %.
    let mean = mahalanobis / count;
    assert!(
        (mean / 3.0 - 1.0).abs() < 0.03,
        "mean squared Mahalanobis distance {mean:.3} of 3"
    );
    for (parameter, name) in ["pan", "tilt", "focal"].into_iter().enumerate() {
        let mean = efficiencies
            .iter()
            .map(|share| share[parameter])
            .sum::<f64>()
            / efficiencies.len() as f64;
        assert!(mean >= 0.97, "{name}: efficiency {mean:.3}");
    }
}

/// Click noise, and a base whose true position and rotation differ from the nominal ones by its own
/// sigma: the 68 % ellipse of the overlay holds the truth 68 % of the time, and the covariance of
/// pan, tilt and focal length is right.
#[test]
fn the_uncertainty_of_a_base_is_propagated_into_the_solution_and_the_overlay() {
    const CHI_SQUARED_68: f64 = 2.28;
    let mut rng = seeded::rng("an_uncertain_base_is_carried_into_the_solution_and_the_overlay");
    let context = SolveContext::new(SIZE);
    let (mut inside, mut overlays, mut mahalanobis, mut solved, mut misfit) =
        (0.0, 0.0, 0.0, 0.0, 0.0);
    for _ in 0..4000 {
        let truth = random_camera(&mut rng);
        let sigma = BaseSigma {
            position_m: Vec3::new(0.1, 0.2, 0.1),
            rotation: Vec3::new(0.05f64.to_radians(), 0.05f64.to_radians(), 0.0),
            ..BaseSigma::default()
        };
        let gaussian = Vec3::from_fn(|_, _| normal(&mut rng));
        let turn = Vec3::from_fn(|_, _| normal(&mut rng)).component_mul(&sigma.rotation);
        let nominal = CameraBase {
            position_m: truth.base().position_m - gaussian.component_mul(&sigma.position_m),
            base_from_world: truth.base().base_from_world * from_rotation_vector(-turn),
            sigma,
            ..*truth.base()
        };
        let pair = good_pair(&mut rng);
        if pair.iter().any(|pixel| {
            truth
                .plane_from_image(*pixel, 0.0)
                .is_none_or(|ground| ground.norm() > 120.0)
        }) {
            continue;
        }
        let clicks = noisy(&exact_clicks(&truth, &pair), &mut rng);
        let Ok(solution) = solve_frame(&nominal, &clicks, &context) else {
            continue;
        };
        let found = PtzCamera::new(nominal, solution.ptz);
        let ptz_error = error(&solution.ptz, &truth.ptz());
        mahalanobis += ptz_error.dot(&(solution.covariance.try_inverse().unwrap() * ptz_error));
        misfit += solution.misfit().unwrap().powi(2);
        solved += 1.0;
        for pixel in [[100.0, 300.0], [1800.0, 400.0], [960.0, 1000.0]].map(ImagePoint::from) {
            let Some(ground) = truth
                .plane_from_image(pixel, 0.0)
                .filter(|ground| ground.norm() < 150.0)
            else {
                continue;
            };
            let Ok(drawn) = found.image_from_world(ground) else {
                continue;
            };
            let offset = drawn.offset_from(truth.image_from_world(ground).unwrap());
            let covariance: Matrix2<f64> = solution
                .uncertainty
                .overlay_at_world(&found, ground)
                .unwrap();
            overlays += 1.0;
            if offset.dot(&(covariance.try_inverse().unwrap() * offset)) < CHI_SQUARED_68 {
                inside += 1.0;
            }
        }
    }
    assert!(
        (mahalanobis / solved / 3.0 - 1.0).abs() < 0.06,
        "{} of 3 over {solved}",
        mahalanobis / solved
    );
    assert!(
        (misfit / solved - 1.0).abs() < 0.1,
        "χ² is {} times what is expected",
        misfit / solved
    );
    let share: f64 = inside / overlays;
    assert!(
        (share - 0.68).abs() < 0.03,
        "the 68 % ellipses hold {:.1} %",
        100.0 * share
    );
}

#[test]
fn check_clicks_get_honest_z_scores() {
    let mut rng = seeded::rng("check_clicks_get_honest_z_scores");
    let (mut below_68, mut all, mut alarms) = (0.0, 0.0, 0);
    for _ in 0..2000 {
        let camera = random_camera(&mut rng);
        let [one, two] = good_pair(&mut rng);
        let mut clicks = noisy(
            &exact_clicks(&camera, &[one, two, good_pair(&mut rng)[0]]),
            &mut rng,
        );
        clicks[2] = clicks[2].hold_out();
        let solution = solve_frame(camera.base(), &clicks, &SolveContext::new(SIZE)).unwrap();
        let z = solution.checks[0].z_score.unwrap();
        all += 1.0;
        below_68 += if z * z < 2.28 { 1.0 } else { 0.0 };
        alarms += usize::from(
            solution
                .warnings
                .iter()
                .any(|warning| warning.code == WarningCode::CheckFailed),
        );
    }
    assert!(
        (below_68 / all - 0.68f64).abs() < 0.03,
        "{}",
        below_68 / all
    );
    assert!(alarms < 15, "{alarms} false alarms");
}

#[test]
fn a_prior_pulls_and_one_landmark_is_then_enough() {
    let [one, _] = known_clicks();
    let prior = PtzPrior {
        ptz: Ptz::from_degrees(10.4, -14.1, 2550.0),
        sigma_pan: Angle::from_degrees(0.5),
        sigma_tilt: Angle::from_degrees(0.5),
        sigma_focal_share: 0.02,
        by_base: nalgebra::SMatrix::zeros(),
    };
    let context = SolveContext {
        prior: Some(prior),
        loss: Loss::Squared,
        ..SolveContext::new(SIZE)
    };
    let solution = solve_frame(&known_base(), &[one], &context).unwrap();
    assert!(solution.residuals[0].distance_px().unwrap() < 1.0);
    assert!((solution.ptz.focal_px - 2550.0).abs() < 60.0 && solution.redundancy == 2);
    assert!(solution.sigma_focal_px() < 51.0);
}
