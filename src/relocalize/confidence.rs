//! How probable it is that an answer is right.

use super::SeenRange;
use super::nearest_references::{apart, nearest};
use crate::camera::Ptz;
use crate::geometry::ImageSize;
use serde::Serialize;

/// What speaks for an answer. How many features agree says little: those of one advertising board, or of a row of them,
/// agree on a wrong camera in any number. Boards are narrow, though, and what narrow evidence fixes is fixed badly.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Evidence {
    /// How far agreeing features spread where they spread least, px at 1920 px width.
    pub breadth_px: f64,
    /// 1-σ of the overlay at the worst corner of the picture by the features alone, px at 1920 px width.
    pub features_sigma_px: f64,
    /// The same with what the references' labels leave open. What the base leaves open is not in it: it is the same for all
    /// frames, and the references show it.
    pub labelled_sigma_px: f64,
    /// How far the camera turned and zoomed from the nearest reference.
    pub from_reference: FromReference,
    /// No greater probability is stated, by what references that were left out show.
    pub at_most: f64,
}

/// How far a camera is from the nearest reference.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize)]
pub struct FromReference {
    /// The turn of the axis, as a share of the picture's width.
    pub turn: f64,
    /// The logarithm of the ratio of the focal lengths, without its sign.
    pub zoom: f64,
}

/// An overlay that is off by no more is right, px at 1920 px width.
const RIGHT_PX: f64 = 10.0;

impl FromReference {
    /// How far a camera is from the nearest reference; nothing where none is known.
    pub(super) fn of(ptz: &Ptz, image_size: ImageSize, seen: &SeenRange) -> Self {
        let Some(number) = nearest(ptz, &seen.cameras, 1).into_iter().next() else { return Self::default() };
        let (turn, zoom) = apart(ptz, &seen.cameras[number]);
        Self { turn: turn * ptz.focal_px / f64::from(image_size.width), zoom: zoom.abs() }
    }
}

/// The logarithm of the odds that an overlay is right within 10 px at 1920 px width, by [`Evidence::terms`]: the logistic
/// curve of greatest likelihood over 1086 answers on frames of three real matches, each from references of other clips and
/// mostly from too few of them, and 484 on drawn pictures where chance and repeated boards agree, these at 0.3 of the
/// weight. `cargo bench --bench relocalize reliability` fits it again and says what it is worth on matches that it was not
/// fitted to. The number of places, the share and the crowding of agreeing features and their distances were tried as
/// well: they add nothing on matches not seen in the fit.
const LOG_ODDS: [f64; Evidence::TERMS] = [-1.86, -1.63, 1.35];

impl Evidence {
    /// How many [`Self::terms`] there are.
    pub const TERMS: usize = 3;

    /// What the logarithm of the odds is linear in: 1, and the logarithms of the error to be expected and of the breadth.
    #[must_use]
    pub fn terms(&self) -> [f64; Self::TERMS] {
        [1.0, self.features_sigma_px.clamp(0.05, 100.0).ln(), self.breadth_px.clamp(1.0, 1000.0).ln()]
    }

    /// The probability that the features agree on what they show, and not on graphics, boards or by chance.
    #[must_use]
    pub fn agreement(&self) -> f64 {
        let log_odds: f64 = self.terms().iter().zip(LOG_ODDS).map(|(term, weight)| term * weight).sum();
        1.0 / (1.0 + (-log_odds).exp())
    }

    /// The probability that the overlay is right within 10 px at 1920 px width.
    #[must_use]
    pub fn confidence(&self) -> f64 {
        self.confidence_if(self.agreement())
    }

    /// The same if it is known otherwise how probable it is that the features agree on what they show: then the overlay errs as
    /// it is stated, and the error's length has a Rayleigh distribution.
    #[must_use]
    pub fn confidence_if(&self, agreement: f64) -> f64 {
        let within = 1.0 - (-(RIGHT_PX / self.labelled_sigma_px).powi(2)).exp();
        (agreement * within).min(self.at_most)
    }
}

#[cfg(test)]
mod tests {
    use super::{Evidence, FromReference};

    #[test]
    fn broad_and_exact_evidence_is_believed_and_a_row_of_boards_is_not() {
        let confidence = |breadth_px, features_sigma_px| {
            let from_reference = FromReference::default();
            let labelled_sigma_px = features_sigma_px;
            Evidence { breadth_px, features_sigma_px, labelled_sigma_px, from_reference, at_most: 1.0 }.confidence()
        };
        assert!(confidence(250.0, 0.5) > 0.99, "most of the picture");
        assert!(confidence(1.0, 1.4) < 0.15, "a row of boards");
        assert!(confidence(4.0, 10.0) < 0.05, "one board");
        assert!(confidence(100.0, 2.0) > confidence(100.0, 4.0) && confidence(200.0, 4.0) > confidence(100.0, 4.0));
        let labelled = |labelled_sigma_px| {
            let from_reference = FromReference::default();
            Evidence { breadth_px: 250.0, features_sigma_px: 0.5, labelled_sigma_px, from_reference, at_most: 1.0 }
        };
        assert!(labelled(2.0).confidence() > 0.99 && labelled(10.0).confidence() < 0.65, "labels of few clicks");
        assert!(Evidence { at_most: 0.9, ..labelled(2.0) }.confidence() <= 0.9, "left-out references were wrong");
        assert!(confidence(0.0, f64::INFINITY) < 0.01 && confidence(f64::INFINITY, 0.0) <= 1.0);
    }
}
