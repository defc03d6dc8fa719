//! Checks after every edit whether one base still fits all frames of the shown frame's camera. With
//! few frames the check runs at once, otherwise in the background.

use crate::app::operation::{Context, Failure, Operation, Slot};
use crate::app::window_state::session::Level;
use crate::app::{App, Command};
use std::convert::Infallible;
use std::sync::Arc;
use touchline_calibration::calibrate::{CameraChange, FrameLookup, camera_change};
use touchline_core::field::FieldModel;
use touchline_documents::document::{CameraId, Document};

/// Maximum number of clicked frames for a check at once. The check takes about 30 µs a frame.
const AT_ONCE: usize = 40;

/// Checks the frames of one camera for a change of its base over time.
#[derive(Debug)]
pub struct CameraWatch {
    document: Document,
    /// The field that the camera sees.
    field: Arc<FieldModel>,
    of: CheckedCamera,
}

/// The subject of a check: a camera in one revision of the document.
#[derive(Clone, Debug, PartialEq, Eq)]
struct CheckedCamera {
    revision: u64,
    camera: CameraId,
}

/// The result of the last check.
#[derive(Debug, Default)]
pub(in crate::app) struct CameraWatchState {
    slot: Slot<CameraWatch>,
    /// The subject of the last check.
    of: Option<CheckedCamera>,
    /// Where the camera stops fitting, if it does.
    change: Option<CameraChange>,
    /// The camera and the frame index of the last notice. Each change is reported once.
    reported: Option<(CameraId, usize)>,
}

impl Operation for CameraWatch {
    type Progress = Infallible;
    type Output = Option<CameraChange>;
    type Error = Infallible;

    const NAME: &'static str = "camera watch";

    fn run(&self, _: &Context<'_, Infallible>) -> Result<Option<CameraChange>, Infallible> {
        Ok(camera_change(
            &self.document,
            &FrameLookup::from_document(&self.document),
            &self.of.camera,
            &self.field,
        ))
    }

    fn slot(app: &mut App) -> &mut Slot<Self> {
        &mut app.operations.camera_watch.slot
    }

    fn take_over(&self, app: &mut App, result: Result<Option<CameraChange>, Failure<Infallible>>) {
        let change = result.unwrap_or_else(|failure| {
            app.session.notify(Level::Error, failure.to_string());
            None
        });
        app.camera_looked_at(self.of.clone(), change);
    }
}

impl App {
    /// The frame from which on the shown frame's camera no longer fits, if there is one.
    pub fn camera_change(&self) -> Option<&CameraChange> {
        // While this camera is being checked, the last result may be another one's.
        let change = self.operations.camera_watch.change.as_ref()?;
        (Some(&change.camera) == self.camera_id()).then_some(change)
    }

    /// Checks the shown frame's camera, unless this revision has been checked. A running check is
    /// not replaced: with edits in quick succession none would ever finish.
    pub(in crate::app) fn watch_camera(&mut self) {
        let frame = self
            .open
            .as_ref()
            .and_then(|open| Some((open, open.frame(self.session.frame)?)));
        let of = frame.map(|(open, frame)| CheckedCamera {
            revision: open.revision,
            camera: frame.camera.clone(),
        });
        let state = &mut self.operations.camera_watch;
        let (Some(of), Some(open)) = (of, &mut self.open) else {
            (state.of, state.change) = (None, None);
            return;
        };
        // When a running check ends, its revision differs from the present one, so that the next
        // action starts another.
        if state.of.as_ref() == Some(&of) || state.slot.is_running() {
            return;
        }
        // Without a valid field nothing can be said; its template may still be read.
        let Some(field) = self.current.field() else {
            (state.of, state.change) = (None, None);
            return;
        };
        let lookup = open.derived.lookup(&open.document);
        if lookup.clicked_frame_count(&of.camera) <= AT_ONCE {
            let change = camera_change(&open.document, lookup, &of.camera, field);
            self.camera_looked_at(of, change);
            return;
        }
        let (document, field) = (open.document.clone(), Arc::clone(field));
        self.start(CameraWatch {
            document,
            field,
            of,
        });
    }

    /// Stores the result of a check, and reports a change that is new.
    fn camera_looked_at(&mut self, of: CheckedCamera, change: Option<CameraChange>) {
        let state = &mut self.operations.camera_watch;
        if let (Some(change), Some(open)) = (&change, &self.open) {
            let reported = (of.camera.clone(), change.frame);
            if state.reported.as_ref() != Some(&reported) {
                state.reported = Some(reported);
                let button = [("New camera from here", Command::NewCameraFromChange)];
                let text = change.describe(&open.document);
                self.session.notify_with(Level::Warning, text, button);
            }
        }
        (state.of, state.change) = (Some(of), change);
    }
}
