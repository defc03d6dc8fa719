//! Two clicks against known truth: exactness without noise, honesty and efficiency with it, every
//! error by its name.

use crate::seeded::{self, normal};
use nalgebra::{Matrix2, Vector3};
use rand::RngExt;
use rand_pcg::Pcg64Mcg;
use touchline_core::camera::{BaseAngles, BaseSigma, CameraBase, FocalCurve, Ptz, PtzCamera};
use touchline_core::geometry::rotation::from_rotation_vector;
use touchline_core::geometry::{Angle, AngleRange, ImagePoint, ImageSize, Vec2, Vec3};
use touchline_core::solve::{
    Loss, Observation, ObservedShape, PtzPrior, SolveContext, SolveError, Verdict, WarningCode,
    judge, solve_frame, solve_two_points,
};

/// The size of the pictures.
pub const SIZE: ImageSize = ImageSize::new(1920, 1080);

/// A camera at the side of a field that looks somewhere, with a lens in every second case.
fn random_camera(rng: &mut Pcg64Mcg) -> PtzCamera {
    let angles = BaseAngles {
        heading: Angle::ZERO,
        pitch: Angle::from_degrees(rng.random_range(-2.0..2.0)),
        roll: Angle::from_degrees(rng.random_range(-2.0..2.0)),
    };
    let position = Vec3::new(
        rng.random_range(-30.0..30.0),
        rng.random_range(-100.0..-45.0),
        rng.random_range(8.0..40.0),
    );
    let mut base = CameraBase::new(position, angles.base_from_world(), SIZE.centre());
    if rng.random_bool(0.5) {
        base.distortion = FocalCurve {
            at_focal_px: 2000.0,
            value: rng.random_range(-0.08..0.05),
            per_1000_px: rng.random_range(0.0..0.25),
            ..FocalCurve::NONE
        };
    }
    let ptz = Ptz::from_degrees(
        rng.random_range(-50.0..50.0),
        rng.random_range(-30.0..-6.0),
        rng.random_range(1500.0f64.ln()..6000.0f64.ln()).exp(),
    );
    PtzCamera::new(base, ptz)
}

fn random_pixel(rng: &mut Pcg64Mcg) -> ImagePoint {
    ImagePoint::new(
        rng.random_range(0.0..f64::from(SIZE.width)),
        rng.random_range(0.0..f64::from(SIZE.height)),
    )
}

/// The ground that a pixel shows, or a point 80 m off above the horizon.
fn world_behind(camera: &PtzCamera, pixel: ImagePoint) -> Vec3 {
    camera
        .plane_from_image(pixel, 0.0)
        .filter(|ground| ground.norm() < 300.0)
        .unwrap_or_else(|| {
            camera.base().position_m
                + camera
                    .world_direction_from_image(pixel)
                    .expect("within the lens")
                    * 80.0
        })
}

fn landmark(at: Vec3, image: ImagePoint, click: usize) -> Observation {
    Observation::of_point(at, image, 2.0, click)
}

fn exact_clicks(camera: &PtzCamera, pixels: &[ImagePoint]) -> Vec<Observation> {
    let click = |(index, pixel): (usize, &ImagePoint)| {
        let at = world_behind(camera, *pixel);
        landmark(at, camera.image_from_world(at).expect("seen"), index)
    };
    pixels.iter().enumerate().map(click).collect()
}

fn is_truth(found: &Ptz, truth: &Ptz) -> bool {
    (found.pan - truth.pan).abs().radians() < 1e-9
        && (found.tilt - truth.tilt).abs().radians() < 1e-9
        && (found.focal_px - truth.focal_px).abs() < 1e-6
}

/// Over 100,000 random cameras and pairs of pixels the truth comes back to 1e-9 rad and 1e-6 px.
/// The only other answer is the refusal of clicks less than 2 px apart.
#[test]
fn the_truth_comes_back_from_any_two_exact_clicks() {
    let mut rng = seeded::rng("the_truth_comes_back_from_any_two_exact_clicks");
    let context = SolveContext::new(SIZE);
    let mut refused = 0;
    for trial in 0..100_000 {
        let camera = random_camera(&mut rng);
        let clicks = exact_clicks(&camera, &[random_pixel(&mut rng), random_pixel(&mut rng)]);
        match solve_frame(camera.base(), &clicks, &context) {
            Ok(solution) if is_truth(&solution.ptz, &camera.ptz()) => {}
            Err(SolveError::PointsTooClose { separation_px, .. }) if separation_px < 2.0 => {
                refused += 1;
            }
            result => panic!("trial {trial}: {result:?}\n for {camera:?}\n {clicks:?}"),
        }
    }
    assert!(refused < 20, "{refused} pairs less than 2 px apart");
}

/// Exact clicks anywhere in the picture of a camera whose k₁ follows the usual curve down to 900
/// px; k₁ alone folds inside the picture below 1223 px. Refused are only landmarks more than a
/// right angle apart, as without a lens.
#[test]
fn a_lens_without_a_fold_refuses_no_exact_clicks() {
    let mut rng = seeded::rng("a_lens_without_a_fold_refuses_no_exact_clicks");
    let context = SolveContext::new(SIZE);
    let (mut tried, mut ambiguous) = (0, 0);
    while tried < 6_000 {
        let drawn = random_camera(&mut rng);
        let distortion = FocalCurve {
            at_focal_px: 2000.0,
            value: -0.02,
            per_1000_px: 0.21,
            k2_per_k1_squared: FocalCurve::WITHOUT_FOLD,
        };
        let focal_px = rng.random_range(900.0f64.ln()..6000.0f64.ln()).exp();
        let camera = PtzCamera::new(
            CameraBase {
                distortion,
                ..*drawn.base()
            },
            Ptz {
                focal_px,
                ..drawn.ptz()
            },
        );
        let pixels = [random_pixel(&mut rng), random_pixel(&mut rng)];
        let rays = pixels.map(|pixel| camera.world_direction_from_image(pixel).expect("no fold"));
        if pixels[0].distance_px(pixels[1]) < 2.0 || rays[0].dot(&rays[1]) < 1e-3 {
            continue;
        }
        tried += 1;
        let clicks = exact_clicks(&camera, &pixels);
        match solve_frame(camera.base(), &clicks, &context) {
            Ok(solution) => ambiguous += u32::from(!is_truth(&solution.ptz, &camera.ptz())),
            Err(error) => panic!("pair {tried}: {error}\n for {camera:?}\n {clicks:?}"),
        }
    }
    // Seven: a second focal length is tried only where the first one misses the clicks by five
    // sigmas.
    assert!(
        ambiguous <= 7,
        "{ambiguous} pairs got another camera that fits within five sigmas"
    );
}

#[test]
fn about_one_pair_of_forty_has_two_focal_lengths_and_both_are_kept() {
    let mut rng = seeded::rng("about_one_pair_of_forty_has_two_focal_lengths_and_both_are_kept");
    let (trials, mut two) = (20_000, 0);
    for _ in 0..trials {
        let mut camera = random_camera(&mut rng);
        let base = CameraBase {
            distortion: FocalCurve::NONE,
            ..*camera.base()
        };
        camera = PtzCamera::new(base, camera.ptz());
        let clicks = exact_clicks(&camera, &[random_pixel(&mut rng), random_pixel(&mut rng)]);
        let [Some(one), Some(other)] = [clicks[0].shape.point(), clicks[1].shape.point()] else {
            unreachable!("both are landmarks")
        };
        let Ok(roots) = solve_two_points(&base, [one, other], [clicks[0].image, clicks[1].image])
        else {
            continue;
        };
        if roots.is_two() {
            two += 1;
            let solution = solve_frame(&base, &clicks, &SolveContext::new(SIZE)).unwrap();
            assert!(
                is_truth(&solution.ptz, &camera.ptz()),
                "the surplus equation tells exact roots apart"
            );
        }
    }
    let share = f64::from(two) / f64::from(trials);
    assert!((0.015..0.035).contains(&share), "{share}");
}

#[test]
fn a_second_root_that_fits_is_named_and_the_neighbours_decide() {
    let mut rng = seeded::rng("a_second_root_that_fits_is_named_and_the_neighbours_decide");
    let mut seen = 0;
    for _ in 0..4000 {
        let camera = random_camera(&mut rng);
        let clicks = exact_clicks(&camera, &[random_pixel(&mut rng), random_pixel(&mut rng)]);
        // Careless clicks: 30 px of noise hide the difference.
        let clicks: Vec<Observation> = clicks
            .into_iter()
            .map(|click| Observation {
                sigma_px: 30.0,
                ..click
            })
            .collect();
        let mut context = SolveContext::new(SIZE);
        // A second root is nearly always a fish-eye of under 400 px: it counts only where such a
        // lens is plausible.
        context.ranges.focal_px = 10.0..=1e5;
        let Ok(solution) = solve_frame(camera.base(), &clicks, &context) else {
            continue;
        };
        let Some(warning) = solution
            .warnings
            .iter()
            .find(|warning| warning.code == WarningCode::TwoRoots)
        else {
            continue;
        };
        seen += 1;
        assert!(
            warning.message.starts_with("Two focal lengths fit: "),
            "{}",
            warning.message
        );
        context.neighbours = vec![solution.alternatives[0].ptz];
        let other = solve_frame(camera.base(), &clicks, &context).unwrap();
        assert!((other.ptz.focal_px / solution.alternatives[0].ptz.focal_px - 1.0).abs() < 1e-9);
        assert!(
            other
                .warnings
                .iter()
                .any(|warning| warning.message.ends_with("as neighbours do."))
        );
    }
    assert!(seen > 3, "{seen}");
}

/// The clicks with normal noise of their own sigma, kept inside the frame.
pub fn noisy(clicks: &[Observation], rng: &mut Pcg64Mcg) -> Vec<Observation> {
    let shake = |click: &Observation, rng: &mut Pcg64Mcg| {
        let image = click
            .image
            .moved(Vec2::new(normal(rng), normal(rng)) * click.sigma_px);
        let inside = |x: f64, upto: u32| x.clamp(0.0, f64::from(upto));
        Observation {
            image: ImagePoint::new(inside(image.x, SIZE.width), inside(image.y, SIZE.height)),
            ..*click
        }
    };
    clicks.iter().map(|click| shake(click, rng)).collect()
}

/// The errors of pan and tilt, degrees, and of the focal length, px.
pub fn error(found: &Ptz, truth: &Ptz) -> Vector3<f64> {
    Vector3::new(
        (found.pan - truth.pan).degrees(),
        (found.tilt - truth.tilt).degrees(),
        found.focal_px - truth.focal_px,
    )
}

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
        clicks[2] = clicks[2].held_out();
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
fn a_landmark_and_a_line_or_three_lines_find_the_camera() {
    let mut rng = seeded::rng("a_landmark_and_a_line_or_three_lines_find_the_camera");
    let field = touchline_core::field::builtin("soccer")
        .unwrap()
        .model(&std::collections::BTreeMap::new(), 0.1)
        .unwrap();
    let base = CameraBase::new(
        Vec3::new(2.0, -62.0, 17.0),
        BaseAngles::default().base_from_world(),
        SIZE.centre(),
    );
    let mut context = SolveContext::new(SIZE);
    context.ranges.pan = AngleRange::around(Angle::ZERO, Angle::from_degrees(45.0));
    context.ranges.tilt = Angle::from_degrees(-30.0)..=Angle::from_degrees(0.0);
    context.ranges.focal_px = 1200.0..=6000.0;
    let (mut found_first, mut trials) = (0, 0);
    for _ in 0..60 {
        let truth = Ptz::from_degrees(
            rng.random_range(20.0..34.0),
            rng.random_range(-13.0..-10.0),
            2200.0,
        );
        let camera = PtzCamera::new(base, truth);
        let on_line = |name: &str, share: f64, click: usize| {
            let line = field.line(name).unwrap();
            let at = field.world_from_nominal(line.curve.point_at(share));
            let image = camera
                .image_from_world(at)
                .ok()
                .filter(|image| SIZE.contains(*image))?;
            Some(Observation::of_line(&field, name, image, SIZE, click).unwrap())
        };
        let mark = field.landmark_in_world(field.landmark("penalty_mark_right").unwrap());
        let Ok(image) = camera.image_from_world(mark) else {
            continue;
        };
        let mark = Observation::of_landmark(&field, "penalty_mark_right", image, SIZE, 0).unwrap();
        let lines = [
            on_line("goal_line_right", 0.55, 1),
            on_line("penalty_area_right_far", 0.5, 2),
            on_line("penalty_arc_right", 0.5, 3),
            on_line("penalty_area_right_front", 0.3, 4),
        ];
        let [Some(goal_line), Some(far), Some(arc), Some(front)] = lines else {
            continue;
        };
        let landmark_and_line: &[Observation] = &[mark, far];
        for clicks in [
            landmark_and_line,
            &[mark, goal_line, arc],
            &[goal_line, far, front, arc],
        ] {
            trials += 1;
            let solution = solve_frame(&base, clicks, &context).unwrap();
            let found = |ptz: &Ptz| {
                let error = error(ptz, &truth);
                error.x.abs() < 1e-6 && error.y.abs() < 1e-6 && error.z.abs() < 1e-3
            };
            found_first += i32::from(found(&solution.ptz));
            // The solution of the frame before decides where the clicks alone cannot.
            let neighbour = Ptz {
                pan: truth.pan + Angle::from_degrees(0.3),
                ..truth
            };
            let informed = SolveContext {
                neighbours: vec![neighbour],
                ..context.clone()
            };
            assert!(found(&solve_frame(&base, clicks, &informed).unwrap().ptz));
        }
    }
    assert!(
        trials > 60 && found_first == trials,
        "{found_first} of {trials}"
    );
}

fn known_base() -> CameraBase {
    CameraBase::new(
        Vec3::new(0.0, -60.0, 18.0),
        BaseAngles::default().base_from_world(),
        SIZE.centre(),
    )
}

fn known_clicks() -> [Observation; 2] {
    let camera = PtzCamera::new(known_base(), Ptz::from_degrees(10.0, -14.0, 2500.0));
    let clicks = exact_clicks(
        &camera,
        &[
            ImagePoint::new(300.0, 400.0),
            ImagePoint::new(1500.0, 700.0),
        ],
    );
    [clicks[0], clicks[1]]
}

#[test]
fn every_degenerate_case_is_named_with_its_numbers() {
    let context = SolveContext::new(SIZE);
    let [one, two] = known_clicks();
    let at = one.shape.point().unwrap();
    let moved = |x: f64, y: f64| Observation {
        image: ImagePoint::new(x, y),
        ..two
    };
    let farther = known_base().position_m + (at - known_base().position_m) * 1.5;
    let behind = known_base().position_m - (at - known_base().position_m);
    let base = known_base();
    // Even at its fold this lens sees no angle as wide as that between the landmarks.
    let fold = CameraBase {
        distortion: FocalCurve::constant(-30.0),
        ..base
    };
    let nowhere = CameraBase {
        position_m: Vec3::new(f64::NAN, 0.0, 0.0),
        ..base
    };
    let cases: Vec<(&str, CameraBase, Vec<Observation>, &str)> = vec![
        (
            "nothing",
            base,
            vec![],
            "0 equations for 3 unknowns: a landmark gives two, a point on a line one; click two landmarks",
        ),
        ("one", base, vec![one], "2 equations for 3 unknowns"),
        (
            "only a check",
            base,
            vec![one, two.held_out()],
            "2 equations for 3 unknowns",
        ),
        (
            "same pixel",
            base,
            vec![one, moved(one.image.x + 1.0, one.image.y)],
            "the points are 1.00 px apart, at least 2.0 px are needed",
        ),
        (
            "same landmark",
            base,
            vec![
                one,
                Observation {
                    shape: one.shape,
                    ..two
                },
            ],
            "show landmarks 0.0000° apart",
        ),
        (
            "same ray",
            base,
            vec![
                one,
                Observation {
                    shape: ObservedShape::Point(farther),
                    ..two
                },
            ],
            "points 1 and 2 show landmarks 0.0000° apart",
        ),
        (
            "opposite rays",
            base,
            vec![
                one,
                Observation {
                    shape: ObservedShape::Point(behind),
                    ..two
                },
            ],
            "show landmarks 180.0000° apart",
        ),
        (
            "behind",
            base,
            vec![
                one,
                Observation {
                    shape: ObservedShape::Point(Vec3::new(0.0, -90.0, 0.0)),
                    ..two
                },
            ],
            "point 2 shows something behind the camera: check its name",
        ),
        (
            "NaN",
            base,
            vec![one, moved(f64::NAN, 3.0)],
            "point 2 is not a finite pixel",
        ),
        (
            "no sigma",
            base,
            vec![
                one,
                Observation {
                    sigma_px: 0.0,
                    ..two
                },
            ],
            "point 2 is not a finite pixel with a positive sigma",
        ),
        (
            "NaN landmark",
            base,
            vec![
                one,
                Observation {
                    shape: ObservedShape::Point(Vec3::new(0.0, f64::NAN, 0.0)),
                    ..two
                },
            ],
            "point 2 is not a finite pixel",
        ),
        (
            "outside",
            base,
            vec![one, moved(1920.5, 3.0)],
            "point 2 at (1920.5, 3.0) lies outside the 1920×1080 px frame",
        ),
        (
            "at the camera",
            base,
            vec![
                one,
                Observation {
                    shape: ObservedShape::Point(base.position_m),
                    ..two
                },
            ],
            "point 2 shows a landmark 0.000 m from the camera",
        ),
        (
            "base",
            nowhere,
            vec![one, two],
            "the camera base is not finite",
        ),
        (
            "no root",
            base,
            vec![
                Observation {
                    image: ImagePoint::new(1400.0, 540.0),
                    ..one
                },
                moved(1500.0, 545.0),
            ],
            "no focal length fits points 1 and 2: 100 px apart for landmarks",
        ),
        ("lens", fold, vec![one, two], "no focal length fits"),
    ];
    for (name, base, clicks, message) in cases {
        let clicks: Vec<Observation> = clicks
            .into_iter()
            .enumerate()
            .map(|(click, seen)| Observation { click, ..seen })
            .collect();
        let error = solve_frame(&base, &clicks, &context)
            .map(|solution| solution.ptz)
            .unwrap_err();
        assert!(error.to_string().contains(message), "{name}: {error}");
    }
}

#[test]
fn a_camera_that_sees_a_click_just_inside_the_fold_of_its_lens_is_found() {
    let [one, two] = known_clicks();
    let folding = CameraBase {
        distortion: FocalCurve::constant(-3.0),
        ..known_base()
    };
    let solved = solve_frame(&folding, &[one, two], &SolveContext::new(SIZE)).unwrap();
    let camera = PtzCamera::new(folding, solved.ptz);
    for click in [one, two] {
        assert!(
            click.distance_px(&camera).unwrap() < 2.0,
            "{:?}",
            click.distance_px(&camera)
        );
    }
}

#[test]
fn a_click_on_the_principal_point_is_an_ordinary_case() {
    let camera = PtzCamera::new(known_base(), Ptz::from_degrees(-7.0, -12.0, 3000.0));
    for other in [
        ImagePoint::new(960.0, 100.0),
        ImagePoint::new(100.0, 540.0),
        ImagePoint::new(1800.0, 900.0),
    ] {
        let clicks = exact_clicks(&camera, &[SIZE.centre(), other]);
        let solution = solve_frame(camera.base(), &clicks, &SolveContext::new(SIZE)).unwrap();
        assert!(
            is_truth(&solution.ptz, &camera.ptz()),
            "{other:?}: {:?}",
            solution.ptz
        );
    }
}

#[test]
fn two_good_clicks_are_good_but_no_evidence_and_close_ones_say_what_they_cost() {
    let context = SolveContext::new(SIZE);
    let solution = solve_frame(&known_base(), &known_clicks(), &context).unwrap();
    assert!(!solution.residuals_are_evidence() && solution.redundancy == 1);
    let judgement = judge(&solution, SIZE);
    assert_eq!(judgement.verdict, Verdict::Good, "{judgement:?}");
    assert!(
        judgement.reason.contains("no evidence"),
        "{}",
        judgement.reason
    );

    let camera = PtzCamera::new(known_base(), Ptz::from_degrees(10.0, -14.0, 2500.0));
    let close = exact_clicks(
        &camera,
        &[ImagePoint::new(800.0, 500.0), ImagePoint::new(900.0, 500.0)],
    );
    let solution = solve_frame(&known_base(), &close, &context).unwrap();
    let judgement = judge(&solution, SIZE);
    assert_eq!(judgement.verdict, Verdict::Check);
    let expected =
        "Points 100 px apart: focal ±2.8 %, worst corner ±35 px. A point at 800 px would give ±4";
    assert!(
        judgement.reason.starts_with(expected),
        "{}",
        judgement.reason
    );
}

#[test]
fn clicks_that_contradict_each_other_are_wrong() {
    let camera = PtzCamera::new(known_base(), Ptz::from_degrees(10.0, -14.0, 2500.0));
    let pixels = [
        [300.0, 400.0],
        [1500.0, 700.0],
        [900.0, 300.0],
        [700.0, 900.0],
    ]
    .map(ImagePoint::from);
    let mut clicks = exact_clicks(&camera, &pixels);
    let context = SolveContext::new(SIZE);
    assert_eq!(
        judge(
            &solve_frame(&known_base(), &clicks, &context).unwrap(),
            SIZE
        )
        .verdict,
        Verdict::Good
    );
    clicks[2].image = clicks[2].image.moved(Vec2::new(70.0, 0.0));
    let solution = solve_frame(&known_base(), &clicks, &context).unwrap();
    assert_eq!(judge(&solution, SIZE).verdict, Verdict::Wrong);
    let warning = solution
        .warnings
        .iter()
        .find(|warning| warning.code == WarningCode::Contradiction)
        .unwrap();
    assert!(
        warning.clicks == [2] && warning.message.starts_with("Point 3 is "),
        "{warning}"
    );
    // Held out, it fails as a check and leaves the solution alone.
    clicks[2] = clicks[2].held_out();
    let solution = solve_frame(&known_base(), &clicks, &context).unwrap();
    assert!(is_truth(&solution.ptz, &camera.ptz()));
    assert!((solution.checks[0].error_px.unwrap() - 70.0).abs() < 1e-6);
    assert_eq!(solution.warnings[0].code, WarningCode::CheckFailed);
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
