//! What painted lines said about a base, and the frames that were pulled onto them.

use touchline_core::solve::base::HeldOutErrors;
use touchline_documents::document::{Document, Frame};

/// What painted lines said about a base.
#[derive(Clone, Debug, PartialEq)]
pub struct PaintSeen {
    /// Frames whose paint took part.
    pub frames: usize,
    /// Places of paint that took part.
    pub places: usize,
    /// Different lines among them.
    pub lines: usize,
    /// The base before: errors where a frame's camera is refined on half of its paint and clicks
    /// and judged by the other half. If clicks gave this base it has seen all of them.
    pub before: OnPaintErrors,
    /// The same for the new base, found without the frame.
    pub after: OnPaintErrors,
}

/// What painted lines said about a base, and the frames that were pulled onto them with it.
#[derive(Clone, Debug, PartialEq)]
pub struct OnPaint {
    /// What they said.
    pub seen: PaintSeen,
    /// The frames on their paint, as they were when the base was estimated.
    pub pulled: Vec<Frame>,
}

/// Errors at what was held out.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct OnPaintErrors {
    /// Of the paint; none without any.
    pub paint: Option<HeldOutErrors>,
    /// Of the clicks; none without any.
    pub clicks: Option<HeldOutErrors>,
}

impl PaintSeen {
    /// How far paint that took no part lies off the lines, and before, in a sentence after a space;
    /// empty where none was held out.
    #[must_use]
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

impl OnPaint {
    /// Writes the pulled frames, those of them that lie at some places (ascending): but for frames
    /// whose clicks, camera or use have changed since.
    pub(super) fn write_frames(&self, document: &mut Document, places: &[usize]) {
        for pulled in &self.pulled {
            let Some(index) = document.frames.position_of(&pulled.id) else {
                continue;
            };
            let frame = &document.frames[index];
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
