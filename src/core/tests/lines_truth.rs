//! Two drawn lines, or a line and a landmark, with a known base: the camera that saw them.

use crate::base_truth::field;
use crate::two_point_truth::{SIZE, error, noisy};
use nalgebra::Vector3;
use rand::RngExt;
use rand_pcg::Pcg64Mcg;
use touchline_core::camera::{BaseAngles, CameraBase, FocalCurve, Ptz, PtzCamera};
use touchline_core::field::FieldModel;
use touchline_core::geometry::{Angle, ImagePoint, Vec3};
use touchline_core::solve::{Observation, SolveContext, solve_frame};
use touchline_core::testing::seeded;

const SIGMA_PX: f64 = 2.0;

/// Points that a person draws on each line.
const POINTS: usize = 3;

/// Cameras drawn for each case, and times that noise is drawn for each.
const FRAMES: usize = 60;
const DRAWS: usize = 10;

/// A camera anywhere around the field, looking at a point of it.
fn random_camera(rng: &mut Pcg64Mcg) -> PtzCamera {
    let around = Angle::from_degrees(rng.random_range(0.0..360.0));
    let away = rng.random_range(1.2..2.2);
    let position = Vec3::new(
        away * 55.0 * around.radians().cos(),
        away * 40.0 * around.radians().sin(),
        rng.random_range(6.0..35.0),
    );
    let heading = Angle::from_radians((-position.x).atan2(-position.y));
    let angles = BaseAngles {
        heading,
        pitch: Angle::ZERO,
        roll: Angle::from_degrees(rng.random_range(-1.0..1.0)),
    };
    let mut base = CameraBase::new(position, angles.base_from_world(), SIZE.centre());
    if rng.random_bool(0.5) {
        base.distortion = FocalCurve {
            at_focal_px: 2000.0,
            value: rng.random_range(-0.08..0.05),
            per_1000_px: rng.random_range(0.0..0.1),
            ..FocalCurve::NONE
        };
    }
    let target = Vec3::new(
        rng.random_range(-52.0..52.0),
        rng.random_range(-34.0..34.0),
        0.0,
    );
    let ray = base.base_from_world_point(target);
    let ptz = Ptz {
        pan: Angle::from_radians(ray.x.atan2(ray.z)),
        tilt: Angle::from_radians((-ray.y).atan2(ray.x.hypot(ray.z))),
        focal_px: rng.random_range(1200.0f64.ln()..5000.0f64.ln()).exp(),
    };
    PtzCamera::new(base, ptz)
}

/// Evenly spread points of what a camera sees of a line; none if less than 250 px of it.
fn drawn_line(field: &FieldModel, camera: &PtzCamera, name: &str) -> Option<Vec<Observation>> {
    let line = field.line(name).unwrap();
    let seen: Vec<ImagePoint> = (0..=200)
        .filter_map(|step| {
            let at = field.world_from_nominal(line.curve.point_at(f64::from(step) / 200.0));
            camera
                .image_from_world(at)
                .ok()
                .filter(|image| SIZE.contains(*image))
        })
        .collect();
    let long = seen.first()?.distance_px(*seen.last()?) > 250.0;
    let click = |step: usize| {
        let image = seen[step * (seen.len() - 1) / (POINTS - 1)];
        let observation = Observation::from_line(field, name, image, SIZE, 0).unwrap();
        Observation {
            sigma_px: SIGMA_PX,
            ..observation
        }
    };
    long.then(|| (0..POINTS).map(click).collect())
}

/// Three points on each of two lines, or on one line with one landmark; none where the camera sees
/// too few.
fn random_clicks(
    field: &FieldModel,
    camera: &PtzCamera,
    with_landmark: bool,
    rng: &mut Pcg64Mcg,
) -> Option<Vec<Observation>> {
    let names = field.lines.iter().map(|line| line.id.as_str());
    let mut lines: Vec<Vec<Observation>> = names
        .filter_map(|name| drawn_line(field, camera, name))
        .collect();
    let seen = |name: &str| {
        let at = field.landmark_in_world(field.landmark(name)?);
        let image = camera.image_from_world(at).ok()?;
        let click = Observation::from_landmark(field, name, image, SIZE, 0).ok()?;
        SIZE.contains(image).then_some(vec![click])
    };
    let names = field.landmarks.iter().map(|landmark| landmark.id.as_str());
    let mut others: Vec<Vec<Observation>> = names.filter_map(seen).collect();
    if lines.is_empty() {
        return None;
    }
    let line = lines.swap_remove(rng.random_range(0..lines.len()));
    let others = if with_landmark {
        &mut others
    } else {
        &mut lines
    };
    if others.is_empty() {
        return None;
    }
    let other = others.swap_remove(rng.random_range(0..others.len()));
    let numbered = |(click, observation): (usize, Observation)| Observation {
        click,
        sigma_px: SIGMA_PX,
        ..observation
    };
    let clicks = [line, other].concat().into_iter();
    Some(clicks.enumerate().map(numbered).collect())
}

/// A random camera and a drawing that determines it to a tenth of its focal length and 2° of pan,
/// with the variances of pan, tilt and focal length at the truth.
fn determined_drawing(
    field: &FieldModel,
    with_landmark: bool,
    rng: &mut Pcg64Mcg,
) -> (PtzCamera, Vec<Observation>, Vector3<f64>) {
    loop {
        let camera = random_camera(rng);
        let Some(clicks) = random_clicks(field, &camera, with_landmark, rng) else {
            continue;
        };
        let at_truth = SolveContext {
            start: Some(camera.ptz()),
            ..SolveContext::new(SIZE)
        };
        if let Ok(solution) = solve_frame(camera.base(), &clicks, &at_truth) {
            let variances = solution.covariance.diagonal();
            if variances.z.sqrt() < 0.1 * camera.ptz().focal_px && variances.x.sqrt() < 2.0 {
                return (camera, clicks, variances);
            }
        }
    }
}

fn assert_found_and_efficient(with_landmark: bool, rng: &mut Pcg64Mcg) {
    let field = field(0.1);
    let context = SolveContext::new(SIZE);
    let mut squared_sigmas = Vec::new();
    for frame in 0..FRAMES {
        let (camera, clicks, variances) = determined_drawing(&field, with_landmark, rng);
        let exact = solve_frame(camera.base(), &clicks, &context).unwrap().ptz;
        let off = error(&exact, &camera.ptz());
        assert!(
            off.x.abs() < 1e-5 && off.y.abs() < 1e-5 && off.z.abs() < 1e-2,
            "frame {frame}: {exact:?} for {camera:?}, {clicks:?}"
        );
        for _ in 0..DRAWS {
            let found = solve_frame(camera.base(), &noisy(&clicks, rng), &context).unwrap();
            let off = error(&found.ptz, &camera.ptz());
            squared_sigmas.push(off.component_mul(&off).component_div(&variances));
        }
    }
    let worst = squared_sigmas.iter().map(Vector3::max).fold(0.0, f64::max);
    assert!(worst < 49.0, "{:.1} σ off", worst.sqrt());
    let mean = squared_sigmas.iter().sum::<Vector3<f64>>() / squared_sigmas.len() as f64;
    let efficiency = mean.map(f64::recip);
    assert!(efficiency.min() > 0.9, "{efficiency:?}");
}

/// From anywhere around the field, two lines (arcs among them) determine the camera as well as
/// their points allow, and no other camera is taken for it.
#[test]
fn two_drawn_lines_find_the_camera_to_the_bound() {
    let mut rng = seeded::rng("two_drawn_lines_find_the_camera_to_the_bound");
    assert_found_and_efficient(false, &mut rng);
}

#[test]
fn a_line_and_a_landmark_find_the_camera_to_the_bound() {
    let mut rng = seeded::rng("a_line_and_a_landmark_find_the_camera_to_the_bound");
    assert_found_and_efficient(true, &mut rng);
}
