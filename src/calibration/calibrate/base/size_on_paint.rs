//! The size of a field, fitted to the paint of frames whose cameras are approximately known.
//!
//! Only with its size fitted does a field of another size have the right lines to align to, and only
//! with the right lines is its size seen. So both alternate: the size is fitted to the paint that the
//! lines find, the lines of the fitted size are searched in the pictures, and again until no length
//! moves. One fit is not enough where the initial cameras find little of a line that moves with the
//! size. Drawn clip 2 of the bowl (behind a goal): 32 points of one touchline gave a width that was
//! 1.5 m off; of that size the lines find 257.
//!
//! Seen from one end, a far line that is off by 2 px for another reason gives a width that is off by
//! 1 m and moves the near line by 20 px. So the fitted lines have to find as much paint as the
//! lines before.

use super::paint_observations::{KnownCameras, PaintObservations};
use crate::calibrate::BaseProblem;
use crate::calibrate::field_size::{alone_sigma_m, as_paint_alone_gives};
use touchline_core::field::FieldModel;
use touchline_core::geometry::PixelBox;
use touchline_core::solve::base::{AdjustOptions, BaseModel, FittedSize};
use touchline_vision::media::Picture;

/// A fitted size is taken if the lines of that field find at least this share of the paint that
/// those of the assumed size find; less than 1 for what changes by chance.
const LEAST_SHARE_WITH_SIZE: f64 = 0.99;

/// The size stands still if no length moves by more than this share of [`alone_sigma_m`].
const SETTLED_SHARE: f64 = 1.0 / 3.0;

/// Maximum number of fits of the size, each with the pictures searched once more. A length that
/// still moves in the last one is stated no better than by that step: drawn clip 9 of the bowl (on
/// a low mast, 360 lines), 109.1, 111.9, 112.6, 113.9 m.
const MAX_FITS: usize = 4;

/// Frames with their paint, and the cameras from which it was measured.
pub(super) struct MeasuredFrames {
    pub problem: BaseProblem,
    pub start: KnownCameras,
    pub seen: PaintObservations,
    /// The fitted lengths of the problem's field; empty while it has the assumed ones.
    pub sizes: Vec<FittedSize>,
}

impl MeasuredFrames {
    /// The largest difference between the lengths of this field and another one, m.
    fn change_of_size_m(&self, other: &FieldModel) -> f64 {
        let here = &self.problem.field;
        let length_m = (here.length_m - other.length_m).abs();
        length_m.max((here.width_m - other.width_m).abs())
    }

    /// Makes each fitted length at least as uncertain as its step from another field.
    fn cover_step_from(&mut self, before: &FieldModel) {
        for size in &mut self.sizes {
            if let Some(before_m) = before.params.get(&size.name) {
                size.cover_error((size.value_m - before_m).abs());
            }
        }
    }
}

/// How the size of a field is fitted to the paint of known frames.
pub(super) struct SizingOnPaint<'a> {
    pub model: &'a BaseModel,
    pub adjust: &'a AdjustOptions,
    /// For each frame of the problem, the pixels that are not searched for paint.
    pub masks: &'a [Vec<PixelBox>],
}

impl SizingOnPaint<'_> {
    /// Fits the size to the paint that was measured from the initial cameras (`first`), and then to
    /// what the lines of the fitted size find, until it stands still. Returns the frames as
    /// `measured` if the lines of another size find less. The last step, be it taken or refused, is
    /// in the stated σ unless it is short.
    pub fn fit_until_settled(
        &self,
        mut measured: MeasuredFrames,
        first: (&KnownCameras, &PaintObservations),
        picture: &mut dyn FnMut(usize) -> Option<Picture>,
    ) -> MeasuredFrames {
        for fit in 0..MAX_FITS {
            let from = match fit {
                0 => first,
                _ => (&measured.start, &measured.seen),
            };
            let Some(mut next) = self.resize(&measured.problem, from, picture) else {
                break;
            };
            let enough = LEAST_SHARE_WITH_SIZE * measured.seen.places as f64;
            let is_refused = (next.seen.places as f64) < enough;
            if !is_refused {
                std::mem::swap(&mut measured, &mut next);
            }
            let other = &next.problem.field;
            let is_still = measured.change_of_size_m(other) < SETTLED_SHARE * alone_sigma_m(other);
            if !is_still && (is_refused || fit + 1 == MAX_FITS) {
                measured.cover_step_from(other);
            }
            if is_still || is_refused {
                break;
            }
        }
        measured
    }

    /// Fits the size to observed paint and searches the lines of that size in the pictures. None if
    /// the rules leave no choice, the paint does not determine the size, or too few lines are found.
    fn resize(
        &self,
        problem: &BaseProblem,
        (cameras, seen): (&KnownCameras, &PaintObservations),
        picture: &mut dyn FnMut(usize) -> Option<Picture>,
    ) -> Option<MeasuredFrames> {
        let adjusted = cameras.adjust(problem, seen, self.model, self.adjust);
        let from = (&adjusted.base, adjusted.ptz.as_slice());
        let mut sizes = problem.fit_size(&seen.painted, from, self.model);
        if sizes.is_empty() {
            return None;
        }
        if !cameras.by_clicks {
            as_paint_alone_gives(&mut sizes, &problem.field);
        }
        let field = problem.open_size.field_with(&sizes)?;
        let problem = problem.clone().on_field(field);
        // The cameras belong to the size that they were adjusted with.
        let seen = seen.on_field(&problem.field);
        let start = cameras.adjust(&problem, &seen, self.model, self.adjust);
        let seen = PaintObservations::measure(&problem, &start, self.masks, picture).ok()?;
        Some(MeasuredFrames {
            problem,
            start,
            seen,
            sizes,
        })
    }
}
