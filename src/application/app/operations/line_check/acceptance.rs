//! What painted lines mean for the acceptance of a frame: where they contradict its camera a person
//! has to confirm it. A frame that was accepted before it was checked is named once it has been,
//! and the check of an accepted frame is written into its solution.

use crate::app::App;
use touchline_calibration::calibrate::record_line_check;
use touchline_core::markings::LineVerdict;
use touchline_documents::document::{FrameId, FrameStatus};

impl App {
    /// Whether accepting a frame needs a confirmation because the paint in its picture lies
    /// elsewhere. If lines contradict every camera, a confirmation is needed until a person has
    /// accepted one of them.
    pub(in crate::app) fn paint_forbids(&self, frame: usize) -> bool {
        let is_off = self
            .own_paint_says(frame)
            .is_some_and(|says| says.verdict == LineVerdict::Contradicts);
        is_off && (self.is_contradicted(frame) || !self.has_accepted_off_paint())
    }

    fn has_accepted_off_paint(&self) -> bool {
        let Some(open) = &self.open else { return false };
        let mut frames = open.document.frames.iter();
        frames.any(|frame| frame.evidence_against_acceptance().is_some())
    }

    /// Remembers a frame that is accepted before its paint was checked. If the paint contradicts
    /// it, the user is informed later.
    pub(in crate::app) fn accept_before_check(&mut self, frame: usize) {
        if self.own_paint_says(frame).is_some() {
            return;
        }
        let Some(frame) = self.open.as_ref().and_then(|open| open.frame(frame)) else {
            return;
        };
        let id = frame.id.clone();
        self.operations.line_checks.accepted_unchecked.insert(id);
    }

    /// Says which of the frames that were accepted before their paint was looked at it contradicts.
    pub(super) fn report_accepted_off_paint(&mut self, checked: &[FrameId]) {
        for id in checked {
            if !self.operations.line_checks.accepted_unchecked.remove(id) {
                continue;
            }
            let Some(open) = &self.open else { return };
            let Some(place) = open.document.frames.position_of(id) else {
                continue;
            };
            let is_reference = open
                .frame(place)
                .is_some_and(|frame| frame.status == FrameStatus::Reference);
            if is_reference && self.paint_forbids(place) {
                let number = open.frame_number(place);
                let text = format!(
                    "Frame {number} was accepted before its painted lines were checked: they lie \
                     elsewhere in the picture. Look at it again."
                );
                self.session.warn(text);
            }
        }
    }

    /// Writes what the paint says about a frame's camera into its solution, within a step.
    pub(in crate::app) fn record_paint_of(&mut self, place: usize) {
        let Some(open) = &mut self.open else { return };
        let Some(frame) = open.frame(place) else {
            return;
        };
        let Some(check) = self.operations.line_checks.fresh(open, frame) else {
            return;
        };
        if let Some(frame) = open.document.frames.get_mut(place) {
            record_line_check(frame, &check);
        }
    }
}
