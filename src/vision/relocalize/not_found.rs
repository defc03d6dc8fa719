//! Why a picture has no camera.

use thiserror::Error;
use touchline_core::geometry::Angle;

/// Why no camera is returned. None of it is a failure of the program: some pictures cannot be
/// answered.
#[derive(Clone, Copy, Debug, PartialEq, Error)]
#[non_exhaustive]
pub enum NotFound {
    /// Hardly any feature looks like something in the references.
    #[error(
        "{matched} features look like the references, {needed} are needed; label a frame that looks here"
    )]
    FewMatches {
        /// Features with a candidate ray.
        matched: usize,
        /// As many are needed.
        needed: usize,
    },
    /// No camera is seen by enough features.
    #[error(
        "{agreeing} of {matched} features agree on a camera, {needed} are needed; label a frame that looks here"
    )]
    NoAgreement {
        /// Features with a candidate ray.
        matched: usize,
        /// Features that agree on the best camera.
        agreeing: usize,
        /// As many are needed.
        needed: usize,
    },
    /// The features agree on a camera that does not look where this one can.
    #[error(
        "the features agree on pan {pan}, tilt {tilt}, focal length {focal_px:.0} px, which this camera cannot do"
    )]
    Implausible {
        /// Pan.
        pan: Angle,
        /// Tilt.
        tilt: Angle,
        /// px of the frame.
        focal_px: f64,
    },
    /// The features agree, but only on what stands still on the screen, as burnt-in graphics do.
    #[error(
        "the {inliers} features that agree stand still on the screen while the picture moves, as a score bug or a logo does; \
         label a frame that looks here"
    )]
    StandsStill {
        /// Features that agree.
        inliers: usize,
    },
    /// There is a camera, but too much speaks against it.
    #[error(
        "{inliers} features in {places} places agree on a camera known to {worst_corner_sigma_px:.1} px: right with \
         probability {confidence:.2} only; label a frame that looks here"
    )]
    Unsure {
        /// The probability that it is right.
        confidence: f64,
        /// Features that agree.
        inliers: usize,
        /// In how many places of the picture.
        places: usize,
        /// 1-σ of the overlay at the worst corner, px.
        worst_corner_sigma_px: f64,
    },
}

impl NotFound {
    /// The code of the warning in documents.
    #[must_use]
    pub const fn code(&self) -> &'static str {
        match self {
            Self::FewMatches { .. } => "coverage",
            Self::NoAgreement { .. } | Self::Unsure { .. } => "few_inliers",
            Self::Implausible { .. } => "implausible",
            Self::StandsStill { .. } => "burnt_in",
        }
    }
}
