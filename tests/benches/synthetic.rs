//! The drawn match: building a stadium and drawing a frame of it.
#![allow(
    clippy::unwrap_used,
    missing_docs,
    reason = "a bench fails by stopping"
)]

use touchline::camera::PtzCamera;
use touchline::field::builtin;
use touchline::geometry::ImageSize;
use touchline::synthetic::{Preset, StadiumOptions, camera_path, stadium};

fn main() {
    divan::main();
}

fn options() -> StadiumOptions {
    StadiumOptions::new(builtin("soccer").unwrap().default_model().unwrap(), 5)
}

#[divan::bench]
fn build_a_stadium(bencher: divan::Bencher) {
    let options = options();
    bencher.bench(|| stadium(&options));
}

#[divan::bench(args = ["easy", "paper", "hard"], sample_count = 12)]
fn draw_a_frame_1280x720(bencher: divan::Bencher, preset: &str) {
    let scene = stadium(&options());
    let size = ImageSize::new(1280, 720);
    let shoot = preset.parse::<Preset>().unwrap().shoot();
    let base = shoot.main_camera(size);
    let path = camera_path(&scene, &base, size, &shoot, 12);
    let mut frame = 0;
    bencher.bench_local(|| {
        frame = (frame + 1) % path.len();
        let step = &path[frame];
        scene.render(
            &PtzCamera::new(base, step.ptz),
            size,
            &shoot.frame(frame, step, size, 5),
        )
    });
}
