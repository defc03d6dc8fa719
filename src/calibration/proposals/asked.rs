//! What a frame was when something was asked of it, by which an answer that came too late is known.

use touchline_core::camera::CameraBase;
use touchline_documents::document::{Camera, CameraId, Document, Frame};

/// A frame as it was when it was asked for.
#[derive(Clone, Debug, PartialEq)]
pub struct Asked {
    /// The revision of the frame.
    pub revision: u64,
    /// The frame's picture, by name.
    pub picture: String,
    /// The hash of its image file, where the document has one.
    pub sha256: Option<String>,
    /// Its camera.
    pub camera: CameraId,
    /// Where that camera stands.
    pub base: Option<CameraBase>,
}

impl Asked {
    /// A frame as it is now.
    #[must_use]
    pub fn of(document: &Document, frame: &Frame) -> Self {
        Self {
            revision: frame.revision,
            picture: frame.name(),
            sha256: frame.sha256.clone(),
            camera: frame.camera.clone(),
            base: document.camera_of(frame).and_then(Camera::base),
        }
    }

    /// Whether it is this frame with the picture and the camera that it has now.
    pub(crate) fn is_of(&self, frame: &Frame) -> bool {
        self.sha256 == frame.sha256 && self.camera == frame.camera && self.picture == frame.name()
    }

    /// Whether a frame is still as it was, in what an answer depends on.
    #[must_use]
    pub fn is_still(&self, document: &Document, frame: &Frame) -> bool {
        self.is_of(frame) && self.base == document.camera_of(frame).and_then(Camera::base)
    }
}
