//! The content of a leaf: the means of its samples, one per place of the stadium.

use super::Samples;
use super::tree::MeanRay;
use crate::features::{DESCRIPTOR_BYTES, Descriptor};
use touchline_core::camera::PanTilt;
use touchline_core::geometry::{Angle, Vec3};

/// Clusters the samples `at` of a leaf by their rays and returns the mean of each cluster.
///
/// Greedy: a sample joins the first cluster whose first ray is within `merge_within`, else it
/// starts a cluster.
pub(super) fn means(
    samples: &Samples,
    at: &[u32],
    merge_within: Angle,
) -> Vec<(Descriptor, MeanRay)> {
    // Sorted by the x coordinate of the rays, clusters whose x lies farther back than the radius
    // can no longer match. The radius is a chord of the unit sphere. Equal values are ordered by
    // index, so the result is deterministic.
    let mut order = at.to_vec();
    order.sort_unstable_by(|&a, &b| {
        let by_x = samples.ray(a).x.total_cmp(&samples.ray(b).x);
        by_x.then(a.cmp(&b))
    });
    let chord = 2.0 * (merge_within.radians() / 2.0).sin();
    let mut places: Vec<(Vec3, Vec<u32>)> = Vec::new();
    let mut first_near = 0;
    for sample in order {
        // Clusters are in the order of x of their first rays, so `first_near` only moves forward.
        let at = samples.ray(sample);
        while places
            .get(first_near)
            .is_some_and(|(place, _)| at.x - place.x > chord)
        {
            first_near += 1;
        }
        let near = places[first_near..]
            .iter_mut()
            .find(|(place, _)| (at - *place).norm() < chord);
        match near {
            Some((_, members)) => members.push(sample),
            None => places.push((at, vec![sample])),
        }
    }
    places
        .iter()
        .map(|(_, members)| mean(samples, members))
        .collect()
}

/// The mean descriptor, rounded, and the mean ray of at least one sample.
fn mean(samples: &Samples, members: &[u32]) -> (Descriptor, MeanRay) {
    let count = members.len() as u32;
    let mut sums = [0u32; DESCRIPTOR_BYTES];
    let mut direction = Vec3::zeros();
    for &sample in members {
        for (sum, &byte) in sums.iter_mut().zip(&samples.descriptors[sample as usize].0) {
            *sum += u32::from(byte);
        }
        direction += samples.ray(sample);
    }
    // A single ray is kept exactly; normalising would round it.
    let mean = if count == 1 {
        direction
    } else {
        direction.normalize()
    };
    // Chords stand for angles, which they equal for rays near each other.
    let squares: f64 = members
        .iter()
        .map(|&sample| (samples.ray(sample) - mean).norm_squared())
        .sum();
    let ray = PanTilt::from_direction(mean);
    let pan_tilt = [ray.pan.radians() as f32, ray.tilt.radians() as f32];
    let spread = (squares / f64::from(count)).sqrt() as f32;
    let descriptor = Descriptor(sums.map(|sum| ((sum + count / 2) / count) as u8));
    (
        descriptor,
        MeanRay {
            pan_tilt,
            spread,
            samples: count,
        },
    )
}
