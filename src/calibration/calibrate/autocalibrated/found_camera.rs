//! The result of autocalibration on its way into a document that has been edited meanwhile.

use crate::calibrate::{AutocalibratedCamera, AutocalibratedFrame, record_found};
use touchline_core::camera::Ptz;
use touchline_core::geometry::ImageSize;
use touchline_documents::document::{CameraId, Document, FrameId};

/// The result of autocalibration for a camera of a document.
#[derive(Clone, Debug, PartialEq)]
pub struct FoundCamera {
    /// The camera.
    pub camera: CameraId,
    /// The result.
    pub found: AutocalibratedCamera,
    /// The ids of the frames in `found.frames`, in the same order: their indices may change.
    frames: Vec<FrameId>,
}

impl FoundCamera {
    /// Pairs a result with the document as it is now.
    pub fn new(document: &Document, camera: &CameraId, found: AutocalibratedCamera) -> Self {
        let frames = found
            .frames
            .iter()
            .map(|frame| document.frames[frame.index].id.clone())
            .collect();
        Self {
            camera: camera.clone(),
            found,
            frames,
        }
    }

    /// The frames that a document still has: index, camera and picture size.
    pub fn looks<'a>(
        &'a self,
        document: &'a Document,
    ) -> impl Iterator<Item = (usize, (Ptz, ImageSize))> + 'a {
        self.frames
            .iter()
            .zip(&self.found.frames)
            .filter_map(|(id, of_found)| {
                let index = document.frames.position_of(id)?;
                Some((index, (of_found.ptz, document.frames[index].image_size)))
            })
    }

    /// Writes base, crown and suggestions into a document. Frames that a person has clicked in or
    /// decided on do not change.
    pub(in crate::calibrate) fn write(&self, document: &mut Document) {
        // While the search ran, frames may have been added, removed or moved: ids stay, indices do
        // not.
        let frames = self
            .frames
            .iter()
            .zip(&self.found.frames)
            .filter_map(|(id, frame)| self.find_open_frame(document, id, frame))
            .collect();
        let found = AutocalibratedCamera {
            frames,
            ..self.found.clone()
        };
        record_found(document, &self.camera, &found);
    }

    /// A frame of the calibration with its present index in a document, in which it is found by id.
    /// None if it was deleted, assigned to another camera or decided on meanwhile.
    fn find_open_frame(
        &self,
        document: &Document,
        id: &FrameId,
        frame: &AutocalibratedFrame,
    ) -> Option<AutocalibratedFrame> {
        let index = document.frames.position_of(id)?;
        let now = &document.frames[index];
        (now.is_open() && now.camera == self.camera).then(|| AutocalibratedFrame {
            index,
            ..frame.clone()
        })
    }
}
