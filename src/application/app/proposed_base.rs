//! The shown frame as it would be with a base that was estimated and waits for a decision.

use super::OpenProject;
use std::sync::Arc;
use touchline_calibration::calibrate::{CalibrationError, EstimatedBase, calibrate};
use touchline_core::camera::{CameraBase, PtzCamera};
use touchline_core::field::FieldModel;
use touchline_core::solve::{FrameSolution, Judgement, judge};

/// The shown frame as it would be with a base that waits for a decision.
#[derive(Clone, Debug)]
pub struct WithProposal {
    /// The field with the crown that was found.
    pub field: Arc<FieldModel>,
    /// The camera's base as it was found.
    pub base: CameraBase,
    /// The frame's camera; none where its clicks do not give one.
    pub camera: Option<PtzCamera>,
    /// What its clicks say; none without any.
    pub solution: Option<Result<FrameSolution, CalibrationError>>,
    /// One word and its reason.
    pub judgement: Option<Judgement>,
    /// The clicks that the others contradict.
    pub disputed: Vec<usize>,
}

impl WithProposal {
    pub(super) fn derive(
        open: &mut OpenProject,
        index: usize,
        found: &EstimatedBase,
    ) -> Option<Self> {
        let frame = open
            .document
            .frames
            .get(index)
            .filter(|frame| frame.camera == found.camera)?;
        let mut document = open.document.clone();
        found.write_camera(&mut document);
        let field = open.derived.field_in(&document, frame).ok()?;
        let base = document.camera_of(frame)?.base_for(frame)?;
        let is_named = frame.clicks.iter().any(|click| click.target.is_some());
        let solution = is_named.then(|| {
            calibrate(
                &document,
                open.derived.lookup(&open.document),
                frame,
                &field,
                index,
            )
        });
        let solved = solution
            .as_ref()
            .and_then(|solution| solution.as_ref().ok());
        let camera = solved.map(|solved| PtzCamera::new(base, solved.ptz));
        let judgement = solved.map(|solved| judge(solved, frame.image_size));
        let disputed = solved.map(FrameSolution::disputed).unwrap_or_default();
        Some(Self {
            field: Arc::new(field),
            base,
            camera,
            solution,
            judgement,
            disputed,
        })
    }
}
