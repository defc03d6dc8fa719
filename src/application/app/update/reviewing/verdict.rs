//! The verdict on the shown frame, including paint and neighbours.

use crate::app::{App, LineOffset};
use touchline_core::markings::LineVerdict;
use touchline_core::solve::{CHECK_MISFIT, Judgement, Verdict, Warning, WarningCode};
use touchline_documents::document::FrameStatus;

impl App {
    /// The verdict on the shown frame. A good one becomes *check* if the painted lines or the
    /// neighbouring frames contradict it. Neighbours also count for a reference without a verdict
    /// of its own.
    pub fn judgement(&self) -> Option<Judgement> {
        // If the clicks contradict each other, that reason is the one to read. Numbers that were
        // set by hand have no clicks that could.
        let judgement = self.current.judgement.clone();
        let is_uncertain = self.is_only_uncertain();
        if let Some(judgement) = &judgement
            && judgement.verdict != Verdict::Good
            && !is_uncertain
            && !self.current.by_hand
        {
            return Some(judgement.clone());
        }
        // Then the paint: it sees what two clicks cannot, and it is the number that row, timeline
        // and review state, too.
        let frame = self.session.frame;
        if let Some(beside) = self.line_beside_paint(frame) {
            let LineOffset {
                line, offset_px, ..
            } = beside;
            let px = offset_px.abs();
            return Some(check(format!("{line}: {px:.0} px beside its paint")));
        }
        let says = self.paint_says(frame).filter(|_| judgement.is_some());
        match says {
            Some(says) if says.verdict == LineVerdict::Contradicts => {
                return Some(check(says.describe()));
            }
            // Clicks close together leave the corners open; paint that is found there does not.
            Some(says) if says.verdict == LineVerdict::Supports && is_uncertain => {
                return Some(Judgement {
                    verdict: Verdict::Good,
                    reason: says.describe(),
                });
            }
            _ => {}
        }
        // The panel shows a proposal's disagreement with its neighbours elsewhere.
        let is_reference = self
            .frame()
            .is_some_and(|frame| frame.status == FrameStatus::Reference);
        if let Some(off) = self.current.off_neighbours
            && (judgement.is_some() || is_reference)
        {
            return Some(check(format!(
                "{:.0} px off the way between the frames before and after it",
                off.apart_px
            )));
        }
        judgement
    }

    /// Whether the clicks are in doubt only because they leave the corners of the picture
    /// uncertain, and nothing contradicts them.
    fn is_only_uncertain(&self) -> bool {
        let Some(solved) = self.current.click_solution() else {
            return false;
        };
        let is_uncertainty = |warning: &Warning| {
            matches!(
                warning.code,
                WarningCode::Separation | WarningCode::Extrapolation
            )
        };
        let is_check = |judgement: &Judgement| judgement.verdict == Verdict::Check;
        self.current.judgement.as_ref().is_some_and(is_check)
            && solved.warnings.iter().all(is_uncertainty)
            && solved.misfit().is_none_or(|misfit| misfit <= CHECK_MISFIT)
    }
}

/// The verdict *check* with a reason.
fn check(reason: String) -> Judgement {
    Judgement {
        verdict: Verdict::Check,
        reason,
    }
}
