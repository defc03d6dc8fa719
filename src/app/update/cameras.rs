//! Which camera took which frames, and a camera that stops fitting.

use super::App;
use crate::app::Command;
use crate::app::action::CameraChoice;
use crate::app::selection::{Scope, Selecting, after_click};
use crate::app::session::{Dialog, Level};
use crate::calibrate::{CameraChange, camera_change};
use crate::document::{CameraId, Step};

/// What a look at a camera over time gave, and for which state of the document.
#[derive(Debug)]
pub(super) struct Watched {
    revision: u64,
    camera: CameraId,
    change: Option<CameraChange>,
}

impl App {
    /// Where the shown frame's camera stops fitting, if it does.
    #[must_use]
    pub fn camera_change(&self) -> Option<&CameraChange> {
        self.watched.as_ref()?.change.as_ref()
    }

    pub(super) fn select_frame(&mut self, frame: usize, how: Selecting) {
        if let Some(open) = self.open.as_ref().filter(|open| open.frame(frame).is_some()) {
            self.session.frames_selected = after_click(open, &self.session, frame, how);
        }
    }

    pub(super) fn select_shot(&mut self) {
        let Some(open) = &self.open else { return };
        let frames = Scope::Shot.frames(open, &self.session);
        if frames.len() < 2 {
            self.session.notify(Level::Info, "This frame's shot has no other frame.");
            return;
        }
        self.session.frames_selected = frames.into_iter().collect();
    }

    /// Opens the sheet on which frames are given to a camera; it begins with what is selected.
    pub(super) fn ask_camera(&mut self) {
        let scope = if self.session.frames_selected.is_empty() { Scope::Frame } else { Scope::Selected };
        self.session.dialog = Some(Dialog::GiveToCamera(scope));
    }

    /// Gives frames to a camera: one step of undo.
    pub(super) fn give_to_camera(&mut self, scope: Scope, choice: &CameraChoice) {
        let Some(open) = &self.open else { return };
        let frames = scope.frames(open, &self.session);
        let Some(like) = self.camera_id().cloned().filter(|_| !frames.is_empty()) else { return };
        let (CameraChoice::Known(name) | CameraChoice::New(name)) = choice;
        let step = Step::on_document(format!("Give {} to {name}", counted(frames.len())));
        let is_new = matches!(choice, CameraChoice::New(_));
        let given = self.change_cameras(step, |document, fields| {
            if is_new {
                document.add_camera_like(name, &like)?;
            }
            document.give_to_camera(&frames, name, fields)
        });
        if given.is_some() {
            self.session.dialog = None;
            self.session.frames_selected.clear();
            let text = format!("{} given to camera “{name}”.", counted(frames.len()));
            self.session.notify(Level::Info, text);
        }
    }

    /// Makes a new camera for the frames that the shown one's camera no longer fits: one step of undo.
    pub(super) fn new_camera_from_change(&mut self) {
        let Some(change) = self.camera_change().cloned() else { return };
        let step = Step::on_document(format!("New camera from frame {}", change.frame + 1));
        if let Some(name) = self.change_cameras(step, |document, fields| change.part(document, fields)) {
            self.session
                .notices
                .retain(|notice| notice.offer.is_none_or(|(_, command)| command != Command::NewCameraFromChange));
            let text = format!(
                "Camera “{name}” has the frames from {} on: points fit to {:.1} px. More points there, then estimate its base.",
                change.frame + 1,
                change.own_px
            );
            self.session.notify(Level::Info, text);
        }
    }

    /// Changes the document's cameras within a step of undo; what cannot be done is said, and nothing is changed.
    fn change_cameras<T>(
        &mut self,
        step: Step,
        change: impl FnOnce(
            &mut crate::document::Document,
            &crate::document::Fields,
        ) -> Result<T, crate::calibrate::GiveError>,
    ) -> Option<T> {
        let fields = match self.open.as_mut()?.fields() {
            Ok(fields) => fields,
            Err(error) => {
                self.session.notify(Level::Warning, format!("The frames stay where they are: {error}."));
                return None;
            }
        };
        if !self.begin_step(step) {
            return None;
        }
        match change(&mut self.open.as_mut()?.document, &fields) {
            Ok(done) => {
                self.commit();
                Some(done)
            }
            Err(error) => {
                self.abort();
                self.session.notify(Level::Warning, format!("The frames stay where they are: {error}."));
                None
            }
        }
    }

    /// Looks whether the shown frame's camera still fits, after every edit; what is found is told once.
    pub(super) fn watch_camera(&mut self) {
        let seen =
            self.open.as_ref().and_then(|open| Some((open.revision, open.frame(self.session.frame)?.camera.clone())));
        let Some((revision, camera)) = seen else {
            self.watched = None;
            return;
        };
        if self.watched.as_ref().is_some_and(|known| known.revision == revision && known.camera == camera) {
            return;
        }
        let change = match (&self.open, self.current.field()) {
            (Some(open), Some(field)) => camera_change(&open.document, &camera, field),
            _ => None,
        };
        if let Some(change) = &change {
            let told = (camera.clone(), change.frame);
            if self.session.told_change.as_ref() != Some(&told) {
                self.session.told_change = Some(told);
                let offer = Some(("New camera from here", Command::NewCameraFromChange));
                self.session.notify_with(Level::Warning, change.describe(), offer);
            }
        }
        self.watched = Some(Watched { revision, camera, change });
    }
}

/// "1 frame", "12 frames".
pub(super) fn counted(frames: usize) -> String {
    format!("{frames} frame{}", if frames == 1 { "" } else { "s" })
}
