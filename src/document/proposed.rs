//! What the program proposed for a frame: where a person's correction starts from.

use super::{Frame, FramePtz, Solution, SolutionSource, adapters};
use crate::geometry::Mat3;
use serde::{Deserialize, Serialize};

/// A camera that the program proposed. A frame keeps it when a person corrects it: fewer clicks than decide by themselves
/// start from it, and without clicks it holds again.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Proposed {
    /// How the camera was pointed.
    #[serde(flatten)]
    pub ptz: FramePtz,
    /// Who proposed it.
    pub source: SolutionSource,
    /// The probability that it is right.
    #[serde(default, with = "adapters::optional_number", skip_serializing_if = "Option::is_none")]
    pub confidence: Option<f64>,
    /// Its covariance in the order `pan_deg`, `tilt_deg`, `focal_px`.
    #[serde(default, with = "adapters::optional_matrix", skip_serializing_if = "Option::is_none")]
    pub covariance: Option<Mat3>,
    /// 1-σ of its overlay at the worst corner of the picture, px.
    #[serde(default, with = "adapters::optional_number", skip_serializing_if = "Option::is_none")]
    pub worst_corner_sigma_px: Option<f64>,
}

impl Frame {
    /// What the program proposed, whether or not it was corrected since.
    #[must_use]
    pub fn proposed(&self) -> Option<Proposed> {
        let solution = self.solution.as_ref()?;
        if let Some(kept) = &solution.proposed {
            return Some(kept.clone());
        }
        let (source, ptz) = (solution.source?, self.ptz.clone().filter(|_| self.is_suggestion())?);
        let (covariance, worst_corner_sigma_px) = (solution.covariance, solution.worst_corner_sigma_px);
        Some(Proposed { ptz, source, confidence: solution.confidence, covariance, worst_corner_sigma_px })
    }

    /// Whether a person corrected a proposal and no click is left of it: then the proposal holds again. True if it does now.
    pub fn restore_proposed(&mut self) -> bool {
        let Some(proposed) = self.solution.as_mut().and_then(|solution| solution.proposed.take()) else { return false };
        let Proposed { ptz, source, confidence, covariance, worst_corner_sigma_px } = proposed;
        self.ptz = Some(ptz);
        let source = Some(source);
        self.solution = Some(Solution { covariance, worst_corner_sigma_px, source, confidence, ..Solution::default() });
        true
    }
}
