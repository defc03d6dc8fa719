//! Why a camera is not aligned to the paint.

use thiserror::Error;

/// Why a frame is not aligned to its painted lines.
#[derive(Clone, Copy, Debug, PartialEq, Error)]
pub enum SnapError {
    /// The camera predicts, or the picture shows, too little paint.
    #[error("paint is seen at {found} places along the lines, {needed} are needed")]
    TooFewSamples {
        /// Number of samples with a ridge.
        found: usize,
        /// Minimum number.
        needed: usize,
    },
    /// The visible lines do not determine the camera.
    #[error(
        "the lines that are seen leave the camera open (±{sigma_px:.0} px at the worst corner)"
    )]
    Undetermined {
        /// 1-σ of the overlay at the worst corner, px.
        sigma_px: f64,
    },
    /// The visible lines do not determine the lens.
    #[error("the lines that are seen leave k1 open (±{sigma:.2})")]
    LensOpen {
        /// 1-σ of k₁.
        sigma: f64,
    },
    /// Two halves of the samples give different cameras.
    #[error(
        "two halves of the paint give cameras {apart_px:.1} px apart, {allowed_px:.1} px are allowed"
    )]
    HalvesDisagree {
        /// Distance between the overlays of the two cameras, px.
        apart_px: f64,
        /// Maximum distance, px.
        allowed_px: f64,
    },
    /// Another camera fits the paint as well.
    #[error("another camera {apart_px:.0} px away fits the paint as well")]
    Ambiguous {
        /// Distance between the overlays of the two cameras, px.
        apart_px: f64,
    },
    /// The line check of the aligned camera fails.
    #[error("the paint does not bear the camera out (line check {score:.2})")]
    NotBorneOut {
        /// The line check's score, 0 to 1.
        score: f64,
    },
    /// A click lies far from where the aligned camera puts it.
    #[error("click {} would be {sigmas:.0} sigmas off", click + 1)]
    AgainstClicks {
        /// Index of the click.
        click: usize,
        /// Distance from the click to where the camera puts it, in σ of the click.
        sigmas: f64,
    },
}
