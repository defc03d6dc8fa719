//! Synthetic pictures for the tests of this module: a field with its paint, seen by a known camera.

use crate::media::Picture;
use std::collections::BTreeMap;
use std::sync::LazyLock;
use touchline_core::camera::{BaseAngles, CameraBase, FocalCurve, Ptz, PtzCamera};
use touchline_core::field::{FieldModel, builtin};
use touchline_core::geometry::{Angle, ImagePoint, ImageSize, Vec3};
use touchline_core::testing::{TestBase, base_at};

/// Size of the pictures, px.
pub const SIZE: ImageSize = ImageSize::new(1280, 720);

/// The camera of [`PICTURE`].
pub fn truth() -> PtzCamera {
    camera(4.0, -14.0, 1500.0)
}

/// The soccer field as [`truth`] sees it, drawn once for all tests.
pub static PICTURE: LazyLock<Picture> = LazyLock::new(|| draw_field(&soccer(), &truth(), SIZE));

/// Pixels whose centre is farther than this from all paint are drawn with one sample, m.
const NO_PAINT_M: f64 = 1.0;

/// Samples along each side of a pixel near paint.
const SUBPIXELS: u32 = 3;

/// A crowned soccer field.
pub fn soccer() -> FieldModel {
    builtin("soccer")
        .unwrap()
        .model(&BTreeMap::new(), 0.1)
        .unwrap()
}

/// A camera in the stand of a soccer pitch, with lens distortion.
pub fn camera(pan_deg: f64, tilt_deg: f64, focal_px: f64) -> PtzCamera {
    let base = CameraBase {
        distortion: FocalCurve {
            at_focal_px: 1500.0,
            value: -0.03,
            per_1000_px: 0.2,
            ..FocalCurve::NONE
        },
        ..base_at([1.0, -62.0, 17.0], SIZE)
    };
    base.aim(pan_deg, tilt_deg, focal_px)
}

/// The basketball court as [`court_truth`] sees it, drawn once for all tests.
pub static COURT: LazyLock<Picture> =
    LazyLock::new(|| draw_ground(&court(), &court_truth(), SIZE, court_colour));

/// A flat basketball court.
pub fn court() -> FieldModel {
    builtin("basketball_nba")
        .unwrap()
        .model(&BTreeMap::new(), 0.0)
        .unwrap()
}

/// A camera in the stand of a sports hall.
pub fn court_camera(pan_deg: f64, tilt_deg: f64, focal_px: f64) -> PtzCamera {
    base_at([1.0, -24.0, 11.0], SIZE).aim(pan_deg, tilt_deg, focal_px)
}

/// The camera of [`COURT`].
pub fn court_truth() -> PtzCamera {
    court_camera(-18.0, -21.0, 1300.0)
}

/// Light planks, a blue key and blue ground around the court, white lines, a three-point line of
/// the key's blue.
fn court_colour(field: &FieldModel, at: Vec3) -> [f64; 3] {
    const BLUE: [f64; 3] = [18.0, 52.0, 140.0];
    let painted = field.lines.iter().filter(|line| line.painted);
    let mut hit = painted.filter(|line| line.paint_centre.distance_m(at) <= line.width_m / 2.0);
    if let Some(line) = hit.next() {
        return if line.id.as_str().starts_with("three_point") {
            BLUE
        } else {
            [236.0, 238.0, 236.0]
        };
    }
    let key = 0.5 * field.length_m - 5.79;
    if at.x.abs() > 0.5 * field.length_m
        || at.y.abs() > 0.5 * field.width_m
        || (at.x.abs() > key && at.y.abs() < 2.44)
    {
        return BLUE;
    }
    let plank = 1.0 + 0.02 * f64::from((at.y / 0.4).floor() as i32 % 3);
    [214.0, 178.0, 132.0].map(|value| value * plank)
}

/// A purple tennis court in a green surround as [`tennis_truth`] sees it.
pub static HARD_COURT: LazyLock<Picture> =
    LazyLock::new(|| draw_ground(&tennis(), &tennis_truth(), SIZE, hard_court_colour));

/// A flat tennis court.
pub fn tennis() -> FieldModel {
    let template = builtin("tennis").unwrap();
    template.model(&BTreeMap::new(), 0.0).unwrap()
}

/// A camera in the stand behind a baseline of a tennis court.
pub fn tennis_camera(pan_deg: f64, tilt_deg: f64, focal_px: f64) -> PtzCamera {
    let turned = BaseAngles {
        heading: Angle::from_degrees(90.0),
        ..BaseAngles::default()
    };
    let base = CameraBase::new(
        Vec3::new(-33.0, 0.1, 8.7),
        turned.base_from_world(),
        SIZE.centre(),
    );
    PtzCamera::new(base, Ptz::from_degrees(pan_deg, tilt_deg, focal_px))
}

/// The camera of [`HARD_COURT`].
pub fn tennis_truth() -> PtzCamera {
    tennis_camera(0.0, -13.0, 2000.0)
}

fn hard_court_colour(field: &FieldModel, at: Vec3) -> [f64; 3] {
    if from_paint_m(field, at) <= 0.0 {
        [235.0, 236.0, 238.0]
    } else if at.x.abs() <= 0.5 * field.length_m && at.y.abs() <= 0.5 * field.width_m {
        [92.0, 70.0, 140.0]
    } else {
        [52.0, 104.0, 66.0]
    }
}

/// Turf with the field's paint, and sky where no ground is seen.
pub fn draw_field(field: &FieldModel, camera: &PtzCamera, size: ImageSize) -> Picture {
    draw_ground(field, camera, size, colour)
}

/// Ground of the given colours, and sky where no ground is seen.
fn draw_ground(
    field: &FieldModel,
    camera: &PtzCamera,
    size: ImageSize,
    colour: impl Fn(&FieldModel, Vec3) -> [f64; 3],
) -> Picture {
    let mut rgba = Vec::with_capacity(4 * (size.width * size.height) as usize);
    for row in 0..size.height {
        for column in 0..size.width {
            let middle = ImagePoint::new(f64::from(column) + 0.5, f64::from(row) + 0.5);
            // Antialiasing only near paint: elsewhere the colour hardly changes within a pixel.
            let far =
                ground(field, camera, middle).is_none_or(|at| from_paint_m(field, at) > NO_PAINT_M);
            let each = if far { 1 } else { SUBPIXELS };
            let mut sums = [0.0; 3];
            for sub in 0..each * each {
                // Centres of the sub-pixels, corner convention.
                let at = |pixel: u32, sub: u32| {
                    f64::from(pixel) + (f64::from(sub) + 0.5) / f64::from(each)
                };
                let point = ImagePoint::new(at(column, sub % each), at(row, sub / each));
                let colour = ground(field, camera, point)
                    .map_or([150.0, 180.0, 220.0], |at| colour(field, at));
                for (sum, value) in sums.iter_mut().zip(colour) {
                    *sum += value;
                }
            }
            rgba.extend(sums.map(|sum| (sum / f64::from(each * each)).round() as u8));
            rgba.push(255);
        }
    }
    Picture::new(size, rgba).unwrap()
}

/// The point of the crowned ground that a point of the picture shows, m. Fixed-point iteration:
/// intersects the ray with the horizontal plane at the height of the previous point.
fn ground(field: &FieldModel, camera: &PtzCamera, point: ImagePoint) -> Option<Vec3> {
    let mut at = camera.plane_from_image(point, 0.0)?;
    for _ in 0..3 {
        at = camera.plane_from_image(point, field.ground_z(at.y))?;
    }
    Some(at)
}

/// Signed distance to the edge of the nearest paint, m; negative on paint.
fn from_paint_m(field: &FieldModel, at: Vec3) -> f64 {
    let (painted, at) = (
        field.lines.iter().filter(|line| line.painted),
        Vec3::new(at.x, at.y, 0.0),
    );
    let lines = painted.map(|line| line.paint_centre.distance_m(at) - line.width_m / 2.0);
    let spots = field.landmarks.iter().filter_map(|landmark| {
        let radius_m = 0.5 * landmark.spot_diameter_m?;
        Some((landmark.nominal_m - at).norm() - radius_m)
    });
    lines.chain(spots).fold(f64::INFINITY, f64::min)
}

fn colour(field: &FieldModel, at: Vec3) -> [f64; 3] {
    // Mowing stripes, 5 m wide, up to 4 m outside the side lines.
    let striped = at.y.abs() < field.width_m / 2.0 + 4.0;
    let light = if striped && (at.x / 5.0).floor() as i64 % 2 == 0 {
        1.0
    } else {
        1.2
    };
    if from_paint_m(field, at) <= 0.0 {
        [225.0, 230.0, 220.0]
    } else {
        [62.0 * light, 110.0 * light, 42.0 * light]
    }
}
