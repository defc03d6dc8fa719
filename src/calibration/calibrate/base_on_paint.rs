//! The base of a camera from the clicks and the painted lines of its frames, in one adjustment.
//!
//! The clicks give a first base, or the camera has one. With it every frame is pulled onto its paint, the places of the paint and
//! the clicks are adjusted together, and once more with what that has found. Lens and crown are chosen by paint that they
//! have not seen.

use super::field_size::set_field_size;
use super::follow_base::forget_certainty;
use super::on_paint::{OnPaint, OnPaintErrors, PaintSeen};
use super::paint::{record_snapped, snap_frame};
use super::refit::refit;
use super::solve_frames::is_by_clicks;
use super::{BaseEstimationError, BaseProblem, EstimatedBase, observations};
use rayon::prelude::*;
use std::collections::{BTreeMap, BTreeSet};
use std::sync::Arc;
use thiserror::Error;
use touchline_core::camera::{CameraBase, Ptz, PtzCamera};
use touchline_core::field::FieldModel;
use touchline_core::geometry::subsample;
use touchline_core::progress::Progress;
use touchline_core::solve::Observation;
use touchline_core::solve::base::{
    AdjustOptions, BaseError, BaseModel, BaseOptions, BaseProgress, CameraClicks, FittedSize, FrameClicks,
    HeldOutErrors, adjust_base, estimate_base_on_paint, held_out_on_paint,
};
use touchline_documents::document::{CameraId, Document, DocumentAt, Frame, FramePtz, FrameStatus};
use touchline_vision::media::Picture;
use touchline_vision::paint::{GroundPicture, PaintPlace, SnapOptions, paint_places, snap};

/// Frames whose pictures are looked at, at most: spread over all that have a camera.
const MOST_FRAMES: usize = 150;

/// Fewer frames with paint, or fewer lines in all of them together, do not hold a base.
pub const FRAMES_FOR_PAINT: usize = 3;
const FEWEST_LINES: usize = 5;

/// 1-σ of the position along each axis, and of a fitted length of the field, where paint alone gives it, m: what grounds are off by
/// is common to all frames. Positions are .06 to .64 m from those fitted to people's clicks where the paint's scatter alone says .05,
/// and widths up to .8 m where that says .04 to .13. Where clicks give a position too, half of the way between the two takes its place.
pub(crate) const ALONE_SIGMA_M: f64 = 0.3;

/// Lengths that paint alone gives are stated no better than they are known.
pub(crate) fn as_paint_alone_gives(sizes: &mut [FittedSize]) {
    for length in sizes {
        length.sigma_m = length.sigma_m.max(ALONE_SIGMA_M);
    }
}

/// Pictures that are held in memory at once.
const AT_ONCE: usize = 8;

/// Why no base is found from clicks and paint.
#[derive(Clone, Debug, PartialEq, Error)]
#[non_exhaustive]
pub enum BaseOnPaintError {
    /// There is neither a base nor enough clicks for one, or the adjustment gives none.
    #[error(transparent)]
    Base(#[from] BaseEstimationError),
    /// Hardly any paint is seen where the cameras predict it.
    #[error(
        "painted lines are seen in {frames} frames, {lines} different lines in all ({FRAMES_FOR_PAINT} frames and {FEWEST_LINES} lines are \
         needed): refine the base from clicks alone, or click frames that show more of the lines"
    )]
    TooFewLines {
        /// Frames whose camera could be pulled onto its paint.
        frames: usize,
        /// Different lines in them.
        lines: usize,
    },
}

/// A base from clicks and paint.
#[derive(Clone, Debug, PartialEq)]
pub struct BaseOnPaint {
    /// The base, and the frames that gave it; their cameras are where clicks and paint together put them.
    pub estimated: EstimatedBase,
    /// What the paint said.
    pub seen: PaintSeen,
}

/// Where a frame's picture comes from; none where it cannot be read.
pub type PictureOf<'a> = &'a mut dyn FnMut(&Frame) -> Option<Picture>;

impl BaseOnPaint {
    /// Pulls all frames of the camera onto their paint with the new base and writes them; how many could be. The document has the base
    /// already, and its frames are solved from their clicks: a frame that cannot be pulled stays so; without clicks it gets the camera
    /// of the adjustment, or where it took no part in that the one that leaves its lines where they were in `before`.
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

    /// The estimate together with the frames pulled onto their paint: to be written where the pictures are not at hand. `document`
    /// is the one that it was estimated from.
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
        let field = solved.at(document.folder).model_of(solved.field_of_camera(&self.estimated.camera))?;
        let (pulled, _) = self.pull(&solved, document.document, &field, pictures);
        let pulled = pulled.into_iter().map(|(_, frame)| frame).collect();
        Ok(EstimatedBase { on_paint: Some(Arc::new(OnPaint { seen: self.seen, pulled })), ..self.estimated })
    }

    /// The frames that the paint or the new base changes, by their indices. Every solved frame of the camera is one of them, however few
    /// of them the base was found from.
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
            frame.camera == self.estimated.camera && frame.ptz.is_some() && frame.status != FrameStatus::Rejected
        };
        let (mut frames, mut counts) = (Vec::new(), PulledFrames::default());
        let mut carried_over = document.clone();
        for index in (0..document.frames.len()).filter(|index| is_of_camera(&document.frames[*index])) {
            let frame = &document.frames[index];
            let by_clicks = is_by_clicks(frame);
            if let Some(ptz) = fits.get(&index) {
                carried_over.frames[index].point(*ptz, estimate.base.distortion.radial_at(ptz.focal_px));
            } else if !by_clicks {
                refit(&mut carried_over, index, before);
                forget_certainty(&mut carried_over.frames[index]);
            }
            counts.solved += 1;
            let mut pulled = Frame::clone(&carried_over.frames[index]);
            let picture = pictures(&pulled);
            let snapped = picture
                .and_then(|picture| snap_frame(&carried_over, &pulled, field, &picture, &SnapOptions::default()).ok());
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

/// What came of a camera's frames when they were pulled onto their paint.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct PulledFrames {
    /// Frames with a camera.
    pub solved: usize,
    /// Those of them that lie on their paint now.
    pub on_paint: usize,
}

/// Estimates the base of a camera from clicks and paint; with `size` the field's length and width as well.
///
/// # Errors
/// There is no base to begin with, too few lines are seen, or the adjustment gives no base.
pub fn estimate_on_paint(
    document: DocumentAt<'_>,
    camera: &CameraId,
    options: &BaseOptions,
    size: bool,
    pictures: PictureOf<'_>,
    progress: &Progress<'_, BaseProgress>,
) -> Result<BaseOnPaint, BaseOnPaintError> {
    let mut problem = BaseProblem::with_solved(document, camera)?;
    let first_field = problem.field.clone();
    let first = Cameras::first(&problem, document, options, progress)?;
    let seen = Seen::of(&problem, &document, &first, pictures)?;
    let model = options.richest(&problem.camera_clicks());
    let mut start = first.adjusted(&problem, &seen, &model, &options.adjust);

    let mut document = document;
    let mut sized = document.document.clone();
    let mut sizes = Vec::new();
    if size {
        sizes = problem.fit_size(document, &seen.painted, (&start.base, &start.ptz), &model)?;
        if !first.by_clicks {
            as_paint_alone_gives(&mut sizes);
        }
        set_field_size(&mut sized, camera, &sizes);
        document = sized.at(document.folder);
        problem = BaseProblem::with_solved(document, camera)?;
    }
    let seen = Seen::of(&problem, &document, &start, pictures)?;
    start.ptz.clone_from(&seen.ptz);
    let clicks = problem.camera_clicks();
    let from = (&start.base, start.ptz.as_slice());
    let mut estimate =
        estimate_base_on_paint(&clicks, &seen.painted, from, options, progress).map_err(BaseEstimationError::from)?;
    let sigma = estimate.base.sigma;
    estimate.base.sigma = if first.by_clicks {
        // What both have in common errs by about half of what they differ by.
        let half = sigma.following_position((estimate.base.position_m - first.base.position_m) * 0.5);
        sigma.covering(&(half * half.transpose()))
    } else {
        sigma.with_position_error_of(ALONE_SIGMA_M)
    };
    // The first base is judged by the same paint, on the field that it was found with.
    let as_first: Vec<FrameClicks> = seen.painted.iter().map(|frame| on_field(frame, &first_field)).collect();
    let as_first = CameraClicks { field: &first_field, frames: &as_first, ..clicks };
    let (paint, at_clicks) = held_out_on_paint(&as_first, &first.base, first.crown_m, &start.ptz);
    let chosen = estimate.scores.iter().find(|score| score.model == estimate.model);
    let after = OnPaintErrors {
        paint: chosen.map(|score| HeldOutErrors {
            median_px: score.median_px,
            p90_px: score.p90_px,
            count: score.held_out,
        }),
        clicks: chosen.and_then(|score| score.at_clicks),
    };
    let estimated = EstimatedBase { sizes, ..problem.estimated(&document, estimate) };
    let Seen { frames, places, lines, .. } = seen;
    let before = OnPaintErrors { paint, clicks: at_clicks };
    Ok(BaseOnPaint { estimated, seen: PaintSeen { frames, places, lines: lines.len(), before, after } })
}

/// The same clicks and paint on a field of another size.
fn on_field(frame: &FrameClicks, field: &FieldModel) -> FrameClicks {
    let renamed = |seen: &Observation| seen.element.and_then(|element| seen.renamed(field, element)).unwrap_or(*seen);
    FrameClicks { observations: frame.observations.iter().map(renamed).collect(), start: frame.start }
}

/// A base, its crown and the frames' cameras.
struct Cameras {
    base: CameraBase,
    crown_m: f64,
    /// Of each frame of the problem.
    ptz: Vec<Option<Ptz>>,
    /// Whether clicks gave them.
    by_clicks: bool,
}

impl Cameras {
    /// What the clicks alone say; where they do not give a base, what the document says.
    fn first(
        problem: &BaseProblem,
        document: DocumentAt<'_>,
        options: &BaseOptions,
        progress: &Progress<'_, BaseProgress>,
    ) -> Result<Self, BaseEstimationError> {
        let recorded = |index: &usize| document.frames.get(*index)?.ptz.as_ref().map(FramePtz::ptz);
        let mut ptz: Vec<Option<Ptz>> = problem.frames.iter().map(recorded).collect();
        let by_clicks = BaseProblem::of(document, &problem.camera)?.estimate(&document, options, progress);
        match (by_clicks, problem.previous) {
            (Ok(EstimatedBase { frames, estimate, .. }), _) => {
                for (index, fit) in frames.iter().zip(&estimate.frames) {
                    if let (Ok(place), Some(fit)) = (problem.frames.binary_search(index), fit) {
                        ptz[place] = Some(fit.ptz);
                    }
                }
                Ok(Self { base: estimate.base, crown_m: estimate.crown_m, ptz, by_clicks: true })
            }
            (Err(BaseEstimationError::Base(BaseError::Stopped)), _) => Err(BaseError::Stopped.into()),
            (Err(_), Some(base)) => Ok(Self { base, crown_m: problem.field.crown_m, ptz, by_clicks: false }),
            (Err(error), None) => Err(error),
        }
    }

    /// The field with the crown.
    fn field(&self, problem: &BaseProblem) -> FieldModel {
        FieldModel { crown_m: self.crown_m, ..problem.field.clone() }
    }

    /// Adjusted to what is seen.
    fn adjusted(&self, problem: &BaseProblem, seen: &Seen, model: &BaseModel, options: &AdjustOptions) -> Self {
        let painted = CameraClicks { frames: &seen.painted, ..problem.camera_clicks() };
        let adjusted = adjust_base(&painted, &self.base, &seen.ptz, model, options);
        Self { base: adjusted.base, crown_m: adjusted.crown_m, ptz: adjusted.ptz, ..*self }
    }
}

/// What is seen of the lines.
struct Seen {
    /// The clicks of each frame of the problem, and its paint after them.
    painted: Vec<FrameClicks>,
    /// Each frame's camera: pulled onto the paint, or as it was.
    ptz: Vec<Option<Ptz>>,
    frames: usize,
    places: usize,
    lines: BTreeSet<usize>,
}

impl Seen {
    /// Looks at the pictures of frames with known cameras.
    fn of(
        problem: &BaseProblem,
        document: &Document,
        cameras: &Cameras,
        pictures: PictureOf<'_>,
    ) -> Result<Self, BaseOnPaintError> {
        let field = cameras.field(problem);
        let solved: Vec<usize> = (0..problem.frames.len()).filter(|place| cameras.ptz[*place].is_some()).collect();
        let looked_at: Vec<usize> = subsample(solved, MOST_FRAMES).collect();
        let mut seen = Self {
            painted: problem.clicks.clone(),
            ptz: cameras.ptz.clone(),
            frames: 0,
            places: 0,
            lines: BTreeSet::new(),
        };
        for some in looked_at.chunks(AT_ONCE) {
            let read = |place: &usize| Some((*place, pictures(document.frames.get(problem.frames[*place])?)?));
            let read: Vec<(usize, Picture)> = some.iter().filter_map(read).collect();
            let looked = read.par_iter().map(|(place, picture)| {
                let frame = &*document.frames[problem.frames[*place]];
                let ground = GroundPicture::new(picture, &document.masks_of(frame));
                let clicks = observations(frame, &field).unwrap_or_default();
                let snapped = snap(&ground, &field, &cameras.base, cameras.ptz[*place]?, &clicks, &lenient()).ok()?;
                let camera = PtzCamera::new(cameras.base, snapped.ptz);
                Some((*place, snapped.ptz, paint_places(&ground, &field, &camera)))
            });
            let looked: Vec<_> = looked.collect();
            for (place, ptz, paint) in looked.into_iter().flatten() {
                seen.add(problem, place, ptz, &paint);
            }
        }
        if seen.frames < FRAMES_FOR_PAINT || seen.lines.len() < FEWEST_LINES {
            return Err(BaseOnPaintError::TooFewLines { frames: seen.frames, lines: seen.lines.len() });
        }
        Ok(seen)
    }

    fn add(&mut self, problem: &BaseProblem, place: usize, ptz: Ptz, paint: &[PaintPlace]) {
        self.ptz[place] = Some(ptz);
        self.frames += 1;
        self.places += paint.len();
        self.lines.extend(paint.iter().map(|seen| seen.line));
        let observed = paint.iter().enumerate().filter_map(|(number, seen)| {
            Observation::of_paint(&problem.field, seen.line, seen.image, seen.sigma_px, number)
        });
        self.painted[place].observations.extend(observed);
    }
}

/// A base that is not yet right bends lines: halves of a frame's paint may disagree more than where a frame is snapped for good.
fn lenient() -> SnapOptions {
    SnapOptions { halves_px: 4.0, min_score: 0.5, ..SnapOptions::default() }
}
