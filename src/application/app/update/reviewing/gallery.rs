//! Acceptance and rejection of frames that were chosen by their pictures, in the gallery.

use crate::app::App;
use crate::app::window_state::session::Dialog;
use std::collections::BTreeSet;
use touchline_core::geometry::pluralise;
use touchline_documents::document::{Frame, FrameStatus, RejectReason, Step};

/// Whether a suggestion can be accepted by its picture alone: it has a camera, and all its points
/// have names.
fn is_acceptable(frame: &Frame) -> bool {
    frame.status == FrameStatus::Suggested && frame.ptz.is_some() && frame.unnamed_click().is_none()
}

impl App {
    /// Shows the gallery, or closes it.
    pub(in crate::app::update) fn toggle_gallery(&mut self) {
        if self.session.dialog == Some(Dialog::Gallery) {
            self.session.dialog = None;
            return;
        }
        self.commit_open_step();
        self.session.frames_selected.clear();
        self.session.dialog = Some(Dialog::Gallery);
    }

    /// Selects frames, by their indices.
    pub(in crate::app::update) fn select_frames(&mut self, mut frames: BTreeSet<usize>) {
        frames.retain(|place| {
            self.open
                .as_ref()
                .is_some_and(|open| open.frame(*place).is_some())
        });
        self.session.frames_selected = frames;
    }

    /// Accepts the selected suggestions, the pictures of which the user has seen: one step of undo.
    /// Those without a camera, or with a point without a name, stay.
    pub(in crate::app::update) fn accept_selected(&mut self) {
        let selected = std::mem::take(&mut self.session.frames_selected);
        let Some(open) = &self.open else { return };
        let (frames, stay): (Vec<usize>, Vec<usize>) = selected
            .into_iter()
            .partition(|place| open.frame(*place).is_some_and(is_acceptable));
        if frames.is_empty() {
            let none = "None of the selected frames is a suggestion that can be accepted.";
            self.session.note(none);
        } else if self.accept_together(&frames, "suggestion", false) && stay.is_empty() {
            return;
        }
        self.session.frames_selected = stay.into_iter().collect();
    }

    /// Marks the selected frames as not calibratable for a reason: one step of undo.
    pub(in crate::app::update) fn reject_selected(&mut self, reason: RejectReason) {
        let selected = std::mem::take(&mut self.session.frames_selected);
        let count = pluralise(selected.len(), "frame");
        let step = Step::on_document(format!("Mark {count} as not calibratable"));
        if !selected.is_empty() {
            self.reject_frames(step, selected, reason);
        }
    }

    /// Marks frames as not calibratable, in one step of undo. Returns whether it did.
    pub(super) fn reject_frames(
        &mut self,
        step: Step,
        frames: impl IntoIterator<Item = usize>,
        reason: RejectReason,
    ) -> bool {
        if !self.begin_step(step) {
            return false;
        }
        for place in frames {
            if let Some(frame) = self.frame_mut_at(place) {
                frame.status = FrameStatus::Rejected;
                frame.reason = Some(reason);
            }
        }
        self.commit();
        self.refresh_review();
        true
    }
}
