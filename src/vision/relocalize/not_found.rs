//! Reasons why relocalization returns no camera.

use thiserror::Error;
use touchline_core::geometry::{Angle, pluralise};

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
        "{inliers} features in {} agree on a camera {}: right with probability {confidence:.2} only; label a frame that \
         looks here",
        pluralise(*places, "place"), accuracy(*worst_corner_sigma_px)
    )]
    Unsure {
        /// The probability that it is right.
        confidence: f64,
        /// Features that agree.
        inliers: usize,
        /// Number of cells of the picture that contain them.
        places: usize,
        /// 1-σ of the overlay at the worst corner, px; infinite if the picture leaves it open.
        worst_corner_sigma_px: f64,
    },
}

/// How well a camera is known, in words.
fn accuracy(worst_corner_sigma_px: f64) -> String {
    if worst_corner_sigma_px.is_finite() {
        format!("known to {worst_corner_sigma_px:.1} px")
    } else {
        "that does not determine the overlay".to_owned()
    }
}

impl NotFound {
    /// The code of the warning in documents.
    pub const fn code(&self) -> &'static str {
        match self {
            Self::FewMatches { .. } => "coverage",
            Self::NoAgreement { .. } | Self::Unsure { .. } => "few_inliers",
            Self::Implausible { .. } => "implausible",
            Self::StandsStill { .. } => "burnt_in",
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn an_unsure_camera_says_how_well_it_is_known() {
        for (places, worst_corner_sigma_px, expected) in [
            (1, 41.3, "1 place agree on a camera known to 41.3 px"),
            (
                3,
                f64::INFINITY,
                "3 places agree on a camera that does not determine the overlay",
            ),
        ] {
            let unsure = NotFound::Unsure {
                confidence: 0.2,
                inliers: 8,
                places,
                worst_corner_sigma_px,
            };
            let said = unsure.to_string();
            assert!(
                said.starts_with(&format!("8 features in {expected}: right")),
                "{said}"
            );
        }
    }
}
