//! The base of a camera from frames whose cameras are approximately known: from the positions of
//! painted lines in their pictures, and from clicks where there are some.
//!
//! 1. Each frame is aligned to its paint, beginning with its known camera, and positions of paint
//!    are measured.
//! 2. Base and frames are adjusted to them. Where the size of the field is unknown it is fitted.
//! 3. Paint is measured once more from the adjusted cameras, and the base is estimated from it.
//!    Lens and crown are chosen by their error at held-out paint.

use super::field_size::set_size;
use super::on_paint::{BasePaintEvidence, OnPaintErrors};
use super::size_fit::OpenSize;
use crate::calibrate::{BaseEstimationError, BaseProblem};
use rayon::prelude::*;
use std::collections::BTreeSet;
use thiserror::Error;
use touchline_core::camera::{CameraBase, Ptz, PtzCamera};
use touchline_core::field::{FieldError, FieldModel, Template};
use touchline_core::geometry::{PixelBox, pluralise, subsample};
use touchline_core::progress::Progress;
use touchline_core::solve::Observation;
use touchline_core::solve::base::{
    AdjustOptions, BaseEstimate, BaseModel, BaseOptions, BaseProgress, CameraClicks, FittedSize,
    FrameClicks, HeldOutErrors, adjust_base, cross_validated_errors, estimate_base_on_paint,
};
use touchline_documents::document::{DocumentAt, FieldSpec};
use touchline_vision::media::Picture;
use touchline_vision::paint::{GroundPicture, PaintPlace, SnapOptions, paint_places, snap};

/// Minimum number of frames with paint, and of different lines in all of them together, that
/// determine a base.
pub const FRAMES_FOR_PAINT: usize = 3;
const FEWEST_LINES: usize = 5;

/// Minimum 1-σ of the position along each axis, and of a fitted length of the field, where paint
/// alone determines it, m.
///
/// Deviations of the real ground from the model are common to all frames, so the scatter of the
/// paint does not show them. Positions differ by 0.06 to 0.64 m from those fitted to people's
/// clicks, where the scatter alone suggests 0.05 m; widths differ by up to 0.8 m where it suggests
/// 0.04 to 0.13 m. If clicks give a position too, half of the difference between the two is used
/// instead.
pub(crate) const ALONE_SIGMA_M: f64 = 0.3;

/// Raises the σ of each length to the floor that applies to paint alone.
pub(crate) fn as_paint_alone_gives(sizes: &mut [FittedSize]) {
    for length in sizes {
        length.sigma_m = length.sigma_m.max(ALONE_SIGMA_M);
    }
}

/// Why no base was found from clicks and paint.
#[derive(Clone, Debug, PartialEq, Error)]
#[non_exhaustive]
pub enum BaseOnPaintError {
    /// There is neither a base nor enough clicks for one, or the adjustment gives none.
    #[error(transparent)]
    Base(#[from] BaseEstimationError),
    /// Hardly any paint is visible where the cameras project the lines.
    #[error(
        "painted lines are seen in {}, {} in all ({FRAMES_FOR_PAINT} frames and {FEWEST_LINES} lines are \
         needed): refine the base from clicks alone, or click frames that show more of the lines",
        pluralise(*frames, "frame"),
        pluralise(*lines, "different line")
    )]
    TooFewLines {
        /// Number of frames whose camera could be aligned to its paint.
        frames: usize,
        /// Number of different lines in them.
        lines: usize,
    },
}

/// Maximum number of frames whose pictures are read, spread evenly over all that have a camera.
const MOST_FRAMES: usize = 150;

/// A fitted size is taken if the lines of that field find at least this share of the paint that
/// those of the assumed size find; less than 1 for what changes by chance.
const LEAST_SHARE_WITH_SIZE: f64 = 0.99;

/// Number of pictures in memory at the same time.
pub(crate) const AT_ONCE: usize = 8;

/// Frames of one camera, their approximate cameras, and the source of their pictures.
pub(crate) struct KnownFrames<'a> {
    /// The frames with their clicks, if any, and their field.
    pub problem: BaseProblem,
    /// The initial cameras.
    pub start: KnownCameras,
    /// For each frame of the problem, the pixels that are not searched for paint.
    pub masks: Vec<Vec<PixelBox>>,
    /// Reads the picture of a frame of the problem, by its index there; none if it cannot be read.
    pub picture: &'a mut dyn FnMut(usize) -> Option<Picture>,
    /// The field, where its size is fitted as well.
    pub open_field: Option<OpenField<'a>>,
}

/// A field of unknown size.
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
    fn field_with_sizes(&self, sizes: &[FittedSize]) -> Result<FieldModel, FieldError> {
        let mut sized = self.spec.clone();
        set_size(&mut sized, sizes);
        self.document.model_of(&sized)
    }
}

/// The base estimated from the paint of known frames.
pub(crate) struct PaintEstimate {
    /// The frames, with their clicks on the field of fitted size.
    pub problem: BaseProblem,
    /// The base, with the frames numbered as in the problem.
    pub estimate: BaseEstimate,
    /// The fitted lengths of the field.
    pub sizes: Vec<FittedSize>,
    /// The lengths of the field as assumed, where they were to be fitted.
    pub open_size: Option<OpenSize>,
    /// The amount of paint, and the errors at it.
    pub seen: BasePaintEvidence,
}

impl KnownFrames<'_> {
    /// Estimates the base.
    ///
    /// # Errors
    /// Too few lines are visible, the adjustment gives no base, or it was cancelled.
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
        // Steps 1 and 2: measure paint from the initial cameras and adjust with the richest model
        // of the base that the data allow. The result is only the start for the size and for step
        // 3.
        let first_field = problem.field.clone();
        let seen = PaintObservations::measure(&problem, &first, &masks, picture)?;
        let model = options.richest(&problem.camera_clicks());
        let mut start = first.adjust(&problem, &seen, &model, &options.adjust);

        // Step 3: measure again from the adjusted cameras. Frames that failed at first may align
        // now, and paint that was assigned to the wrong line may find its own.
        let mut again = PaintObservations::measure(&problem, &start, &masks, picture)?;
        let (mut sizes, mut open_size) = (Vec::new(), None);
        // Only with its size fitted does a field of another size have the right lines to align to.
        // Seen from one end, a far line that is off by 2 px for another reason gives a width that
        // is off by 1 m and moves the near line by 20 px. So the fitted lines must find the paint
        // too.
        if let Some(open) = open_field {
            let template = open.template().map_err(BaseEstimationError::from)?;
            let size = OpenSize::new(template, &problem.field);
            let from = (&start.base, start.ptz.as_slice());
            let mut fitted = problem.fit_size(&size, &seen.painted, from, &model);
            open_size = Some(size);
            if !first.by_clicks {
                as_paint_alone_gives(&mut fitted);
            }
            let field = open
                .field_with_sizes(&fitted)
                .map_err(BaseEstimationError::from)?;
            let sized = problem.clone().on_field(field);
            // The cameras belong to the size that they were adjusted with.
            let seen_on_sized = PaintObservations {
                painted: seen
                    .painted
                    .iter()
                    .map(|frame| frame_on_field(frame, &sized.field))
                    .collect(),
                ..seen
            };
            let sized_start = first.adjust(&sized, &seen_on_sized, &model, &options.adjust);
            // Too few lines on the fitted field are no error: the assumed size stays.
            let with_size = PaintObservations::measure(&sized, &sized_start, &masks, picture).ok();
            let enough = LEAST_SHARE_WITH_SIZE * again.places as f64;
            if let Some(with_size) = with_size.filter(|with| with.places as f64 >= enough) {
                (problem, start, again, sizes) = (sized, sized_start, with_size, fitted);
            }
        }
        let seen = again;
        start.ptz.clone_from(&seen.ptz);
        let clicks = problem.camera_clicks();
        let from = (&start.base, start.ptz.as_slice());
        let mut estimate = estimate_base_on_paint(&clicks, &seen.painted, from, options, progress)
            .map_err(BaseEstimationError::from)?;
        let sigma = estimate.base.sigma;
        estimate.base.sigma = if first.by_clicks {
            // Errors that the estimates from clicks and from paint have in common show in no
            // residual. They are about half of the difference of the two positions; rotation and
            // lens follow by their correlation with the position. The covariance is raised along
            // that direction only.
            let half =
                sigma.following_position((estimate.base.position_m - first.base.position_m) * 0.5);
            sigma.covering(&(half * half.transpose()))
        } else {
            sigma.with_position_error_of(ALONE_SIGMA_M)
        };
        estimate.position_covariance = estimate.base.sigma.position_covariance();
        // For comparison, the errors of the initial base at the same paint, on the field size that
        // it was estimated with.
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
            cross_validated_errors(&as_first, &first.base, first.crown_m, &start.ptz);
        // The errors of the new base come from the choice of its model, which evaluated each frame
        // with a base estimated without it.
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
        let PaintObservations {
            frames,
            places,
            lines,
            ..
        } = seen;
        let before = OnPaintErrors {
            paint,
            clicks: at_clicks,
        };
        let seen = BasePaintEvidence {
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
            open_size,
            seen,
        })
    }
}

impl BaseProblem {
    /// The same frames with their clicks on a field of another size.
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

/// The same clicks and paint with their coordinates on a field of another size.
fn frame_on_field(frame: &FrameClicks, field: &FieldModel) -> FrameClicks {
    FrameClicks {
        observations: frame
            .observations
            .iter()
            .map(|seen| observation_on_field(seen, field))
            .collect(),
        start: frame.start,
    }
}

/// The same observation of the same element on another field; unchanged where it has no such
/// element.
fn observation_on_field(seen: &Observation, field: &FieldModel) -> Observation {
    seen.element
        .and_then(|element| seen.with_element(field, element))
        .unwrap_or(*seen)
}

/// A base, its crown, and the cameras of the frames.
pub(crate) struct KnownCameras {
    pub base: CameraBase,
    pub crown_m: f64,
    /// One for each frame of the problem.
    pub ptz: Vec<Option<Ptz>>,
    /// Whether they were determined by clicks.
    pub by_clicks: bool,
}

impl KnownCameras {
    /// The problem's field with the crown of these cameras.
    fn field(&self, problem: &BaseProblem) -> FieldModel {
        problem.field.with_crown_m(self.crown_m)
    }

    /// These cameras after an adjustment to clicks and paint.
    fn adjust(
        &self,
        problem: &BaseProblem,
        seen: &PaintObservations,
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

/// Observations of the painted lines.
struct PaintObservations {
    /// The clicks of each frame of the problem, followed by its paint.
    painted: Vec<FrameClicks>,
    /// The camera of each frame: aligned to the paint, or unchanged.
    ptz: Vec<Option<Ptz>>,
    frames: usize,
    places: usize,
    lines: BTreeSet<usize>,
}

impl PaintObservations {
    /// Aligns frames with known cameras to their pictures and measures positions of paint.
    fn measure(
        problem: &BaseProblem,
        cameras: &KnownCameras,
        masks: &[Vec<PixelBox>],
        picture: &mut dyn FnMut(usize) -> Option<Picture>,
    ) -> Result<Self, BaseOnPaintError> {
        let field = cameras.field(problem);
        // A subsample, spread evenly over all frames with a camera, limits the time.
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
        // Pictures are read one after the other and processed in parallel, a few at a time to limit
        // memory.
        for some in looked_at.chunks(AT_ONCE) {
            let read: Vec<(usize, Picture)> = some
                .iter()
                .filter_map(|place| Some((*place, picture(*place)?)))
                .collect();
            let looked = read.par_iter().map(|(place, picture)| {
                let ground = GroundPicture::new(picture, &masks[*place]);
                // Paint counts only in frames that can be aligned; elsewhere it may belong to other
                // lines. The clicks take part in the alignment.
                let clicks = frame_on_field(&problem.clicks[*place], &field).observations;
                let snapped = snap(
                    &ground,
                    &field,
                    &cameras.base,
                    cameras.ptz[*place]?,
                    &clicks,
                    &SnapOptions::for_unknown_lens(),
                )
                .ok()?;
                // Positions of paint are searched from the aligned camera, where the lines are
                // nearest.
                let camera = PtzCamera::new(cameras.base, snapped.ptz);
                Some((*place, snapped.ptz, paint_places(&ground, &field, &camera)))
            });
            let looked: Vec<_> = looked.collect();
            for (place, ptz, paint) in looked.into_iter().flatten() {
                seen.add(problem, place, ptz, &paint);
            }
        }
        // Few lines leave directions of the base undetermined, even if many frames show them.
        if seen.frames < FRAMES_FOR_PAINT || seen.lines.len() < FEWEST_LINES {
            return Err(BaseOnPaintError::TooFewLines {
                frames: seen.frames,
                lines: seen.lines.len(),
            });
        }
        Ok(seen)
    }

    /// Adds the aligned camera and the paint of one frame.
    fn add(&mut self, problem: &BaseProblem, place: usize, ptz: Ptz, paint: &[PaintPlace]) {
        self.ptz[place] = Some(ptz);
        self.frames += 1;
        self.places += paint.len();
        self.lines.extend(paint.iter().map(|seen| seen.line));
        // Paint observations follow the frame's clicks and are numbered by themselves.
        let observed = paint.iter().enumerate().filter_map(|(number, seen)| {
            Observation::from_paint(&problem.field, seen.line, seen.image, seen.sigma_px, number)
        });
        self.painted[place].observations.extend(observed);
    }
}
