//! Minima of the joint adjustment beside the one that a hypothesis lies in: on a field of another
//! size, and from another distance.
//!
//! # Problem
//!
//! A camera that stands nearer and looks with a shorter focal length sees nearly the same picture,
//! and so does one in front of a smaller field. What tells them apart is perspective, which is
//! weakest from low cameras and with long lenses; the radial distortion, which is free as well,
//! takes up much of the rest. So the adjustment has several minima in a row. Drawn clip 4 of the
//! bowl (a mast 4.1 m high): 4.7 m and 5 % of the focal length apart, both explain 95 % of the
//! paint, with median residuals of 0.30 px in the wrong one and 0.22 px in the right one.
//!
//! # Method
//!
//! Least squares does not leave a minimum, so it is started again beside it: on neighbouring sizes
//! of the field ([`try_neighbouring_sizes`]), and from nearer and farther away with the focal
//! lengths that go with it ([`try_neighbouring_distances`]).

use super::hypothesis::{Hypothesis, MIN_GAIN_NATS};
use super::joint::JointStart;
use crate::autocalibrate::field_prior::FieldPrior;
use crate::autocalibrate::frames::matched_frames::{FramePaint, MatchedFrames};
use rayon::prelude::*;
use touchline_core::camera::PtzCamera;
use touchline_core::field::FieldModel;
use touchline_core::geometry::Vec3;

/// Moves a hypothesis to a neighbouring field size as long as that raises the evidence by
/// [`MIN_GAIN_NATS`].
///
/// Least squares alone does not get there: while paint is assigned to the wrong lines, the size
/// that fits best is the wrong one.
pub fn try_neighbouring_sizes(
    hypothesis: &mut Hypothesis,
    field_prior: &FieldPrior,
    matched: &MatchedFrames,
) {
    const MAX_STEPS: usize = 3;
    for _ in 0..MAX_STEPS {
        // Adjust at each neighbouring size, starting from the present base and frames.
        let neighbours: Vec<Hypothesis> = field_prior
            .neighbouring_sizes(&hypothesis.camera.field)
            .into_par_iter()
            .filter_map(|field| {
                let (base, ptz) = (hypothesis.camera.base, hypothesis.ptz.clone());
                let start = JointStart { field, base, ptz };
                Hypothesis::adjust(&start, Some(field_prior), &hypothesis.frames, matched)
            })
            .collect();
        match neighbours
            .into_iter()
            .max_by(|a, b| a.nats().total_cmp(&b.nats()))
        {
            Some(best) if best.nats() > hypothesis.nats() + MIN_GAIN_NATS => *hypothesis = best,
            _ => return,
        }
    }
}

/// Distances from which the adjustment starts again, in terms of the present one. The first to
/// either side is about as far away as the neighbouring minimum of a low camera.
const DISTANCES: [f64; 4] = [0.88, 0.94, 1.06, 1.12];

/// The hypothesis in the neighbouring minimum, nearer or farther away, for which more evidence
/// speaks; none if there is no better one.
pub fn try_neighbouring_distances(
    hypothesis: &Hypothesis,
    field_prior: &FieldPrior,
    matched: &MatchedFrames,
) -> Option<Hypothesis> {
    let size_prior = field_prior.is_size_unknown().then_some(field_prior);
    let present = JointStart::from_hypothesis(hypothesis, matched)?;
    let middle_m = middle_of_paint(&present, &hypothesis.frames.paint)?;
    let mut best = DISTANCES
        .into_par_iter()
        .filter_map(|factor| {
            let start = from_other_distance(&present, middle_m, factor);
            Hypothesis::adjust_repeatedly(&start, size_prior, &hypothesis.frames, matched)
        })
        .max_by(|a, b| a.nats().total_cmp(&b.nats()))?;
    // What contradicts a stated size was found with both sizes, and is not measured again.
    best.camera.evidence.other_size_m = hypothesis.camera.evidence.other_size_m;
    (best.nats() > hypothesis.nats() + MIN_GAIN_NATS).then_some(best)
}

/// The camera moved towards a point or away from it by a factor on the distance, with focal lengths
/// such that what lies around the point keeps its size in the pictures (a "dolly zoom").
fn from_other_distance(present: &JointStart, middle_m: Vec3, factor: f64) -> JointStart {
    let mut base = present.base;
    base.position_m = middle_m + factor * (base.position_m - middle_m);
    let mut ptz = present.ptz.clone();
    for ptz in ptz.iter_mut().flatten() {
        ptz.focal_px *= factor;
    }
    JointStart {
        field: present.field.clone(),
        base,
        ptz,
    }
}

/// The mean of the paint on the ground within the field, in `world`, m.
fn middle_of_paint(cameras: &JointStart, paint: &[FramePaint]) -> Option<Vec3> {
    let (mut sum, mut count) = (Vec3::zeros(), 0.0);
    for (ptz, paint) in cameras.ptz.iter().zip(paint) {
        let Some(ptz) = *ptz else { continue };
        let camera = PtzCamera::new(cameras.base, ptz);
        let on_ground = paint
            .iter()
            .filter_map(|paint| camera.plane_from_image(paint.at, 0.0));
        for ground in on_ground.filter(|at| is_on_field(at, &cameras.field)) {
            sum += ground;
            count += 1.0;
        }
    }
    (count > 0.0).then(|| sum / count)
}

/// Whether a point of the ground lies within the border of a field.
fn is_on_field(at: &Vec3, field: &FieldModel) -> bool {
    at.x.abs() < 0.5 * field.length_m && at.y.abs() < 0.5 * field.width_m
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::autocalibrate::rotating_camera::{
        base, hypothesis, matched_views, matched_views_with_pixels, soccer,
    };

    /// The right hypothesis seen from another distance, with evidence.
    fn from_distance(factor: f64, nats: f64) -> Hypothesis {
        let mut moved = hypothesis(&soccer().assumed);
        let present = JointStart::from_hypothesis(&moved, &matched_views()).unwrap();
        let middle_m = middle_of_paint(&present, &moved.frames.paint).unwrap();
        let start = from_other_distance(&present, middle_m, factor);
        (moved.camera.base, moved.ptz) = (start.base, start.ptz);
        moved.camera.evidence.nats = nats;
        moved
    }

    #[test]
    fn a_camera_that_stands_too_far_away_is_brought_back() {
        let far = from_distance(1.0 / 0.94, 0.0);
        let matched = matched_views_with_pixels(&soccer().assumed, &[0, 1, 2, 3, 4, 5, 6]);
        let off_m = |of: &Hypothesis| (of.position_m() - base().position_m).norm();
        assert!(off_m(&far) > 2.0, "{:.2} m", off_m(&far));
        let back = try_neighbouring_distances(&far, &soccer(), &matched).unwrap();
        assert!(off_m(&back) < 0.1, "{:.2} m", off_m(&back));
    }

    #[test]
    fn a_hypothesis_whose_lines_lie_on_the_paint_stays() {
        let right = from_distance(1.0, f64::INFINITY);
        assert!(try_neighbouring_distances(&right, &soccer(), &matched_views()).is_none());
    }

    #[test]
    fn without_paint_on_the_field_nothing_is_tried() {
        let mut bare = hypothesis(&soccer().assumed);
        bare.camera.base.position_m.z = -1.0;
        assert!(try_neighbouring_distances(&bare, &soccer(), &matched_views()).is_none());
    }
}
