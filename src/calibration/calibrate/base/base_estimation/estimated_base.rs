//! An estimated base and its way into the document: the camera, the frames that are solved with it,
//! and the clicks that it disputes.

use super::super::follow_base::pan_turn;
use super::super::on_paint::BasePaintAlignment;
use super::landmark_fit::LandmarkFit;
use super::{BaseEstimationError, describe_mirrored};
use crate::calibrate::CalibrationError;
use crate::calibrate::field_size::written::write_base;
use crate::calibrate::frames::solve_frames::{FrameFields, is_by_clicks, solve_frames};
use std::collections::{BTreeMap, BTreeSet};
use std::path::Path;
use std::sync::Arc;
use touchline_core::field::FieldError;
use touchline_core::geometry::Angle;
use touchline_core::progress::Progress;
use touchline_core::solve::base::{BaseEstimate, FittedSize};
use touchline_core::solve::{FrameSolution, Verdict, WarningCode};
use touchline_documents::document::{
    Camera, CameraId, Click, Document, Frame, FrameStatus, SolutionWarning,
};

/// An estimated base with its inputs. Frames are numbered as in the document.
#[derive(Clone, Debug, PartialEq)]
pub struct EstimatedBase {
    /// The camera.
    pub camera: CameraId,
    /// Indices in the document of the frames that took part, one for each of
    /// [`BaseEstimate::frames`].
    pub frames: Vec<usize>,
    /// The estimate; its disputed clicks and mirrored frames have the document's frame indices.
    pub estimate: BaseEstimate,
    /// The residuals of each landmark, the worst landmark first.
    pub landmarks: Vec<LandmarkFit>,
    /// The fitted lengths of the field; empty if its size was not fitted.
    pub sizes: Vec<FittedSize>,
    /// The evidence from painted lines, where they took part.
    pub on_paint: Option<Arc<BasePaintAlignment>>,
    /// The clicks of the frames with disputed clicks or mirrored names, by the frames' indices in
    /// the document. The estimate says nothing of clicks that were changed later.
    pub(in crate::calibrate::base) doubted_clicks: BTreeMap<usize, Vec<Click>>,
}

impl EstimatedBase {
    /// Writes position, rotation, lens and σ into the camera, and the crown and a fitted size into
    /// its field. Frames are not changed.
    ///
    /// With several cameras, each gets a field of its own where crown or size change: they may be
    /// at different venues.
    pub fn write_camera(&self, document: &mut Document) {
        let BaseEstimate { base, crown_m, .. } = &self.estimate;
        write_base(document, &self.camera, base, *crown_m, &self.sizes);
    }

    /// Marks the clicks that disagree with the base and the frames with mirrored names in the
    /// solutions of these frames, unless their clicks have changed since the estimation. Call it
    /// after the frames have been solved with the new base.
    pub fn mark_disputes(&self, document: &mut Document) {
        let places: Vec<usize> = (0..document.frames.len()).collect();
        self.mark_disputes_in(document, &places);
    }

    /// The same for some frames only, by their indices in the document, ascending.
    fn mark_disputes_in(&self, document: &mut Document, places: &[usize]) {
        // The estimate is written later than it was computed, and the user may have corrected a
        // frame in between.
        let doubted = self.doubted_clicks.iter().filter(|(index, then)| {
            let now = document.frames.get(**index);
            places.binary_search(index).is_ok() && now.is_some_and(|now| now.clicks == **then)
        });
        let concerned: BTreeSet<usize> = doubted.map(|(index, _)| *index).collect();
        for disputed in self
            .estimate
            .disputed
            .iter()
            .filter(|disputed| concerned.contains(&disputed.frame))
        {
            let Some(frame) = document.frames.get_mut(disputed.frame) else {
                continue;
            };
            // A click that fits another name gets a warning with that name, unless one of the
            // frame's warnings suggests a name for it already.
            let named = frame
                .clicks
                .get(disputed.click)
                .and_then(|click| click.target.as_ref());
            let named = named.map(|target| target.as_str().to_owned());
            let Some(solution) = &mut frame.solution else {
                continue;
            };
            if !solution.disputed.contains(&disputed.click) {
                solution.disputed.push(disputed.click);
            }
            if let (Some((better, distance_px)), Some(named), Some(error_px)) =
                (&disputed.fits_better, named, disputed.error_px)
                && solution.warnings.iter().all(|known| {
                    known
                        .renames
                        .iter()
                        .all(|rename| rename.click != disputed.click)
                })
            {
                let message = format!(
                    "Point {} is {error_px:.0} px off as {named}, {distance_px:.1} px as {better}.",
                    disputed.click + 1
                );
                let warning = SolutionWarning::new(WarningCode::WrongLine.as_str(), message);
                solution.warnings.push(SolutionWarning {
                    clicks: vec![disputed.click],
                    ..warning
                });
            }
        }
        for mirrored in self
            .estimate
            .mirrored
            .iter()
            .filter(|mirrored| concerned.contains(&mirrored.frame))
        {
            // A frame that fits the base with mirrored names gets a warning, once, and its verdict
            // is `Wrong`.
            let Some(solution) = document
                .frames
                .get_mut(mirrored.frame)
                .and_then(|frame| frame.solution.as_mut())
            else {
                continue;
            };
            let has_warning = solution
                .warnings
                .iter()
                .any(|known| known.code == WarningCode::Mirrored.as_str());
            if !has_warning {
                let message = format!("The names look mirrored: {}.", describe_mirrored(mirrored));
                solution.warnings.push(SolutionWarning::new(
                    WarningCode::Mirrored.as_str(),
                    message,
                ));
                solution.verdict = Some(Verdict::Wrong);
            }
        }
    }

    /// Writes the base into the document: the camera, the crown, and all frames of the camera,
    /// solved again from their clicks. Clicks that disagree with the estimate are marked. Frames
    /// whose camera does not come from clicks keep their direction.
    ///
    /// # Errors
    /// The camera's field is not valid with the crown.
    pub fn write_to(
        &self,
        document: &mut Document,
        folder: &Path,
    ) -> Result<(), BaseEstimationError> {
        let before = document.clone();
        self.write_camera(document);
        let places: Vec<usize> = (0..document.frames.len()).collect();
        Ok(self.write_frames(document, &before, folder, &places, &Progress::default())?)
    }

    /// The part of [`Self::write_to`] that changes frames, for some of them by their indices.
    /// `document` has the base already, `before` does not. If `progress` cancels this, some frames
    /// have been changed and the document must be discarded.
    pub(in crate::calibrate) fn write_frames(
        &self,
        document: &mut Document,
        before: &Document,
        folder: &Path,
        places: &[usize],
        progress: &Progress<'_, ()>,
    ) -> Result<(), FieldError> {
        if document.camera(&self.camera).is_none() {
            return Ok(());
        }
        let field = document
            .at(folder)
            .model_of(document.field_of_camera(&self.camera))?;
        let before = before.camera(&self.camera).and_then(Camera::base);
        // Pan zero is a gauge. If the heading of the base changed, shift every pan by the
        // difference, so that a frame which is not solved again still looks in the same direction
        // of the world.
        let turned_deg = pan_turn(before.as_ref(), Some(&self.estimate.base)).degrees();
        // Every frame of the camera follows the gauge, rejected ones included, because the user may
        // take them back; only frames from clicks are solved again.
        let mut clicked = Vec::new();
        for &index in places {
            let frame = &document.frames[index];
            if frame.camera != self.camera {
                continue;
            }
            let is_solved_again = frame.status != FrameStatus::Rejected && is_by_clicks(frame);
            if turned_deg != 0.0
                && let Some(ptz) = &mut document.frames[index].ptz
            {
                ptz.pan_deg = Angle::from_degrees(ptz.pan_deg + turned_deg)
                    .wrap()
                    .degrees();
            }
            if is_solved_again {
                clicked.push(index);
            }
        }
        // A frame is not compared with other cameras here: these may be at another place, and only
        // this one has changed.
        if solve_frames(
            document,
            &clicked,
            FrameFields::Camera(&field),
            record_or_drop,
            progress,
        )
        .is_none()
        {
            return Ok(());
        }
        // Frames that were aligned to paint take precedence over their solution from clicks alone.
        if let Some(on_paint) = &self.on_paint {
            on_paint.write_frames(document, places);
        }
        self.mark_disputes_in(document, places);
        Ok(())
    }
}

/// Records a solution; a camera that the clicks no longer determine on the new base is removed.
fn record_or_drop(frame: &mut Frame, solved: Result<&FrameSolution, &CalibrationError>) {
    match solved {
        Ok(solved) => frame.record(solved),
        Err(CalibrationError::Solve(_)) => {
            frame.ptz = None;
            frame.solution = None;
        }
        // The other errors (no camera, no base, a name that the field lacks) say nothing about the
        // camera that the frame has.
        Err(_) => {}
    }
}
