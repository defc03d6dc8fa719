//! How a clicked spot looks, and which landmarks look so.
//!
//! Before anything is known of a frame but where its camera stands, a single click already says
//! something of its name: from a known place each corner and crossing of the field shows its lines
//! in directions of its own. The directions in which painted lines leave the click are read from
//! the picture; for each landmark the camera is turned so that the landmark lies under the click,
//! and the directions are compared. The focal length is open, and changes them little.

use touchline_core::camera::{CameraBase, PtzCamera};
use touchline_core::field::{FieldModel, Landmark};
use touchline_core::geometry::{Angle, ImagePoint, ImageSize, Vec2};
use touchline_core::markings::{MarkingOptions, project_lines};
use touchline_core::solve::pan_tilt_from_one_point;
use touchline_vision::media::Picture;

/// The distances from the click at which lines are looked for, px at 1920 px width: far enough for
/// a direction, and nearer than the next line of most views.
const RADII_PX: [f64; 5] = [16.0, 22.0, 28.0, 34.0, 40.0];
/// The distance at which a camera's lines are compared with them, px at 1920 px width.
const COMPARED_AT_PX: f64 = 28.0;

/// Number of directions that are tried, all around.
const DIRECTIONS: usize = 120;

/// A line is lighter than the ground at this distance on both sides of it, px at 1920 px width, by
/// at least this number of grey levels.
const BESIDE_PX: f64 = 7.0;
const LEAST_CONTRAST: f64 = 10.0;
/// More contrast makes no line likelier, grey levels.
const CLEAR_CONTRAST: f64 = 40.0;

/// Paint may lie beside the click by this, px at 1920 px width.
const CLICK_OFF_PX: f64 = 4.0;

/// Lines whose directions are nearer to each other are one; those of picture and camera that are
/// nearer are the same line.
const SAME_LINE: Angle = Angle::from_degrees(20.0);

/// The largest number of lines that leave a spot of a field.
const MOST_LINES: usize = 4;

/// Focal lengths that are tried, in widths of the picture: ordinary views of a broadcast.
const FOCAL_WIDTHS: [f64; 4] = [0.8, 1.3, 2.2, 3.6];

/// The directions in which painted lines leave a spot of a picture.
#[derive(Clone, Debug, PartialEq)]
pub struct CornerLooks {
    /// From +x (right) towards +y (down).
    directions: Vec<Angle>,
}

impl CornerLooks {
    /// Reads them from a picture, around a point that may lie some pixels beside the paint.
    pub fn from_picture(picture: &Picture, click: ImagePoint) -> Self {
        let scale = picture.size().scale_from_1920();
        let steps = [-1.0, -0.5, 0.0, 0.5, 1.0].map(|step| step * CLICK_OFF_PX * scale);
        let places = steps
            .into_iter()
            .flat_map(|x| steps.map(|y| Vec2::new(x, y)));
        let found = places.map(|off| strongest_lines(picture, click.translate(off), scale));
        let total = |lines: &Vec<(Angle, f64)>| -> f64 {
            lines
                .iter()
                .map(|(_, contrast)| contrast.min(CLEAR_CONTRAST))
                .sum()
        };
        let best = found.max_by(|one, other| total(one).total_cmp(&total(other)));
        let lines = best.unwrap_or_default();
        Self {
            directions: lines.into_iter().map(|(direction, _)| direction).collect(),
        }
    }

    /// How unlike a landmark of a field looks from a base, 0 for the same: the number of lines that
    /// only one of the two has, and the angles between the others in units of [`SAME_LINE`]. None
    /// if nothing is seen, or the camera cannot be turned so.
    pub(super) fn unlikeness(
        &self,
        field: &FieldModel,
        landmark: &Landmark,
        base: &CameraBase,
        image_size: ImageSize,
        click: ImagePoint,
    ) -> Option<f64> {
        if self.directions.is_empty() {
            return None;
        }
        let place = field.landmark_in_world(landmark);
        let cameras = FOCAL_WIDTHS.into_iter().filter_map(|widths| {
            let focal_px = widths * f64::from(image_size.width);
            pan_tilt_from_one_point(base, focal_px, place, click).ok()
        });
        cameras
            .map(|ptz| {
                let camera = PtzCamera::new(*base, ptz);
                self.unlike(&drawn_directions(field, &camera, image_size, click))
            })
            .min_by(f64::total_cmp)
    }

    /// How unlike these directions are, each line taken once.
    fn unlike(&self, drawn: &[Angle]) -> f64 {
        let mut open = drawn.to_vec();
        let mut unlike = 0.0;
        for seen in &self.directions {
            let angles = open.iter().map(|drawn| drawn.turn_from(*seen).abs());
            let nearest = angles
                .enumerate()
                .min_by(|a, b| a.1.radians().total_cmp(&b.1.radians()));
            match nearest.filter(|(_, turn)| turn.radians() < SAME_LINE.radians()) {
                Some((index, turn)) => {
                    open.swap_remove(index);
                    unlike += turn.radians() / SAME_LINE.radians();
                }
                None => unlike += 1.0,
            }
        }
        unlike + open.len() as f64
    }
}

/// The lines that leave a point, each with its contrast, the clearest first.
fn strongest_lines(picture: &Picture, at: ImagePoint, scale: f64) -> Vec<(Angle, f64)> {
    let mut lines: Vec<(Angle, f64)> = (0..DIRECTIONS)
        .map(|step| {
            let direction = Angle::from_degrees(360.0 * step as f64 / DIRECTIONS as f64);
            (direction, contrast_along(picture, at, direction, scale))
        })
        .filter(|(_, contrast)| *contrast >= LEAST_CONTRAST)
        .collect();
    lines.sort_by(|(_, one), (_, other)| other.total_cmp(one));
    let mut kept: Vec<(Angle, f64)> = Vec::new();
    for line in lines {
        let is_new = kept
            .iter()
            .all(|known| known.0.turn_from(line.0).abs().radians() >= SAME_LINE.radians());
        if is_new && kept.len() < MOST_LINES {
            kept.push(line);
        }
    }
    kept
}

/// How much lighter a ray from a point is than the ground on both sides of it, grey levels: the
/// second least of all distances, since a player may stand on one.
fn contrast_along(picture: &Picture, from: ImagePoint, direction: Angle, scale: f64) -> f64 {
    let along = Vec2::new(direction.radians().cos(), direction.radians().sin());
    let aside = Vec2::new(-along.y, along.x) * (BESIDE_PX * scale);
    let mut contrasts = RADII_PX.map(|radius_px| {
        let at = from.translate(along * (radius_px * scale));
        let beside = [at.translate(aside), at.translate(-aside)].map(|at| grey(picture, at));
        match (grey(picture, at), beside) {
            (Some(line), [Some(left), Some(right)]) => line - left.max(right),
            _ => f64::NEG_INFINITY,
        }
    });
    contrasts.sort_by(f64::total_cmp);
    contrasts[1]
}

/// The grey level of the pixel at a point; none outside.
fn grey(picture: &Picture, at: ImagePoint) -> Option<f64> {
    let is_inside = at.x >= 0.0 && at.y >= 0.0;
    let [red, green, blue, _] = picture
        .pixel(at.x as u32, at.y as u32)
        .filter(|_| is_inside)?;
    Some(f64::from(u32::from(red) + u32::from(green) + u32::from(blue)) / 3.0)
}

/// The directions in which a camera's painted lines leave a point.
fn drawn_directions(
    field: &FieldModel,
    camera: &PtzCamera,
    image_size: ImageSize,
    at: ImagePoint,
) -> Vec<Angle> {
    let radius_px = COMPARED_AT_PX * image_size.scale_from_1920();
    let drawn = project_lines(field, camera, image_size, &MarkingOptions::default());
    let painted = drawn.iter().filter(|drawn| field.lines[drawn.line].painted);
    let mut directions: Vec<Angle> = Vec::new();
    for ends in painted.flat_map(|drawn| drawn.points.windows(2)) {
        let [from, to] = [ends[0], ends[1]].map(|end| end.offset_from(at));
        for crossing in circle_crossings(from, to, radius_px) {
            let direction = Angle::from_radians(crossing.y.atan2(crossing.x));
            let apart = |known: &Angle| known.turn_from(direction).abs().radians();
            // Two lines may share a stretch, and one that ends on the circle is met twice.
            if directions
                .iter()
                .all(|known| apart(known) >= 0.5 * SAME_LINE.radians())
            {
                directions.push(direction);
            }
        }
    }
    directions
}

/// Where a segment crosses a circle about the origin: the solutions of |a + s d| = r with
/// 0 ≤ s ≤ 1.
fn circle_crossings(from: Vec2, to: Vec2, radius: f64) -> impl Iterator<Item = Vec2> {
    let along = to - from;
    let (square, half) = (along.norm_squared(), from.dot(&along));
    let root = (half.powi(2) - square * (from.norm_squared() - radius.powi(2))).sqrt();
    // Without a crossing the root is no number, and neither share lies within the segment.
    let shares = [-1.0, 1.0].map(|sign| (sign * root - half) / square);
    let within = shares
        .into_iter()
        .filter(|share| (0.0..=1.0).contains(share));
    within.map(move |share| from + along * share)
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::collections::BTreeMap;
    use touchline_core::field::builtin;
    use touchline_core::testing::{SIZE, TestBase as _, base_at};

    /// A picture of green ground with a camera's painted lines, 5 px wide.
    fn draw(field: &FieldModel, camera: &PtzCamera) -> Picture {
        let mut rgba = [40, 110, 50, 255].repeat((SIZE.width * SIZE.height) as usize);
        let drawn = project_lines(field, camera, SIZE, &MarkingOptions::default());
        for ends in drawn.iter().flat_map(|drawn| drawn.points.windows(2)) {
            let along = ends[1].offset_from(ends[0]);
            let steps = (2.0 * along.norm()).ceil().max(1.0);
            for step in 0..=steps as usize {
                let at = ends[0].translate(along * (step as f64 / steps));
                for (dx, dy) in (-2..=2).flat_map(|x| (-2..=2).map(move |y| (x, y))) {
                    let (x, y) = (at.x as i64 + dx, at.y as i64 + dy);
                    if (0..i64::from(SIZE.width)).contains(&x)
                        && (0..i64::from(SIZE.height)).contains(&y)
                    {
                        let pixel = 4 * (y as usize * SIZE.width as usize + x as usize);
                        rgba[pixel..pixel + 3].copy_from_slice(&[230, 235, 230]);
                    }
                }
            }
        }
        Picture::new(SIZE, rgba).unwrap()
    }

    #[test]
    fn the_clicked_corner_is_among_the_three_names_that_look_most_like_it() {
        let field = builtin("soccer")
            .unwrap()
            .model(&BTreeMap::new(), 0.0)
            .unwrap();
        let base = base_at([0.0, -66.0, 18.0], SIZE);
        let views = [
            ("penalty_area_far_left_front", -24.0),
            ("penalty_area_near_right_front", 36.0),
            ("corner_far_left", -29.0),
            ("halfway_far", 1.0),
        ];
        for (id, pan_deg) in views {
            let landmark = field.landmark(id).unwrap();
            let camera = base.aim(pan_deg, -13.0, 2100.0);
            let exact = camera.image_from_world(landmark.nominal_m).unwrap();
            assert!(SIZE.contains(exact), "{id}: {exact:?}");
            let click = exact.translate(Vec2::new(2.0, -1.0));
            let looks = CornerLooks::from_picture(&draw(&field, &camera), click);
            let mut ranked: Vec<(&str, f64)> = field
                .landmarks
                .iter()
                .filter(|other| !other.is_unmarked)
                .filter_map(|other| {
                    let unlike = looks.unlikeness(&field, other, &base, SIZE, click)?;
                    Some((other.id.as_str(), unlike))
                })
                .collect();
            ranked.sort_by(|one, other| one.1.total_cmp(&other.1));
            let place = ranked.iter().position(|(other, _)| *other == id);
            assert!(
                place.is_some_and(|place| place < 3),
                "{id}: {place:?} of {ranked:.2?}"
            );
        }
    }

    #[test]
    fn bare_ground_looks_like_nothing() {
        let rgba = [40, 110, 50, 255].repeat((SIZE.width * SIZE.height) as usize);
        let picture = Picture::new(SIZE, rgba).unwrap();
        for click in [
            SIZE.centre(),
            ImagePoint::new(1.0, 1.0),
            ImagePoint::new(-50.0, 9e9),
        ] {
            assert_eq!(CornerLooks::from_picture(&picture, click).directions, []);
        }
    }
}
