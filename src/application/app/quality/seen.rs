//! The directions that a camera's references and suggestions cover.

use touchline_calibration::proposals::Coverage;
use touchline_core::field::FieldModel;
use touchline_documents::document::{CameraId, Document, FrameStatus};

/// Coverage of references and suggestions, over the same range of pan and tilt.
#[derive(Clone, Debug, PartialEq)]
pub struct Seen {
    /// Coverage of the references, and of the field.
    pub references: Coverage,
    /// Coverage of the suggestions.
    pub suggestions: Coverage,
}

impl Seen {
    /// The coverage of a camera's frames; none if it has no base.
    #[must_use]
    pub fn compute(document: &Document, field: &FieldModel, camera: &CameraId) -> Option<Self> {
        let of = |status: FrameStatus| {
            let frames = document
                .frames
                .iter()
                .enumerate()
                .filter(|(_, frame)| frame.status == status);
            let frames: Vec<usize> = frames.map(|(index, _)| index).collect();
            Coverage::measure(document, field, camera, &frames)
        };
        Some(Self {
            references: of(FrameStatus::Reference)?,
            suggestions: of(FrameStatus::Suggested)?,
        })
    }
}
