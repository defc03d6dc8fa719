//! Landmarks that drawn lines show: where they cross, and where they end.
//!
//! A *crossing* of two drawn lines shows where the field's lines, extended, meet. Two crossings and
//! a position give a camera in closed form, so the starts come from them (`starts.rs`); they are no
//! measurements of their own.
//!
//! An *end* of a drawn line is one. Two lines that cross at a shallow angle in the picture may both
//! be fitted within a pixel while their crossing is ten pixels off along them. But people draw a
//! line up to where it ends on the field: at a corner, or at the line that it meets. A drawn end on
//! another line is therefore an observation of the field line's own end, which is known.

use super::drawn_line::{DrawnLine, StraightLine};
use crate::field::Curve;
use crate::geometry::{ImagePoint, ImageSize, Vec3};
use crate::solve::{Observation, ObservedShape};

/// A point of the field, `world`, m, and the pixel that shows it.
#[derive(Clone, Copy, Debug)]
pub(in crate::solve) struct Crossing {
    pub in_world: Vec3,
    pub image: ImagePoint,
    /// 1-σ of the pixel in its worst direction, as a multiple of that of a drawn point.
    pub sigmas: f64,
}

/// A crossing less certain than this is no start, as a multiple of the 1-σ of a drawn point.
const MAX_CROSSING_SIGMAS: f64 = 30.0;

/// 1-σ of a drawn end about the end of the field's line, as a multiple of that of a drawn point
/// across its line.
const END_SIGMAS: f64 = 2.5;

/// A drawn end this near to another line, in sigmas of a drawn point, is where the two meet.
const MEETS_SIGMAS: f64 = 6.0;

/// An end nearer than this to the picture's border is where the line leaves the picture, as a share
/// of the picture's width: 4 px of 960.
const BORDER_SHARE: f64 = 4.0 / 960.0;

/// Curves of the field nearer to each other than this meet, m.
const MEETS_M: f64 = 1e-3;

/// The landmarks that were clicked, and the crossings of the straight lines; the most certain
/// first.
pub(in crate::solve) fn find_crossings(
    lines: &[DrawnLine],
    observations: &[Observation],
) -> Vec<Crossing> {
    let mut found: Vec<Crossing> = observations.iter().filter_map(clicked_landmark).collect();
    let straight = straight_lines(lines);
    for (index, (line, fit)) in straight.iter().enumerate() {
        for (other, other_fit) in &straight[index + 1..] {
            found.extend(crossing((line, fit), (other, other_fit)));
        }
    }
    found.sort_by(|a, b| a.sigmas.total_cmp(&b.sigmas));
    found
}

/// A landmark that was clicked, as certain as one drawn point; none for a click on a line.
fn clicked_landmark(observation: &Observation) -> Option<Crossing> {
    Some(Crossing {
        in_world: observation.shape.point()?,
        image: observation.image,
        sigmas: 1.0,
    })
}

/// The straight lines with what was fitted to their points.
fn straight_lines(lines: &[DrawnLine]) -> Vec<(&DrawnLine, StraightLine)> {
    lines
        .iter()
        .filter_map(|line| Some((line, line.straight()?)))
        .collect()
}

/// Where two drawn lines cross; none where those of the field do not, or not certainly enough.
fn crossing(
    (one, one_fit): (&DrawnLine, &StraightLine),
    (other, other_fit): (&DrawnLine, &StraightLine),
) -> Option<Crossing> {
    let in_world = meeting_point(one.curve.nominal(), other.curve.nominal())?;
    let image = one_fit.crossing(other_fit)?;
    // Each fitted line is a strip as wide as its σ there, which grows away from its points. The
    // crossing of two strips that cross at a small angle is long along them.
    let sine = one_fit.along.perp(&other_fit.along).abs();
    let sigmas = one_fit.sigma_at(image).hypot(other_fit.sigma_at(image)) / sine;
    (sigmas < MAX_CROSSING_SIGMAS).then_some(Crossing {
        in_world,
        image,
        sigmas,
    })
}

/// Where two straight lines of the field, extended, meet; none where they are parallel or pass each
/// other.
fn meeting_point(one: &Curve, other: &Curve) -> Option<Vec3> {
    /// The squared sine below which lines count as parallel.
    const PARALLEL: f64 = 1e-6;
    let (Curve::Segment { from: a, to: b }, Curve::Segment { from: c, to: d }) = (one, other)
    else {
        return None;
    };
    // The points of both lines nearest to each other: a + s u with s = ((c − a) × v) · n / |n|²,
    // n = u × v. The distance of the lines is (c − a) · n / |n|.
    let (u, v) = (b - a, d - c);
    let normal = u.cross(&v);
    let squared = normal.norm_squared();
    if !(squared > PARALLEL * u.norm_squared() * v.norm_squared()) {
        return None;
    }
    let apart_m = (c - a).dot(&normal) / squared.sqrt();
    let share = (c - a).cross(&v).dot(&normal) / squared;
    (apart_m.abs() < MEETS_M).then(|| a + u * share)
}

/// Observations of the ends of the field's lines that drawn ends show.
pub(in crate::solve) fn find_ends(lines: &[DrawnLine], size: ImageSize) -> Vec<Observation> {
    let straight = straight_lines(lines);
    let mut ends = Vec::new();
    for (line, fit) in &straight {
        let Some(of_field) = line.segment() else {
            continue;
        };
        for (parameter, end_m) in [0.0, 1.0].into_iter().zip(of_field) {
            // Other drawn lines, of which the field's own line passes through this end.
            let met = straight.iter().filter(|(other, _)| {
                other.curve != line.curve && other.curve.nominal().distance_m(end_m) < MEETS_M
            });
            // The drawn end has to lie on one of them, or the line was not drawn up to its end; at
            // the border it only leaves the picture.
            let nearest = met
                .filter_map(|(_, other)| end_at(fit, other))
                .filter(|(end, off_px)| {
                    *off_px < MEETS_SIGMAS * line.sigma_px && is_inside(*end, size)
                })
                .min_by(|a, b| a.1.total_cmp(&b.1));
            // Without an element: an end has no name of its own.
            if let Some((image, _)) = nearest {
                ends.push(Observation {
                    image,
                    sigma_px: END_SIGMAS * line.sigma_px,
                    element: None,
                    shape: ObservedShape::Point(line.curve.point_at(parameter)),
                    click: line.indices[0],
                    check: false,
                });
            }
        }
    }
    ends
}

/// The end of a drawn line that is nearer to its crossing with another one, and the end's distance
/// from that one, px.
fn end_at(line: &StraightLine, other: &StraightLine) -> Option<(ImagePoint, f64)> {
    // The fitted direction has either sign, so which drawn end is which end of the field's line is
    // decided by the crossing.
    let crossing = line.crossing(other)?;
    let [first, last] = line.ends;
    let end = if first.distance_px(crossing) <= last.distance_px(crossing) {
        first
    } else {
        last
    };
    Some((end, other.distance_px(end)))
}

/// Whether a point lies in the picture and not at its border.
fn is_inside(point: ImagePoint, size: ImageSize) -> bool {
    let (width, height) = (f64::from(size.width), f64::from(size.height));
    let border_px = BORDER_SHARE * width;
    (border_px..width - border_px).contains(&point.x)
        && (border_px..height - border_px).contains(&point.y)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::testing::soccer;

    const SIZE: ImageSize = ImageSize::new(960, 540);

    fn observations(points: &[(&str, [f64; 2])]) -> Vec<Observation> {
        let field = soccer();
        let observation = |(click, (name, at)): (usize, &(&str, [f64; 2]))| {
            Observation::from_line(&field, name, ImagePoint::from(*at), SIZE, click).unwrap()
        };
        points.iter().enumerate().map(observation).collect()
    }

    #[test]
    fn lines_cross_where_those_of_the_field_meet_on_the_ground_and_above_it() {
        let drawn = observations(&[
            ("touchline_far", [100.0, 100.0]),
            ("touchline_far", [500.0, 100.0]),
            ("goal_line_right", [600.0, 120.0]),
            ("goal_line_right", [700.0, 220.0]),
            // Parallel to the touchline on the field: no crossing.
            ("penalty_area_right_far", [300.0, 200.0]),
            ("penalty_area_right_far", [680.0, 200.0]),
            ("crossbar_right", [720.0, 150.0]),
            ("crossbar_right", [820.0, 160.0]),
            ("post_near_right", [820.0, 160.0]),
            ("post_near_right", [820.0, 260.0]),
        ]);
        let found = find_crossings(&DrawnLine::group(&drawn), &drawn);
        let at = |x: f64, y: f64, z: f64| {
            let there =
                |crossing: &&Crossing| (crossing.in_world - Vec3::new(x, y, z)).norm() < 1e-6;
            found.iter().find(there).map(|crossing| crossing.image)
        };
        // Touchline and goal line cross beyond both: y = 100 at x = 580.
        let corner = at(52.5, 34.0, 0.0).unwrap();
        assert!(
            corner.distance_px(ImagePoint::new(580.0, 100.0)) < 1e-6,
            "{corner:?}"
        );
        let top = at(52.5, -3.66, 2.44).unwrap();
        assert!(
            top.distance_px(ImagePoint::new(820.0, 160.0)) < 1e-6,
            "{top:?}"
        );
        // The near post stands on the goal line; the crossbar passes above the touchline.
        assert!(at(52.5, -3.66, 0.0).is_some());
        assert_eq!(found.len(), 4, "{found:?}");
        assert!(found.is_sorted_by_key(|crossing| crossing.sigmas));
    }

    #[test]
    fn an_end_on_another_line_is_the_end_of_the_fields_line_and_one_at_the_border_is_not() {
        let drawn = observations(&[
            ("goal_line_right", [600.0, 120.0]),
            ("goal_line_right", [700.0, 220.0]),
            // Ends two px before the goal line; the other end is at the picture's border.
            ("penalty_area_right_far", [1.0, 180.0]),
            ("penalty_area_right_far", [657.0, 180.0]),
            // Ends far from the goal line.
            ("goal_area_right_far", [400.0, 210.0]),
            ("goal_area_right_far", [600.0, 210.0]),
        ]);
        let ends = find_ends(&DrawnLine::group(&drawn), SIZE);
        let [end] = ends.as_slice() else {
            panic!("{ends:?}");
        };
        assert_eq!(end.image, ImagePoint::new(657.0, 180.0));
        let expected = Vec3::new(52.5, 20.16, 0.0);
        let off_m = end.shape.point().unwrap() - expected;
        assert!(off_m.norm() < 1e-9, "{end:?}");
        assert!((end.sigma_px / drawn[0].sigma_px - END_SIGMAS).abs() < 1e-12);
    }
}
