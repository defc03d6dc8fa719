//! The values on the quality page: cameras over time, errors of clicks, coverage. They are derived
//! and never stored.
//!
//! The page shows one camera of the document. Nothing is computed while it is closed and no curves
//! are shown below the picture.

mod course;
mod errors;
mod targets;
mod thinning;

pub use crate::app::window_state::choices::{QualityChoice, TimeAxis};
pub use course::{Course, CoursePoint, PointKind, Quantity, within_whole, zoom_span};
pub use errors::{Bin, ClickError, ClickErrors, Histogram, Spread};
pub use targets::{TargetErrors, by_target};
pub use thinning::{Column, SpanMarks, thin_points};

use super::OpenProject;
use crate::app::window_state::session::Session;
use touchline_calibration::proposals::Coverage;
use touchline_core::field::FieldModel;
use touchline_documents::document::{CameraId, Document, FrameStatus};

/// The values on the quality page for one camera: derived, never stored.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Quality {
    pub camera: Option<CameraId>,
    /// Pan, tilt and focal length over time.
    pub course: Course,
    /// Distances of clicks from what they name.
    pub errors: ClickErrors,
    /// The same, grouped by landmark and line.
    pub targets: Vec<TargetErrors>,
    /// The indices of accepted frames whose paint contradicts their cameras.
    pub off_paint: Vec<usize>,
    /// Where references and suggestions look; none if the camera has no base.
    pub seen: Option<CoverageComparison>,
    derived_from: Option<(u64, TimeAxis)>,
}

impl Quality {
    /// Recomputes the values if the page is open, or the curves below the picture are shown, and
    /// their inputs have changed.
    pub(super) fn refresh(
        &mut self,
        open: Option<&mut OpenProject>,
        session: &Session,
        has_curves: bool,
    ) {
        let choice = &session.quality;
        let Some(open) = open.filter(|_| choice.open || has_curves) else {
            // Free the values of a closed page: of a long match they are many.
            if self.derived_from.is_some() {
                *self = Self::default();
            }
            return;
        };
        let camera = chosen_camera(open, session);
        let from = Some((open.document.version(), choice.axis));
        if self.derived_from != from || self.camera != camera {
            *self = Self::derive(open, camera, choice.axis);
            self.derived_from = from;
        }
    }

    /// Computes all values for a camera; empty without one.
    fn derive(open: &mut OpenProject, camera: Option<CameraId>, axis: TimeAxis) -> Self {
        let Some(id) = &camera else {
            return Self::default();
        };
        let fields = open.fields();
        let disagreements = open.derived.disagreements(&open.document);
        let document = &*open.document;
        let off_paint = off_paint(document, id);
        let course_of = || Course::compute(document, disagreements, id, axis);
        // Without a valid field there are no errors of clicks and no coverage.
        let Ok(fields) = fields else {
            return Self {
                course: course_of(),
                camera,
                off_paint,
                ..Self::default()
            };
        };
        let errors_of = || {
            let errors = ClickErrors::compute(document, &fields, id);
            let targets = by_target(&errors);
            (errors, targets)
        };
        // `per_camera` has the fields in the order of the cameras.
        let place = document.cameras.iter().position(|camera| camera.id == *id);
        let field = place.map(|place| fields.per_camera(document).swap_remove(place));
        let seen_of = || CoverageComparison::compute(document, &*field?, id);
        // The three are independent, and each takes a pass over all frames.
        let (course, ((errors, targets), seen)) =
            rayon::join(course_of, || rayon::join(errors_of, seen_of));
        Self {
            course,
            errors,
            targets,
            off_paint,
            seen,
            camera,
            derived_from: None,
        }
    }
}

/// Coverage of references and suggestions, over the same range of pan and tilt.
#[derive(Clone, Debug, PartialEq)]
pub struct CoverageComparison {
    /// Coverage of the references, and of the field.
    pub references: Coverage,
    pub suggestions: Coverage,
}

impl CoverageComparison {
    /// The coverage of a camera's frames; none if it has no base.
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

/// The indices of the camera's accepted frames whose paint contradicts them.
fn off_paint(document: &Document, camera: &CameraId) -> Vec<usize> {
    document
        .frames
        .iter()
        .enumerate()
        .filter(|(_, frame)| {
            frame.camera == *camera && frame.evidence_against_acceptance().is_some()
        })
        .map(|(index, _)| index)
        .collect()
}

/// The chosen camera if the document still has it, otherwise the shown frame's, otherwise the
/// first.
fn chosen_camera(open: &OpenProject, session: &Session) -> Option<CameraId> {
    let document = &open.document;
    let chosen = session
        .quality
        .camera
        .clone()
        .filter(|id| document.camera(id).is_some());
    chosen
        .or_else(|| open.frame(session.frame).map(|frame| frame.camera.clone()))
        .or_else(|| document.cameras.first().map(|camera| camera.id.clone()))
}
