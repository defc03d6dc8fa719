//! What the painted lines of the open document's pictures are asked in the background.

use std::path::PathBuf;
use std::sync::Arc;
use thiserror::Error;
use touchline_calibration::calibrate::{OnPaintError, SnapFrameError, camera_on_paint};
use touchline_calibration::proposals::{PictureError, read_picture};
use touchline_core::camera::CameraBase;
use touchline_core::field::FieldModel;
use touchline_documents::document::Document;
use touchline_vision::media::ReadFrames;
use touchline_vision::paint::{FindOptions, Snapped, WatchFind};

/// A frame's camera is to be pulled onto the painted lines, or found by them.
#[derive(Clone, Debug, PartialEq)]
pub struct SnapOrder {
    /// Which order: the report says it again.
    pub ticket: u64,
    /// The document.
    pub document: Document,
    /// Where its relative paths start.
    pub folder: PathBuf,
    /// The frame's place.
    pub frame: usize,
    /// The field that it shows.
    pub field: Arc<FieldModel>,
    /// Whether its camera is searched by the lines alone: it has none.
    pub from_nothing: bool,
}

/// A camera on the painted lines.
#[derive(Clone, Debug, PartialEq)]
pub struct SnappedFrame {
    /// The base it was snapped with.
    pub base: CameraBase,
    /// The camera and what speaks for it.
    pub snapped: Snapped,
}

/// Why a frame is not snapped.
#[derive(Clone, Debug, PartialEq, Error)]
pub enum SnapFailure {
    /// Its picture cannot be had.
    #[error(transparent)]
    Picture(#[from] PictureError),
    /// The paint does not decide.
    #[error(transparent)]
    Paint(#[from] OnPaintError),
    /// An internal error of this program.
    #[error("internal error (please report it): {message}")]
    Panicked {
        /// The words of the panic.
        message: String,
    },
}

impl SnapOrder {
    /// Pulls the camera onto the paint, or finds it; `watch` is told how far a search has come and may end it.
    ///
    /// # Errors
    /// The picture cannot be had, or the paint does not decide.
    pub fn carry_out(
        &self,
        reader: &mut dyn ReadFrames,
        watch: WatchFind<'_>,
    ) -> Result<Box<SnappedFrame>, SnapFailure> {
        let frame = self.document.frames.get(self.frame).ok_or(OnPaintError::Snap(SnapFrameError::Unsolved))?;
        let picture = read_picture(reader, frame, &self.folder)?;
        let how = (&FindOptions::default(), self.from_nothing);
        let (base, snapped) = camera_on_paint(&self.document, frame, &self.field, &picture, how, watch)?;
        Ok(Box::new(SnappedFrame { base, snapped }))
    }
}
