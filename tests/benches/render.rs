//! A 1080p picture with the overlay of a soccer field, off-screen.
#![allow(
    missing_docs,
    clippy::unwrap_used,
    reason = "a bench says what failed by failing"
)]

use divan::Bencher;
use std::collections::BTreeMap;
use std::sync::Arc;
use touchline::camera::{BaseAngles, BaseSigma, CameraBase, Ptz, PtzCamera};
use touchline::field::{FieldModel, builtin};
use touchline::geometry::{ImageSize, Vec3};
use touchline::media;
use touchline::render::{Layer, Offscreen, PictureKey, PictureLayer, View};
use touchline::scene::drawing::{Colour, Drawing};
use touchline::scene::overlay::{OverlayScene, overlay};
use touchline::scene::uncertainty::{HeatMap, band};
use touchline::scene::{OverlayStyle, PictureLook};
use touchline::solve::{Observation, Uncertainty};

const SIZE: ImageSize = ImageSize::new(1920, 1080);
const BLACK: Colour = Colour::rgb(0, 0, 0);

fn main() {
    if let Ok(offscreen) = Offscreen::new() {
        eprintln!("adapter: {}", offscreen.adapter());
    }
    divan::main();
}

fn drawing() -> Drawing {
    let field = builtin("soccer")
        .unwrap()
        .model(&BTreeMap::new(), 0.15)
        .unwrap();
    let base = CameraBase::new(
        Vec3::new(0.0, -60.0, 18.0),
        BaseAngles::default().base_from_world(),
        SIZE.centre(),
    );
    let camera = PtzCamera::new(base, Ptz::from_degrees(0.0, -14.0, 1600.0));
    overlay(&OverlayScene {
        camera: Some(&camera),
        ..OverlayScene::new(&field, SIZE, &OverlayStyle::default())
    })
}

fn picture(key: u64) -> Layer {
    Layer::Picture(PictureLayer {
        key: PictureKey(key),
        pixels: media::Picture::with_colour(SIZE, [40, 110, 50, 255]),
        look: PictureLook::default(),
    })
}

/// Composing the overlay's scene from field and camera.
#[divan::bench]
fn scene(bencher: Bencher) {
    bencher.bench(drawing);
}

/// A frame solved from two clicks with a base that is not exactly known.
fn solved_frame() -> (FieldModel, PtzCamera, Uncertainty) {
    let field = builtin("soccer")
        .unwrap()
        .model(&BTreeMap::new(), 0.15)
        .unwrap();
    let base = CameraBase {
        sigma: BaseSigma {
            position_m: Vec3::repeat(0.2),
            rotation: Vec3::new(1e-3, 1e-3, 0.0),
            ..BaseSigma::default()
        },
        ..CameraBase::new(
            Vec3::new(0.0, -60.0, 18.0),
            BaseAngles::default().base_from_world(),
            SIZE.centre(),
        )
    };
    let camera = PtzCamera::new(base, Ptz::from_degrees(0.0, -14.0, 1600.0));
    let click = |name: &str| {
        let at = camera
            .image_from_world(field.landmark_in_world(field.landmark(name).unwrap()))
            .unwrap();
        Observation::from_landmark(&field, name, at, SIZE, 0).unwrap()
    };
    let clicks = [click("centre_mark"), click("centre_circle_right")];
    let uncertainty = Uncertainty::from_observations(&camera, &clicks, None).unwrap();
    (field, camera, uncertainty)
}

/// 1-σ of the overlay on a grid of 60×40.
#[divan::bench]
fn heat_map(bencher: Bencher) {
    let (_, camera, uncertainty) = solved_frame();
    bencher.bench(|| HeatMap::new(&uncertainty, &camera, SIZE));
}

/// The 1-σ band around every line.
#[divan::bench]
fn uncertainty_band(bencher: Bencher) {
    let (field, camera, uncertainty) = solved_frame();
    bencher.bench(|| {
        band(
            &uncertainty,
            &field,
            &camera,
            SIZE,
            &OverlayStyle::default(),
        )
    });
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

/// The same at the size of the app's viewport, with a new picture every time: upload, mipmaps,
/// drawing, reading back.
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
