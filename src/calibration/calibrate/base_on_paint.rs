//! The base of a camera from the clicks and the painted lines of its frames, in one adjustment.
//!
//! The initial base comes from the clicks, or else from the document. With it every frame is
//! aligned to its paint, and clicks and positions of paint are adjusted together; this is repeated
//! once from the result. Lens and crown are chosen by their error at held-out paint.

use super::follow_base::forget_certainty;
use super::known_frames::{BaseOnPaintError, KnownCameras, KnownFrames, OpenField, PaintEstimate};
use super::on_paint::{OnPaint, PaintSeen};
use super::paint::{record_snapped, snap_frame};
use super::refit::refit;
use super::solve_frames::is_by_clicks;
use super::{BaseEstimationError, BaseProblem, EstimatedBase};
use std::collections::BTreeMap;
use std::sync::Arc;
use touchline_core::camera::Ptz;
use touchline_core::field::FieldModel;
use touchline_core::progress::Progress;
use touchline_core::solve::base::{BaseError, BaseOptions, BaseProgress};
use touchline_documents::document::{CameraId, Document, DocumentAt, Frame, FramePtz, FrameStatus};
use touchline_vision::media::Picture;
use touchline_vision::paint::SnapOptions;

/// A base estimated from clicks and paint.
#[derive(Clone, Debug, PartialEq)]
pub struct BaseOnPaint {
    /// The base and the frames that it was estimated from; their cameras fit clicks and paint
    /// together.
    pub estimated: EstimatedBase,
    /// The amount of paint, and the errors at it.
    pub seen: PaintSeen,
}

/// Reads a frame's picture; none if it cannot be read.
pub type PictureOf<'a> = &'a mut dyn FnMut(&Frame) -> Option<Picture>;

impl BaseOnPaint {
    /// Aligns all frames of the camera to their paint with the new base, writes them, and counts
    /// them. The document must have the base already, and its frames must have been solved from
    /// their clicks.
    ///
    /// A frame that cannot be aligned keeps its solution from clicks. Without clicks it gets its
    /// camera of the adjustment; if it took no part in that, the camera that keeps its lines where
    /// they were in `before`.
    pub fn write_frames(
        &self,
        document: &mut Document,
        before: &Document,
        field: &FieldModel,
        pictures: PictureOf<'_>,
    ) -> PulledFrames {
        let (pulled, counts) = self.pull(document, before, field, pictures);
        for (index, frame) in pulled {
            *document.frames[index] = frame;
        }
        counts
    }

    /// The estimate together with the aligned frames, for writing them later without the pictures.
    /// `document` is the one that it was estimated from.
    ///
    /// # Errors
    /// The camera's field is not valid with the crown.
    pub fn with_pulled_frames(
        self,
        document: DocumentAt<'_>,
        pictures: PictureOf<'_>,
    ) -> Result<EstimatedBase, BaseEstimationError> {
        let mut solved = document.document.clone();
        self.estimated.write_to(&mut solved, document.folder)?;
        let field = solved
            .at(document.folder)
            .model_of(solved.field_of_camera(&self.estimated.camera))?;
        let (pulled, _) = self.pull(&solved, document.document, &field, pictures);
        let pulled = pulled.into_iter().map(|(_, frame)| frame).collect();
        Ok(EstimatedBase {
            on_paint: Some(Arc::new(OnPaint {
                seen: self.seen,
                pulled,
            })),
            ..self.estimated
        })
    }

    /// The frames that the paint or the new base changes, with their indices. These are all solved
    /// frames of the camera, not only those that the base was estimated from.
    fn pull(
        &self,
        document: &Document,
        before: &Document,
        field: &FieldModel,
        pictures: PictureOf<'_>,
    ) -> (Vec<(usize, Frame)>, PulledFrames) {
        let estimate = &self.estimated.estimate;
        let fits: BTreeMap<usize, Ptz> = self
            .estimated
            .frames
            .iter()
            .zip(&estimate.frames)
            .filter_map(|(index, fit)| Some((*index, fit.as_ref()?.ptz)))
            .collect();
        let is_of_camera = |frame: &Frame| {
            frame.camera == self.estimated.camera
                && frame.ptz.is_some()
                && frame.status != FrameStatus::Rejected
        };
        // The alignment searches near a frame's camera, so each frame first gets the best camera on
        // the new base: of the adjustment, of its clicks, or the old one turned so that its lines
        // stay in place.
        let (mut frames, mut counts) = (Vec::new(), PulledFrames::default());
        let mut carried_over = document.clone();
        for index in
            (0..document.frames.len()).filter(|index| is_of_camera(&document.frames[*index]))
        {
            let frame = &document.frames[index];
            let by_clicks = is_by_clicks(frame);
            if let Some(ptz) = fits.get(&index) {
                carried_over.frames[index]
                    .point(*ptz, estimate.base.distortion.radial_at(ptz.focal_px));
            } else if !by_clicks {
                refit(&mut carried_over, index, before);
                forget_certainty(&mut carried_over.frames[index]);
            }
            counts.solved += 1;
            // The picture decides, where it can be read and its paint is decisive.
            let mut pulled = Frame::clone(&carried_over.frames[index]);
            let picture = pictures(&pulled);
            let snapped = picture.and_then(|picture| {
                snap_frame(
                    &carried_over,
                    &pulled,
                    field,
                    &picture,
                    &SnapOptions::default(),
                )
                .ok()
            });
            // Frames with clicks that cannot be aligned are up to date already.
            if let Some((base, snapped)) = snapped {
                record_snapped(&mut pulled, &base, &snapped);
                counts.on_paint += 1;
            } else if by_clicks {
                continue;
            }
            frames.push((index, pulled));
        }
        (frames, counts)
    }
}

/// Numbers of frames that were to be aligned to their paint.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct PulledFrames {
    /// Frames with a camera.
    pub solved: usize,
    /// Those of them that were aligned.
    pub on_paint: usize,
}

/// Estimates the base of a camera from clicks and paint; with `size`, also the field's length and
/// width.
///
/// # Errors
/// There is no initial base, too few lines are visible, or the adjustment gives no base.
pub fn estimate_on_paint(
    document: DocumentAt<'_>,
    camera: &CameraId,
    options: &BaseOptions,
    size: bool,
    pictures: PictureOf<'_>,
    progress: &Progress<'_, BaseProgress>,
) -> Result<BaseOnPaint, BaseOnPaintError> {
    let problem = BaseProblem::with_solved(document, camera)?;
    let start = first_cameras(&problem, document, options, progress)?;
    let spec = document.field_of_camera(camera);
    let frames: Vec<&Frame> = problem
        .frames
        .iter()
        .map(|index| &*document.frames[*index])
        .collect();
    let known = KnownFrames {
        start,
        masks: frames
            .iter()
            .map(|frame| document.masks_of(frame))
            .collect(),
        picture: &mut |place: usize| pictures(frames.get(place)?),
        open_field: size.then_some(OpenField { document, spec }),
        problem,
    };
    let PaintEstimate {
        problem,
        estimate,
        sizes,
        seen,
    } = known.estimate_base(options, progress)?;
    Ok(BaseOnPaint {
        estimated: EstimatedBase {
            sizes,
            ..problem.estimated(&document, estimate)
        },
        seen,
    })
}

/// The base and cameras that the clicks alone determine; if they do not, those of the document.
fn first_cameras(
    problem: &BaseProblem,
    document: DocumentAt<'_>,
    options: &BaseOptions,
    progress: &Progress<'_, BaseProgress>,
) -> Result<KnownCameras, BaseEstimationError> {
    let recorded = |index: &usize| document.frames.get(*index)?.ptz.as_ref().map(FramePtz::ptz);
    let mut ptz: Vec<Option<Ptz>> = problem.frames.iter().map(recorded).collect();
    let by_clicks =
        BaseProblem::of(document, &problem.camera)?.estimate(&document, options, progress);
    // Frames without clicks keep the document's camera beside the new base; step 1 aligns them.
    match (by_clicks, problem.previous) {
        (
            Ok(EstimatedBase {
                frames, estimate, ..
            }),
            _,
        ) => {
            for (index, fit) in frames.iter().zip(&estimate.frames) {
                if let (Ok(place), Some(fit)) = (problem.frames.binary_search(index), fit) {
                    ptz[place] = Some(fit.ptz);
                }
            }
            Ok(KnownCameras {
                base: estimate.base,
                crown_m: estimate.crown_m,
                ptz,
                by_clicks: true,
            })
        }
        (Err(BaseEstimationError::Base(BaseError::Stopped)), _) => Err(BaseError::Stopped.into()),
        (Err(_), Some(base)) => Ok(KnownCameras {
            base,
            crown_m: problem.field.crown_m,
            ptz,
            by_clicks: false,
        }),
        (Err(error), None) => Err(error),
    }
}
