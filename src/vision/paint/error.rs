//! Why a camera is not aligned to the paint.

use thiserror::Error;
use touchline_core::geometry::pluralise;

/// Why a frame is not aligned to its painted lines.
#[derive(Clone, Copy, Debug, PartialEq, Error)]
pub enum SnapError {
    /// The camera predicts, or the picture shows, too little paint.
    #[error(
        "paint is seen at {} along the lines, {needed} are needed",
        pluralise(*.found, "place")
    )]
    TooFewSamples {
        /// Number of samples with a ridge.
        found: usize,
        /// Minimum number.
        needed: usize,
    },
    /// The visible lines do not determine the camera.
    #[error("the lines that are seen leave the camera open{}", corner_sigma(*.sigma_px))]
    Undetermined {
        /// 1-σ of the overlay at the worst corner, px; infinite if there is none.
        sigma_px: f64,
    },
    /// The visible lines do not determine the lens.
    #[error("the lines that are seen leave k1 open{}", k1_sigma(*.sigma))]
    LensOpen {
        /// 1-σ of k₁; infinite if there is none.
        sigma: f64,
    },
    /// Two halves of the samples give different cameras.
    #[error(
        "two halves of the paint give cameras {}, {allowed_px:.1} px are allowed",
        distance_of_cameras(*.apart_px)
    )]
    HalvesDisagree {
        /// Distance between the overlays of the two cameras, px; infinite if they show hardly
        /// anything in common.
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
    #[error("click {} would be {}", click + 1, distance_of_click(*.sigmas))]
    AgainstClicks {
        /// Index of the click.
        click: usize,
        /// Distance from the click to where the camera puts it, in σ of the click; infinite where
        /// the camera cannot see it.
        sigmas: f64,
    },
}

/// The 1-σ of the overlay in brackets, where there is one.
fn corner_sigma(sigma_px: f64) -> String {
    if sigma_px.is_finite() {
        format!(" (±{sigma_px:.0} px at the worst corner)")
    } else {
        String::new()
    }
}

/// The 1-σ of k₁ in brackets, where there is one.
fn k1_sigma(sigma: f64) -> String {
    if sigma.is_finite() {
        format!(" (±{sigma:.2})")
    } else {
        String::new()
    }
}

/// How far two cameras are apart.
fn distance_of_cameras(apart_px: f64) -> String {
    if apart_px.is_finite() {
        format!("{apart_px:.1} px apart")
    } else {
        "that look elsewhere".to_owned()
    }
}

/// How far a click is off.
fn distance_of_click(sigmas: f64) -> String {
    if sigmas.is_finite() {
        format!("{sigmas:.0} sigmas off")
    } else {
        "out of sight".to_owned()
    }
}

#[cfg(test)]
mod tests {
    use super::SnapError;

    #[test]
    fn no_message_has_an_infinite_number_or_a_wrong_plural() {
        let (sigma_px, sigma, sigmas) = (f64::INFINITY, f64::INFINITY, f64::INFINITY);
        let (apart_px, allowed_px) = (f64::INFINITY, 1.5);
        for (error, says) in [
            (
                SnapError::TooFewSamples {
                    found: 1,
                    needed: 40,
                },
                "paint is seen at 1 place along the lines, 40 are needed",
            ),
            (
                SnapError::Undetermined { sigma_px },
                "the lines that are seen leave the camera open",
            ),
            (
                SnapError::Undetermined { sigma_px: 9.4 },
                "the lines that are seen leave the camera open (±9 px at the worst corner)",
            ),
            (
                SnapError::LensOpen { sigma },
                "the lines that are seen leave k1 open",
            ),
            (
                SnapError::HalvesDisagree {
                    apart_px,
                    allowed_px,
                },
                "two halves of the paint give cameras that look elsewhere, 1.5 px are allowed",
            ),
            (
                SnapError::HalvesDisagree {
                    apart_px: 2.0,
                    allowed_px,
                },
                "two halves of the paint give cameras 2.0 px apart, 1.5 px are allowed",
            ),
            (
                SnapError::AgainstClicks { click: 2, sigmas },
                "click 3 would be out of sight",
            ),
        ] {
            assert_eq!(error.to_string(), says);
        }
    }
}
