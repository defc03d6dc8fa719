//! Which references are nearest to a camera.

use touchline_core::camera::{AngularDistance, Ptz};

/// Indices of at most `most` references nearest to a camera, the nearest first. A rotation by 1 rad
/// and a zoom by a factor e count alike.
pub(super) fn nearest(ptz: &Ptz, references: &[Ptz], most: usize) -> Vec<usize> {
    let mut order: Vec<(f64, usize)> = references
        .iter()
        .enumerate()
        .map(|(number, reference)| {
            let AngularDistance { turn, log_zoom } = AngularDistance::between(ptz, reference);
            (turn.radians().hypot(log_zoom), number)
        })
        .collect();
    order.sort_by(|a, b| a.0.total_cmp(&b.0).then(a.1.cmp(&b.1)));
    order
        .into_iter()
        .take(most)
        .map(|(_, number)| number)
        .collect()
}
