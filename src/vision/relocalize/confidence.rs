//! The probability that an answer is right: that its overlay is within 10 px at 1920 px width.
//!
//! It is the product of two probabilities:
//!
//! 1. **The features agree on the stadium**, and not on graphics, boards or by chance. The number
//!    of inliers says little: those of one advertising board agree on a wrong camera in any number.
//!    What discriminates is their extent along the axis of least spread, and how well they
//!    determine the overlay ([`Evidence::agreement`], a logistic curve fitted to 1,570 answers with
//!    known truth).
//! 2. **The overlay is accurate enough.** Its error has a Rayleigh distribution. The 1-σ comes from
//!    the uncertainty of the labels and grows with the rotation from the nearest reference: small
//!    errors of the lens are absorbed by the camera of a reference, but not elsewhere.
//!
//! The result is bounded by the success rate on references that were left out of the training
//! ([`Evidence::at_most`]). Painted lines are independent evidence; where a picture shows them they
//! replace the first factor (`proposals::LineEvidence`).
//!
//! `cargo bench --bench relocalize reliability` fits the curve again; `trust` counts how often an
//! answer was certain and wrong.

use super::SeenRange;
use super::nearest_references::nearest;
use serde::Serialize;
use touchline_core::camera::{AngularDistance, Ptz};
use touchline_core::geometry::ImageSize;
use touchline_core::solve::probability_right;

/// The evidence for an answer. The number of inliers is not part of it: those of one advertising
/// board, or of a row of them, agree on a wrong camera in any number. But boards are narrow, and
/// narrow evidence determines the camera badly.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Evidence {
    /// Standard deviation of the inliers along the axis of least spread, px at 1920 px width.
    pub breadth_px: f64,
    /// 1-σ of the overlay at the worst corner of the picture by the features alone, px at 1920 px
    /// width.
    pub features_sigma_px: f64,
    /// The same, with the uncertainty of the references' labels. That of the base is excluded: it
    /// is common to all frames, references included.
    pub labelled_sigma_px: f64,
    /// Rotation and zoom relative to the nearest reference.
    pub from_reference: FromReference,
    /// Upper bound of the probability, from answers about references left out of the training.
    pub at_most: f64,
}

/// Rotation and zoom of a camera relative to the nearest reference.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize)]
pub struct FromReference {
    /// Rotation of the optical axis, as a share of the picture's width.
    pub turn: f64,
    /// Absolute logarithm of the ratio of the focal lengths.
    pub zoom: f64,
}

/// Additional 1-σ of the overlay at its worst corner per rotation by the width of the picture from
/// the nearest reference, px at 1920 px width.
///
/// The camera of a reference absorbs small errors of lens and base where the reference looks.
/// Elsewhere that fits less well: features at one edge of the reference are at the other edge of
/// the picture. The maximum likelihood values are 11 px across the picture and, by the focal
/// length, 17 px at its left and right edges. They come from 337 answers on frames of three real
/// matches, with references of other clips: all, those farther than 8° away, and two (`cargo bench
/// --bench relocalize trust`). Single matches give 5 to 18 and 10 to 24 px. So this is an average
/// over cameras: it enters the probability of an answer, but does not inflate the covariance of
/// each.
const PER_TURN_PX: f64 = 22.0;

/// The additional error stops growing at this rotation, in picture widths: so far away features
/// agree on a camera only if they cover much of the picture otherwise.
const FARTHEST_TURN: f64 = 0.35;

impl FromReference {
    /// Relative to the nearest reference; zero if none is known.
    pub(super) fn from_nearest(ptz: &Ptz, image_size: ImageSize, seen: &SeenRange) -> Self {
        let Some(number) = nearest(ptz, &seen.cameras, 1).into_iter().next() else {
            return Self::default();
        };
        Self::between(ptz, &seen.cameras[number], image_size)
    }

    /// Relative to a given reference.
    pub(super) fn between(ptz: &Ptz, reference: &Ptz, image_size: ImageSize) -> Self {
        let AngularDistance { turn, log_zoom } = AngularDistance::between(ptz, reference);
        Self {
            turn: turn.radians() * ptz.focal_px / f64::from(image_size.width),
            zoom: log_zoom.abs(),
        }
    }
}

/// Coefficients of the log odds that an overlay is right within 10 px at 1920 px width, for
/// [`Evidence::terms`].
///
/// Maximum likelihood logistic curve over 1086 answers on frames of three real matches, each from
/// references of other clips and mostly from too few of them, and 484 answers on drawn pictures
/// where chance and repeated boards agree, the latter with weight 0.3. `cargo bench --bench
/// relocalize reliability` fits it again and evaluates it on matches that it was not fitted to.
/// Number of occupied cells, share of inliers, their crowding and their distances were tried as
/// further terms: they gain nothing on matches outside the fit.
const LOG_ODDS: [f64; Evidence::TERMS] = [-1.86, -1.63, 1.35];

impl Evidence {
    /// Number of [`Self::terms`].
    pub const TERMS: usize = 3;

    /// The terms in which the log odds are linear: 1, and the logarithms of the expected error and
    /// of the extent.
    pub fn terms(&self) -> [f64; Self::TERMS] {
        // The clamps keep the logarithms finite for exact or degenerate evidence: a σ of 0, or
        // inliers without extent.
        [
            1.0,
            self.features_sigma_px.clamp(0.05, 100.0).ln(),
            self.breadth_px.clamp(1.0, 1000.0).ln(),
        ]
    }

    /// The probability that the features agree on the stadium, and not on graphics, boards or by
    /// chance.
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
    pub fn confidence(&self) -> f64 {
        self.confidence_if(self.agreement(), 0.0)
    }

    /// The same with a given probability that the features agree on the stadium, from other
    /// evidence such as painted lines, and with a further 1-σ of the overlay from that evidence, px
    /// at 1920 px width.
    pub fn confidence_if(&self, agreement: f64, seen_sigma_px: f64) -> f64 {
        // The three parts have different causes (labels, lens and base, other evidence), so their
        // variances add.
        let by_turning = PER_TURN_PX * self.from_reference.turn.min(FARTHEST_TURN);
        let sigma_px = self
            .labelled_sigma_px
            .hypot(by_turning)
            .hypot(seen_sigma_px);
        let probability = agreement * probability_right(sigma_px);
        // `f64::min` would take the bound in place of a probability that is not a number.
        if probability.is_nan() {
            0.0
        } else {
            probability.min(self.at_most)
        }
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
        assert!(
            confidence(f64::NAN, 0.5) == 0.0 && confidence(250.0, f64::NAN) == 0.0,
            "evidence that could not be computed"
        );
    }
}
