//! Clicks and frames that contradict the base on which all others agree.

use super::FrameClicks;
use crate::camera::{CameraBase, Ptz, PtzCamera};
use crate::field::{FieldModel, LandmarkId, Symmetry};
use crate::geometry::{ImageSize, median_high};
use crate::solve::refine::squared_sigmas;
use crate::solve::{Loss, Observation, SolveContext, solve_frame};
use serde::Serialize;

/// A click farther off than this many sigmas (of the estimated click noise) is disputed.
const DISPUTED_SIGMAS: f64 = 5.0;

/// Another landmark is suggested for a click within this many sigmas.
const FITS_SIGMAS: f64 = 2.5;

/// A click that the other clicks contradict.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct DisputedClick {
    /// Which frame, from 0.
    pub frame: usize,
    /// Which of its clicks, from 0.
    pub click: usize,
    /// Its distance from its landmark or line, px; none where that has no image.
    pub error_px: Option<f64>,
    /// The landmark that fits instead, if there is one, and its distance, px.
    pub fits_better: Option<(LandmarkId, f64)>,
}

/// A frame whose landmarks are all named from the wrong side of the field.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct MirroredFrame {
    /// Which frame, from 0.
    pub frame: usize,
    /// The symmetry that corrects the names: left and right exchanged, near and far, or both.
    pub symmetry: Symmetry,
    /// Median error of its clicks as they are named, px.
    pub median_px: f64,
    /// Median error with the names exchanged, px.
    pub median_mirrored_px: f64,
}

/// The clicks of solved frames that are more than [`DISPUTED_SIGMAS`] off, in order.
pub(super) fn disputed_clicks(
    base: &CameraBase,
    field: &FieldModel,
    frames: &[FrameClicks],
    ptz: &[Option<Ptz>],
    noise_scale: f64,
) -> Vec<DisputedClick> {
    let mut found = Vec::new();
    for (index, (frame, ptz)) in frames.iter().zip(ptz).enumerate() {
        let Some(ptz) = ptz else { continue };
        let camera = PtzCamera::new(*base, *ptz);
        for click in frame.used_clicks() {
            // In sigmas of the noise that the clicks have, not of the stated one: otherwise many
            // clicks of a less careful user would be disputed.
            let error_px = click.distance_px(&camera);
            if squared_sigmas(error_px, click.sigma_px * noise_scale)
                <= DISPUTED_SIGMAS * DISPUTED_SIGMAS
            {
                continue;
            }
            let fits_better = better_landmark(&camera, field, click, noise_scale);
            found.push(DisputedClick {
                frame: index,
                click: click.click,
                error_px,
                fits_better,
            });
        }
    }
    found
}

/// The landmark nearest to a click, if it is within [`FITS_SIGMAS`].
fn better_landmark(
    camera: &PtzCamera,
    field: &FieldModel,
    click: &Observation,
    noise_scale: f64,
) -> Option<(LandmarkId, f64)> {
    field
        .landmarks
        .iter()
        .filter_map(|landmark| {
            let projected = camera
                .image_from_world(field.landmark_in_world(landmark))
                .ok()?;
            Some((landmark.id.clone(), projected.distance_px(click.image)))
        })
        .min_by(|a, b| a.1.total_cmp(&b.1))
        .filter(|(_, distance_px)| *distance_px < FITS_SIGMAS * click.sigma_px * noise_scale)
}

/// The frames whose clicks fit much better when all names are mirrored. Frames with clicks on lines
/// are not tested.
pub(super) fn mirrored_frames(
    base: &CameraBase,
    frames: &[FrameClicks],
    ptz: &[Option<Ptz>],
    image_size: ImageSize,
) -> Vec<MirroredFrame> {
    /// The cost with mirrored names is less than this fraction of the cost as named.
    const BETTER: f64 = 0.25;
    const MIN_CLICKS: usize = 4;
    let loss = Loss::Cauchy { c: 3.0 };
    let context = SolveContext::new(image_size);
    let mut found = Vec::new();
    for (index, frame) in frames.iter().enumerate() {
        // Few points fit from the wrong side by chance.
        let clicks: Vec<Observation> = frame.used_clicks().copied().collect();
        if clicks.len() < MIN_CLICKS {
            continue;
        }
        // A frame without a camera has the cost of clicks without an image, so a mirrored solution
        // beats it.
        let as_named = median_and_cost(base, ptz[index], &clicks, loss);

        // Solve the frame anew under each symmetry and keep the best.
        let mut best: Option<(f64, MirroredFrame)> = None;
        for symmetry in Symmetry::ALL {
            let mirrored: Option<Vec<Observation>> = clicks
                .iter()
                .map(|click| mirror_click(click, symmetry))
                .collect();
            let Some(mirrored) = mirrored else { continue };
            let Ok(solved) = solve_frame(base, &mirrored, &context) else {
                continue;
            };
            let (median_mirrored_px, cost) =
                median_and_cost(base, Some(solved.ptz), &mirrored, loss);
            if cost < BETTER * as_named.1 && best.is_none_or(|(least, _)| cost < least) {
                let median_px = as_named.0;
                best = Some((
                    cost,
                    MirroredFrame {
                        frame: index,
                        symmetry,
                        median_px,
                        median_mirrored_px,
                    },
                ));
            }
        }
        found.extend(best.map(|(_, mirrored)| mirrored));
    }
    found
}

/// A landmark click moved to its mirror image; none for a click on a line.
fn mirror_click(click: &Observation, symmetry: Symmetry) -> Option<Observation> {
    Some(Observation {
        element: None,
        shape: click.shape.mirror_point(symmetry)?,
        ..*click
    })
}

fn median_and_cost(
    base: &CameraBase,
    ptz: Option<Ptz>,
    clicks: &[Observation],
    loss: Loss,
) -> (f64, f64) {
    let camera = ptz.map(|ptz| PtzCamera::new(*base, ptz));
    let distances: Vec<Option<f64>> = clicks
        .iter()
        .map(|click| camera.as_ref().and_then(|camera| click.distance_px(camera)))
        .collect();
    // Clicks without an image have a large constant cost, and an infinite distance in the median.
    let cost = distances
        .iter()
        .zip(clicks)
        .map(|(distance, click)| loss.evaluate(squared_sigmas(*distance, click.sigma_px)).0)
        .sum();
    let mut distances: Vec<f64> = distances
        .into_iter()
        .map(|distance| distance.unwrap_or(f64::INFINITY))
        .collect();
    (median_high(&mut distances).unwrap_or(f64::INFINITY), cost)
}
