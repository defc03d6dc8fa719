//! The values of the frame's camera that the window shows. While an estimated base waits for a
//! decision, lines, residuals, verdict and numbers all refer to that base, and none to the current
//! one.

use crate::app::App;
use touchline_calibration::calibrate::CalibrationError;
use touchline_core::camera::{CameraBase, PtzCamera};
use touchline_core::solve::{ClickResidual, FrameSolution, Judgement};

/// The shown frame's values with either the current base or an estimated one.
#[derive(Clone, Debug)]
pub struct DisplayedValues<'a> {
    pub base: Option<CameraBase>,
    /// The frame's camera.
    pub camera: Option<PtzCamera>,
    /// The solution from the clicks; none if there is nothing to solve.
    pub solution: Option<&'a Result<FrameSolution, CalibrationError>>,
    /// The verdict.
    pub judgement: Option<Judgement>,
    /// The indices of the contradicted clicks.
    pub disputed: &'a [usize],
    /// Whether the values refer to an estimated base that waits for a decision.
    pub is_estimated: bool,
    residuals: &'a [ClickResidual],
}

impl<'a> DisplayedValues<'a> {
    /// The solution from the clicks, if they determine a camera.
    pub fn click_solution(&self) -> Option<&'a FrameSolution> {
        self.solution?.as_ref().ok()
    }

    /// The residual of a click; none for check clicks of a solution from clicks.
    pub fn residual(&self, click: usize) -> Option<&'a ClickResidual> {
        let residuals = self
            .click_solution()
            .map_or(self.residuals, |solved| &solved.residuals);
        residuals.iter().find(|residual| residual.click == click)
    }
}

impl App {
    /// Whether an estimated base of the shown frame's camera waits for a decision.
    pub fn decides_about_base(&self) -> bool {
        let proposed = self.operations.proposed_base();
        proposed
            .zip(self.frame())
            .is_some_and(|(found, frame)| found.camera == frame.camera)
    }

    /// The values to show: of the estimated base if one waits, unless the user holds the key for
    /// comparison.
    pub fn shown_values(&self) -> DisplayedValues<'_> {
        let current = self.current();
        match current
            .proposal
            .as_ref()
            .filter(|_| !self.session.picture.held.compare)
        {
            Some(proposal) => DisplayedValues {
                base: Some(proposal.base),
                camera: proposal.camera,
                solution: proposal.solution.as_ref(),
                judgement: proposal.judgement.clone(),
                disputed: &proposal.disputed,
                is_estimated: true,
                residuals: &[],
            },
            None => DisplayedValues {
                base: current.base,
                camera: current.camera,
                solution: current.solution.as_ref(),
                judgement: self.judgement(),
                disputed: &current.disputed,
                is_estimated: false,
                residuals: &current.residuals,
            },
        }
    }
}
