//! Every error and warning by its name and with its numbers.

use super::{SIZE, exact_clicks, is_truth, known_base, known_clicks};
use touchline_core::camera::CameraBase;
use touchline_core::field::Curve;
use touchline_core::geometry::{ImagePoint, Vec2, Vec3};
use touchline_core::solve::{
    Observation, ObservedShape, SolveContext, Verdict, WarningCode, WorldCurve, judge, solve_frame,
};
use touchline_core::testing::TestBase;

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
    let fold = base.bent(-30.0);
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
            "one on a line",
            base,
            vec![Observation {
                shape: ObservedShape::Curve(WorldCurve::flat(Curve::Segment {
                    from: Vec3::new(-50.0, 30.0, 0.0),
                    to: Vec3::new(50.0, 30.0, 0.0),
                })),
                ..one
            }],
            "1 equation for 3 unknowns: a landmark gives two, a point on a line one; click a landmark",
        ),
        (
            "only a check",
            base,
            vec![one, two.hold_out()],
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

    let camera = known_base().aim(10.0, -14.0, 2500.0);
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
    let camera = known_base().aim(10.0, -14.0, 2500.0);
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
    clicks[2].image = clicks[2].image.translate(Vec2::new(70.0, 0.0));
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
    clicks[2] = clicks[2].hold_out();
    let solution = solve_frame(&known_base(), &clicks, &context).unwrap();
    assert!(is_truth(&solution.ptz, &camera.ptz()));
    assert!((solution.checks[0].error_px.unwrap() - 70.0).abs() < 1e-6);
    assert_eq!(solution.warnings[0].code, WarningCode::CheckFailed);
}
