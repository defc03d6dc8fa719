//! The shown frame with an estimated base that waits for the user's decision.

use crate::app::OpenProject;
use std::sync::Arc;
use touchline_calibration::calibrate::{CalibrationError, EstimatedBase, calibrate};
use touchline_core::camera::{CameraBase, PtzCamera};
use touchline_core::field::FieldModel;
use touchline_core::solve::{FrameSolution, Judgement, judge};

/// The values of the shown frame that would follow from the estimated base.
#[derive(Clone, Debug)]
pub struct WithProposal {
    /// The field with the estimated crown and size.
    pub field: Arc<FieldModel>,
    /// The estimated base.
    pub base: CameraBase,
    /// The frame's camera; none if its clicks do not determine one.
    pub camera: Option<PtzCamera>,
    /// The solution from its clicks; none if no click has a name.
    pub solution: Option<Result<FrameSolution, CalibrationError>>,
    /// The verdict and its reason.
    pub judgement: Option<Judgement>,
    /// The indices of the clicks that the others contradict.
    pub disputed: Vec<usize>,
}

impl WithProposal {
    /// Computes the values of a frame with an estimated base. None if the base is another camera's,
    /// or the field is invalid.
    pub(in crate::app) fn derive(
        open: &mut OpenProject,
        index: usize,
        found: &EstimatedBase,
    ) -> Option<Self> {
        let frame = open
            .document
            .frames
            .get(index)
            .filter(|frame| frame.camera == found.camera)?;
        // The frame is solved in a copy of the document that has the estimated base.
        let mut document = open.document.clone();
        found.write_camera(&mut document);
        let field = open.derived.field_in(&document, frame).ok()?;
        let base = document.camera_of(frame)?.base_for(frame)?;
        let is_named = frame.clicks.iter().any(|click| click.target.is_some());
        let solution = is_named.then(|| {
            calibrate(
                &document,
                // The copy has the same frames, so that their lookup is valid for it.
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
        let disputed = solved
            .map(FrameSolution::disputed_clicks)
            .unwrap_or_default();
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
