//! Accepting a stretch: the selected frames whose painted lines agree with their cameras.

use crate::app::App;
use crate::app::review::{AcceptQuestion, LeftReason, Stretch};
use crate::app::window_state::session::{Dialog, Level};
use touchline_calibration::calibrate::impossible_camera;
use touchline_core::field::FieldModel;
use touchline_core::markings::LineVerdict;
use touchline_documents::document::{Frame, FrameStatus};

impl App {
    /// How many frames are accepted together when a frame is to be accepted; none while no frames
    /// are selected.
    pub fn stretch_size(&self) -> Option<usize> {
        Some(self.session.frames_selected.len()).filter(|count| *count > 0)
    }

    /// Counts the selected frames and opens the sheet that says which of them would be accepted.
    pub(in crate::app::update) fn ask_accept_stretch(&mut self) {
        if self.decides_about_base() {
            let text = "An estimated base is shown. Use it or discard it first.";
            self.session.notify(Level::Info, text);
            return;
        }
        self.commit_open_step();
        let Some(stretch) = self.count_stretch() else {
            return;
        };
        // What was taken out of another list is none of this one.
        self.session.unticked.clear();
        self.accept_question = Some(AcceptQuestion::Stretch(stretch));
        self.session.dialog = Some(Dialog::AcceptAll);
    }

    /// The selected frames as they are now: those on the paint, and the others by their reasons.
    fn count_stretch(&mut self) -> Option<Stretch> {
        let places: Vec<usize> = self.session.frames_selected.iter().copied().collect();
        let mut stretch = Stretch::new(self.open.as_ref()?.document.frames.clone());
        for place in places {
            let field = self.open.as_mut()?.field_of(place).ok();
            let frame = self.open.as_ref()?.frame(place)?;
            if frame.status == FrameStatus::Reference {
                stretch.pass_over_accepted();
            } else if let Some(reason) = self.why_left(frame, place, field.as_deref()) {
                stretch.leave(place, reason);
            } else {
                let open = self.open.as_mut()?;
                let disagreements = open.derived.disagreements(&open.document);
                stretch.take(place, disagreements.for_frame(place));
            }
        }
        Some(stretch)
    }

    /// Why a frame is not accepted together with others; none where the paint in its picture agrees
    /// with its camera and nothing else speaks against it.
    fn why_left(
        &self,
        frame: &Frame,
        place: usize,
        field: Option<&FieldModel>,
    ) -> Option<LeftReason> {
        // The first reason counts; `LeftReason` has the order in which they are listed.
        let document = &self.open.as_ref()?.document;
        if frame.status == FrameStatus::Rejected {
            return Some(LeftReason::Rejected);
        }
        if document.ptz_camera(frame).is_none() {
            return Some(LeftReason::NoCamera);
        }
        if impossible_camera(document, frame, field).is_some() {
            return Some(LeftReason::Impossible);
        }
        let says = self.own_paint_says(place).map(|says| says.verdict);
        if says == Some(LineVerdict::Contradicts) {
            return Some(LeftReason::OffPaint);
        }
        if frame.unnamed_click().is_some() {
            return Some(LeftReason::UnnamedPoint);
        }
        if frame.is_judged_wrong() {
            return Some(LeftReason::PointsDisagree);
        }
        if frame.unlikely().is_some() {
            return Some(LeftReason::Unlikely);
        }
        match says {
            Some(LineVerdict::Supports) => None,
            Some(_) => Some(LeftReason::PaintUndecided),
            None => Some(LeftReason::NotChecked),
        }
    }
}
