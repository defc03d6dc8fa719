//! The base of a camera from frames whose cameras are about known: from the places of painted lines
//! in their pictures, and from their clicks where there are some.
//!
//! 1. Each frame is pulled onto its paint with the cameras to begin with, and the places of the
//!    paint are measured.
//! 2. Base and frames are adjusted to them; where the size of the field is open it is fitted.
//! 3. From there the paint is measured once more, and the base is estimated from it. Lens and crown
//!    are chosen by paint that they have not seen.

use super::field_size::set_size;
use super::on_paint::{OnPaintErrors, PaintSeen};
use super::{BaseEstimationError, BaseProblem};
use rayon::prelude::*;
use std::collections::BTreeSet;
use thiserror::Error;
use touchline_core::camera::{CameraBase, Ptz, PtzCamera};
use touchline_core::field::{FieldError, FieldModel, Template};
use touchline_core::geometry::{PixelBox, subsample};
use touchline_core::progress::Progress;
use touchline_core::solve::Observation;
use touchline_core::solve::base::{
    AdjustOptions, BaseEstimate, BaseModel, BaseOptions, BaseProgress, CameraClicks, FittedSize,
    FrameClicks, HeldOutErrors, adjust_base, estimate_base_on_paint, held_out_on_paint,
};
use touchline_documents::document::{DocumentAt, FieldSpec};
use touchline_vision::media::Picture;
use touchline_vision::paint::{GroundPicture, PaintPlace, SnapOptions, paint_places, snap};

/// Fewer frames with paint, or fewer lines in all of them together, do not hold a base.
pub const FRAMES_FOR_PAINT: usize = 3;
const FEWEST_LINES: usize = 5;

/// 1-σ of the position along each axis, and of a fitted length of the field, where paint alone
/// gives it, m: what grounds are off by is common to all frames. Positions are .06 to .64 m from
/// those fitted to people's clicks where the paint's scatter alone says .05, and widths up to .8 m
/// where that says .04 to .13. Where clicks give a position too, half of the way between the two
/// takes its place.
pub(crate) const ALONE_SIGMA_M: f64 = 0.3;

/// Lengths that paint alone gives are stated no better than they are known.
pub(crate) fn as_paint_alone_gives(sizes: &mut [FittedSize]) {
    for length in sizes {
        length.sigma_m = length.sigma_m.max(ALONE_SIGMA_M);
    }
}

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

/// Frames whose pictures are looked at, at most: spread over all that have a camera.
const MOST_FRAMES: usize = 150;

/// Pictures that are held in memory at once.
const AT_ONCE: usize = 8;

/// Frames of one camera, about where they look, and where their pictures come from.
pub(crate) struct KnownFrames<'a> {
    /// The frames with their clicks, if any, and their field.
    pub problem: BaseProblem,
    /// The cameras to begin with.
    pub start: KnownCameras,
    /// Of each frame of the problem, what shows no paint.
    pub masks: Vec<Vec<PixelBox>>,
    /// The picture of a frame of the problem, by its place there; none where it cannot be read.
    pub picture: &'a mut dyn FnMut(usize) -> Option<Picture>,
    /// The field, where its size is fitted as well.
    pub open_field: Option<OpenField<'a>>,
}

/// A field whose size is open.
pub(crate) struct OpenField<'a> {
    /// The document that it belongs to.
    pub document: DocumentAt<'a>,
    /// The field.
    pub spec: &'a FieldSpec,
}

impl OpenField<'_> {
    fn template(&self) -> Result<Template, FieldError> {
        self.spec.template(self.document.folder)
    }

    /// The field with fitted lengths.
    fn of_size(&self, sizes: &[FittedSize]) -> Result<FieldModel, FieldError> {
        let mut sized = self.spec.clone();
        set_size(&mut sized, sizes);
        self.document.model_of(&sized)
    }
}

/// What the paint of known frames gives.
pub(crate) struct PaintEstimate {
    /// The frames, on the field of fitted size.
    pub problem: BaseProblem,
    pub estimate: BaseEstimate,
    /// The lengths of the field that were fitted.
    pub sizes: Vec<FittedSize>,
    /// What the paint said.
    pub seen: PaintSeen,
}

impl KnownFrames<'_> {
    /// Estimates the base.
    ///
    /// # Errors
    /// Too few lines are seen, the adjustment gives no base, or it was cancelled.
    pub fn estimate_base(
        self,
        options: &BaseOptions,
        progress: &Progress<'_, BaseProgress>,
    ) -> Result<PaintEstimate, BaseOnPaintError> {
        let Self {
            mut problem,
            start: first,
            masks,
            picture,
            open_field,
        } = self;
        let first_field = problem.field.clone();
        let seen = Seen::of(&problem, &first, &masks, picture)?;
        let model = options.richest(&problem.camera_clicks());
        let mut start = first.adjusted(&problem, &seen, &model, &options.adjust);

        let mut sizes = Vec::new();
        if let Some(open) = open_field {
            let template = open.template().map_err(BaseEstimationError::from)?;
            sizes = problem.fit_size(template, &seen.painted, (&start.base, &start.ptz), &model);
            if !first.by_clicks {
                as_paint_alone_gives(&mut sizes);
            }
            problem = problem.on_field(open.of_size(&sizes).map_err(BaseEstimationError::from)?);
        }
        let seen = Seen::of(&problem, &start, &masks, picture)?;
        start.ptz.clone_from(&seen.ptz);
        let clicks = problem.camera_clicks();
        let from = (&start.base, start.ptz.as_slice());
        let mut estimate = estimate_base_on_paint(&clicks, &seen.painted, from, options, progress)
            .map_err(BaseEstimationError::from)?;
        let sigma = estimate.base.sigma;
        estimate.base.sigma = if first.by_clicks {
            // What both have in common errs by about half of what they differ by.
            let half =
                sigma.following_position((estimate.base.position_m - first.base.position_m) * 0.5);
            sigma.covering(&(half * half.transpose()))
        } else {
            sigma.with_position_error_of(ALONE_SIGMA_M)
        };
        // The first base is judged by the same paint, on the field that it was found with.
        let as_first: Vec<FrameClicks> = seen
            .painted
            .iter()
            .map(|frame| frame_on_field(frame, &first_field))
            .collect();
        let as_first = CameraClicks {
            field: &first_field,
            frames: &as_first,
            ..clicks
        };
        let (paint, at_clicks) =
            held_out_on_paint(&as_first, &first.base, first.crown_m, &start.ptz);
        let chosen = estimate
            .scores
            .iter()
            .find(|score| score.model == estimate.model);
        let after = OnPaintErrors {
            paint: chosen.map(|score| HeldOutErrors {
                median_px: score.median_px,
                p90_px: score.p90_px,
                count: score.held_out,
            }),
            clicks: chosen.and_then(|score| score.at_clicks),
        };
        let Seen {
            frames,
            places,
            lines,
            ..
        } = seen;
        let before = OnPaintErrors {
            paint,
            clicks: at_clicks,
        };
        let seen = PaintSeen {
            frames,
            places,
            lines: lines.len(),
            before,
            after,
        };
        Ok(PaintEstimate {
            problem,
            estimate,
            sizes,
            seen,
        })
    }
}

impl BaseProblem {
    /// The same frames on a field of another size.
    fn on_field(self, field: FieldModel) -> Self {
        Self {
            clicks: self
                .clicks
                .iter()
                .map(|frame| frame_on_field(frame, &field))
                .collect(),
            field,
            ..self
        }
    }
}

/// The same clicks and paint on a field of another size.
fn frame_on_field(frame: &FrameClicks, field: &FieldModel) -> FrameClicks {
    let renamed = |seen: &Observation| {
        seen.element
            .and_then(|element| seen.renamed(field, element))
            .unwrap_or(*seen)
    };
    FrameClicks {
        observations: frame.observations.iter().map(renamed).collect(),
        start: frame.start,
    }
}

/// A base, its crown and the frames' cameras.
pub(crate) struct KnownCameras {
    pub base: CameraBase,
    pub crown_m: f64,
    /// Of each frame of the problem.
    pub ptz: Vec<Option<Ptz>>,
    /// Whether clicks gave them.
    pub by_clicks: bool,
}

impl KnownCameras {
    /// The field with the crown.
    fn field(&self, problem: &BaseProblem) -> FieldModel {
        FieldModel {
            crown_m: self.crown_m,
            ..problem.field.clone()
        }
    }

    /// Adjusted to what is seen.
    fn adjusted(
        &self,
        problem: &BaseProblem,
        seen: &Seen,
        model: &BaseModel,
        options: &AdjustOptions,
    ) -> Self {
        let painted = CameraClicks {
            frames: &seen.painted,
            ..problem.camera_clicks()
        };
        let adjusted = adjust_base(&painted, &self.base, &seen.ptz, model, options);
        Self {
            base: adjusted.base,
            crown_m: adjusted.crown_m,
            ptz: adjusted.ptz,
            ..*self
        }
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
        cameras: &KnownCameras,
        masks: &[Vec<PixelBox>],
        picture: &mut dyn FnMut(usize) -> Option<Picture>,
    ) -> Result<Self, BaseOnPaintError> {
        let field = cameras.field(problem);
        let solved: Vec<usize> = (0..problem.frames.len())
            .filter(|place| cameras.ptz[*place].is_some())
            .collect();
        let looked_at: Vec<usize> = subsample(solved, MOST_FRAMES).collect();
        let mut seen = Self {
            painted: problem.clicks.clone(),
            ptz: cameras.ptz.clone(),
            frames: 0,
            places: 0,
            lines: BTreeSet::new(),
        };
        for some in looked_at.chunks(AT_ONCE) {
            let read = |place: &usize| Some((*place, picture(*place)?));
            let read: Vec<(usize, Picture)> = some.iter().filter_map(read).collect();
            let looked = read.par_iter().map(|(place, picture)| {
                let ground = GroundPicture::new(picture, &masks[*place]);
                let clicks = frame_on_field(&problem.clicks[*place], &field).observations;
                let snapped = snap(
                    &ground,
                    &field,
                    &cameras.base,
                    cameras.ptz[*place]?,
                    &clicks,
                    &lenient(),
                )
                .ok()?;
                let camera = PtzCamera::new(cameras.base, snapped.ptz);
                Some((*place, snapped.ptz, paint_places(&ground, &field, &camera)))
            });
            let looked: Vec<_> = looked.collect();
            for (place, ptz, paint) in looked.into_iter().flatten() {
                seen.add(problem, place, ptz, &paint);
            }
        }
        if seen.frames < FRAMES_FOR_PAINT || seen.lines.len() < FEWEST_LINES {
            return Err(BaseOnPaintError::TooFewLines {
                frames: seen.frames,
                lines: seen.lines.len(),
            });
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

/// A base that is not yet right bends lines: halves of a frame's paint may disagree more than where
/// a frame is snapped for good.
fn lenient() -> SnapOptions {
    SnapOptions {
        halves_px: 4.0,
        min_score: 0.5,
        ..SnapOptions::default()
    }
}
