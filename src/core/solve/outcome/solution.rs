//! The result of solving a frame.

use crate::camera::{Ptz, PtzCamera, Radial};
use crate::geometry::{Angle, Mat3, Vec2};
use crate::solve::{IdentityFinding, Observation, PtzStep, Uncertainty, Warning, WarningCode};
use serde::Serialize;

/// A camera that fits the clicks of a frame, but was not chosen.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct Candidate {
    /// Pan, tilt, focal length.
    pub ptz: Ptz,
    /// Root mean square reprojection error of the clicks, px.
    pub rms_px: f64,
    /// Σ (distance / sigma)² over its clicks.
    pub chi_squared: f64,
    /// Within the plausible ranges.
    pub plausible: bool,
}

/// The reprojection error of one click.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct ClickResidual {
    /// Which click, from 0.
    pub click: usize,
    /// From the projected landmark, or the nearest point of the projected line, to the click, px.
    /// None where the landmark or line has no image, for example behind the camera.
    pub offset_px: Option<Vec2>,
    /// The click's own 1-σ, px.
    pub sigma_px: f64,
}

impl ClickResidual {
    /// The reprojection error of a click under a camera.
    pub fn from_observation(camera: &PtzCamera, observation: &Observation) -> Self {
        let offset_px = observation.shape.offset_px(camera, observation.image);
        Self {
            click: observation.click,
            offset_px,
            sigma_px: observation.sigma_px,
        }
    }

    /// The distance, px.
    pub fn distance_px(&self) -> Option<f64> {
        self.offset_px.map(|offset| offset.norm())
    }
}

/// The error of a click that was held out of the solve.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct CheckResult {
    /// Which click, from 0.
    pub click: usize,
    /// Its distance from the projected landmark or line, px; none where the solution gives it no
    /// image.
    pub error_px: Option<f64>,
    /// That distance in sigmas of click noise and prediction together: for a landmark the
    /// Mahalanobis distance (for correct clicks, 50 % are below 1.2 and 99 % below 3.0), for a line
    /// the ratio of distance and σ. None where there is no image.
    pub z_score: Option<f64>,
}

/// Pan, tilt and focal length of a frame, solved from its clicks and a base.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct FrameSolution {
    /// The result.
    pub ptz: Ptz,
    /// The lens at this focal length.
    #[serde(flatten)]
    pub lens: Radial,
    /// Covariance in the order pan (deg), tilt (deg), focal length (px), as documents hold it.
    #[serde(serialize_with = "crate::geometry::rows")]
    pub covariance: Mat3,
    /// The same in radians, with the base's part kept separate; it gives the uncertainty of the
    /// overlay at any pixel.
    #[serde(skip)]
    pub uncertainty: Uncertainty,
    /// One for each click that took part, in the order given.
    pub residuals: Vec<ClickResidual>,
    /// Root mean square of their distances, px.
    pub rms_px: f64,
    /// Surplus equations: 0 means the residuals prove nothing; two landmarks leave one, a weak
    /// check.
    pub redundancy: usize,
    /// Σ (distance / sigma)² of the residuals.
    pub chi_squared: f64,
    /// The expectation of `chi_squared` if all names are correct: `redundancy`, and more where the
    /// base is uncertain.
    pub expected_chi_squared: f64,
    /// Other cameras that fit the same clicks, best first.
    pub alternatives: Vec<Candidate>,
    /// 1-σ (root of the trace) of the overlay at the frame's worst corner, px; the base's
    /// uncertainty included.
    pub worst_corner_sigma_px: f64,
    /// The largest distance between two landmark clicks, px; none with fewer than two.
    pub separation_px: Option<f64>,
    /// The errors of the held-out clicks.
    pub checks: Vec<CheckResult>,
    /// Warnings for the user, the most serious first.
    pub warnings: Vec<Warning>,
    /// Names that fit better, or as well; the first of the warnings reports them. Only
    /// [`check_identity`](crate::solve::check_identity) finds them.
    pub identity: Option<IdentityFinding>,
}

impl FrameSolution {
    /// Whether the residuals are evidence for the solution: more than two clicks, and more
    /// equations than unknowns. For two clicks alone show "no evidence" instead of a small number.
    pub fn residuals_are_evidence(&self) -> bool {
        self.redundancy > 0 && self.residuals.len() > 2
    }

    /// How many times larger than expected the residuals are (root of χ² over its expectation);
    /// none without surplus equations.
    pub fn misfit(&self) -> Option<f64> {
        (self.redundancy > 0).then(|| (self.chi_squared / self.expected_chi_squared).sqrt())
    }

    /// The largest reprojection error of a click that was used, px; 0 where none has an image.
    pub fn farthest_px(&self) -> f64 {
        self.residuals
            .iter()
            .filter_map(ClickResidual::distance_px)
            .fold(0.0, f64::max)
    }

    /// [`Self::worst_corner_sigma_px`] as documents state it, which cannot express that it is
    /// infinite: none then.
    pub fn corner_sigma_px_if_known(&self) -> Option<f64> {
        Some(self.worst_corner_sigma_px).filter(|sigma_px| sigma_px.is_finite())
    }

    /// The 1-σ at the worst corner in words.
    pub fn describe_corner(&self) -> String {
        self.corner_sigma_px_if_known().map_or_else(
            || "unknown".to_owned(),
            |sigma_px| format!("±{sigma_px:.1} px"),
        )
    }

    /// 1-σ of the pan.
    pub fn sigma_pan(&self) -> Angle {
        Angle::from_degrees(self.covariance[(0, 0)].sqrt())
    }

    /// 1-σ of the tilt.
    pub fn sigma_tilt(&self) -> Angle {
        Angle::from_degrees(self.covariance[(1, 1)].sqrt())
    }

    /// Adds the result of the search for other names; its warning comes before all others.
    #[must_use]
    pub fn with_identity(mut self, found: Option<IdentityFinding>) -> Self {
        self.warnings
            .splice(0..0, found.as_ref().map(IdentityFinding::warning));
        self.identity = found;
        self
    }

    /// The clicks that the others, or the camera, contradict, in order.
    pub fn disputed_clicks(&self) -> Vec<usize> {
        let mut clicks: Vec<usize> = self
            .warnings
            .iter()
            .filter(|warning| self.disputes_clicks(warning))
            .flat_map(|warning| &warning.clicks)
            .copied()
            .collect();
        clicks.sort_unstable();
        clicks.dedup();
        clicks
    }

    /// Whether a warning says that its clicks are wrong.
    fn disputes_clicks(&self, warning: &Warning) -> bool {
        match warning.code {
            WarningCode::Swapped | WarningCode::WrongLine | WarningCode::CheckFailed => true,
            // Two clicks that contradict the base do not show which of them is wrong.
            WarningCode::Contradiction => warning.clicks.len() < self.residuals.len().max(2),
            _ => false,
        }
    }

    /// The uncertainty of the result due to click noise and the base: three sigmas.
    pub(in crate::solve) fn slack(&self) -> PtzStep {
        PtzStep {
            pan: self.sigma_pan() * 3.0,
            tilt: self.sigma_tilt() * 3.0,
            log_focal: 3.0 * self.sigma_focal_px() / self.ptz.focal_px,
        }
    }

    /// 1-σ of the focal length, px.
    pub fn sigma_focal_px(&self) -> f64 {
        self.covariance[(2, 2)].sqrt()
    }
}
