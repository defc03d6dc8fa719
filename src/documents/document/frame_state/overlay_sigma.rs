//! How far the drawn lines of a frame may be off, in agreement with its confidence.

use crate::document::{Document, Frame, Solution};
use touchline_core::geometry::ImageSize;
use touchline_core::solve::{Uncertainty, probability_right};

/// 1-σ of a frame's overlay at the worst corner of its picture.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct OverlaySigma {
    /// The σ that goes with the frame's confidence, px.
    pub px: f64,
    /// What the base's uncertainty would add to it, px, where the confidence leaves that out: paint
    /// or references confirm the base where the frame looks.
    pub unused_base_px: Option<f64>,
}

impl Document {
    /// 1-σ of a frame's overlay; none where its solution states none.
    ///
    /// The stated σ includes that of the base, which all frames of a camera share. A confidence
    /// that is higher than this σ permits was computed without it, and then the σ of the frame's
    /// own evidence is the one that belongs to it.
    pub fn overlay_sigma(&self, frame: &Frame) -> Option<OverlaySigma> {
        let solution = frame.solution.as_ref()?;
        let stated_px = solution.worst_corner_sigma_px?;
        let own_px = self.own_sigma_px(frame, solution);
        let own_px = own_px.filter(|_| permits_less(stated_px, solution, frame.image_size));
        Some(match own_px {
            Some(own_px) => OverlaySigma {
                px: own_px.min(stated_px),
                unused_base_px: Some((stated_px.powi(2) - own_px.powi(2)).max(0.0).sqrt()),
            },
            None => OverlaySigma {
                px: stated_px,
                unused_base_px: None,
            },
        })
    }

    /// The same by the frame's own evidence, with an exact base, px.
    fn own_sigma_px(&self, frame: &Frame, solution: &Solution) -> Option<f64> {
        let (own, size) = (solution.own_covariance.as_ref()?, frame.image_size);
        let camera = self.ptz_camera(frame)?;
        let known = Uncertainty::from_own(&camera, own, size).ok()?;
        known
            .with_exact_base()
            .corner_sigma_px_if_known(&camera, size)
    }
}

/// Whether a σ permits less confidence than a solution states.
fn permits_less(sigma_px: f64, solution: &Solution, size: ImageSize) -> bool {
    let permitted = probability_right(sigma_px / size.scale_from_1920());
    solution.confidence.is_some_and(|stated| stated > permitted)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::document::Camera;
    use crate::testing::{new_frame, ptz_at, soccer_document};
    use touchline_core::testing::{SIZE, base_at};

    /// A frame known to 1 px on a base of which its own paint knows more than the base's σ says.
    fn document(base_m: f64, confidence: Option<f64>) -> Document {
        let mut base = base_at([0.0, -60.0, 15.0], SIZE);
        base.sigma.position_m = [base_m, base_m, base_m].into();
        let mut document = soccer_document();
        let mut camera = Camera::new("main".into(), SIZE);
        camera.set_base(&base);
        document.cameras.push(camera.into());
        let mut frame = new_frame("1.jpg", SIZE);
        frame.ptz = ptz_at(0.0, -12.0, 2600.0);
        document.frames.push(frame.into());
        document.state_uncertainty(0, 1.0);
        document.frames[0].solution.as_mut().unwrap().confidence = confidence;
        document
    }

    fn sigma(base_m: f64, confidence: Option<f64>) -> OverlaySigma {
        let document = document(base_m, confidence);
        document.overlay_sigma(&document.frames[0]).unwrap()
    }

    #[test]
    fn a_certain_frame_on_an_uncertain_base_is_as_good_as_its_own_evidence() {
        let certain = sigma(1.0, Some(0.99));
        assert!(certain.px < 4.0, "{certain:?}");
        assert!(certain.unused_base_px.unwrap() > 10.0, "{certain:?}");
        // The two add up to what the document states.
        let stated = sigma(1.0, None);
        assert_eq!(stated.unused_base_px, None);
        let sum_px = certain.px.hypot(certain.unused_base_px.unwrap());
        assert!((sum_px - stated.px).abs() < 1e-9, "{certain:?} {stated:?}");
    }

    #[test]
    fn a_doubted_frame_and_one_on_a_known_base_keep_what_is_stated() {
        assert_eq!(sigma(1.0, Some(0.001)), sigma(1.0, None));
        assert_eq!(sigma(0.0, Some(0.9)), sigma(0.0, None));
        assert!(sigma(0.0, None).px < 4.0);
    }

    #[test]
    fn without_own_evidence_the_stated_sigma_stands() {
        let mut document = document(1.0, Some(0.99));
        let stated = document.frames[0].solution.as_mut().unwrap();
        stated.own_covariance = None;
        let stated_px = stated.worst_corner_sigma_px.unwrap();
        let sigma = document.overlay_sigma(&document.frames[0]).unwrap();
        assert_eq!((sigma.px, sigma.unused_base_px), (stated_px, None));
        document.frames[0].solution = None;
        assert_eq!(document.overlay_sigma(&document.frames[0]), None);
    }
}
