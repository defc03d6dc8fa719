//! Looking whether a camera still fits all of its frames: at once where these are few, else in the background.

use crate::calibrate::{CameraChange, FrameLookup, camera_change};
use crate::document::{CameraId, Document};
use crate::field::FieldModel;
use std::sync::Arc;
use thiserror::Error;

/// A camera with more clicked frames than this is looked at in the background: the look takes about 30 µs a frame.
pub(super) const AT_ONCE: usize = 40;

/// A look at a camera's frames over time.
#[derive(Clone, Debug, PartialEq)]
pub struct CameraWatch {
    /// Which look it is: the report says it again.
    pub ticket: u64,
    /// The document.
    pub document: Document,
    /// Which camera.
    pub camera: CameraId,
    /// The field that it looks at.
    pub field: Arc<FieldModel>,
}

impl CameraWatch {
    /// Where the camera stops fitting, if it does.
    #[must_use]
    pub fn look(&self) -> Option<CameraChange> {
        camera_change(&self.document, &FrameLookup::of(&self.document), &self.camera, &self.field)
    }
}

/// An internal error.
#[derive(Clone, Debug, PartialEq, Eq, Error)]
#[error("internal error (please report it): {message}")]
pub struct WatchPanicked {
    /// The panic's message.
    pub message: String,
}

/// What is known of whether a camera fits, and what is being found out.
#[derive(Debug, Default)]
pub(super) struct Watched {
    /// The state of the document that was looked at last, and the camera.
    pub of: Option<(u64, CameraId)>,
    /// What was found.
    pub change: Option<CameraChange>,
    /// The look under way: its ticket, and what it is of.
    pub under_way: Option<(u64, (u64, CameraId))>,
    /// How many looks have been asked for.
    pub tickets: u64,
}
