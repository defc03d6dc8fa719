//! The verdict on the shown frame, including paint and neighbours.

use crate::app::App;
use touchline_core::markings::LineVerdict;
use touchline_core::solve::{Judgement, Verdict};
use touchline_documents::document::FrameStatus;

impl App {
    /// The verdict on the shown frame. A good one becomes *check* if the painted lines or the
    /// neighbouring frames contradict it. Neighbours also count for a reference without a verdict
    /// of its own.
    #[must_use]
    pub fn judgement(&self) -> Option<Judgement> {
        // Evidence from outside of the frame's clicks can only lower a good verdict: if the clicks
        // themselves are in doubt, that reason is the one to read.
        let judgement = self.current.judgement.clone();
        if judgement
            .as_ref()
            .is_some_and(|judgement| judgement.verdict != Verdict::Good)
        {
            return judgement;
        }
        let says = self
            .paint_says(self.session.frame)
            .filter(|says| says.verdict == LineVerdict::Contradicts);
        if let Some(says) = says.filter(|_| judgement.is_some()) {
            return Some(check(says.describe()));
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
}

/// The verdict *check* with a reason.
fn check(reason: String) -> Judgement {
    Judgement {
        verdict: Verdict::Check,
        reason,
    }
}
