//! The evidence of painted lines for a base, and the frames that were aligned to them.

use touchline_core::solve::base::HeldOutErrors;
use touchline_documents::document::{Document, Frame};

/// The evidence of painted lines for a base.
#[derive(Clone, Debug, PartialEq)]
pub struct BasePaintEvidence {
    /// Number of frames whose paint took part.
    pub frames: usize,
    /// Number of positions of paint that took part.
    pub places: usize,
    /// Number of different lines among them.
    pub lines: usize,
    /// Errors of the earlier base: the camera of each frame is refined on one half of its paint and
    /// clicks and evaluated on the other. If this base was estimated from clicks, it has used all
    /// of them.
    pub before: OnPaintErrors,
    /// The same for the new base, estimated without the frame.
    pub after: OnPaintErrors,
}

/// The evidence of painted lines for a base, and the frames that were aligned to them with it.
#[derive(Clone, Debug, PartialEq)]
pub struct BasePaintAlignment {
    /// The evidence.
    pub seen: BasePaintEvidence,
    /// The aligned frames, as of the estimation of the base.
    pub pulled: Vec<Frame>,
}

/// Errors at held-out data.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct OnPaintErrors {
    /// At the paint; none without any.
    pub paint: Option<HeldOutErrors>,
    /// At the clicks; none without any.
    pub clicks: Option<HeldOutErrors>,
}

impl BasePaintEvidence {
    /// The error at held-out paint, and the earlier one, as a sentence that begins with a space;
    /// empty if no paint was held out.
    pub fn describe(&self) -> String {
        let Some(after) = self.after.paint else {
            return String::new();
        };
        let before = self.before.paint.map_or_else(String::new, |before| {
            format!(" ({:.2} px before)", before.median_px)
        });
        format!(
            " Painted lines that were not used are {:.2} px off{before}.",
            after.median_px
        )
    }
}

impl BasePaintAlignment {
    /// Writes those of the aligned frames that are at these indices (ascending), except frames
    /// whose clicks, camera or use have changed since the estimation.
    pub(in crate::calibrate) fn write_frames(&self, document: &mut Document, places: &[usize]) {
        for pulled in &self.pulled {
            let Some(index) = document.frames.position_of(&pulled.id) else {
                continue;
            };
            let frame = &document.frames[index];
            // The estimate is written later than it was computed, and the user may have edited the
            // frame in between.
            let is_as_then = frame.clicks == pulled.clicks
                && frame.camera == pulled.camera
                && frame.status == pulled.status
                && frame.use_for_base == pulled.use_for_base;
            if is_as_then && places.binary_search(&index).is_ok() {
                let frame = &mut document.frames[index];
                frame.ptz.clone_from(&pulled.ptz);
                frame.solution.clone_from(&pulled.solution);
            }
        }
    }
}
