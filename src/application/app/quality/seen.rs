//! The directions that a camera's references and suggestions cover.

use touchline_calibration::proposals::Coverage;
use touchline_core::field::FieldModel;
use touchline_documents::document::{CameraId, Document, FrameStatus};

/// Coverage of references and suggestions, over the same range of pan and tilt.
#[derive(Clone, Debug, PartialEq)]
pub struct CoverageComparison {
    /// Coverage of the references, and of the field.
    pub references: Coverage,
    /// Coverage of the suggestions.
    pub suggestions: Coverage,
}

impl CoverageComparison {
    /// The coverage of a camera's frames; none if it has no base.
    #[must_use]
    pub fn compute(document: &Document, field: &FieldModel, camera: &CameraId) -> Option<Self> {
        Some(Self {
            references: measure_with_status(document, field, camera, FrameStatus::Reference)?,
            suggestions: measure_with_status(document, field, camera, FrameStatus::Suggested)?,
        })
    }
}

/// The coverage of a camera's frames with a status.
fn measure_with_status(
    document: &Document,
    field: &FieldModel,
    camera: &CameraId,
    status: FrameStatus,
) -> Option<Coverage> {
    let frames = document.frames.iter().enumerate();
    let frames: Vec<usize> = frames
        .filter(|(_, frame)| frame.status == status)
        .map(|(index, _)| index)
        .collect();
    Coverage::measure(document, field, camera, &frames)
}
