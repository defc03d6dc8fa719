//! Pairs of points that drawn lines show. With a position, two points give pan, tilt and focal
//! length in closed form, so these pairs are where a frame or a picture of lines starts.
//!
//! * Two or more crossings of lines, or landmarks: the pairs that determine a camera best.
//! * Else: a drawn point of each of two lines, or of one line and the one crossing, at several
//!   points of the field's lines. One of these pairs is nearly right.

use super::two_point::{OneOrTwo, solve_two_points};
use crate::camera::{CameraBase, Ptz};
use crate::field::Curve;
use crate::geometry::{farthest_pairs, subsample};
use crate::solve::Observation;
use crate::solve::observations::crossings::Crossing;
use crate::solve::observations::drawn_line::DrawnLine;
use crate::solve::observations::observation::landmark_observations;

/// Pairs of crossings that are tried, at most.
const MAX_PAIRS: usize = 4;

/// The most certain crossings, whose pairs are compared.
const MAX_CROSSINGS: usize = 16;

/// The pairs of points of lines and of their crossings, as the page of this module says.
pub(in crate::solve) fn find_pairs(
    lines: &[DrawnLine],
    crossings: &[Crossing],
) -> Vec<[Crossing; 2]> {
    let best = best_pairs(crossings);
    if best.is_empty() {
        pairs_along_lines(lines, crossings.first())
    } else {
        best
    }
}

/// The pairs of crossings that determine a camera best: far apart for their σ.
fn best_pairs(crossings: &[Crossing]) -> Vec<[Crossing; 2]> {
    let certain = &crossings[..crossings.len().min(MAX_CROSSINGS)];
    farthest_pairs(certain, MAX_PAIRS, separation_in_sigmas)
}

/// The distance of two crossings in the picture, px, over the σ of both together.
fn separation_in_sigmas([one, two]: &[Crossing; 2]) -> f64 {
    one.image.distance_px(two.image) / one.sigmas.hypot(two.sigmas)
}

/// Pairs of a drawn point of one line with one of another, each at several points of its line of
/// the field: one of the pairs is nearly right. A crossing, if there is one, stands for the first.
fn pairs_along_lines(lines: &[DrawnLine], crossing: Option<&Crossing>) -> Vec<[Crossing; 2]> {
    // The two lines with the most points; a circle, which bounds the camera from all sides, has
    // many.
    let mut by_points: Vec<&DrawnLine> = lines.iter().collect();
    by_points.sort_by_key(|line| std::cmp::Reverse(line.points.len()));
    let known: Vec<Crossing> = match (crossing, by_points.get(1)) {
        (Some(crossing), _) => vec![*crossing],
        // A drawn line has at least one point.
        (None, Some(two)) => candidates(two, two.points.len() - 1).collect(),
        (None, None) => Vec::new(),
    };
    let Some(one) = by_points.first() else {
        return Vec::new();
    };
    candidates(one, 0)
        .flat_map(|first| known.iter().map(move |second| [first, *second]))
        .collect()
}

/// A drawn point of a line at evenly spaced points of the line of the field.
fn candidates(line: &DrawnLine, index: usize) -> impl Iterator<Item = Crossing> {
    const ALONG_SEGMENT: u32 = 7;
    const ALONG_ARC: u32 = 16;
    let nominal = *line.curve.nominal();
    let count = match nominal {
        Curve::Segment { .. } => ALONG_SEGMENT,
        Curve::Arc { .. } => ALONG_ARC,
    };
    let image = line.points[index];
    (0..count).map(move |step| Crossing {
        in_world: nominal.point_at((f64::from(step) + 0.5) / f64::from(count)),
        image,
        sigmas: 1.0,
    })
}

/// The two-point cameras of a pair of points that lines show; none where there is no such camera.
pub(in crate::solve) fn solve_pair(
    base: &CameraBase,
    [one, two]: &[Crossing; 2],
) -> Option<OneOrTwo<Ptz>> {
    let worlds = [one.in_world, two.in_world];
    solve_two_points(base, worlds, [one.image, two.image]).ok()
}

/// A few observations of each line, evenly spread over its points: what ranks starts.
pub(in crate::solve) fn few_per_line(
    lines: &[DrawnLine],
    observations: &[Observation],
) -> Vec<Observation> {
    const MAX_CLICKS: usize = 4;
    let on_lines = lines
        .iter()
        .flat_map(|line| subsample(&line.indices, MAX_CLICKS))
        .map(|&index| &observations[index]);
    landmark_observations(observations)
        .chain(on_lines)
        .copied()
        .collect()
}
