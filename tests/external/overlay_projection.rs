//! The rendered overlay lies where the formulas put the field's lines: this file projects them on
//! its own, point by point, and looks for them in the rendered picture.

use crate::parts::{Test, tests};
use image::RgbaImage;
use std::collections::BTreeMap;
use touchline::camera::{CameraBase, FocalCurve};
use touchline::field::{Curve, FieldModel, builtin};
use touchline::geometry::{ImagePoint, ImageSize, Vec3};
use touchline::render::{Layer, View};
use touchline::scene::OverlayStyle;
use touchline::scene::drawing::Colour;
use touchline::scene::overlay::{OverlayScene, field_overlay};
use touchline_core::testing::{TestBase, base_at};

pub const TESTS: &[Test] = tests![
    [Adapter] the_rendered_lines_lie_where_the_formulas_put_them;
];

const SIZE: ImageSize = ImageSize::new(1280, 720);
const WIDTH_PX: f32 = 3.0;
const POSITION: [f64; 3] = [4.0, -58.0, 17.0];
const PRINCIPAL: [f64; 2] = [655.0, 350.0];
const CROWN_M: f64 = 0.2;

/// Pan and tilt (degrees), focal length (px), k₁, and how many samples the view must offer at
/// least.
const VIEWS: [(f64, f64, f64, f64, usize); 4] = [
    (0.0, -16.0, 900.0, -0.12, 3000),
    (28.0, -12.0, 1800.0, 0.2, 1500),
    (-35.0, -9.0, 3500.0, 0.0, 800),
    // The near touchline runs under the camera and behind it.
    (75.0, -25.0, 800.0, -0.05, 600),
];

/// The image of a world point by the formulas of the conventions, written out; none behind the
/// camera or far beside the frame, where distortion may fold.
fn project(
    point: [f64; 3],
    (pan_deg, tilt_deg, focal, k1, _): (f64, f64, f64, f64, usize),
) -> Option<[f64; 2]> {
    let (pan, tilt) = (pan_deg.to_radians(), tilt_deg.to_radians());
    // base: x right, y down, z forward (world y).
    let [x, y, z] = [
        point[0] - POSITION[0],
        -(point[2] - POSITION[2]),
        point[1] - POSITION[1],
    ];
    let (x, z) = (x * pan.cos() - z * pan.sin(), x * pan.sin() + z * pan.cos());
    let (y, z) = (
        y * tilt.cos() + z * tilt.sin(),
        z * tilt.cos() - y * tilt.sin(),
    );
    if z < 0.1 {
        return None;
    }
    let (x, y) = (x / z, y / z);
    let r2 = x * x + y * y;
    let stretch = 1.0 + k1 * r2;
    (r2 < 1.2).then(|| {
        [
            PRINCIPAL[0] + focal * x * stretch,
            PRINCIPAL[1] + focal * y * stretch,
        ]
    })
}

fn with_crown(point: Vec3, field: &FieldModel) -> [f64; 3] {
    let across = (point.y / (field.width_m / 2.0)).clamp(-1.0, 1.0);
    [point.x, point.y, point.z - CROWN_M * across * across]
}

/// Points along a curve, closer than a px to each other wherever they are near the frame.
fn samples(curve: &Curve, field: &FieldModel, view: (f64, f64, f64, f64, usize)) -> Vec<[f64; 2]> {
    let count = 40_000;
    let mut points: Vec<[f64; 2]> = Vec::new();
    for i in 0..=count {
        let t = f64::from(i) / f64::from(count);
        let nominal = match *curve {
            Curve::Segment { from, to } => from + (to - from) * t,
            Curve::Arc {
                centre,
                radius_m,
                start,
                sweep,
            } => {
                let angle = start.radians() + sweep.radians() * t;
                centre + Vec3::new(radius_m * angle.cos(), radius_m * angle.sin(), 0.0)
            }
        };
        let Some(point) = project(with_crown(nominal, field), view) else {
            continue;
        };
        let near = |x: f64, limit: u32| x > -20.0 && x < f64::from(limit) + 20.0;
        let far_from_last = points
            .last()
            .is_none_or(|last| (last[0] - point[0]).hypot(last[1] - point[1]) > 0.4);
        if near(point[0], SIZE.width) && near(point[1], SIZE.height) && far_from_last {
            points.push(point);
        }
    }
    points
}

fn brightness(picture: &RgbaImage, at: [f64; 2]) -> f64 {
    let (x, y) = (at[0] - 0.5, at[1] - 0.5);
    let (left, top) = (x.floor(), y.floor());
    let pixel =
        |dx: f64, dy: f64| f64::from(picture.get_pixel((left + dx) as u32, (top + dy) as u32).0[0]);
    let (u, v) = (x - left, y - top);
    (pixel(0.0, 0.0) * (1.0 - u) + pixel(1.0, 0.0) * u) * (1.0 - v)
        + (pixel(0.0, 1.0) * (1.0 - u) + pixel(1.0, 1.0) * u) * v
}

/// How far the rendered line's middle lies from a point, along the normal, px; none where the line
/// is not alone.
fn offset_across(picture: &RgbaImage, line: &[[f64; 2]], at: usize) -> Option<f64> {
    let ([a, p, b], reach) = ([line[at - 1], line[at], line[at + 1]], 5.0);
    let inside = p[0]
        .min(p[1])
        .min(f64::from(SIZE.width) - p[0])
        .min(f64::from(SIZE.height) - p[1]);
    // Not at the border, not near an end, not where the line comes back to itself.
    let alone = line.iter().enumerate().all(|(i, q)| {
        let close = (q[0] - p[0]).hypot(q[1] - p[1]) < 2.0 * reach;
        let end = i == 0 || i == line.len() - 1;
        !close || (!end && i.abs_diff(at) < 60)
    });
    if inside < reach + 2.0 || !alone {
        return None;
    }
    let (dx, dy) = (b[0] - a[0], b[1] - a[1]);
    let length = dx.hypot(dy);
    let normal = [-dy / length, dx / length];
    let (mut moment, mut total) = (0.0, 0.0);
    for step in -20..=20 {
        let s = f64::from(step) * reach / 20.0;
        let light = brightness(picture, [p[0] + s * normal[0], p[1] + s * normal[1]]);
        moment += s * light;
        total += light;
    }
    Some(if total > 0.0 {
        moment / total
    } else {
        f64::INFINITY
    })
}

fn the_rendered_lines_lie_where_the_formulas_put_them() {
    let field = builtin("soccer")
        .unwrap()
        .model(&BTreeMap::new(), CROWN_M)
        .unwrap();
    let style = OverlayStyle {
        colour: [255; 3],
        width: WIDTH_PX,
        opacity: 1.0,
        outline: 0.0,
        landmarks: false,
        ..OverlayStyle::default()
    };
    for view @ (pan, tilt, focal, k1, wanted) in VIEWS {
        let base = CameraBase {
            distortion: FocalCurve {
                at_focal_px: focal,
                value: k1,
                per_1000_px: 0.0,
                ..FocalCurve::NONE
            },
            ..base_at(POSITION, ImagePoint::from(PRINCIPAL))
        };
        let camera = base.aim(pan, tilt, focal);
        let (mut checked, mut worst) = (0, 0.0_f64);
        for line in &field.lines {
            let alone = FieldModel {
                lines: vec![line.clone()],
                ..field.clone()
            };
            let scene = OverlayScene {
                camera: Some(&camera),
                ..OverlayScene::new(&alone, SIZE, &style)
            };
            let layers = [Layer::Drawing(field_overlay(&scene).into())];
            let picture = super::overlay_pixels::offscreen()
                .render(
                    &View::one_to_one([SIZE.width, SIZE.height]),
                    Colour::rgb(0, 0, 0),
                    &layers,
                )
                .unwrap();
            let points = samples(&line.curve, &field, view);
            no_stray_pixel(&picture, &points, line.id.as_str());
            for at in (1..points.len().saturating_sub(1)).step_by(3) {
                if let Some(offset) = offset_across(&picture, &points, at) {
                    assert!(
                        offset.abs() < 0.5,
                        "{} in {view:?}: {offset} px off at {:?}",
                        line.id,
                        points[at]
                    );
                    worst = worst.max(offset.abs());
                    checked += 1;
                }
            }
        }
        println!("{view:?}: {checked} samples, worst {worst:.3} px");
        assert!(checked >= wanted, "{view:?} offered only {checked} samples");
    }
}

/// Every lit pixel is near some sample of the line.
fn no_stray_pixel(picture: &RgbaImage, points: &[[f64; 2]], name: &str) {
    let reach = f64::from(WIDTH_PX) / 2.0 + 1.0;
    let mut allowed = vec![false; SIZE.width as usize * SIZE.height as usize];
    let span = |centre: f64, limit: u32| {
        let low = (centre - reach).floor().max(0.0) as usize;
        low..((centre + reach).ceil().max(0.0) as usize).min(limit as usize)
    };
    for point in points {
        for y in span(point[1], SIZE.height) {
            for x in span(point[0], SIZE.width) {
                allowed[y * SIZE.width as usize + x] = true;
            }
        }
    }
    for (x, y, pixel) in picture.enumerate_pixels() {
        let lit = pixel.0[0] > 0;
        assert!(
            !lit || allowed[(y * SIZE.width + x) as usize],
            "{name}: a stray pixel at {x}, {y}"
        );
    }
}
