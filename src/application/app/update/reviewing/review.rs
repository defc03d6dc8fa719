//! Review of suggestions: the next frame to review, acceptance of several together, and the choice
//! of training frames.

use crate::app::panel_values::progress::ALL_DONE;
use crate::app::review::{AcceptQuestion, AcceptSheet, BulkAccept, LeftReason, Stretch};
use crate::app::window_state::choices::Scope;
use crate::app::window_state::session::{Dialog, SidePanel, is_to_do};
use crate::app::{App, Command};
use std::sync::Arc;
use touchline_calibration::calibrate::impossible_camera;
use touchline_core::field::FieldModel;
use touchline_core::geometry::pluralise;
use touchline_core::markings::LineVerdict;
use touchline_documents::document::{Frame, FrameStatus, Step};

impl App {
    /// Opens a side panel; if it is shown already, returns to the panel of the frame. Closes the
    /// quality page.
    pub(in crate::app::update) fn toggle_panel(&mut self, panel: SidePanel) {
        let behind_page = std::mem::take(&mut self.session.quality.open);
        let is_shown = self.session.panel == panel && !behind_page;
        self.session.panel = if is_shown { SidePanel::Frame } else { panel };
    }

    /// Shows the next frame to do. While the review panel is open, this is the next row of its
    /// list; while a season's queue is open, its next frame.
    pub(in crate::app::update) fn go_to_next_that_needs_me(&mut self, forward: bool) {
        if self.go_on_in_queue(forward) {
            return;
        }
        match self.next_in_list(forward) {
            Some(frame) => self.go_to(frame),
            None => self.go_to_next(forward, is_to_do, ALL_DONE),
        }
    }

    /// The frame of the next row of the review list, while its panel is open and no queue is. None
    /// if there is no other.
    pub(super) fn next_in_list(&self, forward: bool) -> Option<usize> {
        self.review
            .next(self.session.frame, forward)
            .filter(|_| self.session.panel == SidePanel::Review && self.queue_position().is_none())
    }

    /// Shows the frame whose label would help the forest most.
    pub(in crate::app::update) fn go_to_label_next(&mut self) {
        if let Some(next) = self.review.advice.next {
            self.go_to(next.frame);
        }
    }

    /// Opens the sheet *Accept all*. Suggestions that arrive or change while it is open are not
    /// part of it.
    pub(in crate::app::update) fn ask_accept_all(&mut self) {
        self.accept_question = self
            .open
            .as_ref()
            .map(|open| AcceptQuestion::Suggestions(open.document.frames.clone()));
        self.session.dialog = Some(Dialog::AcceptAll);
    }

    /// Includes a suggestion in the common acceptance, or excludes it.
    pub(in crate::app::update) fn tick_suggestion(&mut self, index: usize, ticked: bool) {
        let Some(id) = self
            .open
            .as_ref()
            .and_then(|open| open.frame(index))
            .map(|frame| frame.id.clone())
        else {
            return;
        };
        if ticked {
            self.session.unticked.remove(&id);
        } else {
            self.session.unticked.insert(id);
        }
    }

    /// The suggestions that would be accepted: according to the choices in the panel, without those
    /// that the user unticked.
    pub fn bulk_accept(&self) -> BulkAccept {
        let choice = &self.session.review;
        // The panel counts with its present choices; the open sheet with what it showed when it
        // opened, because the user agrees to that.
        let question = self.accept_question.as_ref().zip(self.open.as_ref());
        let bulk = match question {
            Some((AcceptQuestion::Stretch(stretch), open)) => {
                stretch.bulk(choice, &open.document.frames)
            }
            Some((AcceptQuestion::Suggestions(opened), open)) => self
                .review
                .bulk(choice)
                .without_late(opened, &open.document.frames),
            None => self.review.bulk(choice),
        };
        let places = self.session.unticked.iter();
        let unticked = places
            .filter_map(|id| self.open.as_ref()?.document.frames.position_of(id))
            .collect();
        BulkAccept { unticked, ..bulk }
    }

    /// The content of the sheet *Accept all*; none while it is closed.
    pub const fn accept_sheet(&self) -> Option<&Arc<AcceptSheet>> {
        self.accept_sheet.as_ref()
    }

    /// Updates the content of the sheet. The distribution of the number of wrong suggestions is
    /// computed only if the content changed.
    pub(in crate::app::update) fn refresh_accept_sheet(&mut self) {
        let is_open = self.session.dialog == Some(Dialog::AcceptAll);
        if !is_open && !self.reads_guide_over_accept_sheet() {
            self.accept_question = None;
        }
        let bulk = is_open.then(|| self.bulk_accept());
        if self.accept_sheet.as_ref().map(|sheet| &sheet.bulk) != bulk.as_ref() {
            self.accept_sheet = bulk.map(|bulk| Arc::new(bulk.into()));
        }
    }

    /// Whether the guide lies over the sheet, and closing it leads back there.
    fn reads_guide_over_accept_sheet(&self) -> bool {
        let Some(Dialog::Guide { behind, .. }) = &self.session.dialog else {
            return false;
        };
        behind.as_deref() == Some(&Dialog::AcceptAll)
    }

    /// Accepts every frame that the sheet counts: one step of undo.
    pub(in crate::app::update) fn accept_all(&mut self) {
        self.session.dialog = None;
        let bulk = self.bulk_accept();
        let is_stretch = bulk.of_stretch.is_some();
        let frames: Vec<usize> = bulk
            .ticked_rows()
            .map(|row| row.frame)
            // Of suggestions only those that still are one. A stretch also has solved frames.
            .filter(|place| is_stretch || self.is_suggested_at(*place))
            .collect();
        if frames.is_empty() {
            let none = if is_stretch {
                "None of the selected frames can be accepted together."
            } else {
                "No suggestion has this confidence."
            };
            self.session.note(none);
            return;
        }
        let noun = if is_stretch { "frame" } else { "suggestion" };
        if self.accept_together(&frames, noun, is_stretch) {
            self.session.unticked.clear();
            if is_stretch {
                self.session.frames_selected.clear();
            }
        }
    }

    /// Accepts frames in one step of undo; where they are accepted because of their paint, the
    /// evidence stays with them. Returns false, with a message, if that is impossible now.
    pub(in crate::app::update) fn accept_together(
        &mut self,
        frames: &[usize],
        noun: &str,
        by_paint: bool,
    ) -> bool {
        let count = pluralise(frames.len(), noun);
        if !self.begin_step(Step::on_document(format!("Accept {count}"))) {
            return false;
        }
        for index in frames {
            if let Some(frame) = self.frame_mut_at(*index) {
                frame.status = FrameStatus::Reference;
                frame.reason = None;
            }
            if by_paint {
                self.record_paint_of(*index);
            }
        }
        self.commit();
        let no_tracked_waits = self.open.as_ref().is_some_and(|open| {
            let mut frames = open.document.frames.iter();
            !frames.any(|frame| is_suggested(frame) && frame.is_tracked())
        });
        if no_tracked_waits {
            self.session.retract(Command::DiscardTracked);
        }
        let undo = self.settings.keys.key_or_name(Command::Undo);
        self.session
            .note(format!("{count} accepted. {undo} undoes all of it."));
        true
    }

    fn is_suggested_at(&self, place: usize) -> bool {
        self.open
            .as_ref()
            .and_then(|open| open.frame(place))
            .is_some_and(is_suggested)
    }

    /// Uses a reference for training, or not; one step of undo.
    pub(in crate::app::update) fn set_use_for_training(&mut self, index: usize, used: bool) {
        let Some(frame) = self.open.as_ref().and_then(|open| open.frame(index)) else {
            return;
        };
        if frame.is_used_for_training() == used || frame.status != FrameStatus::Reference {
            return;
        }
        let name = if used {
            "Use for training"
        } else {
            "Do not use for training"
        };
        if self.begin_step(self.step_at(name, index)) {
            if let Some(frame) = self.frame_mut_at(index) {
                frame.set_use_for_training(used);
            }
            self.commit();
        }
    }

    /// Toggles whether the shown frame is used for training.
    pub(in crate::app::update) fn toggle_use_for_training(&mut self) {
        match self.frame().map(|frame| {
            (
                frame.status == FrameStatus::Reference,
                frame.is_used_for_training(),
            )
        }) {
            Some((true, used)) => self.set_use_for_training(self.session.frame, !used),
            _ => self
                .session
                .note("Only references are used for training: accept this frame first."),
        }
    }
}

fn is_suggested(frame: &Frame) -> bool {
    frame.status == FrameStatus::Suggested
}

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
            self.session.note(text);
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

    /// Selects the frames of the shown frame's shot and asks for their common acceptance.
    pub(in crate::app::update) fn ask_accept_shot(&mut self) {
        let Some(open) = &self.open else { return };
        let frames = Scope::Shot.frames(open, &self.session);
        self.session.frames_selected = frames.into_iter().collect();
        self.ask_accept_stretch();
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
