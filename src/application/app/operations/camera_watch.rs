//! Whether a camera still fits all of its frames: looked at after every edit, at once where the
//! frames are few, else in the background.

use crate::app::operation::{Context, Failure, Operation, Slot};
use crate::app::session::Level;
use crate::app::{App, Command};
use std::convert::Infallible;
use std::sync::Arc;
use touchline_calibration::calibrate::{CameraChange, FrameLookup, camera_change};
use touchline_core::field::FieldModel;
use touchline_documents::document::{CameraId, Document};

/// A camera with more clicked frames than this is looked at in the background: the look takes about
/// 30 µs a frame.
const AT_ONCE: usize = 40;

/// A look at a camera's frames over time.
#[derive(Debug)]
pub struct CameraWatch {
    document: Document,
    /// The field that the camera looks at.
    field: Arc<FieldModel>,
    of: Watched,
}

/// What is looked at: a camera in the document of a revision.
#[derive(Clone, Debug, PartialEq, Eq)]
struct Watched {
    revision: u64,
    camera: CameraId,
}

/// What is known of whether the shown frame's camera fits.
#[derive(Debug, Default)]
pub(in crate::app) struct CameraWatchState {
    slot: Slot<CameraWatch>,
    /// What was looked at last.
    of: Option<Watched>,
    /// What was found.
    change: Option<CameraChange>,
    /// The camera and frame of the last notice: each change is told once.
    told: Option<(CameraId, usize)>,
}

impl Operation for CameraWatch {
    type Progress = Infallible;
    type Output = Option<CameraChange>;
    type Error = Infallible;

    const NAME: &'static str = "camera watch";

    fn run(&self, _: &Context<'_, Infallible>) -> Result<Option<CameraChange>, Infallible> {
        Ok(camera_change(
            &self.document,
            &FrameLookup::of(&self.document),
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
    /// Where the shown frame's camera stops fitting, if it does.
    #[must_use]
    pub fn camera_change(&self) -> Option<&CameraChange> {
        self.operations.camera_watch.change.as_ref()
    }

    /// Looks whether the shown frame's camera still fits, after every edit. Looks in the background
    /// do not replace each other: with edits in quick succession none would come to its end.
    pub(in crate::app) fn watch_camera(&mut self) {
        let frame = self
            .open
            .as_ref()
            .and_then(|open| Some((open, open.frame(self.session.frame)?)));
        let of = frame.map(|(open, frame)| Watched {
            revision: open.revision,
            camera: frame.camera.clone(),
        });
        let state = &mut self.operations.camera_watch;
        let (Some(of), Some(open)) = (of, &mut self.open) else {
            (state.of, state.change) = (None, None);
            return;
        };
        if state.of.as_ref() == Some(&of) || state.slot.is_running() {
            return;
        }
        let Some(field) = self.current.field() else {
            (state.of, state.change) = (Some(of), None);
            return;
        };
        let lookup = open.derived.lookup(&open.document);
        if lookup.clicked_count(&of.camera) <= AT_ONCE {
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

    fn camera_looked_at(&mut self, of: Watched, change: Option<CameraChange>) {
        let state = &mut self.operations.camera_watch;
        if let Some(change) = &change {
            let told = (of.camera.clone(), change.frame);
            if state.told.as_ref() != Some(&told) {
                state.told = Some(told);
                let offer = [("New camera from here", Command::NewCameraFromChange)];
                self.session
                    .notify_with(Level::Warning, change.describe(), offer);
            }
        }
        (state.of, state.change) = (Some(of), change);
    }
}
