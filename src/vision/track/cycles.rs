//! Cycle consistency of pairwise matches: the homography between two frames should agree with the
//! one composed over a third frame.

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

/// The connected components of `count` frames under pairwise matches, the largest first, each
/// ascending; a frame without a match is a component of its own.
pub fn groups(count: usize, edges: &[ViewGraphEdge]) -> Vec<Vec<usize>> {
    // Union–find; the root of a component is its smallest frame, so that the result does not depend
    // on the order of the edges.
    let mut group_of: Vec<usize> = (0..count).collect();
    for edge in edges {
        let (one, other) = (
            root(&mut group_of, edge.first),
            root(&mut group_of, edge.second),
        );
        group_of[one.max(other)] = one.min(other);
    }
    let mut groups: Vec<Vec<usize>> = vec![Vec::new(); count];
    for frame in 0..count {
        let of = root(&mut group_of, frame);
        groups[of].push(frame);
    }
    groups.retain(|group| !group.is_empty());
    groups.sort_by_key(|group| (std::cmp::Reverse(group.len()), group[0]));
    groups
}

/// The root of a frame's component, with path halving.
fn root(group_of: &mut [usize], mut frame: usize) -> usize {
    while group_of[frame] != frame {
        group_of[frame] = group_of[group_of[frame]];
        frame = group_of[frame];
    }
    frame
}

/// Point correspondences of two frames of one camera, and the homography that they agree on.
#[derive(Clone, Debug, PartialEq)]
pub struct ViewGraphEdge {
    /// The first frame, as an index into the frames that were matched.
    pub first: usize,
    /// The second frame, likewise.
    pub second: usize,
    /// The same point in the first and in the second frame, px.
    pub matches: Vec<(ImagePoint, ImagePoint)>,
    /// Number of inliers before the matches were subsampled.
    pub agreeing: usize,
    /// The homography from the first to the second frame, px.
    pub second_from_first: Mat3,
}

/// Maps a point by a homography; `None` if it lies behind the second camera.
pub(super) fn brought(to_from: &Mat3, at: ImagePoint) -> Option<ImagePoint> {
    let there = to_from * Vec3::new(at.x, at.y, 1.0);
    (there.z > 0.0).then(|| ImagePoint::new(there.x / there.z, there.y / there.z))
}

/// Zoom and image rotation, degrees, of a homography at a point. `None` if the map reverses
/// orientation there.
pub(super) fn zoom_and_turn(second_from_first: &Mat3, at: ImagePoint) -> Option<(f64, f64)> {
    // The image (x, y) of the point, dehomogenised by w. A homography has no sign: w may be
    // negative, and x, y and the Jacobian are the same for H and −H.
    let h = second_from_first;
    let w = h[(2, 0)] * at.x + h[(2, 1)] * at.y + h[(2, 2)];
    let x = (h[(0, 0)] * at.x + h[(0, 1)] * at.y + h[(0, 2)]) / w;
    let y = (h[(1, 0)] * at.x + h[(1, 1)] * at.y + h[(1, 2)]) / w;
    // The Jacobian of the dehomogenised map (x, y) at the point.
    let [xx, xy] = [0, 1].map(|column| (h[(0, column)] - x * h[(2, column)]) / w);
    let [yx, yy] = [0, 1].map(|column| (h[(1, column)] - y * h[(2, column)]) / w);
    // The zoom is the root of the change of area; the angle is that of the rotation nearest to the
    // 2 × 2 Jacobian.
    let area = xx * yy - xy * yx;
    let turn = (yx - xy).atan2(xx + yy).to_degrees();
    (area.is_finite() && area > 0.0).then(|| (area.sqrt(), turn))
}

#[cfg(test)]
mod tests {
    use super::*;
    use touchline_core::geometry::Mat3;

    #[test]
    fn frames_hang_together_over_others_and_the_largest_group_is_first() {
        let edge = |(first, second)| ViewGraphEdge {
            first,
            second,
            matches: Vec::new(),
            agreeing: 20,
            second_from_first: Mat3::identity(),
        };
        let edges: Vec<ViewGraphEdge> = [(1, 4), (0, 2), (4, 5)].map(edge).to_vec();
        assert_eq!(groups(6, &edges), [vec![1, 4, 5], vec![0, 2], vec![3]]);
        assert_eq!(groups(2, &[]), [vec![0], vec![1]]);
        assert!(groups(0, &[]).is_empty());
    }
}
