//! Why a camera is not pulled onto the paint.

use thiserror::Error;

/// Why a frame is not snapped to its painted lines.
#[derive(Clone, Copy, Debug, PartialEq, Error)]
pub enum SnapError {
    /// The camera or the picture predicts or shows too little paint.
    #[error("paint is seen at {found} places along the lines, {needed} are needed")]
    TooFewSamples {
        /// Samples with a ridge.
        found: usize,
        /// How many are needed.
        needed: usize,
    },
    /// The lines that are seen leave the camera open.
    #[error(
        "the lines that are seen leave the camera open (±{sigma_px:.0} px at the worst corner)"
    )]
    Undetermined {
        /// 1-σ of the overlay at the worst corner, px.
        sigma_px: f64,
    },
    /// The lines that are seen leave the lens open.
    #[error("the lines that are seen leave k1 open (±{sigma:.2})")]
    LensOpen {
        /// 1-σ of k₁.
        sigma: f64,
    },
    /// Two halves of the samples give two cameras.
    #[error(
        "two halves of the paint give cameras {apart_px:.1} px apart, {allowed_px:.1} px are allowed"
    )]
    HalvesDisagree {
        /// How far apart the overlays are, px.
        apart_px: f64,
        /// How far apart they may be, px.
        allowed_px: f64,
    },
    /// Other lines fit as well.
    #[error("another camera {apart_px:.0} px away fits the paint as well")]
    Ambiguous {
        /// How far apart the overlays are, px.
        apart_px: f64,
    },
    /// The paint speaks against the camera that it was pulled to.
    #[error("the paint does not bear the camera out (line check {score:.2})")]
    NotBorneOut {
        /// The line check's score, 0 to 1.
        score: f64,
    },
    /// The clicks lie far from where the lines put them.
    #[error("click {} would be {sigmas:.0} sigmas off", click + 1)]
    AgainstClicks {
        /// Which click, from 0.
        click: usize,
        /// How far off it would be, sigmas.
        sigmas: f64,
    },
}
