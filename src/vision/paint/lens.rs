//! The lens of one frame: k₁ from its paint and clicks, for a camera of which no lens is known.
//!
//! The least cost over pan, tilt and focal length is a function of k₁ alone. The parabola through
//! the best of some values and its neighbours gives k₁ and its σ; the paint is looked at again with
//! that. Far off the cost is no parabola, since far paint hardly pulls, so the values reach over
//! all that k₁ may change by.

use super::{GroundPicture, SnapError, paint_places};
use touchline_core::camera::{CameraBase, FocalCurve, Ptz, PtzCamera};
use touchline_core::field::FieldModel;
use touchline_core::solve::{Loss, Observation, Refined, refine};

/// How often the paint is looked at.
const LOOKS: usize = 3;

/// The values of k₁ that are compared lie this far apart.
const STEP: f64 = 0.02;

/// So many are compared on each side at a look.
const STEPS: i32 = 5;

/// k₁ is never farther from 0 than this, the most that lenses have.
const MOST: f64 = 0.5;

/// A k₁ that is less well known than this is none.
const MAX_SIGMA: f64 = 0.05;

/// Paint of something else hardly pulls.
const LOSS: Loss = Loss::Cauchy { c: 2.0 };

/// A frame's camera with its own k₁.
pub(super) struct OwnLens {
    /// The base with the lens.
    pub base: CameraBase,
    pub ptz: Ptz,
}

/// The k₁ with which a frame's paint and clicks agree best, from a camera near by.
///
/// # Errors
/// [`SnapError::LensOpen`] where they leave it open.
pub(super) fn own_lens(
    ground: &GroundPicture,
    field: &FieldModel,
    near: &PtzCamera,
    clicks: &[Observation],
) -> Result<OwnLens, SnapError> {
    let mut k1 = near.base().distortion.at(near.ptz().focal_px);
    let mut found = *near;
    for _ in 0..LOOKS {
        let places = paint_places(ground, field, &found);
        let paint = places.iter().enumerate().filter_map(|(number, place)| {
            Observation::of_paint(field, place.line, place.image, place.sigma_px, number)
        });
        let seen: Vec<Observation> = clicks
            .iter()
            .filter(|click| !click.check)
            .copied()
            .chain(paint)
            .collect();
        let fitted = |k1: f64| -> Refined {
            refine(&with_k1(near.base(), k1), found.ptz(), &seen, LOSS, None)
        };
        let values: Vec<f64> = (-STEPS..=STEPS)
            .map(|step| k1 + f64::from(step) * STEP)
            .collect();
        let costs: Vec<f64> = values.iter().map(|k1| fitted(*k1).cost).collect();
        let inner = 1..values.len() - 1;
        let best = inner
            .min_by(|a, b| costs[*a].total_cmp(&costs[*b]))
            .unwrap_or(STEPS as usize);
        let [less, here, more] = [costs[best - 1], costs[best], costs[best + 1]];
        let (slope, curvature) = (
            (more - less) / (2.0 * STEP),
            (more - 2.0 * here + less) / (STEP * STEP),
        );
        // A sum of squares in sigmas has twice the inverse variance as its second derivative.
        let sigma = if curvature > 0.0 {
            (2.0 / curvature).sqrt()
        } else {
            f64::INFINITY
        };
        if !(sigma <= MAX_SIGMA) {
            return Err(SnapError::LensOpen { sigma });
        }
        k1 = (values[best] + (-slope / curvature).clamp(-STEP, STEP)).clamp(-MOST, MOST);
        found = PtzCamera::new(with_k1(near.base(), k1), fitted(k1).ptz);
    }
    Ok(OwnLens {
        base: *found.base(),
        ptz: found.ptz(),
    })
}

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
