//! Distances between cameras, and the references nearest to one.

use touchline_core::camera::Ptz;

/// The difference of two cameras: rotation of the optical axis, rad, and logarithm of the ratio of
/// the focal lengths.
pub(super) fn apart(one: &Ptz, other: &Ptz) -> (f64, f64) {
    // Small-angle arc: a pan moves the axis by its cosine of tilt.
    let pan = one.pan.turn_from(other.pan).radians() * one.tilt.radians().cos();
    let tilt = (one.tilt - other.tilt).radians();
    (pan.hypot(tilt), (one.focal_px / other.focal_px).ln())
}

/// Indices of at most `most` references nearest to a camera, the nearest first. A rotation by 1 rad
/// and a zoom by a factor e count alike.
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
