//! What a base out of given cameras states of itself, against errors that all of these share.

use crate::base_truth::field;
use rand::RngExt;
use rand_pcg::Pcg64Mcg;
use touchline_core::camera::{BaseAngles, CameraBase, Ptz, PtzCamera};
use touchline_core::field::FieldModel;
use touchline_core::geometry::{Angle, ImagePoint, Vec2, Vec3};
use touchline_core::solve::base::shared_places;
use touchline_core::solve::{Observation, SolveContext, solve_frame};
use touchline_core::testing::seeded::{self, normal};
use touchline_core::testing::{SIZE, ground_landmarks};

const TRUE_M: Vec3 = Vec3::new(1.5, -66.0, 18.0);

fn levelled(position_m: Vec3, roll: Angle) -> CameraBase {
    let angles = BaseAngles {
        roll,
        ..BaseAngles::default()
    };
    CameraBase::new(position_m, angles.base_from_world(), SIZE.centre())
}

/// The base out of a hundred cameras that all err by half a metre and 0.15°, and scatter besides.
fn base_of_given(rng: &mut Pcg64Mcg) -> CameraBase {
    let common_m = Vec3::new(0.4, 0.6, 0.25).map(|sigma_m| sigma_m * normal(rng));
    let lean = Angle::from_degrees(0.15 * normal(rng));
    let given = |index: usize| {
        let scatter_m = Vec3::new(0.3, 0.35, 0.25).map(|sigma_m| sigma_m * normal(rng));
        let base = levelled(TRUE_M + common_m + scatter_m, lean);
        let ptz = Ptz::from_degrees(0.6 * index as f64 - 30.0, -11.0, 2600.0);
        PtzCamera::new(base, ptz)
    };
    let given: Vec<PtzCamera> = (0..100).map(given).collect();
    shared_places(&given).remove(0).base
}

/// How far the overlay of a camera is off at the picture's corners, px: what it draws where the
/// truth has its corners' ground.
fn worst_corner_px(truth: &PtzCamera, found: &PtzCamera) -> f64 {
    let off_px = |corner: ImagePoint| {
        let shown = found.plane_from_image(corner, 0.0)?;
        Some(truth.image_from_world(shown).ok()?.distance_px(corner))
    };
    SIZE.corners()
        .into_iter()
        .filter_map(off_px)
        .fold(0.0, f64::max)
}

/// A frame of the true camera, solved from two clicks on another base: how far off its worst corner
/// is, in the stated σ. None if it shows too little.
fn corner_off_sigmas(field: &FieldModel, base: &CameraBase, rng: &mut Pcg64Mcg) -> Option<f64> {
    let ptz = Ptz::from_degrees(
        rng.random_range(-25.0..25.0),
        -11.0,
        rng.random_range(2200.0..3200.0),
    );
    let truth = PtzCamera::new(levelled(TRUE_M, Angle::default()), ptz);
    let mut seen: Vec<(&str, ImagePoint)> = ground_landmarks(field, &truth)
        .filter(|(_, _, at)| SIZE.contains(*at))
        .map(|(_, landmark, at)| (landmark.id.as_str(), at))
        .collect();
    let mut clicks = Vec::new();
    while clicks.len() < 2 && !seen.is_empty() {
        let (id, exact) = seen.swap_remove(rng.random_range(0..seen.len()));
        let at = exact.translate(Vec2::new(normal(rng), normal(rng)));
        let click = Observation::from_landmark(field, id, at, SIZE, clicks.len()).unwrap();
        clicks.push(Observation {
            sigma_px: 1.0,
            ..click
        });
    }
    let solved = solve_frame(base, &clicks, &SolveContext::new(SIZE)).ok()?;
    let off_px = worst_corner_px(&truth, &PtzCamera::new(*base, solved.ptz));
    Some(off_px / solved.worst_corner_sigma_px)
}

/// Two clicks, exact to a pixel, in frames of such a base: their overlay is as far off as it says.
#[test]
fn frames_on_a_base_out_of_given_cameras_are_as_far_off_as_they_say() {
    let mut rng = seeded::rng("given_cameras");
    let field = field(0.0);
    let mut sigmas = Vec::new();
    for _ in 0..16 {
        let base = base_of_given(&mut rng);
        let sigma = &base.sigma;
        let is_stated = sigma.position_m.min() >= 0.5 && sigma.rotation.xy().min() > 0.0;
        assert!(is_stated, "{sigma:?}");
        sigmas.extend((0..20).filter_map(|_| corner_off_sigmas(&field, &base, &mut rng)));
    }
    let share = |limit: f64| {
        let beyond = sigmas.iter().filter(|sigmas| **sigmas > limit).count();
        beyond as f64 / sigmas.len() as f64
    };
    println!("beyond 1, 2 σ: {:.2}, {:.2}", share(1.0), share(2.0));
    assert!(sigmas.len() > 250 && share(2.0) < 0.05, "{}", share(2.0));
}
