//! The base of a camera from frames whose cameras are approximately known: from the positions of
//! painted lines in their pictures, and from clicks where there are some.
//!
//! 1. Each frame is aligned to its paint, beginning with its known camera, and positions of paint
//!    are measured (`paint_observations.rs`).
//! 2. Base and frames are adjusted to them.
//! 3. Paint is measured once more from the adjusted cameras. Where the size of the field is unknown
//!    it is fitted, and paint measured again, until it stands still (`size_on_paint.rs`).
//! 4. The base is estimated from that paint. Lens and crown are chosen by their error at held-out
//!    paint.

use super::on_paint::{BasePaintEvidence, OnPaintErrors};
use super::paint_observations::{
    BaseOnPaintError, KnownCameras, PaintObservations, frames_on_field,
};
use super::size_on_paint::{MeasuredFrames, SizingOnPaint};
use crate::calibrate::field_size::alone_sigma_m;
use crate::calibrate::{BaseEstimationError, BaseProblem};
use touchline_core::geometry::PixelBox;
use touchline_core::progress::Progress;
use touchline_core::solve::base::{
    BaseEstimate, BaseOptions, BaseProgress, CameraClicks, FittedSize, HeldOutErrors,
    cross_validated_errors, estimate_base_on_paint,
};
use touchline_vision::media::Picture;

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
    /// Whether the size of the field is fitted as well.
    pub fits_size: bool,
}

/// The base estimated from the paint of known frames.
pub(crate) struct PaintEstimate {
    /// The frames, with their clicks on the field of fitted size.
    pub problem: BaseProblem,
    /// The base, with the frames numbered as in the problem.
    pub estimate: BaseEstimate,
    /// The fitted lengths of the field.
    pub sizes: Vec<FittedSize>,
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
            problem,
            start: first,
            masks,
            picture,
            fits_size,
        } = self;
        let options = &options.clone().with_lens(&problem.lens, problem.image_size);
        // Steps 1 and 2: measure paint from the initial cameras and adjust with the richest model
        // of the base that the data allow. The result is only the start for what follows.
        let first_field = problem.field.clone();
        let seen = PaintObservations::measure(&problem, &first, &masks, picture)?;
        let model = options.richest(&problem.camera_clicks());
        let start = first.adjust(&problem, &seen, &model, &options.adjust);

        // Step 3: measure again from the adjusted cameras. Frames that failed at first may align
        // now, and paint that was assigned to the wrong line may find its own.
        let again = PaintObservations::measure(&problem, &start, &masks, picture)?;
        let mut measured = MeasuredFrames {
            problem,
            start,
            seen: again,
            sizes: Vec::new(),
        };
        if fits_size {
            let sizing = SizingOnPaint {
                model: &model,
                adjust: &options.adjust,
                masks: &masks,
            };
            measured = sizing.fit_until_settled(measured, (&first, &seen), picture);
        }
        let MeasuredFrames {
            problem,
            mut start,
            seen,
            sizes,
        } = measured;
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
            sigma.with_position_error_of(alone_sigma_m(&problem.field))
        };
        estimate.position_covariance = estimate.base.sigma.position_covariance();
        if !fits_size {
            problem.state_open_size(&seen.painted, &mut estimate);
        }
        // For comparison, the errors of the initial base at the same paint, on the field size that
        // it was estimated with.
        let as_first = frames_on_field(&seen.painted, &first_field);
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
            seen,
        })
    }
}
