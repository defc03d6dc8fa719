//! Reasons why relocalization returns no camera.

use thiserror::Error;
use touchline_core::geometry::Angle;

/// The reason why no camera is returned. None of these is a failure of the program: some pictures
/// cannot be relocalized.
#[derive(Clone, Copy, Debug, PartialEq, Error)]
#[non_exhaustive]
pub enum NotFound {
    /// Too few features have a similar one in the references.
    #[error(
        "{matched} features look like the references, {needed} are needed; label a frame that looks here"
    )]
    FewMatches {
        /// Features with a candidate ray.
        matched: usize,
        /// Minimum number of such features.
        needed: usize,
    },
    /// No camera has enough inliers.
    #[error(
        "{agreeing} of {matched} features agree on a camera, {needed} are needed; label a frame that looks here"
    )]
    NoAgreement {
        /// Features with a candidate ray.
        matched: usize,
        /// Features that agree on the best camera.
        agreeing: usize,
        /// Minimum number of inliers.
        needed: usize,
    },
    /// The features agree on a camera outside the range of pan, tilt and focal length of this one.
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
    /// The features agree, but all of them stand still on the screen, as burnt-in graphics do.
    #[error(
        "the {inliers} features that agree stand still on the screen while the picture moves, as a score bug or a logo does; \
         label a frame that looks here"
    )]
    StandsStill {
        /// Features that agree.
        inliers: usize,
    },
    /// There is a camera, but its probability is below the required one.
    #[error(
        "{inliers} features in {places} places agree on a camera known to {worst_corner_sigma_px:.1} px: right with \
         probability {confidence:.2} only; label a frame that looks here"
    )]
    Unsure {
        /// The probability that it is right.
        confidence: f64,
        /// Features that agree.
        inliers: usize,
        /// Number of cells of the picture that contain them.
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
