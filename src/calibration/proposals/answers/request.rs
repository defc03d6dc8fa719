//! The state of a frame at the time of a request, by which stale answers are recognised.

use touchline_core::camera::CameraBase;
use touchline_documents::document::{Camera, CameraId, Document, Frame};

/// The state of a frame at the time of a request.
#[derive(Clone, Debug, PartialEq)]
pub struct FrameRequest {
    /// Revision of the frame.
    pub revision: u64,
    /// Name of its picture.
    pub picture: String,
    /// SHA-256 of its image file, if the document states it.
    pub sha256: Option<String>,
    /// Id of its camera.
    pub camera: CameraId,
    /// Base of that camera.
    pub base: Option<CameraBase>,
}

impl FrameRequest {
    /// The present state of a frame.
    pub fn from_frame(document: &Document, frame: &Frame) -> Self {
        Self {
            revision: frame.revision,
            picture: frame.name(),
            sha256: frame.sha256.clone(),
            camera: frame.camera.clone(),
            base: document.camera_of(frame).and_then(Camera::base),
        }
    }

    /// Whether a frame still has the same picture and camera.
    pub(crate) fn is_of(&self, frame: &Frame) -> bool {
        self.sha256 == frame.sha256 && self.camera == frame.camera && self.picture == frame.name()
    }

    /// Whether everything that an answer depends on is unchanged: picture, camera and base.
    pub fn is_still(&self, document: &Document, frame: &Frame) -> bool {
        self.is_of(frame) && self.base == document.camera_of(frame).and_then(Camera::base)
    }
}
