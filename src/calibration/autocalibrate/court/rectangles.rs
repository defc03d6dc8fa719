//! Cameras that show two pairs of parallel lines of the field as two pairs of lines of a picture.
//!
//! Two lines along the length of a field and two across it are a rectangle. Its picture gives a
//! homography, and this a camera, if there is one with square pixels: of the two equations for the
//! focal length one is left over, which nearly all wrong assignments fail.

use super::grid::Grid;
use super::may_stand_at;
use super::shown_lines::ShownLines;
use rayon::prelude::*;
use touchline_core::camera::Radial;
use touchline_core::field::FieldModel;
use touchline_core::geometry::{Angle, ImagePoint, Mat3, Vec2, Vec3};
use touchline_core::solve::PlanePose;
use touchline_vision::paint::StraightLine;

/// Focal lengths of sports cameras, in widths of a 16:9 picture.
const FOCAL_WIDTHS: [f64; 2] = [0.4, 8.0];

/// The left-over equation: the largest cosine between the axes of the field, and the largest
/// difference of their lengths, as a share.
const MAX_COS: f64 = 0.06;
const MAX_STRETCH: f64 = 0.06;

/// Cameras of sports stand upright.
const MAX_ROLL: Angle = Angle::from_degrees(10.0);

/// Lines of different directions cross under at least this angle.
const MIN_CROSSING: Angle = Angle::from_degrees(8.0);

/// Parallel lines are apart by at least this in the picture, and the corners of a rectangle lie at
/// most so far outside it, in widths of a 16:9 picture.
const MIN_APART_WIDTHS: f64 = 0.015;
const MAX_OUTSIDE_WIDTHS: f64 = 1.0;

/// A rectangle of the field: its corners' coordinates, m. The second y may be the smaller one.
struct FieldRectangle {
    x: [f64; 2],
    y: [f64; 2],
}

/// All cameras that show some rectangle of the field where lines of the picture are, each with a
/// score by `score_of`; those without one are left out. Of cameras that half a turn of the field
/// makes alike, one.
pub fn cameras_of_rectangles<T: Send>(
    shown: &ShownLines<'_>,
    score_of: impl Fn(&PlanePose) -> Option<T> + Sync,
) -> Vec<(PlanePose, T)> {
    let lines = shown.lines;
    let centre = (shown.principal_point(), shown.lens.pixels());
    let (field, rectangles) = (shown.field, field_rectangles(shown.grid));
    let unit_px = shown.size.reference_width_px();
    let pairs: Vec<[usize; 2]> = (0..lines.len())
        .flat_map(|one| (one + 1..lines.len()).map(move |other| [one, other]))
        .collect();
    pairs
        .par_iter()
        .flat_map_iter(|&along| {
            let (pairs, rectangles, score_of) = (&pairs, &rectangles, &score_of);
            pairs
                .iter()
                .filter(move |across| across.iter().all(|line| !along.contains(line)))
                .filter_map(move |across| {
                    let of = |pair: [usize; 2]| pair.map(|line| &lines[line]);
                    PictureRectangle::new(of(along), of(*across), centre, unit_px)
                })
                .flat_map(move |picture| {
                    rectangles.iter().filter_map(move |rectangle| {
                        let pose = picture.camera(field, rectangle, unit_px)?;
                        let score = score_of(&pose)?;
                        Some((pose, score))
                    })
                })
        })
        .collect()
}

/// Every rectangle of lines of the field, with y in either order: which of two lines of the picture
/// is which is not known. In x one order is enough, as half a turn exchanges both.
fn field_rectangles(grid: &Grid) -> Vec<FieldRectangle> {
    let [x, y] = grid.levels_m();
    let pairs = |levels: &[f64]| -> Vec<[f64; 2]> {
        let above = |from: usize| levels[from + 1..].iter().map(move |to| (from, *to));
        (0..levels.len())
            .flat_map(above)
            .map(|(from, to)| [levels[from], to])
            .collect()
    };
    let (x, y) = (pairs(&x), pairs(&y));
    x.iter()
        .flat_map(|&x| {
            y.iter().flat_map(move |&[from, to]| {
                [[from, to], [to, from]].map(|y| FieldRectangle { x, y })
            })
        })
        .collect()
}

/// Two lines of a picture that may run along the field's length, and two that may run across it.
struct PictureRectangle {
    /// The homography of the unit square, with the principal point as origin and the width of a
    /// 16:9 picture as unit.
    from_square: Mat3,
}

impl PictureRectangle {
    /// None where the lines make no rectangle that a camera may see.
    fn new(
        along: [&StraightLine; 2],
        across: [&StraightLine; 2],
        (principal_point, pixels): (ImagePoint, Radial),
        unit_px: f64,
    ) -> Option<Self> {
        // The crossing of each line along with each across: u runs along, v across.
        let mut corners = [[Vec2::zeros(); 2]; 2];
        for (v, along) in along.into_iter().enumerate() {
            for (u, across) in across.into_iter().enumerate() {
                let offset = crossing(along, across)?.offset_from(principal_point);
                let corner = pixels.square_from_pixels(offset) / unit_px;
                if corner.norm() > MAX_OUTSIDE_WIDTHS {
                    return None;
                }
                corners[v][u] = corner;
            }
        }
        let sides = [
            corners[0][1] - corners[0][0],
            corners[1][1] - corners[1][0],
            corners[1][0] - corners[0][0],
            corners[1][1] - corners[0][1],
        ];
        if sides.iter().any(|side| side.norm() < MIN_APART_WIDTHS) {
            return None;
        }
        let from_square = square_to(corners)?;
        Some(Self { from_square })
    }

    /// The camera that shows a rectangle of the field here.
    fn camera(
        &self,
        field: &FieldModel,
        of_field: &FieldRectangle,
        unit_px: f64,
    ) -> Option<PlanePose> {
        let [u, v, origin] = [0, 1, 2].map(|column| Vec3::from(self.from_square.column(column)));
        let [x, y] = [of_field.x, of_field.y];
        let (h1, h2) = (u / (x[1] - x[0]), v / (y[1] - y[0]));
        let h3 = origin - h1 * x[0] - h2 * y[0];

        // As in `pose_from_plane`: two equations in 1/f², by least squares.
        let orthogonal = (h1.x * h2.x + h1.y * h2.y, h1.z * h2.z);
        let flat = |h: &Vec3| h.x * h.x + h.y * h.y;
        let equal = (flat(&h1) - flat(&h2), h1.z * h1.z - h2.z * h2.z);
        let inverse_square = -(orthogonal.0 * orthogonal.1 + equal.0 * equal.1)
            / (orthogonal.0 * orthogonal.0 + equal.0 * equal.0);
        let focal = inverse_square.sqrt().recip();
        if !(FOCAL_WIDTHS[0]..FOCAL_WIDTHS[1]).contains(&focal) {
            return None;
        }
        let in_cam = |h: Vec3| Vec3::new(h.x / focal, h.y / focal, h.z);
        let [r1, r2, t] = [h1, h2, h3].map(in_cam);
        let lengths = (r1.norm(), r2.norm());
        let is_camera = r1.dot(&r2).abs() <= MAX_COS * lengths.0 * lengths.1
            && (lengths.0 / lengths.1 - 1.0).abs() <= MAX_STRETCH;
        if !is_camera {
            return None;
        }

        // The nearest rotation, without a decomposition: both axes are turned alike.
        let (x_axis, y_axis) = (r1 / lengths.0, r2 / lengths.1);
        let (sum, difference) = ((x_axis + y_axis).normalize(), (x_axis - y_axis).normalize());
        let half = std::f64::consts::FRAC_1_SQRT_2;
        let (x_axis, y_axis) = ((sum + difference) * half, (sum - difference) * half);
        let up = x_axis.cross(&y_axis);
        let cam_from_world = Mat3::from_columns(&[x_axis, y_axis, up]);
        let position_m = -(cam_from_world.transpose() * t) / f64::midpoint(lengths.0, lengths.1);
        // Above the ground, and upright: y points down in the picture.
        let roll = Angle::from_radians(up.x.atan2(-up.y));
        (may_stand_at(position_m, field) && roll.abs() <= MAX_ROLL).then_some(PlanePose {
            position_m,
            cam_from_world,
            focal_px: focal * unit_px,
        })
    }
}

/// Where two lines cross. None where they are about parallel.
fn crossing(one: &StraightLine, other: &StraightLine) -> Option<ImagePoint> {
    let sin = one.direction().dot(&other.normal);
    if sin.abs() < MIN_CROSSING.sin_cos().0 {
        return None;
    }
    Some(one.point_at(-other.across_px(one.at) / sin))
}

/// The homography of the unit square to four corners, by v and u, that keeps it in front of the
/// camera (Heckbert: "Fundamentals of Texture Mapping and Image Warping", 1989, section 2.2.3).
fn square_to(corners: [[Vec2; 2]; 2]) -> Option<Mat3> {
    let [[p00, p10], [p01, p11]] = corners;
    let (one, other, sum) = (p10 - p11, p01 - p11, p00 - p10 + p11 - p01);
    let cross = |a: Vec2, b: Vec2| a.x * b.y - a.y * b.x;
    let area = cross(one, other);
    let (g, h) = (cross(sum, other) / area, cross(one, sum) / area);
    let depths = [1.0 + g, 1.0 + h, 1.0 + g + h];
    if !depths.iter().all(|depth| *depth > 0.0) {
        return None;
    }
    let (u, v) = (p10 * (1.0 + g) - p00, p01 * (1.0 + h) - p00);
    Some(Mat3::new(u.x, v.x, p00.x, u.y, v.y, p00.y, g, h, 1.0))
}
