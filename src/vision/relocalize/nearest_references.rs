//! How far cameras are apart, and which references are nearest to one.

use touchline_core::camera::Ptz;

/// How far two cameras are apart: the turn of the axis in rad, and the logarithm of the ratio of
/// their focal lengths.
pub(super) fn apart(one: &Ptz, other: &Ptz) -> (f64, f64) {
    let pan = one.pan.turn_from(other.pan).radians() * one.tilt.radians().cos();
    let tilt = (one.tilt - other.tilt).radians();
    (pan.hypot(tilt), (one.focal_px / other.focal_px).ln())
}

/// The references nearest to a camera, at most `most`, by their places, the nearest first. A turn
/// by a rad and a zoom by a factor of e count alike.
pub(super) fn nearest(ptz: &Ptz, references: &[Ptz], most: usize) -> Vec<usize> {
    let distance = |reference: &Ptz| {
        let (turn, zoom) = apart(ptz, reference);
        turn.hypot(zoom)
    };
    let mut order: Vec<(f64, usize)> = references
        .iter()
        .enumerate()
        .map(|(number, reference)| (distance(reference), number))
        .collect();
    order.sort_by(|a, b| a.0.total_cmp(&b.0).then(a.1.cmp(&b.1)));
    order
        .into_iter()
        .take(most)
        .map(|(_, number)| number)
        .collect()
}
