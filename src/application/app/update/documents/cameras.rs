//! Assigns frames to cameras, and starts a new camera where one stops fitting.

use crate::app::project::selection::{Scope, Selecting, after_click};
use crate::app::window_state::session::{Dialog, Level};
use crate::app::{App, CameraChoice, Command};
use touchline_calibration::calibrate::{
    AssignedFrames, BaseReadiness, BulkChange, LANDMARKS_ALONE, NewCamera, next_for_base,
};
use touchline_core::field::{FieldModel, Symmetry};
use touchline_core::geometry::pluralise;
use touchline_core::solve::Name;
use touchline_documents::document::{Click, Frame, Step, Target};

impl App {
    /// Changes the selection on the filmstrip after a click on a frame.
    pub(in crate::app::update) fn select_frame(&mut self, frame: usize, how: Selecting) {
        if let Some(open) = self
            .open
            .as_ref()
            .filter(|open| open.frame(frame).is_some())
        {
            self.session.frames_selected = after_click(open, &self.session, frame, how);
        }
    }

    /// Selects all frames of the shown shot.
    pub(in crate::app::update) fn select_shot(&mut self) {
        let Some(open) = &self.open else { return };
        let frames = Scope::Shot.frames(open, &self.session);
        if frames.len() < 2 {
            self.session.note("This shot has no other frames.");
            return;
        }
        self.session.frames_selected = frames.into_iter().collect();
    }

    /// Opens the dialog that assigns frames to a camera, with the selected frames if there are any.
    pub(in crate::app::update) fn ask_camera(&mut self) {
        let scope = if self.session.frames_selected.is_empty() {
            Scope::Frame
        } else {
            Scope::Selected
        };
        self.session.dialog = Some(Dialog::AssignToCamera(scope));
    }

    /// Assigns the frames of a scope to a camera; one step of undo.
    pub(in crate::app::update) fn assign_to_camera(&mut self, scope: Scope, choice: &CameraChoice) {
        let Some(open) = &self.open else { return };
        let frames = scope.frames(open, &self.session);
        let Some(like) = self.camera_id().cloned().filter(|_| !frames.is_empty()) else {
            return;
        };
        let Some(open) = &self.open else { return };
        let (CameraChoice::Known(name) | CameraChoice::New(name)) = choice;
        let step = Step::on_document(format!(
            "Assign {} to {name}",
            pluralise(frames.len(), "frame")
        ));
        // By ids: the change may be made in the background, while positions change.
        let is_new = matches!(choice, CameraChoice::New(_));
        let frames = frames
            .into_iter()
            .filter_map(|index| Some(open.frame(index)?.id.clone()))
            .collect();
        let new = is_new.then_some(NewCamera { like, base: None });
        let change = BulkChange::Assign(Box::new(AssignedFrames {
            frames,
            camera: name.clone(),
            new,
        }));
        if self.change_in_bulk(step, change, Self::report_assigned) {
            self.session.dialog = None;
            self.session.frames_selected.clear();
        }
    }

    /// Reports frames that were assigned to a camera.
    fn report_assigned(&mut self, change: &BulkChange) {
        let BulkChange::Assign(given) = change else {
            return;
        };
        let (count, name) = (pluralise(given.frames.len(), "frame"), &given.camera);
        let has_base = given.new.as_ref().is_some_and(|new| new.base.is_some());
        let mut text = format!("{count} assigned to camera “{name}”.");
        if has_base {
            self.session.retract(Command::NewCameraFromChange);
            text.push_str(" Add points there, then estimate its base.");
        }
        self.session.note(text);
    }

    /// Assigns the frames that the shown frame's camera no longer fits to a new camera; one step of
    /// undo.
    pub(in crate::app::update) fn new_camera_from_change(&mut self) {
        let (Some(change), Some(open)) = (self.camera_change(), &self.open) else {
            return;
        };
        let step = Step::on_document(format!(
            "New camera from frame {}",
            open.frame_number(change.frame)
        ));
        let given = change.assignment(&open.document);
        self.change_in_bulk(
            step,
            BulkChange::Assign(Box::new(given)),
            Self::report_assigned,
        );
    }
}

impl App {
    /// The data available for an estimate of the shown frame's camera.
    pub const fn base_readiness(&self) -> BaseReadiness {
        self.current.readiness
    }

    /// Shows the frame whose points would improve the base of the shown frame's camera most.
    pub(in crate::app::update) fn show_for_base(&mut self) {
        let (Some(open), Some(camera)) = (&self.open, self.camera_id().cloned()) else {
            return;
        };
        let Some(field) = self.current.field() else {
            return;
        };
        let button = [("Estimate the base", Command::EstimateBase)];
        let Some(next) = next_for_base(&open.document, &camera, field) else {
            let text = "Every frame of this camera that shows enough of the field has its points. Estimate the base again.";
            self.session.notify_with(Level::Info, text, button);
            return;
        };
        self.go_to(next);
        let text = format!(
            "Click {LANDMARKS_ALONE} or more landmarks here, spread over the picture; then estimate the base again."
        );
        self.session.notify_with(Level::Info, text, button);
    }

    /// Includes a frame in the estimation of the base, or leaves it out; one step of undo.
    pub(in crate::app::update) fn use_for_base(&mut self, index: usize, used: bool) {
        let Some(frame) = self.open.as_ref().and_then(|open| open.frame(index)) else {
            return;
        };
        if frame.use_for_base == used {
            return;
        }
        let name = if used {
            "Put frame back"
        } else {
            "Leave frame out"
        };
        if self.begin_step(self.step_at(name, index)) {
            if let Some(frame) = self.frame_mut_at(index) {
                frame.use_for_base = used;
            }
            self.commit();
        }
    }

    /// Mirrors the names of a frame's clicks (left and right, near and far, or both); one step of
    /// undo.
    pub(in crate::app::update) fn mirror_names(&mut self, index: usize, symmetry: Symmetry) {
        // A change of another frame than the shown one would go unnoticed.
        self.go_to(index);
        let Some(Ok(field)) = self.open.as_mut().map(|open| open.field_of(index)) else {
            return;
        };
        if self.begin("Mirror names") {
            if let Some(frame) = self.frame_mut() {
                mirror(frame, &field, symmetry);
            }
            self.clicks_changed();
            self.commit();
            self.forget_mirrored(index);
        }
    }
}

/// Replaces each name by its mirror image. Names without one stay.
fn mirror(frame: &mut Frame, field: &FieldModel, symmetry: Symmetry) {
    for Click { target, .. } in &mut frame.clicks {
        let element = target.as_ref().and_then(|target| target.element(field));
        let twin =
            element.and_then(|element| Name::from_element(element.twin(symmetry, field)?, field));
        if let Some(twin) = &twin {
            *target = Some(Target::from(twin));
        }
    }
}
