//! How probable it is that an answer is right: its overlay within 10 px at 1920 px width.
//!
//! Two things have to be so, and the probability is their product:
//!
//! 1. **The features agree on the stadium**, and not on graphics, boards or by chance. The number
//!    of agreeing features says little: those of one advertising board agree on a wrong camera in
//!    any number. What tells is how far they spread where they spread least, and how well they fix
//!    the overlay ([`Evidence::agreement`], a logistic curve fitted to 1,570 answers whose truth is
//!    known).
//! 2. **The overlay is exact enough.** Its error has a Rayleigh distribution whose 1-σ is what
//!    labels leave open, and grows with the turn from the nearest reference: a lens that is not
//!    quite right is made up for where a reference looks, and elsewhere it is not.
//!
//! No probability is stated that references which were left out do not bear out
//! ([`Evidence::at_most`]). The painted lines are other evidence; where a picture shows them they
//! replace the first factor (`proposals::LineEvidence`).
//!
//! `cargo bench --bench relocalize reliability` fits the curve again, `trust` counts how often an
//! answer was certain and wrong.

use super::SeenRange;
use super::nearest_references::nearest;
use serde::Serialize;
use touchline_core::camera::{AngularDistance, Ptz};
use touchline_core::geometry::ImageSize;

/// What speaks for an answer. How many features agree says little: those of one advertising board,
/// or of a row of them, agree on a wrong camera in any number. Boards are narrow, though, and what
/// narrow evidence fixes is fixed badly.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Evidence {
    /// How far agreeing features spread where they spread least, px at 1920 px width.
    pub breadth_px: f64,
    /// 1-σ of the overlay at the worst corner of the picture by the features alone, px at 1920 px
    /// width.
    pub features_sigma_px: f64,
    /// The same with what the references' labels leave open. What the base leaves open is not in
    /// it: it is the same for all frames, and the references show it.
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

/// 1-σ by which an overlay is off more at its worst corner where the camera turned away from the
/// nearest reference by the width of its picture, px at 1920 px width.
///
/// A lens and a base that are not quite right are made up for by the camera of each reference, as
/// well as its clicks show where it looks. Elsewhere that fits less well: features seen at one edge
/// of the reference are at the other edge now. Of greatest likelihood, over 337 answers on frames
/// of three real matches with all references of other clips, those farther than 8° away and two
/// (`cargo bench --bench relocalize trust`), are 11 px across the picture and, by the focal length,
/// 17 px at its left and right edge. One match alone gives 5 to 18 and 10 to 24 px, so that this is
/// an average over cameras: it says how probable a right overlay is, and does not widen the
/// covariance of each.
const PER_TURN_PX: f64 = 22.0;

/// From this turn on, in widths of the picture, an overlay is not off more: so far away features
/// agree on a camera only where much else is seen.
const FARTHEST_TURN: f64 = 0.35;

/// An overlay that is off by no more is right, px at 1920 px width.
const RIGHT_PX: f64 = 10.0;

impl FromReference {
    /// How far a camera is from the nearest reference; nothing where none is known.
    pub(super) fn of(ptz: &Ptz, image_size: ImageSize, seen: &SeenRange) -> Self {
        let Some(number) = nearest(ptz, &seen.cameras, 1).into_iter().next() else {
            return Self::default();
        };
        Self::between(ptz, &seen.cameras[number], image_size)
    }

    /// How far a camera is from a reference.
    pub(super) fn between(ptz: &Ptz, reference: &Ptz, image_size: ImageSize) -> Self {
        let AngularDistance { turn, log_zoom } = AngularDistance::between(ptz, reference);
        Self {
            turn: turn.radians() * ptz.focal_px / f64::from(image_size.width),
            zoom: log_zoom.abs(),
        }
    }
}

/// The logarithm of the odds that an overlay is right within 10 px at 1920 px width, by
/// [`Evidence::terms`]: the logistic curve of greatest likelihood over 1086 answers on frames of
/// three real matches, each from references of other clips and mostly from too few of them, and 484
/// on drawn pictures where chance and repeated boards agree, these at 0.3 of the weight.
/// `cargo bench --bench relocalize reliability` fits it again and says what it is worth on matches
/// that it was not fitted to. The number of places, the share and the crowding of agreeing features
/// and their distances were tried as well: they add nothing on matches not seen in the fit.
const LOG_ODDS: [f64; Evidence::TERMS] = [-1.86, -1.63, 1.35];

impl Evidence {
    /// How many [`Self::terms`] there are.
    pub const TERMS: usize = 3;

    /// What the logarithm of the odds is linear in: 1, and the logarithms of the error to be
    /// expected and of the breadth.
    #[must_use]
    pub fn terms(&self) -> [f64; Self::TERMS] {
        [
            1.0,
            self.features_sigma_px.clamp(0.05, 100.0).ln(),
            self.breadth_px.clamp(1.0, 1000.0).ln(),
        ]
    }

    /// The probability that the features agree on what they show, and not on graphics, boards or by
    /// chance.
    #[must_use]
    pub fn agreement(&self) -> f64 {
        let log_odds: f64 = self
            .terms()
            .iter()
            .zip(LOG_ODDS)
            .map(|(term, weight)| term * weight)
            .sum();
        1.0 / (1.0 + (-log_odds).exp())
    }

    /// The probability that the overlay is right within 10 px at 1920 px width.
    #[must_use]
    pub fn confidence(&self) -> f64 {
        self.confidence_if(self.agreement(), 0.0)
    }

    /// The same if it is known otherwise how probable it is that the features agree on what they
    /// show: then the overlay errs as the labels and the way from them leave it, and by what else
    /// is seen of it, a 1-σ in px at 1920 px width. The error's length has a Rayleigh distribution.
    #[must_use]
    pub fn confidence_if(&self, agreement: f64, seen_sigma_px: f64) -> f64 {
        let by_turning = PER_TURN_PX * self.from_reference.turn.min(FARTHEST_TURN);
        let sigma_px = self
            .labelled_sigma_px
            .hypot(by_turning)
            .hypot(seen_sigma_px);
        let within = 1.0 - (-(RIGHT_PX / sigma_px).powi(2)).exp();
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
            Evidence {
                breadth_px,
                features_sigma_px,
                labelled_sigma_px,
                from_reference,
                at_most: 1.0,
            }
            .confidence()
        };
        assert!(confidence(250.0, 0.5) > 0.99, "most of the picture");
        assert!(confidence(1.0, 1.4) < 0.15, "a row of boards");
        assert!(confidence(4.0, 10.0) < 0.05, "one board");
        assert!(
            confidence(100.0, 2.0) > confidence(100.0, 4.0)
                && confidence(200.0, 4.0) > confidence(100.0, 4.0)
        );
        let labelled = |labelled_sigma_px| {
            let from_reference = FromReference::default();
            Evidence {
                breadth_px: 250.0,
                features_sigma_px: 0.5,
                labelled_sigma_px,
                from_reference,
                at_most: 1.0,
            }
        };
        assert!(
            labelled(2.0).confidence() > 0.99 && labelled(10.0).confidence() < 0.65,
            "labels of few clicks"
        );
        let turned = |turn| {
            Evidence {
                from_reference: FromReference { turn, zoom: 0.0 },
                ..labelled(1.0)
            }
            .confidence()
        };
        assert!(
            turned(0.1) > 0.99 && turned(0.3) < 0.95 && turned(0.6) > 0.7,
            "the camera turned away from all references"
        );
        assert!(
            labelled(1.0).confidence_if(1.0, 1.0) > 0.99
                && labelled(1.0).confidence_if(1.0, 7.0) < 0.9,
            "seen off"
        );
        assert!(
            Evidence {
                at_most: 0.9,
                ..labelled(2.0)
            }
            .confidence()
                <= 0.9,
            "left-out references were wrong"
        );
        assert!(confidence(0.0, f64::INFINITY) < 0.01 && confidence(f64::INFINITY, 0.0) <= 1.0);
    }
}
