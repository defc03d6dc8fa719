//! Ties that contradict the others: going from one frame to another over a third should lead to the same place.

use super::Tie;
use crate::geometry::{ImageSize, Mat3, Vec3};
use std::collections::BTreeMap;

/// Two ways from frame to frame agree within this distance, px at 1920 px width: homographies of narrow overlaps are
/// uncertain far from them.
const AGREE_PX: f64 = 120.0;

/// A tie goes if a smaller share of the ways around it agree with it, and there are at least two.
const MIN_SHARE: f64 = 0.34;
const MIN_WAYS: i32 = 2;

/// The ties that the others do not contradict.
pub(super) fn uncontradicted(ties: &[Tie], size: ImageSize) -> Vec<Tie> {
    let mut between: BTreeMap<(usize, usize), Mat3> = BTreeMap::new();
    let mut beside: BTreeMap<usize, Vec<usize>> = BTreeMap::new();
    for tie in ties {
        let Some(back) = tie.second_from_first.try_inverse() else { continue };
        between.insert((tie.first, tie.second), tie.second_from_first);
        between.insert((tie.second, tie.first), back);
        beside.entry(tie.first).or_default().push(tie.second);
        beside.entry(tie.second).or_default().push(tie.first);
    }
    let stays = |tie: &&Tie| {
        let (mut ways, mut agreeing) = (0, 0);
        for third in beside.get(&tie.first).into_iter().flatten() {
            let (Some(there), Some(on)) = (between.get(&(tie.first, *third)), between.get(&(*third, tie.second)))
            else {
                continue;
            };
            ways += 1;
            agreeing +=
                i32::from(apart_px(&tie.second_from_first, &(on * there), size) < AGREE_PX * size.scale_from_1920());
        }
        ways < MIN_WAYS || f64::from(agreeing) >= MIN_SHARE * f64::from(ways)
    };
    ties.iter().filter(stays).cloned().collect()
}

/// How far two homographies take the points of a picture apart, px: the second smallest of four, as one frame may show little
/// of another.
fn apart_px(one: &Mat3, other: &Mat3, size: ImageSize) -> f64 {
    let (width, height) = (f64::from(size.width), f64::from(size.height));
    let apart = |(x, y): (f64, f64)| {
        let at = Vec3::new(x * width, y * height, 1.0);
        let (a, b) = (one * at, other * at);
        ((a.x / a.z - b.x / b.z).hypot(a.y / a.z - b.y / b.z), a.z.signum() == b.z.signum())
    };
    let mut distances: Vec<f64> = [(0.25, 0.4), (0.75, 0.4), (0.25, 0.7), (0.75, 0.7)]
        .into_iter()
        .map(apart)
        .map(|(distance, same_side)| if same_side { distance } else { f64::INFINITY })
        .collect();
    distances.sort_by(f64::total_cmp);
    distances[1]
}
