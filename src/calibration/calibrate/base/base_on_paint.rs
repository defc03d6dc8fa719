//! The base of a camera from the clicks and the painted lines of its frames, in one adjustment.
//!
//! The initial base comes from the clicks, or else from the document. With it every frame is
//! aligned to its paint, and clicks and positions of paint are adjusted together; this is repeated
//! once from the result. Lens and crown are chosen by their error at held-out paint.

use super::follow_base::forget_certainty;
use super::known_frames::{KnownFrames, PaintEstimate};
use super::on_paint::{BasePaintAlignment, BasePaintEvidence};
use super::paint_observations::{AT_ONCE, BaseOnPaintError, KnownCameras};
use super::refit::refit;
use crate::calibrate::frames::solve_frames::is_by_clicks;
use crate::calibrate::paint::{record_snapped, snap_frame};
use crate::calibrate::{BaseEstimationError, BaseProblem, EstimatedBase};
use rayon::prelude::*;
use std::collections::BTreeMap;
use std::sync::Arc;
use touchline_core::camera::{CameraBase, Ptz};
use touchline_core::field::FieldModel;
use touchline_core::progress::Progress;
use touchline_core::solve::base::{BaseError, BaseOptions, BaseProgress};
use touchline_documents::document::{CameraId, Document, DocumentAt, Frame, FramePtz, FrameStatus};
use touchline_vision::media::Picture;
use touchline_vision::paint::SnapOptions;

/// A base is replaced if the median distance of its lines from paint falls by at least this share.
/// Smaller changes are noise: refined again on their own frames, the bases of five broadcasts gain
/// 0 to 3 %.
const WORTHWHILE: f64 = 0.05;

/// A base estimated from clicks and paint.
#[derive(Clone, Debug, PartialEq)]
pub struct BaseOnPaint {
    /// The base and the frames that it was estimated from; their cameras fit clicks and paint
    /// together.
    pub estimated: EstimatedBase,
    /// The amount of paint, and the errors at it.
    pub seen: BasePaintEvidence,
}

/// Reads a frame's picture; none if it cannot be read.
pub type PictureOf<'a> = &'a mut dyn FnMut(&Frame) -> Option<Picture>;

impl BaseOnPaint {
    /// Whether the new base lies nearer to paint that was held out than the earlier one, by more
    /// than noise.
    pub fn is_worthwhile(&self) -> bool {
        let (before, after) = (self.seen.before.paint, self.seen.after.paint);
        before
            .zip(after)
            .is_some_and(|(before, after)| after.median_px < (1.0 - WORTHWHILE) * before.median_px)
    }

    /// The same with an earlier base and crown in place of the new ones: frames are then aligned to
    /// their paint with these.
    #[must_use]
    pub fn with_base(mut self, base: CameraBase, crown_m: f64) -> Self {
        self.estimated.estimate.base = base;
        self.estimated.estimate.crown_m = crown_m;
        // The cameras of the adjustment are valid for the new base alone.
        self.estimated.estimate.frames.fill(None);
        self.estimated.sizes.clear();
        self
    }

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
            on_paint: Some(Arc::new(BasePaintAlignment {
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
        // The alignment searches near a frame's camera, so each frame first gets the best camera on
        // the new base: of the adjustment, of its clicks, or the old one turned so that its lines
        // stay in place.
        let of_camera: Vec<usize> = (0..document.frames.len())
            .filter(|index| {
                let frame = &document.frames[*index];
                frame.camera == self.estimated.camera
                    && frame.ptz.is_some()
                    && frame.status != FrameStatus::Rejected
            })
            .collect();
        let mut started = document.clone();
        for &index in &of_camera {
            if let Some(ptz) = fits.get(&index) {
                started.frames[index].point(*ptz, estimate.base.distortion.radial_at(ptz.focal_px));
            } else if !is_by_clicks(&document.frames[index]) {
                refit(&mut started, index, before);
                forget_certainty(&mut started.frames[index]);
            }
        }
        // The picture decides, where it can be read and its paint is decisive. Pictures are read in
        // order and aligned in parallel, a few at a time to limit memory.
        let (mut frames, mut on_paint) = (Vec::new(), 0);
        for some in of_camera.chunks(AT_ONCE) {
            let read: Vec<(usize, Option<Picture>)> = some
                .iter()
                .map(|index| (*index, pictures(&started.frames[*index])))
                .collect();
            let aligned = read.par_iter().map(|(index, picture)| {
                let frame = &started.frames[*index];
                let options = SnapOptions::default();
                snap_frame(&started, frame, field, picture.as_ref()?, &options).ok()
            });
            let aligned: Vec<_> = aligned.collect();
            for ((index, _), aligned) in read.iter().zip(aligned) {
                let mut pulled = Frame::clone(&started.frames[*index]);
                match aligned {
                    Some((base, snapped)) => {
                        record_snapped(&mut pulled, &base, &snapped);
                        on_paint += 1;
                    }
                    // Frames with clicks that cannot be aligned are up to date already.
                    None if is_by_clicks(&document.frames[*index]) => continue,
                    None => {}
                }
                frames.push((*index, pulled));
            }
        }
        let solved = of_camera.len();
        (frames, PulledFrames { solved, on_paint })
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
        fits_size: size,
        problem,
    };
    let PaintEstimate {
        problem,
        estimate,
        sizes,
        seen,
    } = known.estimate_base(options, progress)?;
    let sizes = if size {
        problem.open_size.fitted_or_assumed(sizes)
    } else {
        sizes
    };
    Ok(BaseOnPaint {
        estimated: EstimatedBase {
            sizes,
            ..problem.estimated_base(&document, estimate)
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
    let mut ptz: Vec<Option<Ptz>> = problem
        .frames
        .iter()
        .map(|index| document.frames.get(*index)?.ptz.as_ref().map(FramePtz::ptz))
        .collect();
    // Without a click the estimation has priors alone to go by, and must not replace a base.
    if let Some(base) = problem.previous.filter(|_| problem.click_count() == 0) {
        return Ok(KnownCameras {
            base,
            crown_m: problem.field.crown_m,
            ptz,
            by_clicks: false,
        });
    }
    let by_clicks = BaseProblem::from_document(document, &problem.camera)?
        .estimate(&document, options, progress);
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
        // A cancelled estimation must not pass for clicks that give no base.
        (Err(BaseEstimationError::Base(BaseError::Stopped)), _) => Err(BaseError::Stopped.into()),
        // Clicks that give no base are no error: the paint can begin at the base that is there.
        (Err(_), Some(base)) => Ok(KnownCameras {
            base,
            crown_m: problem.field.crown_m,
            ptz,
            by_clicks: false,
        }),
        (Err(error), None) => Err(error),
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::path::Path;
    use touchline_core::testing::{SIZE, base_at};
    use touchline_documents::document::Click;
    use touchline_documents::testing::match_from;
    use touchline_documents::testing::{new_frame, ptz_at};

    #[test]
    fn check_clicks_alone_leave_the_base_of_the_document() {
        let base = base_at([1.0, -62.0, 17.0], SIZE);
        let mut document = match_from(&base, SIZE);
        let mut frame = new_frame("1.jpg", SIZE);
        frame.ptz = ptz_at(-4.0, -14.0, 2300.0);
        let mut click = Click::landmark("centre_mark".into(), SIZE.centre());
        click.check = true;
        frame.clicks.push(click);
        document.frames.push(frame.into());
        let at = document.at(Path::new(""));
        let problem = BaseProblem::with_solved(at, &"main".into()).unwrap();
        assert_eq!(problem.frames, [0]);
        let first = first_cameras(&problem, at, &BaseOptions::default(), &Progress::default());
        let first = first.unwrap();
        assert!(!first.by_clicks);
        assert_eq!(first.base.position_m, base.position_m);
    }
}
