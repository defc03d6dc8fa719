//! Solving one frame: two clicks, many clicks, lines.
#![allow(
    missing_docs,
    clippy::unwrap_used,
    reason = "a bench says what failed by failing"
)]

use divan::{Bencher, black_box};
use std::collections::BTreeMap;
use touchline::camera::{BaseAngles, BaseSigma, CameraBase, FocalCurve, Ptz, PtzCamera};
use touchline::field::builtin;
use touchline::geometry::{ImageSize, Vec3};
use touchline::progress::Progress;
use touchline::solve::base::{
    AdjustOptions, BaseModel, BaseOptions, CameraClicks, CrownModel, FrameClicks, LensModel,
    adjust_base, estimate_base,
};
use touchline::solve::{
    Observation, SolveContext, Uncertainty, check_identity, solve_frame, solve_two_points,
};

const SIZE: ImageSize = ImageSize::new(1920, 1080);

fn main() {
    divan::main();
}

fn camera(k1: f64) -> PtzCamera {
    let base = CameraBase {
        distortion: FocalCurve {
            at_focal_px: 2000.0,
            value: k1,
            per_1000_px: k1 * -3.0,
            ..FocalCurve::NONE
        },
        sigma: BaseSigma {
            position_m: Vec3::new(0.1, 0.2, 0.1),
            rotation: Vec3::new(1e-3, 1e-3, 0.0),
            ..BaseSigma::default()
        },
        ..CameraBase::new(
            Vec3::new(1.0, -62.0, 18.0),
            BaseAngles::default().base_from_world(),
            SIZE.centre(),
        )
    };
    PtzCamera::new(base, Ptz::from_degrees(28.0, -12.0, 2200.0))
}

/// Clicks on the first `count` landmarks that the frame shows, one px off.
fn clicks(camera: &PtzCamera, count: usize) -> Vec<Observation> {
    let field = builtin("soccer")
        .unwrap()
        .model(&BTreeMap::new(), 0.1)
        .unwrap();
    let names = [
        "penalty_mark_right",
        "corner_far_right",
        "penalty_area_near_right_front",
    ];
    let others = field
        .landmarks
        .iter()
        .map(|landmark| landmark.id.as_str())
        .filter(|name| !names.contains(name));
    names
        .into_iter()
        .chain(others)
        .filter_map(|name| {
            let exact = camera
                .image_from_world(field.landmark_in_world(field.landmark(name).unwrap()))
                .ok()?;
            let image = exact.translate(touchline::geometry::Vec2::new(0.6, -0.8));
            SIZE.contains(image)
                .then(|| Observation::from_landmark(&field, name, image, SIZE, 0).unwrap())
        })
        .take(count)
        .collect()
}

#[divan::bench(args = [0.0, -0.06])]
fn two_points_closed_form(bencher: Bencher, k1: f64) {
    let camera = camera(k1);
    let clicks = clicks(&camera, 2);
    let points: Vec<Vec3> = clicks
        .iter()
        .filter_map(|click| click.shape.point())
        .collect();
    bencher.bench_local(|| {
        solve_two_points(
            black_box(camera.base()),
            black_box([points[0], points[1]]),
            black_box([clicks[0].image, clicks[1].image]),
        )
        .unwrap()
    });
}

/// Closed form, refinement, covariance with an uncertain base, worst corner, warnings.
#[divan::bench(args = [0.0, -0.06])]
fn two_points_frame(bencher: Bencher, k1: f64) {
    let camera = camera(k1);
    let (clicks, context) = (clicks(&camera, 2), SolveContext::new(SIZE));
    bencher.bench_local(|| {
        solve_frame(black_box(camera.base()), black_box(&clicks), &context).unwrap()
    });
}

#[divan::bench(args = [4, 8, 12])]
fn many_points_frame(bencher: Bencher, count: usize) {
    let camera = camera(-0.06);
    let (clicks, context) = (clicks(&camera, count), SolveContext::new(SIZE));
    bencher.bench_local(|| {
        solve_frame(black_box(camera.base()), black_box(&clicks), &context).unwrap()
    });
}

#[divan::bench]
fn landmark_and_line_frame(bencher: Bencher) {
    let camera = camera(-0.06);
    let field = builtin("soccer")
        .unwrap()
        .model(&BTreeMap::new(), 0.1)
        .unwrap();
    let line = field.line("penalty_area_right_far").unwrap();
    let image = camera
        .image_from_world(field.world_from_nominal(line.curve.point_at(0.5)))
        .unwrap();
    let mut clicks = clicks(&camera, 1);
    clicks.push(Observation::from_line(&field, "penalty_area_right_far", image, SIZE, 1).unwrap());
    let context = SolveContext::new(SIZE);
    bencher.bench_local(|| {
        solve_frame(black_box(camera.base()), black_box(&clicks), &context).unwrap()
    });
}

/// A frame whose names contradict each other: two of them are swapped.
#[divan::bench(args = [4, 6, 12])]
fn identity_of_a_swap(bencher: Bencher, count: usize) {
    let camera = camera(-0.06);
    let field = builtin("soccer")
        .unwrap()
        .model(&BTreeMap::new(), 0.1)
        .unwrap();
    let mut clicks = clicks(&camera, count);
    let [one, two] = [clicks[1].element, clicks[2].element].map(Option::unwrap);
    (clicks[1], clicks[2]) = (
        clicks[1].with_element(&field, two).unwrap(),
        clicks[2].with_element(&field, one).unwrap(),
    );
    let context = SolveContext::new(SIZE);
    let solution = solve_frame(camera.base(), &clicks, &context).unwrap();
    bencher.bench_local(|| {
        check_identity(
            camera.base(),
            &field,
            black_box(&clicks),
            &solution,
            &context,
        )
        .unwrap()
    });
}

/// Position, base rotation, k₁(f), crown and every frame's pan, tilt, focal length; started 2 px
/// off.
#[divan::bench(args = [30, 500], sample_count = 10)]
fn adjust_frames_of_ten_clicks(bencher: Bencher, count: usize) {
    let field = builtin("soccer")
        .unwrap()
        .model(&BTreeMap::new(), 0.1)
        .unwrap();
    let base = *camera(-0.06).base();
    let (mut frames, mut ptz) = (Vec::new(), Vec::new());
    for index in 0..count {
        let share = index as f64 / count as f64;
        let pointed = Ptz::from_degrees(
            -30.0 + 60.0 * share,
            -12.0,
            1700.0 + 900.0 * ((7.0 * share) % 1.0),
        );
        let observations = clicks(&PtzCamera::new(base, pointed), 10);
        frames.push(FrameClicks {
            observations,
            start: None,
        });
        ptz.push(Some(Ptz {
            focal_px: pointed.focal_px * 1.002,
            ..pointed
        }));
    }
    let start = CameraBase {
        position_m: base.position_m + Vec3::new(0.3, -0.5, 0.2),
        ..base
    };
    let model = BaseModel {
        lens: LensModel::K1Focal,
        crown: CrownModel::Free,
        principal_point: None,
    };
    let options = AdjustOptions::default();
    bencher.bench_local(|| {
        adjust_base(
            &CameraClicks::with_centred_principal_point(&field, black_box(&frames), SIZE),
            &start,
            &ptz,
            &model,
            &options,
        )
    });
}

/// From clicks alone, six models compared: 77 frames of up to 16 clicks.
#[divan::bench(sample_count = 3)]
fn estimate_a_base_from_77_frames(bencher: Bencher) {
    let field = builtin("soccer")
        .unwrap()
        .model(&BTreeMap::new(), 0.1)
        .unwrap();
    let base = *camera(-0.06).base();
    let frames: Vec<FrameClicks> = (0..77)
        .map(|index| {
            let share = f64::from(index) / 77.0;
            let pointed = Ptz::from_degrees(
                -30.0 + 60.0 * share,
                -12.0,
                1700.0 + 900.0 * ((7.0 * share) % 1.0),
            );
            FrameClicks {
                observations: clicks(&PtzCamera::new(base, pointed), 16),
                start: None,
            }
        })
        .collect();
    let options = BaseOptions::default();
    bencher.bench_local(|| {
        estimate_base(
            &CameraClicks::with_centred_principal_point(&field, black_box(&frames), SIZE),
            None,
            &options,
            &Progress::default(),
        )
        .unwrap()
    });
}

/// 1-σ of the overlay on a grid of 60 × 40 pixels.
#[divan::bench]
fn overlay_sigma_grid(bencher: Bencher) {
    let camera = camera(-0.06);
    let uncertainty: Uncertainty =
        solve_frame(camera.base(), &clicks(&camera, 3), &SolveContext::new(SIZE))
            .unwrap()
            .uncertainty;
    bencher.bench_local(|| {
        let mut sum = 0.0;
        for column in 0..60 {
            for row in 0..40 {
                let pixel = touchline::geometry::ImagePoint::new(
                    f64::from(column) * 32.0 + 16.0,
                    f64::from(row) * 27.0 + 13.5,
                );
                sum += uncertainty
                    .overlay_sigma_px(black_box(&camera), pixel)
                    .unwrap_or(0.0);
            }
        }
        sum
    });
}
