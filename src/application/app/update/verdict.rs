//! The verdict on the shown frame, including paint and neighbours.

use super::App;
use touchline_core::markings::LineVerdict;
use touchline_core::solve::{Judgement, Verdict};
use touchline_documents::document::FrameStatus;

impl App {
    /// The verdict on the shown frame. A good one becomes *check* if the painted lines or the
    /// neighbouring frames contradict it. Neighbours also count for a reference without a verdict
    /// of its own.
    #[must_use]
    pub fn judgement(&self) -> Option<Judgement> {
        let judgement = self.current.judgement.clone();
        if judgement
            .as_ref()
            .is_some_and(|judgement| judgement.verdict != Verdict::Good)
        {
            return judgement;
        }
        let check = |reason| Judgement {
            verdict: Verdict::Check,
            reason,
        };
        let says = self
            .paint_says(self.session.frame)
            .filter(|says| says.verdict == LineVerdict::Contradicts);
        let of_paint = says
            .filter(|_| judgement.is_some())
            .map(|says| check(says.describe()));
        let is_reference = || {
            self.frame()
                .is_some_and(|frame| frame.status == FrameStatus::Reference)
        };
        let of_neighbours = || {
            // The panel shows a proposal's disagreement with its neighbours elsewhere.
            if judgement.is_none() && !is_reference() {
                return None;
            }
            let apart_px = self.current.off_neighbours?.apart_px;
            Some(check(format!(
                "{apart_px:.0} px off the way between the frames before and after it"
            )))
        };
        of_paint.or_else(of_neighbours).or(judgement)
    }
}
