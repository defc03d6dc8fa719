//! Samples along the painted lines in a camera's picture, with the normal and the width of the
//! paint.

use crate::camera::PtzCamera;
use crate::field::{Curve, FieldModel};
use crate::geometry::{ImagePoint, ImageSize, Vec2, Vec3};

/// Options of the sampling of painted lines.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct SampleOptions {
    /// Distance between neighbouring samples of a line, px. Default 8.
    pub spacing_px: f64,
    /// Samples nearer to the picture's border than this are skipped, px. A negative number includes
    /// samples beyond the border. Default 2.
    pub border_px: f64,
}

impl Default for SampleOptions {
    fn default() -> Self {
        Self {
            spacing_px: 8.0,
            border_px: 2.0,
        }
    }
}

/// A sample: a point on the centre line of the paint.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct LineSample {
    /// Which line: index into [`FieldModel::lines`].
    pub line: usize,
    /// The point on the crowned ground, `world`, m.
    pub at: Vec3,
    /// Its image, px.
    pub image: ImagePoint,
    /// The unit normal of the projected line, pointing to its left as displayed (y down).
    pub normal: Vec2,
    /// The width of the paint along the normal, px.
    pub width_px: f64,
    /// The share of the line's length that has paint, 0 to 1: less than 1 on a dashed line.
    pub painted_share: f64,
    /// The side that is outside the playing area: 1 along the normal, −1 against it, 0 if both
    /// sides are inside.
    pub outward: f64,
}

/// Paint at least this wide is seen wherever it is not covered, px. In drawn clips that were
/// re-encoded at 360p or filmed off a screen, a detector of ridges sees 0.85 to 1.0 of the samples
/// from this width on, 0.2 to 0.9 of those of half of it, and 0.05 to 0.6 of those of a quarter.
const PLAIN_WIDTH_PX: f64 = 0.8;

impl LineSample {
    /// How much it counts against a camera if no paint is seen here, 0 to 1 ([`detectability`]).
    pub fn detectability(&self) -> f64 {
        self.painted_share * detectability(self.width_px)
    }

    /// How far the line moves in the picture, along its normal, for each metre that the ground
    /// under it moves along a direction, px per m; negative against the normal. A motion along the
    /// line itself cannot be seen. None where the camera does not see it.
    pub fn motion_px_per_m(&self, camera: &PtzCamera, along: Vec3) -> Option<f64> {
        const STEP_M: f64 = 0.05;
        let beside = camera.image_from_world(self.at + along * STEP_M).ok()?;
        let moved_px = Vec2::new(beside.x - self.image.x, beside.y - self.image.y);
        Some(moved_px.dot(&self.normal) / STEP_M)
    }
}

/// How surely paint of a width is seen in a picture where nothing covers it, 0 to 1: 1 for wide
/// paint. The contrast that is left of paint narrower than a pixel falls with its width, and what
/// compression leaves of it falls faster.
pub fn detectability(width_px: f64) -> f64 {
    (width_px / PLAIN_WIDTH_PX).powi(2).min(1.0)
}

/// Maximum step outside the picture, as a fraction of a line, so that no visible part is skipped.
const MAX_STEP: f64 = 1.0 / 128.0;

/// Minimum step outside the picture, as a fraction of a line.
const SHORTEST_STEP: f64 = 1e-5;

/// Distance on either side of a line, m, at which the playing area is tested to decide whether the
/// line bounds it.
const BESIDE_M: f64 = 0.5;

/// Samples every painted line at equal distances in the picture, in the field's order.
///
/// Samples lie on the centre of the paint ([`crate::field::FieldLine::paint_centre`]), not on the
/// nominal line. A camera with NaN or infinite parameters has none.
pub fn sample_lines(
    field: &FieldModel,
    camera: &PtzCamera,
    size: ImageSize,
    options: &SampleOptions,
) -> Vec<LineSample> {
    let spacing_px = options.spacing_px.max(0.1);
    let mut samples = Vec::new();
    for (line, of) in field.lines.iter().enumerate().filter(|(_, of)| of.painted) {
        let curve = &of.paint_centre;
        let mut t = 0.0;
        while t <= 1.0 {
            // Step along the curve by px in the picture: the speed |d image / dt| converts to t.
            let Some(here) = project(field, camera, curve, t) else {
                t += MAX_STEP;
                continue;
            };
            let outside_px = outside_px(here.image, size, options.border_px);
            if outside_px == 0.0 {
                samples.push(LineSample {
                    line,
                    at: here.at,
                    image: here.image,
                    normal: here.normal,
                    width_px: here.width_px(of.width_m),
                    painted_share: of.painted_share(),
                    outward: here.outward(field),
                });
            }
            t += if outside_px == 0.0 {
                spacing_px / here.px_per_t
            } else {
                // Outside, half of the distance to the picture bounds the step: at the current
                // speed it does not reach the border.
                (spacing_px.max(0.5 * outside_px) / here.px_per_t).clamp(SHORTEST_STEP, MAX_STEP)
            };
        }
    }
    samples
}

/// A line as a camera sees it around one of its points.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ProjectedLine {
    /// The point, `world`, m.
    at: Vec3,
    /// Its image, px.
    image: ImagePoint,
    /// The unit normal of the projected line.
    normal: Vec2,
    /// Derivative of the image along the line, px per unit of the curve's parameter.
    px_per_t: f64,
    /// The horizontal direction across the line, `world`, unit.
    across: Vec3,
    /// Derivative of the image along the normal, by a shift of the point across the line, px/m.
    px_across_per_m: f64,
}

impl ProjectedLine {
    /// Projects a line through a point (`world`, m) with this tangent, the derivative of the point
    /// by the parameter of its curve. None if the camera does not see the point, or if the line
    /// degenerates to a point in the picture.
    pub fn new(camera: &PtzCamera, at: Vec3, tangent: Vec3) -> Option<Self> {
        let here = camera.image_from_world_jacobian(at).ok()?;
        let along = here.by_world * tangent;
        let px_per_t = along.norm();
        if !(px_per_t > 0.0) || !here.point.is_finite() {
            return None;
        }

        // The paint's width is horizontal and perpendicular to the line. Its image along the normal
        // is the visible width.
        let normal = Vec2::new(along.y, -along.x) / px_per_t;
        let across = Vec3::new(-tangent.y, tangent.x, 0.0).try_normalize(0.0)?;
        let px_across_per_m = normal.dot(&(here.by_world * across));
        Some(Self {
            at,
            image: here.point,
            normal,
            px_per_t,
            across,
            px_across_per_m,
        })
    }

    /// The distance of an image point from the line, px.
    pub fn distance_px(&self, image: ImagePoint) -> f64 {
        image.offset_from(self.image).dot(&self.normal).abs()
    }

    /// The width along the normal, px, of paint that is `paint_m` wide.
    pub fn width_px(&self, paint_m: f64) -> f64 {
        self.px_across_per_m.abs() * paint_m
    }

    /// The side of the line that is outside the playing area: see [`LineSample::outward`].
    fn outward(&self, field: &FieldModel) -> f64 {
        // Both places are tested, because a line inside the field has none of them outside.
        let [beyond_along, beyond_against] = [1.0, -1.0].map(|sign: f64| {
            let at = self.at + self.across * (sign * BESIDE_M);
            at.x.abs() > field.length_m / 2.0 || at.y.abs() > field.width_m / 2.0
        });
        // `across` may point against the picture's normal; the sign is that of the normal.
        let sign = f64::from(i8::from(beyond_along) - i8::from(beyond_against));
        if self.px_across_per_m < 0.0 {
            -sign
        } else {
            sign
        }
    }
}

/// Projects a curve of a field around one of its points, on the crowned ground.
fn project(field: &FieldModel, camera: &PtzCamera, curve: &Curve, t: f64) -> Option<ProjectedLine> {
    let nominal = curve.point_at(t);
    let at = field.world_from_nominal(nominal);
    // The tangent on the crowned ground: dz/dt = −c · d(drop)/dy · dy/dt.
    let mut tangent = curve.tangent_at(t);
    let crown = field.crown();
    let [drop_by_y, _] = crown.drop_share_by_y_and_width(nominal.y);
    tangent.z -= crown.height_m * drop_by_y * tangent.y;
    ProjectedLine::new(camera, at, tangent)
}

/// Distance of a point from the picture less its border, px; 0 inside.
fn outside_px(point: ImagePoint, size: ImageSize, border_px: f64) -> f64 {
    let x_px = outside_side_px(point.x, size.width, border_px);
    let y_px = outside_side_px(point.y, size.height, border_px);
    x_px.max(y_px)
}

/// Distance of a coordinate from one side of a picture less its border, px; 0 within.
fn outside_side_px(at_px: f64, side_px: u32, border_px: f64) -> f64 {
    (border_px - at_px)
        .max(at_px - (f64::from(side_px) - border_px))
        .max(0.0)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::field::builtin;
    use crate::testing::{SIZE, TestBase, base_at};
    use std::collections::BTreeMap;

    fn soccer() -> FieldModel {
        builtin("soccer")
            .unwrap()
            .model(&BTreeMap::new(), 0.15)
            .unwrap()
    }

    fn camera(pan_deg: f64, tilt_deg: f64, focal_px: f64) -> PtzCamera {
        base_at([2.0, -60.0, 18.0], SIZE)
            .bent(-0.05)
            .aim(pan_deg, tilt_deg, focal_px)
    }

    #[test]
    fn every_part_of_the_paint_that_the_picture_shows_has_a_sample_near_by() {
        let field = soccer();
        let options = SampleOptions {
            spacing_px: 10.0,
            border_px: 0.0,
        };
        for camera in [
            camera(0.0, -14.0, 2000.0),
            camera(-40.0, -9.0, 3500.0),
            camera(25.0, -25.0, 9000.0),
        ] {
            let samples = sample_lines(&field, &camera, SIZE, &options);
            for (line, of) in field.lines.iter().enumerate().filter(|(_, of)| of.painted) {
                for step in 0..=400 {
                    let at =
                        field.world_from_nominal(of.paint_centre.point_at(f64::from(step) / 400.0));
                    let Ok(image) = camera.image_from_world(at) else {
                        continue;
                    };
                    if outside_px(image, SIZE, 1.0) > 0.0 {
                        continue;
                    }
                    let mine = samples.iter().filter(|sample| sample.line == line);
                    let nearest = mine
                        .map(|sample| sample.image.distance_px(image))
                        .fold(f64::INFINITY, f64::min);
                    assert!(
                        nearest <= 12.0,
                        "{}: no sample within {nearest} px of {image:?}",
                        of.id
                    );
                }
            }
        }
    }

    #[test]
    fn normals_and_widths_are_those_of_the_edges_of_the_paint() {
        let (field, camera) = (soccer(), camera(8.0, -14.0, 2200.0));
        let samples = sample_lines(&field, &camera, SIZE, &SampleOptions::default());
        assert!(samples.len() > 300, "{}", samples.len());
        for sample in &samples {
            assert!((sample.normal.norm() - 1.0).abs() < 1e-12);
            assert!(
                camera
                    .image_from_world(sample.at)
                    .unwrap()
                    .distance_px(sample.image)
                    < 1e-9
            );
            assert!(outside_px(sample.image, SIZE, 2.0) == 0.0);
        }
        let halfway = field
            .lines
            .iter()
            .position(|line| line.id.as_str() == "halfway_line")
            .unwrap();
        for sample in samples.iter().filter(|sample| sample.line == halfway) {
            let edge = |side: f64| {
                camera
                    .image_from_world(sample.at + Vec3::new(0.06 * side, 0.0, 0.0))
                    .unwrap()
            };
            let width_px = sample.normal.dot(&edge(1.0).offset_from(edge(-1.0))).abs();
            assert!(
                (sample.width_px / width_px - 1.0).abs() < 1e-4,
                "{} is not {width_px}",
                sample.width_px
            );
            assert!(sample.outward == 0.0);
        }
    }

    #[test]
    fn beyond_the_touchlines_the_ground_may_end() {
        let (field, camera) = (soccer(), camera(0.0, -14.0, 1500.0));
        let samples = sample_lines(&field, &camera, SIZE, &SampleOptions::default());
        let far = field
            .lines
            .iter()
            .position(|line| line.id.as_str() == "touchline_far")
            .unwrap();
        let mut far = samples
            .iter()
            .filter(|sample| sample.line == far)
            .peekable();
        assert!(far.peek().is_some());
        for sample in far {
            // The far side is up in the picture.
            assert!(sample.outward * sample.normal.y < 0.0, "{sample:?}");
        }
    }

    #[test]
    fn a_camera_that_looks_away_has_no_samples() {
        let samples = sample_lines(
            &soccer(),
            &camera(180.0, -10.0, 2000.0),
            SIZE,
            &SampleOptions::default(),
        );
        assert!(samples.is_empty());
        let broken = sample_lines(
            &soccer(),
            &camera(f64::NAN, -10.0, 2000.0),
            SIZE,
            &SampleOptions::default(),
        );
        assert!(broken.is_empty());
    }
}
