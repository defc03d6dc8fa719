//! Data for the estimate of a camera's base: which frames are used, which frame to click next,
//! mirrored names.

use crate::app::App;
use crate::app::Command;
use crate::app::window_state::session::Level;
use touchline_calibration::calibrate::{BaseReadiness, LANDMARKS_ALONE, next_for_base};
use touchline_core::field::{FieldModel, Symmetry};
use touchline_core::solve::Name;
use touchline_documents::document::{Click, Frame, Target};

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
