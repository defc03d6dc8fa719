//! Cycle consistency of pairwise matches: the homography between two frames should agree with the
//! one composed over a third frame.

use super::ViewGraphEdge;
use super::view_graph_edge::brought;
use std::collections::BTreeMap;
use touchline_core::geometry::{ImagePoint, ImageSize, Mat3, Vec3};

/// A direct and a composed homography agree within this distance, px at 1920 px width. It is loose,
/// because a homography from a narrow overlap is uncertain far from it.
const AGREE_PX: f64 = 120.0;

/// A pairwise match is dropped if at least [`MIN_WAYS`] frames lead around it and a smaller share
/// than this agrees with it.
const MIN_SHARE: f64 = 0.34;
const MIN_WAYS: i32 = 2;

/// The pairwise matches that the others do not contradict.
pub(super) fn cycle_consistent_edges(
    edges: &[ViewGraphEdge],
    size: ImageSize,
) -> Vec<ViewGraphEdge> {
    // Homographies in both directions, and the neighbours of each frame in the view graph. A match
    // without points or with a singular homography is in neither, and is dropped below.
    let mut between: BTreeMap<(usize, usize), Mat3> = BTreeMap::new();
    let mut beside: BTreeMap<usize, Vec<usize>> = BTreeMap::new();
    for edge in edges {
        let Some(&(here, there)) = edge.matches.first() else {
            continue;
        };
        let Some(first_from_second) = edge.second_from_first.try_inverse() else {
            continue;
        };
        between.insert(
            (edge.first, edge.second),
            ahead_at(edge.second_from_first, here),
        );
        between.insert(
            (edge.second, edge.first),
            ahead_at(first_from_second, there),
        );
        beside.entry(edge.first).or_default().push(edge.second);
        beside.entry(edge.second).or_default().push(edge.first);
    }
    edges
        .iter()
        .filter(|edge| is_cycle_consistent(edge, &between, &beside, size))
        .cloned()
        .collect()
}

/// Whether enough of the compositions over a common neighbour agree with the direct homography of a
/// pairwise match.
fn is_cycle_consistent(
    edge: &ViewGraphEdge,
    between: &BTreeMap<(usize, usize), Mat3>,
    beside: &BTreeMap<usize, Vec<usize>>,
    size: ImageSize,
) -> bool {
    let Some(direct) = between.get(&(edge.first, edge.second)) else {
        return false;
    };
    // The homography to a third frame, and from there to the second one, is the direct one if all
    // three are right. The neighbours of the first frame are tried as the third.
    let agree_px = AGREE_PX * size.scale_from_1920();
    let (mut ways, mut agreeing) = (0, 0);
    for third in beside.get(&edge.first).into_iter().flatten() {
        let (Some(there), Some(on)) = (
            between.get(&(edge.first, *third)),
            between.get(&(*third, edge.second)),
        ) else {
            continue;
        };
        if let Some(apart_px) = apart_px(direct, &(on * there), size) {
            ways += 1;
            agreeing += i32::from(apart_px < agree_px);
        }
    }
    // A match that too few others can contradict stays.
    ways < MIN_WAYS || f64::from(agreeing) >= MIN_SHARE * f64::from(ways)
}

/// Fixes the sign of a homography so that a point it was estimated from lies in front of the
/// camera. An estimated homography has an arbitrary sign.
fn ahead_at(homography: Mat3, at: ImagePoint) -> Mat3 {
    if (homography * Vec3::new(at.x, at.y, 1.0)).z < 0.0 {
        -homography
    } else {
        homography
    }
}

/// The distance between the images of points under two homographies, px: the second smallest of
/// four test points, because two frames may overlap in a part only. `None` if fewer than two of the
/// points lie in front of the second camera under both.
fn apart_px(one: &Mat3, other: &Mat3, size: ImageSize) -> Option<f64> {
    let (width, height) = (f64::from(size.width), f64::from(size.height));
    let mut distances: Vec<f64> = [(0.25, 0.4), (0.75, 0.4), (0.25, 0.7), (0.75, 0.7)]
        .into_iter()
        .filter_map(|(x, y)| {
            let at = ImagePoint::new(x * width, y * height);
            Some(brought(one, at)?.distance_px(brought(other, at)?))
        })
        .collect();
    distances.sort_by(f64::total_cmp);
    distances.get(1).copied()
}
