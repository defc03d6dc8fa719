//! The paint of frames whose cameras are approximately known, as observations of the field's lines.
//!
//! Each frame is aligned to the paint of its own picture, beginning with its known camera, and the
//! positions of paint are measured along the lines where the aligned camera projects them. A frame
//! that cannot be aligned contributes its clicks alone. Observations carry the element of the field
//! that they belong to, so that they can be moved to a field of another size.

use crate::calibrate::{BaseEstimationError, BaseProblem};
use rayon::prelude::*;
use std::collections::BTreeSet;
use thiserror::Error;
use touchline_core::camera::{CameraBase, Ptz, PtzCamera};
use touchline_core::field::FieldModel;
use touchline_core::geometry::{PixelBox, pluralise, subsample};
use touchline_core::solve::Observation;
use touchline_core::solve::base::{
    AdjustOptions, BaseModel, CameraClicks, FrameClicks, adjust_base,
};
use touchline_vision::media::Picture;
use touchline_vision::paint::{
    GroundPicture, PaintPlace, SnapOptions, observations_of_paint, paint_places, snap,
};

/// Minimum number of frames with paint, and of different lines in all of them together, that
/// determine a base.
pub const FRAMES_FOR_PAINT: usize = 3;
const FEWEST_LINES: usize = 5;

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

/// Number of pictures in memory at the same time.
pub(crate) const AT_ONCE: usize = 8;

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
    pub(in crate::calibrate) fn adjust(
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
pub(in crate::calibrate) struct PaintObservations {
    /// The clicks of each frame of the problem, followed by its paint.
    pub painted: Vec<FrameClicks>,
    /// The camera of each frame: aligned to the paint, or unchanged.
    pub ptz: Vec<Option<Ptz>>,
    /// Number of frames whose camera could be aligned to their paint.
    pub frames: usize,
    /// Number of positions of paint.
    pub places: usize,
    /// The lines that they lie on, by index in the field.
    pub lines: BTreeSet<usize>,
}

impl PaintObservations {
    /// Aligns frames with known cameras to their pictures and measures positions of paint.
    pub fn measure(
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
        let observed = observations_of_paint(paint, &problem.field);
        self.painted[place].observations.extend(observed);
    }

    /// The same paint with its coordinates on a field of another size.
    pub fn on_field(&self, field: &FieldModel) -> Self {
        Self {
            painted: frames_on_field(&self.painted, field),
            ptz: self.ptz.clone(),
            lines: self.lines.clone(),
            ..*self
        }
    }
}

impl BaseProblem {
    /// The same frames with their clicks on a field of another size.
    pub(in crate::calibrate) fn on_field(self, field: FieldModel) -> Self {
        Self {
            clicks: frames_on_field(&self.clicks, &field),
            field,
            ..self
        }
    }
}

/// The same clicks and paint with their coordinates on a field of another size.
pub(in crate::calibrate) fn frames_on_field(
    frames: &[FrameClicks],
    field: &FieldModel,
) -> Vec<FrameClicks> {
    let moved = frames.iter().map(|frame| frame_on_field(frame, field));
    moved.collect()
}

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
