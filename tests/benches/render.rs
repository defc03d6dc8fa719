//! A 1080p picture with the overlay of a soccer field, off-screen.
#![allow(missing_docs, clippy::unwrap_used, reason = "a bench says what failed by failing")]

use divan::Bencher;
use std::collections::BTreeMap;
use std::sync::Arc;
use touchline::app::OverlayStyle;
use touchline::app::drawing::{Colour, Drawing};
use touchline::app::overlay::{OverlayScene, Standing, overlay};
use touchline::camera::{BaseAngles, CameraBase, Ptz, PtzCamera};
use touchline::field::builtin;
use touchline::geometry::{ImageSize, Vec3};
use touchline::media;
use touchline::render::{Layer, Offscreen, Picture, PictureKey, View};

const SIZE: ImageSize = ImageSize::new(1920, 1080);
const BLACK: Colour = Colour::rgb(0, 0, 0);

fn main() {
    if let Ok(offscreen) = Offscreen::new() {
        eprintln!("adapter: {}", offscreen.adapter());
    }
    divan::main();
}

fn drawing() -> Drawing {
    let field = builtin("soccer").unwrap().model(&BTreeMap::new(), 0.15).unwrap();
    let base = CameraBase::new(Vec3::new(0.0, -60.0, 18.0), BaseAngles::default().base_from_world(), SIZE.centre());
    let camera = PtzCamera::new(base, Ptz::from_degrees(0.0, -14.0, 1600.0));
    overlay(&OverlayScene {
        field: &field,
        camera: Some(&camera),
        standing: Standing::Solved,
        image_size: SIZE,
        clicks: &[],
        selected: None,
        disputed: &[],
        style: &OverlayStyle::default(),
        zoom: 1.0,
    })
}

fn picture(key: u64) -> Layer {
    Layer::Picture(Picture {
        key: PictureKey(key),
        pixels: media::Picture::filled(SIZE, [40, 110, 50, 255]),
        brightness: 1.0,
    })
}

/// Composing the overlay's scene from field and camera.
#[divan::bench]
fn scene(bencher: Bencher) {
    bencher.bench(drawing);
}

/// Drawing and reading back; the picture is on the GPU already.
#[divan::bench(args = ["picture", "picture_and_overlay"])]
fn frame_1080p(bencher: Bencher, what: &str) {
    let mut offscreen = Offscreen::new().unwrap();
    let mut layers = vec![picture(1)];
    if what == "picture_and_overlay" {
        layers.push(Layer::Drawing(Arc::new(drawing())));
    }
    let view = View::one_to_one([SIZE.width, SIZE.height]);
    bencher.bench_local(|| offscreen.render(&view, BLACK, &layers).unwrap());
}

/// The same at the size of the app's viewport, with a new picture every time: upload, mipmaps, drawing, reading back.
#[divan::bench]
fn step_to_a_new_picture(bencher: Bencher) {
    let mut offscreen = Offscreen::new().unwrap();
    let overlay = Layer::Drawing(Arc::new(drawing()));
    let view = View::fit([SIZE.width, SIZE.height], [980, 580]);
    let mut key = 0;
    bencher
        .with_inputs(|| {
            key += 1;
            [picture(key), overlay.clone()]
        })
        .bench_local_values(|layers| offscreen.render(&view, BLACK, &layers).unwrap());
}
