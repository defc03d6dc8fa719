//! The work of a line check: a few frames are read, and each camera is compared with the painted
//! lines of its own picture. A batch is small, so that an edit in between soon has its effect.

use super::offsets::{LineOffset, line_offsets};
use crate::app::App;
use crate::app::operation::{Context, Failure, Operation, Slot};
use crate::app::window_state::session::Level;
use std::convert::Infallible;
use std::path::PathBuf;
use std::sync::Arc;
use touchline_calibration::proposals::{FramePicture, PictureStream};
use touchline_core::camera::PtzCamera;
use touchline_core::field::FieldModel;
use touchline_core::progress::Progress;
use touchline_documents::document::{Document, FrameId};
use touchline_vision::paint::{GroundPicture, LineCheck, check_lines};

/// Compares the cameras of a few frames with the painted lines.
pub struct LineCheckBatch {
    pub(super) document: Document,
    pub(super) folder: PathBuf,
    pub(super) frames: Vec<FrameToCheck>,
}

/// A frame of a batch.
pub(super) struct FrameToCheck {
    pub(super) index: usize,
    pub(super) frame: FrameId,
    pub(super) camera: PtzCamera,
    /// The field that the frame shows.
    pub(super) field: Arc<FieldModel>,
}

/// The line check of a frame's camera.
#[derive(Clone, Debug)]
pub struct CheckedLines {
    pub(super) frame: FrameId,
    /// The camera that was checked. The result is valid for this camera only.
    pub(super) camera: PtzCamera,
    /// The result; none if the picture cannot be read.
    pub(super) check: Option<LineCheck>,
    /// How far the paint lies from the drawn lines.
    pub(super) offsets: Vec<LineOffset>,
}

impl Operation for LineCheckBatch {
    type Progress = Infallible;
    type Output = Vec<CheckedLines>;
    type Error = Infallible;

    const NAME: &'static str = "line check";

    fn run(&self, context: &Context<'_, Infallible>) -> Result<Vec<CheckedLines>, Infallible> {
        let at = self.document.at(&self.folder);
        let mut reader = context.open_reader();
        let pictures = PictureStream::new(at, self.frames.iter().map(|to_check| to_check.index))
            .with_reader(&mut *reader)
            .with_progress(Progress::new(|_| context.check()));
        let mut checked = Vec::with_capacity(self.frames.len());
        // The stream gives one item for each index, in their order, so that the two fit.
        for (to_check, FramePicture { frame, picture, .. }) in self.frames.iter().zip(pictures) {
            let field = &to_check.field;
            let ground = picture
                .ok()
                .map(|picture| GroundPicture::new(&picture, &at.document.masks_of(frame)));
            let check = ground
                .as_ref()
                .map(|ground| check_lines(ground, field, &to_check.camera));
            let offsets = ground
                .filter(|_| check.is_some_and(|check| check.can_say()))
                .map(|ground| line_offsets(&ground, field, &to_check.camera));
            checked.push(CheckedLines {
                frame: to_check.frame.clone(),
                camera: to_check.camera,
                check,
                offsets: offsets.unwrap_or_default(),
            });
        }
        Ok(checked)
    }

    fn slot(app: &mut App) -> &mut Slot<Self> {
        &mut app.operations.line_checks.slot
    }

    fn take_over(&self, app: &mut App, result: Result<Vec<CheckedLines>, Failure<Infallible>>) {
        let found = result.unwrap_or_else(|failure| {
            app.session.notify(Level::Error, failure.to_string());
            Vec::new()
        });
        let checks = &mut app.operations.line_checks;
        // Frames without a result are kept too, so that they are not checked again until their
        // camera changes.
        for FrameToCheck { frame, camera, .. } in &self.frames {
            checks.keep(CheckedLines {
                frame: frame.clone(),
                camera: *camera,
                check: None,
                offsets: Vec::new(),
            });
        }
        let ids: Vec<FrameId> = found.iter().map(|checked| checked.frame.clone()).collect();
        for checked in found {
            checks.keep(checked);
        }
        app.report_accepted_off_paint(&ids);
    }
}
