//! The verdict on a solved frame, with its reason.

use crate::geometry::ImageSize;
use crate::solve::{Evidence, FrameSolution, WarningCode};
use serde::{Deserialize, Serialize};
use std::fmt;

/// A good frame has at most this 1-σ at the worst corner, px at 1920 px width.
pub const GOOD_CORNER_SIGMA_PX: f64 = 7.0;

/// An overlay with an error of at most this is right, px at 1920 px width.
pub const RIGHT_PX: f64 = 10.0;

/// The probability that an overlay is right, from its 1-σ at the worst corner, px at 1920 px width.
///
/// The error's length has a Rayleigh distribution, P(e ≤ r) = 1 − exp(−r²/s²), where s² is the
/// expected squared length, twice the variance along one axis.
pub fn probability_right(corner_sigma_px: f64) -> f64 {
    1.0 - (-(RIGHT_PX / corner_sigma_px).powi(2)).exp()
}

/// From this misfit on, the clicks contradict each other (see [`FrameSolution::misfit`]).
pub const WRONG_MISFIT: f64 = 4.0;

/// From this misfit on, the frame should be checked.
pub const CHECK_MISFIT: f64 = 2.0;

/// The verdict on a solved frame.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
#[serde(rename_all = "snake_case")]
pub enum Verdict {
    /// Nothing speaks against it.
    Good,
    /// Look at it before accepting it.
    Check,
    /// Something in it contradicts something else.
    Wrong,
}

impl fmt::Display for Verdict {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.pad(match self {
            Self::Good => "Good",
            Self::Check => "Check",
            Self::Wrong => "Wrong",
        })
    }
}

/// A verdict with its reason.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Judgement {
    /// The one word.
    pub verdict: Verdict,
    /// The reason in one line, with its number.
    pub reason: String,
}

impl Judgement {
    const fn new(verdict: Verdict, reason: String) -> Self {
        Self { verdict, reason }
    }
}

/// The verdict on a solved frame, by its check clicks, its names, the contradiction among its
/// clicks, its warnings and its worst corner, in this order.
pub fn judge(solution: &FrameSolution, image_size: ImageSize) -> Judgement {
    let corner = solution.corner_sigma_px_if_known().map_or_else(
        || "the lens shows no corner of the picture: check its distortion".to_owned(),
        |sigma_px| format!("worst corner ±{sigma_px:.1} px"),
    );
    // If other names fit better, the frame is wrong. If they fit as well and are only favoured by
    // the motion prior, the user should check.
    let contradicted = solution
        .identity
        .as_ref()
        .is_some_and(|found| found.evidence == Evidence::Clicks);
    let wrong = solution
        .warnings
        .iter()
        .find(|warning| is_wrong(warning.code, contradicted));
    if let Some(warning) = wrong {
        return Judgement::new(Verdict::Wrong, warning.message.clone());
    }
    // The misfit of a single surplus equation is large by chance more often than the mean of many:
    // add 1 / redundancy to the thresholds.
    let chance = 1.0 / solution.redundancy.max(1) as f64;
    if let Some(misfit) = solution
        .misfit()
        .filter(|misfit| *misfit > CHECK_MISFIT + chance)
    {
        let verdict = if misfit > WRONG_MISFIT + chance {
            Verdict::Wrong
        } else {
            Verdict::Check
        };
        let contradicting = solution
            .warnings
            .iter()
            .find(|warning| warning.code == WarningCode::Contradiction);
        let reason = match contradicting {
            Some(warning) => warning.message.clone(),
            None => format!(
                "points are up to {:.1} px off, {misfit:.1} times what is usual",
                solution.farthest_px()
            ),
        };
        return Judgement::new(verdict, reason);
    }
    if let Some(warning) = solution.warnings.first() {
        return Judgement::new(Verdict::Check, warning.message.clone());
    }
    if !(solution.worst_corner_sigma_px <= GOOD_CORNER_SIGMA_PX * image_size.scale_from_1920()) {
        return Judgement::new(Verdict::Check, corner);
    }
    let evidence = if solution.residuals_are_evidence() {
        format!("clicks fit to {:.1} px", solution.rms_px)
    } else {
        "no evidence beyond two clicks".to_owned()
    };
    Judgement::new(Verdict::Good, format!("{corner}; {evidence}"))
}

/// Whether a warning alone makes a frame wrong. One about names does where the clicks contradict
/// each other as named.
const fn is_wrong(code: WarningCode, contradicted: bool) -> bool {
    match code {
        WarningCode::CheckFailed | WarningCode::OtherCamera => true,
        WarningCode::Swapped | WarningCode::WrongLine | WarningCode::Mirrored => contradicted,
        _ => false,
    }
}
