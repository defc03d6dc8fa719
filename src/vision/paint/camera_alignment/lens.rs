//! The lens of one frame: k₁ from its paint and clicks, for a camera whose lens is unknown.
//!
//! # Method
//!
//! Profile likelihood: the minimum of the cost over pan, tilt and focal length is a function of k₁
//! alone. It is computed on a grid. The parabola through the best value and its two neighbours
//! gives k₁ and its σ. Then the picture is searched for paint again with that lens, three times in
//! all. A grid is used instead of descent because far from the minimum the robust loss makes the
//! cost flat.

use crate::paint::{GroundPicture, SnapError, observations_of_paint, paint_places};
use touchline_core::camera::{CameraBase, FocalCurve, Ptz, PtzCamera};
use touchline_core::field::FieldModel;
use touchline_core::solve::{Loss, Observation, Refined, refine};

/// Number of times the picture is searched for paint.
const LOOKS: usize = 3;

/// Step of the grid of k₁.
const STEP: f64 = 0.02;

/// Grid steps on each side of the current k₁.
const STEPS: i32 = 5;

/// Maximum |k₁| of real lenses.
const MAX_K1: f64 = 0.5;

/// Maximum 1-σ of an accepted k₁.
const MAX_SIGMA: f64 = 0.05;

/// Ridges of something else have little influence.
const LOSS: Loss = Loss::Cauchy { c: 2.0 };

/// A frame's camera with its own k₁.
pub(super) struct OwnLens {
    /// The base with the fitted lens.
    pub base: CameraBase,
    pub ptz: Ptz,
}

/// Fits k₁ to a frame's paint and clicks, from a camera near by.
///
/// # Errors
///
/// [`SnapError::LensOpen`] if they do not determine k₁.
pub(super) fn own_lens(
    ground: &GroundPicture,
    field: &FieldModel,
    near: &PtzCamera,
    clicks: &[Observation],
) -> Result<OwnLens, SnapError> {
    // A constant k₁: the frame has one focal length, so that its paint says nothing about the slope
    // of a curve.
    let mut k1 = near.base().distortion.at(near.ptz().focal_px);
    let mut found = *near;
    for _ in 0..LOOKS {
        // Observations: ridges near the lines that the current camera predicts, and the clicks.
        let places = paint_places(ground, field, &found);
        let paint = observations_of_paint(&places, field);
        let seen: Vec<Observation> = clicks
            .iter()
            .filter(|click| !click.check)
            .copied()
            .chain(paint)
            .collect();
        // The profile of the cost: every k₁ of the grid has its own pan, tilt and focal length. The
        // ends of the grid are no candidates: they lack a neighbour. If the minimum lies beyond,
        // the next pass begins nearer to it.
        let values: Vec<f64> = (-STEPS..=STEPS)
            .map(|step| k1 + f64::from(step) * STEP)
            .collect();
        let costs: Vec<f64> = values
            .iter()
            .map(|k1| refine_with_k1(&found, *k1, &seen).cost)
            .collect();
        let inner = 1..values.len() - 1;
        let best = inner
            .min_by(|a, b| costs[*a].total_cmp(&costs[*b]))
            .unwrap_or(STEPS as usize);
        // First and second derivative by central differences.
        let [less, here, more] = [costs[best - 1], costs[best], costs[best + 1]];
        let (slope, curvature) = (
            (more - less) / (2.0 * STEP),
            (more - 2.0 * here + less) / (STEP * STEP),
        );
        // The cost is a sum of squares in σ; its second derivative is 2 / variance.
        let sigma = if curvature > 0.0 {
            (2.0 / curvature).sqrt()
        } else {
            f64::INFINITY
        };
        if !(sigma <= MAX_SIGMA) {
            return Err(SnapError::LensOpen { sigma });
        }
        // Newton step to the vertex of the parabola, at most one grid step.
        k1 = (values[best] + (-slope / curvature).clamp(-STEP, STEP)).clamp(-MAX_K1, MAX_K1);
        let ptz = refine_with_k1(&found, k1, &seen).ptz;
        let base = with_k1(near.base(), k1);
        let base = CameraBase {
            sigma: base.sigma.with_own_k1(sigma),
            ..base
        };
        found = PtzCamera::new(base, ptz);
    }
    Ok(OwnLens {
        base: *found.base(),
        ptz: found.ptz(),
    })
}

/// Pan, tilt and focal length for a given k₁, from those of a camera near by, and their cost.
fn refine_with_k1(near: &PtzCamera, k1: f64, seen: &[Observation]) -> Refined {
    refine(&with_k1(near.base(), k1), near.ptz(), seen, LOSS, None)
}

/// The base with a constant k₁, the same at all focal lengths, in place of its own curve.
fn with_k1(base: &CameraBase, k1: f64) -> CameraBase {
    CameraBase {
        distortion: FocalCurve::constant(k1),
        ..*base
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::paint::drawn::{PICTURE, SIZE, soccer, truth};
    use touchline_core::geometry::PixelBox;

    #[test]
    fn the_lens_of_a_drawn_picture_is_found_from_none() {
        let (ground, field) = (GroundPicture::new(&PICTURE, &[]), soccer());
        let near = PtzCamera::new(with_k1(truth().base(), 0.0), truth().ptz());
        let own = own_lens(&ground, &field, &near, &[]).unwrap();
        let k1 = truth().base().distortion.at(truth().ptz().focal_px);
        assert!(
            (own.base.distortion.at(own.ptz.focal_px) - k1).abs() < 0.01,
            "{:?}",
            own.base.distortion
        );
    }

    #[test]
    fn without_paint_the_lens_is_left_open() {
        let (width, height) = (f64::from(SIZE.width), f64::from(SIZE.height));
        let all = PixelBox {
            x: 0.0,
            y: 0.0,
            width,
            height,
        };
        let hidden = own_lens(
            &GroundPicture::new(&PICTURE, &[all]),
            &soccer(),
            &truth(),
            &[],
        );
        assert!(matches!(hidden, Err(SnapError::LensOpen { .. })));
    }
}
