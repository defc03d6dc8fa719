//! From a document's clicks to the base of one of its cameras, and back into the document.

use super::field_size::write_base;
use super::follow_base::pan_turn;
use super::on_paint::BasePaintAlignment;
use super::own_cameras::cameras_from_lines;
use crate::calibrate::base_readiness::LANDMARKS_ALONE;
use crate::calibrate::frames::solve_frames::{FrameFields, is_by_clicks, solve_frames};
use crate::calibrate::{CalibrationError, observations};
use std::collections::{BTreeMap, BTreeSet};
use std::path::Path;
use std::sync::Arc;
use thiserror::Error;
use touchline_core::camera::{CameraBase, PtzCamera};
use touchline_core::field::{FieldError, FieldModel, LandmarkId, Symmetry};
use touchline_core::geometry::{Angle, ImagePoint, ImageSize, median};
use touchline_core::progress::Progress;
use touchline_core::solve::base::{
    AdjustOptions, BaseError, BaseEstimate, BaseModel, BaseOptions, BaseProgress, CameraClicks,
    CrownModel, FittedSize, FrameClicks, LensModel, MirroredFrame, adjust_base, estimate_base,
    start_base,
};
use touchline_core::solve::{FrameSolution, ObservationError, Verdict, WarningCode};
use touchline_documents::document::{
    Camera, CameraId, Click, Document, DocumentAt, Frame, FrameStatus, SolutionWarning, Target,
};

/// Why a base cannot be estimated.
#[derive(Clone, Debug, PartialEq, Error)]
#[non_exhaustive]
pub enum BaseEstimationError {
    /// The camera is not in the document.
    #[error("camera {camera:?} is not in the document")]
    UnknownCamera {
        /// The camera's name.
        camera: String,
    },
    /// The field is not valid.
    #[error(transparent)]
    Field(#[from] FieldError),
    /// A click names a landmark or line that the field does not have.
    #[error("{frame}: {source}")]
    Observation {
        /// The frame's name.
        frame: String,
        /// The error of the name.
        source: ObservationError,
    },
    /// The clicks do not determine a base.
    #[error(transparent)]
    Base(#[from] BaseError),
}

/// The input for estimating the base of a camera: its frames with their clicks.
#[derive(Clone, Debug)]
pub struct BaseProblem {
    /// The camera.
    pub camera: CameraId,
    /// The field that it shows.
    pub field: FieldModel,
    /// Indices in the document of the frames that take part.
    pub frames: Vec<usize>,
    /// Their clicks, in the same order.
    pub clicks: Vec<FrameClicks>,
    pub(in crate::calibrate) image_size: ImageSize,
    pub(in crate::calibrate) principal_point: ImagePoint,
    pub(super) previous: Option<CameraBase>,
}

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
    pub(super) doubted_clicks: BTreeMap<usize, Vec<Click>>,
}

/// The residuals of the clicks on one landmark, over all frames.
#[derive(Clone, Debug, PartialEq)]
pub struct LandmarkFit {
    /// The landmark.
    pub id: LandmarkId,
    /// Median residual, px.
    pub median_px: f64,
    /// Number of clicks.
    pub clicks: usize,
    /// The click with the largest residual: its frame's index in the document, and its index in the
    /// frame.
    pub worst: (usize, usize),
    /// The residual of that click, px.
    pub worst_px: f64,
}

impl BaseProblem {
    /// Gathers the clicks of a camera's frames, except rejected frames and those excluded from the
    /// base. `folder` is the document's.
    ///
    /// # Errors
    /// The document lacks the camera, its field is not valid, or a click names something that the
    /// field lacks.
    pub fn from_document(
        document: DocumentAt<'_>,
        camera: &CameraId,
    ) -> Result<Self, BaseEstimationError> {
        Self::gather(document, camera, |_| false)
    }

    /// The same, with solved frames that have no clicks: their paint may contribute.
    ///
    /// # Errors
    /// Those of [`Self::from_document`].
    pub(super) fn with_solved(
        document: DocumentAt<'_>,
        camera: &CameraId,
    ) -> Result<Self, BaseEstimationError> {
        Self::gather(document, camera, |frame| frame.ptz.is_some())
    }

    /// Frames of a camera, by their indices in the document, without any clicks.
    pub(crate) fn without_clicks(
        camera: &Camera,
        field: FieldModel,
        base: &CameraBase,
        frames: Vec<usize>,
    ) -> Self {
        let clicks = frames
            .iter()
            .map(|_| FrameClicks {
                observations: Vec::new(),
                start: None,
            })
            .collect();
        Self {
            camera: camera.id.clone(),
            field,
            frames,
            clicks,
            image_size: camera.image_size,
            principal_point: base.principal_point,
            previous: Some(*base),
        }
    }

    /// Gathers the frames with clicks, and those without clicks that satisfy `is_wanted`.
    fn gather(
        document: DocumentAt<'_>,
        camera: &CameraId,
        is_wanted: impl Fn(&Frame) -> bool,
    ) -> Result<Self, BaseEstimationError> {
        let known = document
            .camera(camera)
            .ok_or_else(|| BaseEstimationError::UnknownCamera {
                camera: camera.as_str().to_owned(),
            })?;
        let field = document.model_of(document.field_of_camera(camera))?;
        let (mut frames, mut clicks) = (Vec::new(), Vec::new());
        for (index, frame) in document.frames.iter().enumerate() {
            // Frames of another picture size cannot share the camera's lens and principal point. A
            // wrong name in a frame that takes no part does no harm.
            if frame.camera != *camera
                || frame.image_size != known.image_size
                || !frame.is_used_for_base()
            {
                continue;
            }
            let observations =
                observations(frame, &field).map_err(|source| BaseEstimationError::Observation {
                    frame: frame.name(),
                    source,
                })?;
            // Check clicks alone contribute nothing to a base.
            let has_clicks = observations.iter().any(|observation| !observation.check);
            if has_clicks || is_wanted(frame) {
                frames.push(index);
                clicks.push(FrameClicks {
                    observations,
                    start: None,
                });
            }
        }
        Ok(Self {
            camera: camera.clone(),
            field,
            frames,
            clicks,
            image_size: known.image_size,
            principal_point: known.principal_point,
            previous: known.base(),
        })
    }

    /// Number of clicks that take part.
    #[must_use]
    pub fn click_count(&self) -> usize {
        self.clicks
            .iter()
            .flat_map(|frame| &frame.observations)
            .filter(|observation| !observation.check)
            .count()
    }

    /// Estimates the base. `document` is the one that the clicks were gathered from.
    ///
    /// # Errors
    /// The clicks give no base, or it was cancelled.
    pub fn estimate(
        &self,
        document: &Document,
        options: &BaseOptions,
        progress: &Progress<'_, BaseProgress>,
    ) -> Result<EstimatedBase, BaseEstimationError> {
        let has_landmarks = self
            .frames
            .iter()
            .any(|index| document.frames[*index].landmark_clicks() >= LANDMARKS_ALONE);
        // Frames without landmarks enough may have cameras by their lines, from which to start.
        let own_cameras = if has_landmarks {
            Vec::new()
        } else {
            cameras_from_lines(&self.field, &self.clicks, self.image_size)
        };
        let clicks = CameraClicks {
            own_cameras: &own_cameras,
            ..self.camera_clicks()
        };
        let estimate = estimate_base(&clicks, self.previous.as_ref(), options, progress)?;
        Ok(self.estimated_base(document, estimate))
    }

    /// The clicks as the input of an adjustment.
    pub(super) fn camera_clicks(&self) -> CameraClicks<'_> {
        CameraClicks {
            field: &self.field,
            frames: &self.clicks,
            image_size: self.image_size,
            principal_point: self.principal_point,
            own_cameras: &[],
        }
    }

    /// An estimate from these frames, with the document's frame indices.
    pub(super) fn estimated_base(
        &self,
        document: &Document,
        mut estimate: BaseEstimate,
    ) -> EstimatedBase {
        // The estimator counts the frames that take part, readers count those of the document.
        for disputed in &mut estimate.disputed {
            disputed.frame = self.frames[disputed.frame];
        }
        for mirrored in &mut estimate.mirrored {
            mirrored.frame = self.frames[mirrored.frame];
        }
        let disputed = estimate.disputed.iter().map(|disputed| disputed.frame);
        let mirrored = estimate.mirrored.iter().map(|mirrored| mirrored.frame);
        let doubted_clicks = disputed
            .chain(mirrored)
            .filter_map(|index| Some((index, document.frames.get(index)?.clicks.clone())))
            .collect();
        let landmarks = self.landmark_fits(document, &estimate);
        let (camera, frames) = (self.camera.clone(), self.frames.clone());
        EstimatedBase {
            camera,
            frames,
            estimate,
            landmarks,
            sizes: Vec::new(),
            on_paint: None,
            doubted_clicks,
        }
    }

    /// The distance of the clicks on each landmark from its projection with the new base, crown and
    /// frame cameras. Landmarks are sorted by their median, the worst first.
    fn landmark_fits(&self, document: &Document, estimate: &BaseEstimate) -> Vec<LandmarkFit> {
        // The crown raises the middle of the field, so landmarks are projected from the surface
        // that the estimate found.
        let field = self.field.with_crown_m(estimate.crown_m);
        // Residuals in px by landmark, with the indices of frame and click. Check clicks count for
        // nothing.
        let mut errors: BTreeMap<&LandmarkId, Vec<(f64, usize, usize)>> = BTreeMap::new();
        for (index, fit) in self.frames.iter().zip(&estimate.frames) {
            let (Some(fit), Some(frame)) = (fit, document.frames.get(*index)) else {
                continue;
            };
            let camera = PtzCamera::new(estimate.base, fit.ptz);
            for (number, click) in frame
                .clicks
                .iter()
                .enumerate()
                .filter(|(_, click)| !click.check)
            {
                if let Some(Target::Landmark(id)) = &click.target
                    && let Some(landmark) = field.landmark(id.as_str())
                    && let Ok(image) = camera.image_from_world(field.landmark_in_world(landmark))
                {
                    errors.entry(id).or_default().push((
                        image.distance_px(click.image),
                        *index,
                        number,
                    ));
                }
            }
        }
        let mut fits: Vec<LandmarkFit> = errors
            .into_iter()
            .filter_map(|(id, errors)| landmark_fit(id, errors))
            .collect();
        fits.sort_by(|a, b| b.median_px.total_cmp(&a.median_px));
        fits
    }
}

/// The fit of one landmark from its residuals (px) with the indices of frame and click; none
/// without a residual. The median is robust against a single wrong click, which `worst` names.
fn landmark_fit(id: &LandmarkId, mut errors: Vec<(f64, usize, usize)>) -> Option<LandmarkFit> {
    errors.sort_by(|a, b| a.0.total_cmp(&b.0));
    let (worst_px, frame, click) = *errors.last()?;
    let median_px = median(&mut errors.iter().map(|error| error.0).collect::<Vec<_>>())?;
    Some(LandmarkFit {
        id: id.clone(),
        median_px,
        clicks: errors.len(),
        worst: (frame, click),
        worst_px,
    })
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

/// The camera that a frame's own clicks determine without a known base, from four or more landmarks
/// on the ground, or else from lines and landmarks with as many equations; none if they do not.
///
/// A homography gives position, rotation and focal length. They are refined with a pinhole lens and
/// the field's crown: one frame does not determine a lens. A camera from lines has the usual places
/// of cameras as a prior instead of a known principal point and lens.
#[must_use]
pub fn camera_alone(document: &Document, frame: &Frame, field: &FieldModel) -> Option<PtzCamera> {
    let camera = document.camera_of(frame)?;
    let frames = [FrameClicks {
        observations: observations(frame, field).ok()?,
        start: None,
    }];
    if frame.landmark_clicks() < LANDMARKS_ALONE {
        return cameras_from_lines(field, &frames, frame.image_size).pop();
    }
    let (image_size, principal_point) = (frame.image_size, camera.principal_point);
    let clicks = CameraClicks {
        field,
        frames: &frames,
        image_size,
        principal_point,
        own_cameras: &[],
    };
    // The linear start, then the nonlinear refinement of position, rotation, pan, tilt and focal
    // length.
    let start = start_base(&clicks).ok()?;
    let crown = CrownModel::Fixed(field.crown_m);
    let model = BaseModel {
        lens: LensModel::Pinhole,
        crown,
        principal_point: None,
    };
    let options = AdjustOptions::default();
    let adjusted = adjust_base(&clicks, &start.base, &start.ptz, &model, &options);
    Some(PtzCamera::new(adjusted.base, (*adjusted.ptz.first()?)?))
}

/// Describes the residuals of a frame with mirrored names.
#[must_use]
pub fn describe_mirrored(mirrored: &MirroredFrame) -> String {
    let exchanged = match mirrored.symmetry {
        Symmetry::MirrorX => "left and right",
        Symmetry::MirrorY => "near and far",
        Symmetry::Turn180 => "left and right, near and far",
    };
    format!(
        "{:.0} px off as named, {:.1} px with {exchanged} exchanged",
        mirrored.median_px, mirrored.median_mirrored_px
    )
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::calibrate::fixtures::document_with;
    use touchline_core::camera::{BaseAngles, Ptz};
    use touchline_core::geometry::{Mat3, Vec3};
    use touchline_core::solve::base::{DisputedClick, ModelReason};
    use touchline_documents::document::{FramePtz, Solution};

    const SIZE: ImageSize = ImageSize::new(1920, 1080);

    fn base(heading_deg: f64) -> CameraBase {
        let angles = BaseAngles {
            heading: Angle::from_degrees(heading_deg),
            ..BaseAngles::default()
        };
        let position_m = Vec3::new(0.0, -60.0, 18.0);
        CameraBase::new(position_m, angles.base_from_world(), SIZE.centre())
    }

    /// An estimate of a base along world +y that took no frame.
    fn estimate() -> BaseEstimate {
        BaseEstimate {
            base: base(0.0),
            crown_m: 0.0,
            model: BaseModel {
                lens: LensModel::Pinhole,
                crown: CrownModel::Fixed(0.0),
                principal_point: None,
            },
            reason: ModelReason::Prescribed,
            scores: Vec::new(),
            position_covariance: Mat3::zeros(),
            frames: Vec::new(),
            median_px: 1.0,
            p90_px: 1.0,
            previous_median_px: None,
            one_more_frame: None,
            disputed: Vec::new(),
            mirrored: Vec::new(),
        }
    }

    fn problem(document: &Document) -> Result<BaseProblem, BaseEstimationError> {
        BaseProblem::from_document(document.at(Path::new("/")), &"main".into())
    }

    #[test]
    fn a_rejected_frame_keeps_its_direction_in_the_world() {
        let mut document = document_with(&base(20.0), SIZE);
        let mut frame = Frame::from_image("1.jpg", "main".into(), SIZE);
        frame.ptz = Some(FramePtz::new(Ptz::from_degrees(5.0, -12.0, 2000.0), None));
        frame.status = FrameStatus::Rejected;
        document.frames.push(frame.into());
        let estimated = problem(&document)
            .unwrap()
            .estimated_base(&document, estimate());
        estimated.write_to(&mut document, Path::new("/")).unwrap();
        let pan_deg = document.frames[0].ptz.as_ref().unwrap().pan_deg;
        assert!((pan_deg - 25.0).abs() < 1e-9, "{pan_deg}");
    }

    #[test]
    fn a_wrong_name_in_a_rejected_frame_does_not_end_the_estimation() {
        let mut document = document_with(&base(0.0), SIZE);
        let mut frame = Frame::from_image("1.jpg", "main".into(), SIZE);
        let click = Click::landmark("no_such_mark".into(), SIZE.centre());
        frame.clicks.push(click);
        document.frames.push(frame.into());
        assert!(problem(&document).is_err());
        document.frames[0].status = FrameStatus::Rejected;
        assert!(problem(&document).is_ok());
    }

    #[test]
    fn clicks_that_changed_after_the_estimation_are_not_disputed() {
        let mut document = document_with(&base(0.0), SIZE);
        let mut frame = Frame::from_image("1.jpg", "main".into(), SIZE);
        for landmark in ["centre_mark", "halfway_far"] {
            let click = Click::landmark(landmark.into(), SIZE.centre());
            frame.clicks.push(click);
        }
        frame.solution = Some(Solution::default());
        document.frames.push(frame.into());
        let disputed = DisputedClick {
            frame: 0,
            click: 1,
            error_px: Some(90.0),
            fits_better: None,
        };
        let estimate = BaseEstimate {
            disputed: vec![disputed],
            ..estimate()
        };
        let estimated = problem(&document)
            .unwrap()
            .estimated_base(&document, estimate);
        let mut same = document.clone();
        estimated.mark_disputes(&mut same);
        assert_eq!(same.frames[0].solution.as_ref().unwrap().disputed, [1]);
        document.frames[0].clicks.remove(0);
        estimated.mark_disputes(&mut document);
        let solution = document.frames[0].solution.as_ref().unwrap();
        assert!(solution.disputed.is_empty());
    }
}
