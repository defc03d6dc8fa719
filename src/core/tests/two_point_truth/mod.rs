//! Two clicks against known truth: exactness without noise, honesty and efficiency with it, every
//! error by its name.

mod exact;
mod named_cases;
mod noise;

use nalgebra::Vector3;
use rand::RngExt;
use rand_pcg::Pcg64Mcg;
use touchline_core::camera::{CameraBase, FocalCurve, Ptz, PtzCamera};
use touchline_core::geometry::{ImagePoint, ImageSize, Vec2, Vec3};
use touchline_core::solve::Observation;
use touchline_core::testing::seeded::normal;
use touchline_core::testing::{TestBase, base_at, turned_base};

/// The size of the pictures.
pub const SIZE: ImageSize = ImageSize::new(1920, 1080);

/// A camera at the side of a field that looks somewhere, with a lens in every second case.
fn random_camera(rng: &mut Pcg64Mcg) -> PtzCamera {
    let position = Vec3::new(
        rng.random_range(-30.0..30.0),
        rng.random_range(-100.0..-45.0),
        rng.random_range(8.0..40.0),
    );
    let mut base = turned_base(
        position,
        [
            0.0,
            rng.random_range(-2.0..2.0),
            rng.random_range(-2.0..2.0),
        ],
        SIZE,
    );
    if rng.random_bool(0.5) {
        base.distortion = FocalCurve {
            at_focal_px: 2000.0,
            value: rng.random_range(-0.08..0.05),
            per_1000_px: rng.random_range(0.0..0.25),
            ..FocalCurve::NONE
        };
    }
    let ptz = Ptz::from_degrees(
        rng.random_range(-50.0..50.0),
        rng.random_range(-30.0..-6.0),
        rng.random_range(1500.0f64.ln()..6000.0f64.ln()).exp(),
    );
    PtzCamera::new(base, ptz)
}

fn random_pixel(rng: &mut Pcg64Mcg) -> ImagePoint {
    ImagePoint::new(
        rng.random_range(0.0..f64::from(SIZE.width)),
        rng.random_range(0.0..f64::from(SIZE.height)),
    )
}

/// The ground that a pixel shows, or a point 80 m off above the horizon.
fn world_behind(camera: &PtzCamera, pixel: ImagePoint) -> Vec3 {
    camera
        .plane_from_image(pixel, 0.0)
        .filter(|ground| ground.norm() < 300.0)
        .unwrap_or_else(|| {
            camera.base().position_m
                + camera
                    .world_direction_from_image(pixel)
                    .expect("within the lens")
                    * 80.0
        })
}

fn landmark(at: Vec3, image: ImagePoint, click: usize) -> Observation {
    Observation::from_point(at, image, 2.0, click)
}

fn exact_clicks(camera: &PtzCamera, pixels: &[ImagePoint]) -> Vec<Observation> {
    let click = |(index, pixel): (usize, &ImagePoint)| {
        let at = world_behind(camera, *pixel);
        landmark(at, camera.image_from_world(at).expect("seen"), index)
    };
    pixels.iter().enumerate().map(click).collect()
}

fn is_truth(found: &Ptz, truth: &Ptz) -> bool {
    (found.pan - truth.pan).abs().radians() < 1e-9
        && (found.tilt - truth.tilt).abs().radians() < 1e-9
        && (found.focal_px - truth.focal_px).abs() < 1e-6
}

/// The clicks with normal noise of their own sigma, kept inside the frame.
pub fn noisy(clicks: &[Observation], rng: &mut Pcg64Mcg) -> Vec<Observation> {
    let shake = |click: &Observation, rng: &mut Pcg64Mcg| {
        let image = click
            .image
            .translate(Vec2::new(normal(rng), normal(rng)) * click.sigma_px);
        let inside = |x: f64, upto: u32| x.clamp(0.0, f64::from(upto));
        Observation {
            image: ImagePoint::new(inside(image.x, SIZE.width), inside(image.y, SIZE.height)),
            ..*click
        }
    };
    clicks.iter().map(|click| shake(click, rng)).collect()
}

/// The errors of pan and tilt, degrees, and of the focal length, px.
pub fn error(found: &Ptz, truth: &Ptz) -> Vector3<f64> {
    Vector3::new(
        (found.pan - truth.pan).degrees(),
        (found.tilt - truth.tilt).degrees(),
        found.focal_px - truth.focal_px,
    )
}

fn known_base() -> CameraBase {
    base_at([0.0, -60.0, 18.0], SIZE)
}

fn known_clicks() -> [Observation; 2] {
    let camera = known_base().aim(10.0, -14.0, 2500.0);
    let clicks = exact_clicks(
        &camera,
        &[
            ImagePoint::new(300.0, 400.0),
            ImagePoint::new(1500.0, 700.0),
        ],
    );
    [clicks[0], clicks[1]]
}
