//! Cameras from lines that were drawn exactly, and from lines that give none.

use super::*;
use crate::field::{Curve, Symmetry, builtin};
use crate::geometry::{Angle, ImagePoint, Vec2, Vec3};
use crate::markings::{MarkingOptions, project_lines};
use crate::solve::observations::drawn_line::DrawnLine;
use crate::solve::{IdentityKind, ObservedShape};
use crate::testing::{TestBase, turned_base};

const SIZE: ImageSize = ImageSize::new(960, 540);

fn soccer() -> FieldModel {
    let template = builtin("soccer").unwrap();
    template
        .model(&std::collections::BTreeMap::new(), 0.0)
        .unwrap()
}

/// A camera at a position that looks at a point of the ground.
fn looking_at(position_m: [f64; 3], at_m: [f64; 2], focal_px: f64) -> PtzCamera {
    let position_m = Vec3::from(position_m);
    let along = Vec3::new(at_m[0], at_m[1], 0.0) - position_m;
    let ptz = Ptz {
        pan: Angle::from_radians(along.x.atan2(along.y)),
        tilt: Angle::from_radians(along.z.atan2(along.xy().norm())),
        focal_px,
    };
    PtzCamera::new(
        turned_base(position_m, [0.0, 0.0, 0.3], SIZE).bent(0.1),
        ptz,
    )
}

/// What an exact annotator draws: the ends of every straight line that the picture shows for some
/// length, and points along every round one.
fn exact_lines(field: &FieldModel, camera: &PtzCamera) -> Vec<Observation> {
    const SHORTEST_PX: f64 = 25.0;
    let options = MarkingOptions {
        margin_px: 0.0,
        ..MarkingOptions::default()
    };
    let mut drawn: Vec<Observation> = Vec::new();
    for part in project_lines(field, camera, SIZE, &options) {
        let (first, last) = (part.points[0], part.points[part.points.len() - 1]);
        let line = &field.lines[part.line];
        let is_round = matches!(line.curve, Curve::Arc { .. });
        if !is_round && first.distance_px(last) < SHORTEST_PX || line.curve.length_m() < 2.0 {
            continue;
        }
        let points = if is_round {
            crate::geometry::subsample(part.points.clone(), 9).collect()
        } else {
            vec![first, last]
        };
        for point in points {
            let click = drawn.len();
            let on_line = Observation::from_line(field, line.id.as_str(), point, SIZE, click);
            drawn.push(on_line.unwrap());
        }
    }
    drawn
}

fn solve(
    field: &FieldModel,
    observations: &[Observation],
) -> Result<CameraFromLines, FromLinesError> {
    let picture = LinePicture {
        field,
        observations,
        image_size: SIZE,
        lens: StatedLens::default(),
    };
    camera_from_lines(&picture, &FromLinesOptions::default())
}

/// The largest distance of the field's landmarks from where the true camera shows them in the
/// picture, px.
fn overlay_error_px(field: &FieldModel, truth: &PtzCamera, found: &PtzCamera) -> f64 {
    let distance_px = |landmark| {
        let at = field.landmark_in_world(landmark);
        let shown = truth
            .image_from_world(at)
            .ok()
            .filter(|pixel| SIZE.contains(*pixel))?;
        let found = found.image_from_world(at).ok();
        Some(found.map_or(f64::INFINITY, |found| found.distance_px(shown)))
    };
    let distances = field.landmarks.iter().filter_map(distance_px);
    distances.fold(0.0, f64::max)
}

/// The largest such distance all over the ground that the picture shows, in stated sigmas.
fn overlay_sigmas(truth: &PtzCamera, found: &CameraFromLines) -> f64 {
    let sigmas = |pixel: ImagePoint| {
        let ground = truth.plane_from_image(pixel, 0.0)?;
        let camera = found.camera();
        let off_px = camera.image_from_world(ground).ok()?.distance_px(pixel);
        Some(off_px / found.uncertainty.overlay_sigma_px(&camera, pixel)?)
    };
    SIZE.cell_centres(8, 6)
        .filter_map(sigmas)
        .fold(0.0, f64::max)
}

/// The distance of the positions in sigmas of the stated covariance.
fn position_sigmas(truth: &PtzCamera, found: &CameraFromLines) -> f64 {
    let off_m = found.base.position_m - truth.base().position_m;
    let covariance = found.base.sigma.covariance();
    let of_position = covariance.fixed_view::<3, 3>(0, 0).into_owned();
    (off_m.dot(&(of_position.try_inverse().unwrap() * off_m))).sqrt()
}

#[test]
fn cameras_all_around_the_field_come_back_from_their_lines() {
    let field = soccer();
    for (what, position_m, at_m, focal_px) in [
        ("main camera", [2.0, -66.0, 16.0], [-36.0, 5.0], 2200.0),
        (
            "main camera, middle",
            [0.0, -75.0, 20.0],
            [4.0, 0.0],
            1500.0,
        ),
        ("high and far", [5.0, -110.0, 45.0], [30.0, 5.0], 2500.0),
        ("other side", [-4.0, 64.0, 14.0], [38.0, -2.0], 2000.0),
        ("behind the goal", [-95.0, 3.0, 14.0], [-40.0, 0.0], 1100.0),
        ("corner", [66.0, -47.0, 12.0], [40.0, -8.0], 900.0),
        ("penalty area, low", [48.0, -46.0, 5.0], [42.0, 0.0], 1200.0),
    ] {
        let truth = looking_at(position_m, at_m, focal_px);
        let found = solve(&field, &exact_lines(&field, &truth)).unwrap();
        let error_px = overlay_error_px(&field, &truth, &found.camera());
        assert!(error_px < 1.5, "{what}: {error_px} px, {found:?}");
        let sigmas = [
            overlay_sigmas(&truth, &found),
            position_sigmas(&truth, &found),
        ];
        assert!(
            sigmas.iter().all(|sigmas| *sigmas < 3.0),
            "{what}: {sigmas:?}"
        );
        assert_eq!(found.identity, None, "{what}");
    }
}

#[test]
fn a_narrow_view_leaves_the_distance_open_and_says_so() {
    let field = soccer();
    let wide = looking_at([0.0, -66.0, 16.0], [36.0, 8.0], 1800.0);
    let narrow = looking_at([0.0, -66.0, 16.0], [41.0, 16.0], 9000.0);
    let [wide, narrow] = [wide, narrow].map(|truth| {
        let found = solve(&field, &exact_lines(&field, &truth)).unwrap();
        assert!(position_sigmas(&truth, &found) < 3.0, "{found:?}");
        found.base.sigma.position_m.norm()
    });
    assert!(narrow > 4.0 * wide, "{wide} m, {narrow} m");
}

#[test]
fn the_circle_and_the_halfway_line_give_a_camera() {
    let field = soccer();
    let truth = looking_at([3.0, -68.0, 17.0], [1.0, 1.0], 2000.0);
    let mut drawn = exact_lines(&field, &truth);
    drawn.retain(|observation| {
        let name = observation.element.and_then(|element| element.name(&field));
        matches!(name, Some("centre_circle" | "halfway_line"))
    });
    assert!(
        crate::solve::observations::crossings::find_crossings(&DrawnLine::group(&drawn), &drawn)
            .is_empty()
    );
    let found = solve(&field, &drawn).unwrap();
    assert!(
        overlay_error_px(&field, &truth, &found.camera()) < 1.5,
        "{found:?}"
    );
    assert!(overlay_sigmas(&truth, &found) < 3.0, "{found:?}");
    assert!(position_sigmas(&truth, &found) < 3.0, "{found:?}");
}

#[test]
fn a_line_with_the_name_of_another_one_is_named() {
    let field = soccer();
    let truth = looking_at([2.0, -66.0, 16.0], [-36.0, 5.0], 2000.0);
    let drawn = exact_lines(&field, &truth);
    let other_end = |observation: &Observation| {
        let name = observation.element.and_then(|element| element.name(&field));
        if name == Some("penalty_arc_left") {
            let element = field.line_element("penalty_arc_right").unwrap();
            return observation.with_element(&field, element).unwrap();
        }
        *observation
    };
    let wrong: Vec<Observation> = drawn.iter().map(other_end).collect();
    let found = solve(&field, &wrong).unwrap();
    assert!(
        overlay_error_px(&field, &truth, &found.camera()) < 1.5,
        "{found:?}"
    );
    let identity = found.identity.unwrap();
    assert_eq!(identity.kind, IdentityKind::WrongName);
    assert!(!identity.renames.is_empty());
    for rename in &identity.renames {
        assert_eq!(rename.name.as_str(), "penalty_arc_left");
    }
}

#[test]
fn left_and_right_exchanged_are_named_as_mirrored() {
    let field = soccer();
    let truth = looking_at([2.0, -66.0, 16.0], [-36.0, 5.0], 2000.0);
    let drawn = exact_lines(&field, &truth);
    let mirrored = names::mirror(&field, &drawn, Symmetry::MirrorX).unwrap();
    let found = solve(&field, &mirrored).unwrap();
    assert!(
        overlay_error_px(&field, &truth, &found.camera()) < 1.5,
        "{found:?}"
    );
    let identity = found.identity.unwrap();
    assert_eq!(identity.kind, IdentityKind::Mirrored(Symmetry::MirrorX));
    let exchanged = drawn
        .iter()
        .zip(&mirrored)
        .filter(|(one, other)| one.element != other.element);
    assert_eq!(identity.renames.len(), exchanged.count());
}

#[test]
fn a_circle_and_one_landmark_give_a_camera() {
    let field = soccer();
    let truth = looking_at([3.0, -68.0, 17.0], [1.0, 1.0], 2000.0);
    let mut drawn = exact_lines(&field, &truth);
    drawn.retain(|observation| observation.element == field.line_element("centre_circle"));
    let image = truth.image_from_world(Vec3::zeros()).unwrap();
    let mark = Observation::from_landmark(&field, "centre_mark", image, SIZE, drawn.len());
    drawn.push(mark.unwrap());
    let found = solve(&field, &drawn).unwrap();
    let off_px = found.camera().image_from_world(Vec3::zeros()).unwrap();
    assert!(off_px.distance_px(image) < 1.0, "{found:?}");
    for click in &drawn {
        assert!(
            click.distance_px(&found.camera()).unwrap() < 1.0,
            "{found:?}"
        );
    }
}

/// Observations at pixels of named lines.
fn on_lines(field: &FieldModel, points: &[(&str, [f64; 2])]) -> Vec<Observation> {
    let observation = |(click, (name, at)): (usize, &(&str, [f64; 2]))| {
        Observation::from_line(field, name, ImagePoint::from(*at), SIZE, click).unwrap()
    };
    points.iter().enumerate().map(observation).collect()
}

#[test]
fn too_little_is_named_in_one_line() {
    let field = soccer();
    let three = on_lines(
        &field,
        &[
            ("touchline_far", [10.0, 100.0]),
            ("touchline_far", [900.0, 120.0]),
            ("goal_line_left", [10.0, 300.0]),
            ("goal_line_left", [400.0, 110.0]),
            ("penalty_area_left_front", [300.0, 400.0]),
            ("penalty_area_left_front", [700.0, 200.0]),
        ],
    );
    let error = solve(&field, &three).unwrap_err();
    assert!(
        error
            .to_string()
            .starts_with("6 equations from 3 lines, 7 are needed: draw more lines"),
        "{error}"
    );
    let error = solve(&field, &three[..1]).unwrap_err();
    assert!(
        error
            .to_string()
            .starts_with("1 equation from 1 line, 7 are needed: draw more lines"),
        "{error}"
    );
    // Points that coincide count once, and each point of a circle one.
    let mut circle = vec![("centre_circle", [500.0, 200.0]); 3];
    let equations = |points: &[(&str, [f64; 2])]| match solve(&field, &on_lines(&field, points)) {
        Err(FromLinesError::TooFewLines { equations, .. }) => Some(equations),
        _ => None,
    };
    assert_eq!(equations(&circle), Some(1));
    circle[1].1 = [420.0, 230.0];
    circle[2].1 = [530.0, 260.0];
    assert_eq!(equations(&circle), Some(3));
    circle.extend([("halfway_line", [480.0, 100.0]); 2]);
    assert_eq!(equations(&circle), Some(4));
    let parallel: Vec<(&str, [f64; 2])> = [
        ("touchline_far", 100.0),
        ("touchline_near", 500.0),
        ("penalty_area_left_near", 400.0),
        ("goal_area_left_far", 200.0),
    ]
    .into_iter()
    .flat_map(|(name, y)| [(name, [50.0, y]), (name, [900.0, y + 10.0])])
    .collect();
    assert_eq!(
        solve(&field, &on_lines(&field, &parallel)).unwrap_err(),
        FromLinesError::Parallel { lines: 4 }
    );
    assert!(matches!(
        solve(&field, &[]),
        Err(FromLinesError::TooFewLines { equations: 0, .. })
    ));
}

#[test]
fn a_point_that_is_no_number_is_named() {
    let field = soccer();
    let truth = looking_at([2.0, -66.0, 16.0], [-36.0, 5.0], 2000.0);
    let good = exact_lines(&field, &truth);
    let spoilt = |spoil: &dyn Fn(&mut Observation)| {
        let mut drawn = good.clone();
        spoil(&mut drawn[5]);
        solve(&field, &drawn)
    };
    let not_finite = Err(FromLinesError::NotFinite { click: 5 });
    assert_eq!(spoilt(&|click| click.image.x = f64::NAN), not_finite);
    assert_eq!(spoilt(&|click| click.sigma_px = 0.0), not_finite);
    let nowhere = ObservedShape::Point(Vec3::new(f64::INFINITY, 0.0, 0.0));
    assert_eq!(spoilt(&|click| click.shape = nowhere), not_finite);
}

#[test]
fn lines_of_no_field_are_refused() {
    use rand::{RngExt, SeedableRng};
    let field = soccer();
    let truth = looking_at([2.0, -66.0, 16.0], [-36.0, 5.0], 2000.0);
    let mut random = rand_pcg::Pcg64Mcg::seed_from_u64(5);
    let mut scattered = exact_lines(&field, &truth);
    for observation in &mut scattered {
        let [x, y] = [SIZE.width, SIZE.height].map(|side| random.random::<f64>() * f64::from(side));
        observation.image = ImagePoint::new(x, y);
    }
    assert!(matches!(
        solve(&field, &scattered),
        Err(FromLinesError::NoFit { .. })
    ));
}

#[test]
fn landmarks_count_among_the_lines() {
    let field = soccer();
    let truth = looking_at([2.0, -66.0, 16.0], [-36.0, 5.0], 2000.0);
    let names = [
        "penalty_mark_left",
        "penalty_area_far_left_front",
        "goal_area_far_left_front",
        "corner_far_left",
    ];
    let landmark = |(click, name): (usize, &str)| {
        let at = field.landmark_in_world(field.landmark(name).unwrap());
        let image = truth
            .image_from_world(at)
            .unwrap()
            .translate(Vec2::new(0.2, -0.1));
        Observation::from_landmark(&field, name, image, SIZE, click).unwrap()
    };
    let clicked: Vec<Observation> = names.into_iter().enumerate().map(landmark).collect();
    let found = solve(&field, &clicked).unwrap();
    assert!(
        overlay_error_px(&field, &truth, &found.camera()) < 10.0,
        "{found:?}"
    );
    assert!(position_sigmas(&truth, &found) < 3.0, "{found:?}");
}
