//! The overlay's polylines: every marking of a field, projected and clipped.
#![allow(
    missing_docs,
    clippy::unwrap_used,
    reason = "a bench says what failed by failing"
)]

use divan::Bencher;
use std::collections::BTreeMap;
use touchline::camera::{BaseAngles, CameraBase, FocalCurve, Ptz, PtzCamera};
use touchline::field::builtin;
use touchline::geometry::{ImageSize, Vec3};
use touchline::markings::{MarkingOptions, project_landmarks, project_lines};

const SIZE: ImageSize = ImageSize::new(1920, 1080);

fn main() {
    divan::main();
}

/// (view, pan °, tilt °, focal px, k₁, crown m)
const VIEWS: [(&str, f64, f64, f64, f64, f64); 5] = [
    ("whole_field", 0.0, -14.0, 900.0, 0.0, 0.0),
    ("whole_field_barrel_crown", 0.0, -14.0, 900.0, -0.1, 0.15),
    ("middle", 0.0, -13.0, 2400.0, -0.05, 0.15),
    ("penalty_area", 33.0, -10.0, 3500.0, 0.2, 0.15),
    ("tight", 33.0, -10.0, 8000.0, 0.0, 0.0),
];

fn view(name: &str) -> (PtzCamera, f64) {
    let (_, pan, tilt, focal, k1, crown_m) = VIEWS.into_iter().find(|view| view.0 == name).unwrap();
    let level = BaseAngles::default().base_from_world();
    let base = CameraBase {
        distortion: FocalCurve::constant(k1),
        ..CameraBase::new(Vec3::new(0.0, -60.0, 18.0), level, SIZE.centre())
    };
    (
        PtzCamera::new(base, Ptz::from_degrees(pan, tilt, focal)),
        crown_m,
    )
}

#[divan::bench(args = VIEWS.map(|view| view.0))]
fn soccer_lines(bencher: Bencher, name: &str) {
    let (camera, crown_m) = view(name);
    let field = builtin("soccer")
        .unwrap()
        .model(&BTreeMap::new(), crown_m)
        .unwrap();
    let options = MarkingOptions::default();
    bencher.bench(|| {
        project_lines(
            divan::black_box(&field),
            divan::black_box(&camera),
            SIZE,
            &options,
        )
    });
}

#[divan::bench]
fn soccer_landmarks(bencher: Bencher) {
    let (camera, crown_m) = view("whole_field");
    let field = builtin("soccer")
        .unwrap()
        .model(&BTreeMap::new(), crown_m)
        .unwrap();
    bencher.bench(|| {
        project_landmarks(
            divan::black_box(&field),
            divan::black_box(&camera),
            SIZE,
            16.0,
        )
    });
}

#[divan::bench]
fn soccer_model(bencher: Bencher) {
    let soccer = builtin("soccer").unwrap();
    bencher.bench(|| soccer.model(divan::black_box(&BTreeMap::new()), 0.1));
}
