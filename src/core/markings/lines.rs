//! Lines, circles, arcs and posts as polylines in the picture.

use super::clip::{Window, within_cone, within_frame, within_pyramid};
use super::flatten::Flattener;
use crate::camera::PtzCamera;
use crate::field::{Curve, FieldModel};
use crate::geometry::{ImagePoint, ImageSize, Vec2, Vec3};

/// Options of the projection of lines.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct MarkingOptions {
    /// Maximum distance of a polyline from the exact curve, px. Default 0.1.
    pub tolerance_px: f64,
    /// Lines extend beyond the picture's border by this, px, so that the ends of wide strokes are
    /// not visible. Default 16.
    pub margin_px: f64,
    /// Whether a dashed line is projected dash by dash, to be drawn; else as one line. Default
    /// false.
    pub dashes: bool,
}

impl Default for MarkingOptions {
    fn default() -> Self {
        Self {
            tolerance_px: 0.1,
            margin_px: 16.0,
            dashes: false,
        }
    }
}

/// A visible part of a line.
#[derive(Clone, Debug, PartialEq)]
pub struct MarkingPolyline {
    /// Which line: index into [`FieldModel::lines`].
    pub line: usize,
    /// At least two points, px. A whole circle ends where it begins.
    pub points: Vec<ImagePoint>,
}

/// Projects every visible part of every line of a field, in the field's order.
///
/// All points are finite and within the picture and its margin. A camera with NaN or infinite
/// parameters sees nothing.
pub fn project_lines(
    field: &FieldModel,
    camera: &PtzCamera,
    size: ImageSize,
    options: &MarkingOptions,
) -> Vec<MarkingPolyline> {
    let Some(window) = Window::new(camera, size, options.margin_px) else {
        return Vec::new();
    };
    // Two approximations add up: the curve by pieces that are straight in space, and the picture of
    // such a piece, which distortion bends. Each gets half of the tolerance.
    let half_tolerance_px = options.tolerance_px.max(1e-6) / 2.0;
    let flattener = Flattener::new(field, camera, &window, half_tolerance_px);
    let mut pen = Pen {
        camera,
        window: &window,
        tolerance_px: half_tolerance_px,
        polylines: Vec::new(),
    };
    for (line, field_line) in field.lines.iter().enumerate() {
        let first = pen.polylines.len();
        let mut draw = |of: &Curve| flattener.flatten(of, &mut |a, b| pen.piece(line, first, a, b));
        // Dashes are for the eye. Distances are measured from the line on which they lie.
        if options.dashes {
            field_line
                .pieces(&field_line.curve)
                .for_each(|dash| draw(&dash));
        } else {
            draw(&field_line.curve);
        }
    }
    pen.polylines
}

/// Projects straight pieces in `cam` into the picture, and joins each to the previous one where
/// their ends coincide.
struct Pen<'a> {
    camera: &'a PtzCamera,
    window: &'a Window,
    tolerance_px: f64,
    polylines: Vec<MarkingPolyline>,
}

impl Pen<'_> {
    /// Draws the piece from `a` to `b` (`cam`, m) of a line. The line's polylines begin at index
    /// `first`.
    fn piece(&mut self, line: usize, first: usize, a: Vec3, b: Vec3) {
        // Clip in `cam`, before the division by z: to the window's pyramid, then to the fold's
        // cone.
        let Some(span) = within_pyramid(self.window, a, b, 0.0) else {
            return;
        };
        let Some(span) = within_cone(self.window, a, b, span) else {
            return;
        };
        let (start, end) = (ideal_at(a, b, span.start), ideal_at(a, b, span.end));
        // The piece is straight before distortion, and curved by at most (6 |k₁| r + 20 |k₂| r³) f
        // after it. A chord of n equal steps deviates by at most curvature · length² / (8 n²),
        // which gives n.
        let (lens, radius) = (self.camera.lens(), start.norm().max(end.norm()));
        let curvature = radius * (6.0 * lens.k1.abs() + 20.0 * lens.k2.abs() * radius * radius);
        let focal_px = self.camera.ptz().focal_px * lens.pixel_aspect.max(1.0);
        let bend_px = curvature * focal_px / 8.0 * (end - start).norm_squared();
        let steps = (bend_px / self.tolerance_px)
            .sqrt()
            .ceil()
            .clamp(1.0, 4096.0);
        let Some(mut from) = self.image_from_ideal(start) else {
            return;
        };
        for step in 1..=steps as u32 {
            let share = f64::from(step) / steps;
            let ideal = if share == 1.0 {
                end
            } else {
                start + (end - start) * share
            };
            let Some(to) = self.image_from_ideal(ideal) else {
                return;
            };
            self.stroke(line, first, from, to);
            from = to;
        }
    }

    /// The image, px, of a point of the plane z = 1 of `cam`; none beyond the fold of the lens.
    fn image_from_ideal(&self, ideal: Vec2) -> Option<ImagePoint> {
        self.camera
            .image_from_cam(Vec3::new(ideal.x, ideal.y, 1.0))
            .ok()
    }

    /// Adds the part of a piece from `from` to `to` (`image`, px) inside the frame.
    fn stroke(&mut self, line: usize, first: usize, from: ImagePoint, to: ImagePoint) {
        let Some(span) = within_frame(self.window, from, to) else {
            return;
        };
        // Unclipped ends stay exact, because the next piece is joined by equality.
        let along = to.offset_from(from);
        let start = if span.start == 0.0 {
            from
        } else {
            from.translate(along * span.start)
        };
        let end = if span.end == 1.0 {
            to
        } else {
            from.translate(along * span.end)
        };
        // Rounding may put a clipped point slightly outside; the clamp does not move points inside.
        let [start, end] = [start, end].map(|point| {
            ImagePoint::new(
                point.x.clamp(self.window.min.x, self.window.max.x),
                point.y.clamp(self.window.min.y, self.window.max.y),
            )
        });
        if start == end {
            return;
        }
        // A clipped end equals no start of a later piece, so that a line that leaves the picture
        // and comes back has several polylines.
        let goes_on = self.polylines[first..]
            .last()
            .is_some_and(|last| last.points.last() == Some(&start));
        match self.polylines.last_mut() {
            Some(last) if goes_on => last.points.push(end),
            _ => self.polylines.push(MarkingPolyline {
                line,
                points: vec![start, end],
            }),
        }
    }
}

/// The point at a fraction of the way from `a` to `b` (`cam`), on the plane z = 1. At 0 and 1 it
/// comes from `a` and `b` themselves, without rounding.
fn ideal_at(a: Vec3, b: Vec3, t: f64) -> Vec2 {
    let p = if t == 0.0 { a } else { a + (b - a) * t };
    let p = if t == 1.0 { b } else { p };
    Vec2::new(p.x / p.z, p.y / p.z)
}

/// A landmark that is visible in the picture.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ProjectedLandmark {
    /// Which landmark: index into [`FieldModel::landmarks`].
    pub landmark: usize,
    /// Its image, px.
    pub image: ImagePoint,
}

/// Projects all landmarks that lie within the picture enlarged by a margin, px, in the field's
/// order.
pub fn project_landmarks(
    field: &FieldModel,
    camera: &PtzCamera,
    size: ImageSize,
    margin_px: f64,
) -> Vec<ProjectedLandmark> {
    field
        .landmarks
        .iter()
        .enumerate()
        .filter_map(|(landmark, of)| {
            let image = camera.image_from_world(field.landmark_in_world(of)).ok()?;
            is_within_margin(image, size, margin_px)
                .then_some(ProjectedLandmark { landmark, image })
        })
        .collect()
}

/// Whether a point lies in the picture enlarged by a margin, px, the border included.
fn is_within_margin(point: ImagePoint, size: ImageSize, margin_px: f64) -> bool {
    point.x >= -margin_px
        && point.y >= -margin_px
        && point.x <= f64::from(size.width) + margin_px
        && point.y <= f64::from(size.height) + margin_px
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::field::{Curve, builtin};
    use crate::testing::{SIZE, TestBase, base_at};
    use proptest::prelude::*;
    use proptest::test_runner::RngSeed;
    use std::collections::BTreeMap;

    fn soccer(crown_m: f64) -> FieldModel {
        builtin("soccer")
            .unwrap()
            .model(&BTreeMap::new(), crown_m)
            .unwrap()
    }

    fn camera(position_m: [f64; 3], pan: f64, tilt: f64, focal_px: f64, k1: f64) -> PtzCamera {
        base_at(position_m, SIZE).bent(k1).aim(pan, tilt, focal_px)
    }

    /// The distance from an image point to the exact projection of a curve, px: the least of all
    /// local minima, by angle (which is even where the picture is steep) and by px (which is even
    /// at the fold).
    fn distance_px(
        field: &FieldModel,
        camera: &PtzCamera,
        curve: &Curve,
        point: ImagePoint,
    ) -> f64 {
        const STEPS: i32 = 400;
        let direction = camera.world_direction_from_image(point).unwrap();
        let world = |t: f64| field.world_from_nominal(curve.point_at(t));
        let angle = |t: f64| {
            let ray = world(t) - camera.base().position_m;
            ray.cross(&direction).norm().atan2(ray.dot(&direction))
        };
        // Where there is no image, the angle leads to where there is one.
        let miss = |t: f64| {
            camera
                .image_from_world(world(t))
                .map_or_else(|_| 1e6 * (1.0 + angle(t)), |image| image.distance_px(point))
        };
        let refined = |mut low: f64, mut high: f64| {
            for _ in 0..60 {
                let (left, right) = (low + (high - low) / 3.0, high - (high - low) / 3.0);
                if miss(left) < miss(right) {
                    high = right;
                } else {
                    low = left;
                }
            }
            miss(low.midpoint(high))
        };
        let at = |step: i32| (f64::from(step) / f64::from(STEPS)).clamp(0.0, 1.0);
        let least = |cost: &dyn Fn(f64) -> f64| {
            let costs: Vec<_> = (-1..=STEPS + 1).map(|step| cost(at(step))).collect();
            (0..=STEPS)
                .filter(|step| {
                    let index = (step + 1) as usize;
                    costs[index] <= costs[index - 1] && costs[index] <= costs[index + 1]
                })
                .map(|step| refined(at(step - 1), at(step + 1)))
                .fold(f64::INFINITY, f64::min)
        };
        least(&angle).min(least(&miss))
    }

    fn distance_to_polylines_px<'a>(
        polylines: impl Iterator<Item = &'a MarkingPolyline>,
        point: ImagePoint,
    ) -> f64 {
        polylines
            .flat_map(|polyline| polyline.points.windows(2))
            .map(|ends| point.distance_from_segment_px(ends[0], ends[1]))
            .fold(f64::INFINITY, f64::min)
    }

    proptest! {
        #![proptest_config(ProptestConfig {
            rng_seed: RngSeed::Fixed(0x6c69_6e65),
            failure_persistence: None,
            ..ProptestConfig::with_cases(96)
        })]

        #[test]
        fn polylines_are_the_projected_lines_and_nothing_else(
            position in (-80.0..80.0f64, -80.0..80.0f64, 1.5..40.0f64),
            pan in -180.0..180.0f64, tilt in -85.0..30.0f64, focal in 5.3..9.0f64,
            k1 in prop_oneof![Just(0.0), -0.4..0.4f64], crown_m in prop_oneof![Just(0.0), -0.1..0.3f64],
        ) {
            let field = soccer(crown_m);
            let camera = camera([position.0, position.1, position.2], pan, tilt, focal.exp(), k1);
            let options = MarkingOptions::default();
            let polylines = project_lines(&field, &camera, SIZE, &options);
            let margin = options.margin_px;
            for polyline in &polylines {
                let name = &field.lines[polyline.line].id;
                prop_assert!(polyline.points.len() >= 2);
                let every = polyline.points.len() / 8 + 1;
                for (index, point) in polyline.points.iter().enumerate() {
                    prop_assert!(point.is_finite());
                    prop_assert!(point.x >= -margin && point.x <= 1920.0 + margin, "{name}: {point:?}");
                    prop_assert!(point.y >= -margin && point.y <= 1080.0 + margin, "{name}: {point:?}");
                    if index % every == 0 {
                        let off = distance_px(&field, &camera, &field.lines[polyline.line].curve, *point);
                        prop_assert!(off <= options.tolerance_px, "{name}: {point:?} is {off} px off its line");
                    }
                }
                for ends in polyline.points.windows(2).step_by(every) {
                    let middle = ends[0].translate(ends[1].offset_from(ends[0]) / 2.0);
                    let off = distance_px(&field, &camera, &field.lines[polyline.line].curve, middle);
                    prop_assert!(off <= options.tolerance_px, "{name}: halfway to {:?} it is {off} px off", ends[1]);
                }
            }
            for (line, of) in field.lines.iter().enumerate() {
                for step in 0..=300 {
                    let world = field.world_from_nominal(of.curve.point_at(f64::from(step) / 300.0));
                    let in_cam = camera.cam_from_world_point(world);
                    let ideal = in_cam.xy().norm() / in_cam.z;
                    let Ok(image) = camera.image_from_cam(in_cam) else { continue };
                    if in_cam.z < 0.06 || ideal > 0.999 * camera.fold_radius() || !SIZE.contains(image) {
                        continue;
                    }
                    let mine = polylines.iter().filter(|polyline| polyline.line == line);
                    let off = distance_to_polylines_px(mine, image);
                    prop_assert!(off <= options.tolerance_px, "{} is missing at {image:?}: {off} px", of.id);
                }
            }
        }
    }

    #[test]
    fn a_tight_view_of_one_spot_misses_no_line() {
        // 2 m of a 105 m touchline fill the picture.
        let field = soccer(0.1);
        let camera = camera([0.0, -60.0, 18.0], 20.0, -30.0, 40_000.0, 0.0);
        let seen = camera
            .plane_from_image(SIZE.centre(), field.ground_z(-34.0))
            .unwrap();
        assert!(
            (seen.y + 34.0).abs() < 6.0,
            "the view is near the touchline: {seen}"
        );
        let tilt = (18.0 + 0.1_f64)
            .atan2(26.0 / 20.0_f64.to_radians().cos())
            .to_degrees();
        let camera = camera.base().aim(20.0, -tilt, 40_000.0);
        let polylines = project_lines(&field, &camera, SIZE, &MarkingOptions::default());
        assert_eq!(polylines.len(), 1);
        assert_eq!(field.lines[polylines[0].line].id.as_str(), "touchline_near");
    }

    #[test]
    fn a_camera_looking_away_sees_nothing() {
        let away = camera([0.0, -60.0, 18.0], 180.0, -10.0, 2000.0, -0.1);
        assert_eq!(
            project_lines(&soccer(0.0), &away, SIZE, &MarkingOptions::default()),
            []
        );
        let broken = camera([f64::NAN, -60.0, 18.0], 0.0, -10.0, 2000.0, 0.0);
        assert_eq!(
            project_lines(&soccer(0.0), &broken, SIZE, &MarkingOptions::default()),
            []
        );
        let beyond_numbers = camera([1e308, -1e308, 1e308], 0.0, -10.0, 2000.0, 0.3);
        assert_eq!(
            project_lines(
                &soccer(0.1),
                &beyond_numbers,
                SIZE,
                &MarkingOptions::default()
            ),
            []
        );
    }

    #[test]
    fn a_circle_within_the_picture_is_one_closed_polyline() {
        let field = soccer(0.0);
        let camera = camera([0.0, -60.0, 18.0], 0.0, -16.5, 2000.0, 0.0);
        let polylines = project_lines(&field, &camera, SIZE, &MarkingOptions::default());
        let circle = field
            .lines
            .iter()
            .position(|line| line.id.as_str() == "centre_circle")
            .unwrap();
        let of_circle: Vec<_> = polylines
            .iter()
            .filter(|polyline| polyline.line == circle)
            .collect();
        assert_eq!(of_circle.len(), 1);
        let points = &of_circle[0].points;
        assert!(points[0].distance_px(points[points.len() - 1]) < 1e-9);
        assert!(points.len() < 300, "{} points", points.len());
    }
}
