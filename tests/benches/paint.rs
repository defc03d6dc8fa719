//! Painted lines of a drawn 1080p picture: made ready, checked, snapped, on one thread.
#![allow(
    clippy::unwrap_used,
    missing_docs,
    reason = "a bench fails by stopping"
)]

use divan::{Bencher, black_box};
use std::sync::LazyLock;
use touchline::camera::{Ptz, PtzCamera};
use touchline::field::{FieldModel, builtin};
use touchline::geometry::{Angle, ImageSize};
use touchline::media::Picture;
use touchline::paint::{GroundPicture, SnapOptions, check_lines, snap};
use touchline::synthetic::{Preset, StadiumOptions, camera_path, stadium};

const SIZE: ImageSize = ImageSize::new(1920, 1080);

fn main() {
    divan::main();
}

fn field() -> FieldModel {
    builtin("soccer").unwrap().default_model().unwrap()
}

/// A frame of a drawn match and its camera.
static FRAME: LazyLock<(Picture, PtzCamera)> = LazyLock::new(|| {
    let scene = stadium(&StadiumOptions::new(field(), 5));
    let shoot = "paper".parse::<Preset>().unwrap().shoot();
    let base = shoot.main_camera(SIZE);
    let step = &camera_path(&scene, &base, SIZE, &shoot, 1)[0];
    let camera = PtzCamera::new(base, step.ptz);
    let drawn = scene
        .render(&camera, SIZE, &shoot.frame(0, step, SIZE, 5))
        .image;
    let rgba = drawn
        .pixels()
        .flat_map(|pixel| [pixel[0], pixel[1], pixel[2], 255])
        .collect();
    (Picture::new(SIZE, rgba).unwrap(), camera)
});

#[divan::bench]
fn make_a_picture_ready(bencher: Bencher) {
    let (picture, _) = &*FRAME;
    bencher.bench(|| GroundPicture::new(black_box(picture), &[]));
}

#[divan::bench]
fn check_a_camera(bencher: Bencher) {
    let (picture, camera) = &*FRAME;
    let (ground, field) = (GroundPicture::new(picture, &[]), field());
    bencher.bench(|| check_lines(&ground, &field, black_box(camera)));
}

/// From 30 px off, the picture made ready in it.
#[divan::bench]
fn snap_a_frame(bencher: Bencher) {
    let (picture, camera) = &*FRAME;
    let field = field();
    let ptz = camera.ptz();
    let start = Ptz {
        pan: ptz.pan + Angle::from_radians(30.0 / ptz.focal_px),
        ..ptz
    };
    bencher.bench(|| {
        let ground = GroundPicture::new(picture, &[]);
        snap(
            &ground,
            &field,
            camera.base(),
            black_box(start),
            &[],
            &SnapOptions::default(),
        )
        .unwrap()
    });
}
