//! Where a camera's references and suggestions look.

use touchline_calibration::proposals::Coverage;
use touchline_core::field::FieldModel;
use touchline_documents::document::{CameraId, Document, FrameStatus};

/// Where references and suggestions look, over the same pans and tilts.
#[derive(Clone, Debug, PartialEq)]
pub struct Seen {
    /// What references see, and the field.
    pub references: Coverage,
    /// What suggestions see.
    pub suggestions: Coverage,
}

impl Seen {
    /// What a camera's frames see; none while its base is not known.
    #[must_use]
    pub fn of(document: &Document, field: &FieldModel, camera: &CameraId) -> Option<Self> {
        let of = |status: FrameStatus| {
            let frames = document
                .frames
                .iter()
                .enumerate()
                .filter(|(_, frame)| frame.status == status);
            let frames: Vec<usize> = frames.map(|(index, _)| index).collect();
            Coverage::of(document, field, camera, &frames)
        };
        Some(Self {
            references: of(FrameStatus::Reference)?,
            suggestions: of(FrameStatus::Suggested)?,
        })
    }
}
