//! Ties that contradict the others: going from one frame to another over a third should lead to the
//! same place.

use super::Tie;
use super::tie::brought;
use std::collections::BTreeMap;
use touchline_core::geometry::{ImagePoint, ImageSize, Mat3, Vec3};

/// Two ways from frame to frame agree within this distance, px at 1920 px width: homographies of
/// narrow overlaps are uncertain far from them.
const AGREE_PX: f64 = 120.0;

/// A tie goes if a smaller share of the ways around it agree with it, and there are at least two.
const MIN_SHARE: f64 = 0.34;
const MIN_WAYS: i32 = 2;

/// The ties that the others do not contradict.
pub(super) fn uncontradicted(ties: &[Tie], size: ImageSize) -> Vec<Tie> {
    let mut between: BTreeMap<(usize, usize), Mat3> = BTreeMap::new();
    let mut beside: BTreeMap<usize, Vec<usize>> = BTreeMap::new();
    for tie in ties {
        let Some(&(here, there)) = tie.matches.first() else {
            continue;
        };
        let Some(first_from_second) = tie.second_from_first.try_inverse() else {
            continue;
        };
        between.insert(
            (tie.first, tie.second),
            ahead_at(tie.second_from_first, here),
        );
        between.insert((tie.second, tie.first), ahead_at(first_from_second, there));
        beside.entry(tie.first).or_default().push(tie.second);
        beside.entry(tie.second).or_default().push(tie.first);
    }
    let agree_px = AGREE_PX * size.scale_from_1920();
    let stays = |tie: &&Tie| {
        let Some(direct) = between.get(&(tie.first, tie.second)) else {
            return false;
        };
        let (mut ways, mut agreeing) = (0, 0);
        for third in beside.get(&tie.first).into_iter().flatten() {
            let (Some(there), Some(on)) = (
                between.get(&(tie.first, *third)),
                between.get(&(*third, tie.second)),
            ) else {
                continue;
            };
            if let Some(apart_px) = apart_px(direct, &(on * there), size) {
                ways += 1;
                agreeing += i32::from(apart_px < agree_px);
            }
        }
        ways < MIN_WAYS || f64::from(agreeing) >= MIN_SHARE * f64::from(ways)
    };
    ties.iter().filter(stays).cloned().collect()
}

/// A homography with the sign that takes a point it was found from ahead of the camera; the sign
/// means nothing before.
fn ahead_at(homography: Mat3, at: ImagePoint) -> Mat3 {
    if (homography * Vec3::new(at.x, at.y, 1.0)).z < 0.0 {
        -homography
    } else {
        homography
    }
}

/// How far two homographies take the points of a picture apart, px: the second smallest of four, as
/// one frame may show little of another. None where not two of the points are ahead of the second
/// frame's camera on both ways.
fn apart_px(one: &Mat3, other: &Mat3, size: ImageSize) -> Option<f64> {
    let (width, height) = (f64::from(size.width), f64::from(size.height));
    let apart = |(x, y): (f64, f64)| {
        let at = ImagePoint::new(x * width, y * height);
        Some(brought(one, at)?.distance_px(brought(other, at)?))
    };
    let mut distances: Vec<f64> = [(0.25, 0.4), (0.75, 0.4), (0.25, 0.7), (0.75, 0.7)]
        .into_iter()
        .filter_map(apart)
        .collect();
    distances.sort_by(f64::total_cmp);
    distances.get(1).copied()
}
