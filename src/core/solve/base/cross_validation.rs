//! Cross-validation of lens and pitch models: every model is evaluated on held-out clicks, or on
//! held-out paint where paint is known.

use super::adjust::adjust_base;
use super::{
    AdjustOptions, AdjustedBase, Adjustments, BaseModel, CameraClicks, FrameClicks, LensModel,
};
use crate::camera::{CameraBase, Ptz, PtzCamera, SharedCovariance, SharedError};
use crate::field::FieldModel;
use crate::geometry::quantile;
use crate::solve::{Loss, Observation, refine};
use rayon::prelude::*;
use serde::Serialize;
use std::fmt;

/// The cross-validation errors of a model: at held-out clicks, or at held-out paint where the
/// frames' paint is known.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct ModelScore {
    /// The model.
    pub model: BaseModel,
    /// Median error at what was held out, px.
    pub median_px: f64,
    /// The 90 % quantile of it, px.
    pub p90_px: f64,
    /// Root mean square with large errors (wrong names, other paint) clipped, px. The choice is
    /// made by this number.
    pub clipped_rms_px: f64,
    /// The number of held-out clicks or paint samples; each is held out once.
    pub held_out: usize,
    /// The errors at held-out clicks, where the other fields are about paint.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub at_clicks: Option<HeldOutErrors>,
    /// Jackknife covariance of the parameters that the frames share, from their changes when a
    /// group is held out.
    #[serde(skip)]
    pub spread: SharedCovariance,
}

/// Larger errors at clicks are clipped to this, px at 1920 px width: they are wrong names, whatever
/// the model.
const CLIP_PX: f64 = 12.0;

/// Larger errors of paint are clipped to this, px at 1920 px width: they are other paint, whatever
/// the model.
const PAINT_CLIP_PX: f64 = 4.0;

/// The number of consecutive paint samples that are held out together. Neighbours on one line have
/// correlated errors, so that a sample between fitted neighbours would not test the model.
const PAINT_BLOCK: usize = 4;

/// With fewer frames, clicks are held out instead of frames.
pub(super) const MIN_FRAMES: usize = 6;

/// The number of groups into which frames or clicks are divided.
pub(super) const FOLDS: usize = 5;

/// The inputs of cross-validation beside the model.
pub(super) struct CrossValidation<'a> {
    pub clicks: &'a CameraClicks<'a>,
    pub start: &'a CameraBase,
    pub start_ptz: &'a [Option<Ptz>],
    pub options: &'a AdjustOptions,
    pub adjustments: &'a Adjustments<'a>,
}

impl CrossValidation<'_> {
    /// Scores every model, in the given order.
    pub fn scores(&self, models: &[BaseModel]) -> Vec<ModelScore> {
        models.par_iter().map(|model| self.score(model)).collect()
    }

    /// Holds out groups of frames, or of clicks where frames are few.
    fn score(&self, model: &BaseModel) -> ModelScore {
        let enough = self.start_ptz.iter().flatten().count() >= MIN_FRAMES;
        let folds: Vec<Fold> = (0..FOLDS)
            .into_par_iter()
            .map(|fold| self.evaluate_fold(model, fold, enough))
            .collect();
        let errors = folds
            .iter()
            .fold(Errors::default(), |sum, fold| sum.and(&fold.errors));

        // Held-out paint decides where there is any; the errors at clicks are then only reported.
        let scale = self.clicks.image_size.scale_from_1920();
        let (deciding, clip_px, at_clicks) = if errors.paint.is_empty() {
            (errors.clicks, CLIP_PX * scale, None)
        } else {
            (
                errors.paint,
                PAINT_CLIP_PX * scale,
                HeldOutErrors::from_errors(errors.clicks),
            )
        };
        // Clip the errors, so that a few wrong names or other paint do not decide between models.
        let squares: f64 = deciding
            .iter()
            .map(|error| error.min(clip_px).powi(2))
            .sum();
        let clipped_rms_px = (squares / deciding.len().max(1) as f64).sqrt();
        let summary = HeldOutErrors::from_errors(deciding).unwrap_or(HeldOutErrors::NONE);
        ModelScore {
            model: *model,
            median_px: summary.median_px,
            p90_px: summary.p90_px,
            clipped_rms_px,
            held_out: summary.count,
            at_clicks,
            spread: jackknife(&folds),
        }
    }

    /// Holds out one group: of frames, or of clicks. Without errors once cancelled.
    fn evaluate_fold(&self, model: &BaseModel, fold: usize, of_frames: bool) -> Fold {
        if self.adjustments.are_cancelled() {
            return Fold {
                errors: Errors::default(),
                shared: SharedError::zeros(),
            };
        }
        let tried = if of_frames {
            self.evaluate_frame_fold(model, fold)
        } else {
            self.evaluate_click_fold(model, fold)
        };
        // A cancellation is noticed by the next fold.
        let _ = self.adjustments.count();
        tried
    }

    /// Adjusts the base to the frames of the other groups. Each frame of this group is refined on
    /// half of its clicks and evaluated on the other half, and the reverse.
    fn evaluate_frame_fold(&self, model: &BaseModel, fold: usize) -> Fold {
        // Groups are formed of the frames with a camera, by their rank. By their index all of them
        // may be one group: paint is measured in a subsample, which may be every fifth frame.
        let with_camera = self.start_ptz.iter().enumerate();
        let with_camera = with_camera.filter_map(|(index, ptz)| Some((index, (*ptz)?)));
        let held_out: Vec<(usize, Ptz)> = with_camera.skip(fold).step_by(FOLDS).collect();
        // Adjust without the cameras of this group: a frame without a camera is left out of the
        // bundle.
        let mut ptz = self.start_ptz.to_vec();
        for (index, _) in &held_out {
            ptz[*index] = None;
        }
        let (adjusted, field) = self.adjust(self.clicks.frames, &ptz, model);
        let mut errors = Errors::default();
        for (index, start) in held_out {
            let frame = &self.clicks.frames[index];
            errors.add_halves(&adjusted.base, start, frame, self.clicks.field, &field);
        }
        Fold {
            errors,
            shared: shared_difference(&adjusted, self.start),
        }
    }

    /// Adjusts base and frames to the clicks of the other groups, and evaluates them on the clicks
    /// of this group.
    fn evaluate_click_fold(&self, model: &BaseModel, fold: usize) -> Fold {
        let frames: Vec<FrameClicks> = self
            .clicks
            .frames
            .iter()
            .enumerate()
            .map(|(index, frame)| hold_out_clicks(frame, index, fold))
            .collect();

        // A frame needs three equations for pan, tilt and focal length.
        let ptz: Vec<Option<Ptz>> = frames
            .iter()
            .zip(self.start_ptz)
            .map(|(frame, ptz)| ptz.filter(|_| frame.equations() >= 3))
            .collect();
        let (adjusted, field) = self.adjust(&frames, &ptz, model);
        // Errors only at the clicks that were held out, moved to the crown that was fitted.
        let mut errors = Errors::default();
        for (frame, ptz) in frames.iter().zip(&adjusted.ptz) {
            let Some(ptz) = ptz else { continue };
            let camera = PtzCamera::new(adjusted.base, *ptz);
            let held_out = frame.observations.iter().filter(|click| click.check);
            errors.add(
                &camera,
                held_out.map(|click| click.change_crown(self.clicks.field, &field)),
            );
        }
        Fold {
            errors,
            shared: shared_difference(&adjusted, self.start),
        }
    }

    fn adjust(
        &self,
        frames: &[FrameClicks],
        ptz: &[Option<Ptz>],
        model: &BaseModel,
    ) -> (AdjustedBase, FieldModel) {
        let clicks = CameraClicks {
            frames,
            ..*self.clicks
        };
        let adjusted = adjust_base(&clicks, self.start, ptz, model, self.options);
        let field = clicks.field.with_crown_m(adjusted.crown_m);
        (adjusted, field)
    }
}

/// The result of holding out one group.
struct Fold {
    errors: Errors,
    /// The difference of the shared parameters from those of the start.
    shared: SharedError,
}

/// The errors at something held out.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct HeldOutErrors {
    /// The median, px.
    pub median_px: f64,
    /// The 90 % quantile, px.
    pub p90_px: f64,
    /// How many there are.
    pub count: usize,
}

impl HeldOutErrors {
    const NONE: Self = Self {
        median_px: f64::INFINITY,
        p90_px: f64::INFINITY,
        count: 0,
    };

    /// Summarises errors (px, in any order); none if there are none.
    fn from_errors(mut errors: Vec<f64>) -> Option<Self> {
        errors.sort_by(f64::total_cmp);
        (!errors.is_empty()).then(|| Self {
            median_px: quantile(&errors, 0.5),
            p90_px: quantile(&errors, 0.9),
            count: errors.len(),
        })
    }
}

/// Held-out errors of clicks and of paint, px.
#[derive(Clone, Debug, Default)]
pub(super) struct Errors {
    clicks: Vec<f64>,
    paint: Vec<f64>,
}

impl Errors {
    /// Adds the errors of observations under a camera: infinite where one has no image, as beyond
    /// the fold of a lens.
    fn add(&mut self, camera: &PtzCamera, held_out: impl Iterator<Item = Observation>) {
        for observation in held_out {
            let of_kind = if observation.is_paint() {
                &mut self.paint
            } else {
                &mut self.clicks
            };
            of_kind.push(observation.distance_px_or_infinite(camera));
        }
    }

    /// Adds the errors of a frame whose camera is refined on one half of its observations and
    /// evaluated on the other, both ways. Its observations are of the field `from`; the base was
    /// estimated on `to`.
    pub fn add_halves(
        &mut self,
        base: &CameraBase,
        start: Ptz,
        frame: &FrameClicks,
        from: &FieldModel,
        to: &FieldModel,
    ) {
        let [even, odd] = [0, 1].map(|half: usize| -> Vec<Observation> {
            let of_half = group_observations(frame).filter(|(group, _)| group % 2 == half);
            of_half
                .map(|(_, observation)| observation.change_crown(from, to))
                .collect()
        });
        for (fitted, held_out) in [(&even, &odd), (&odd, &even)] {
            let refined = refine(base, start, fitted, Loss::default(), None);
            self.add(
                &PtzCamera::new(*base, refined.ptz),
                held_out.iter().copied(),
            );
        }
    }

    /// The union of both.
    fn and(mut self, others: &Self) -> Self {
        self.clicks.extend_from_slice(&others.clicks);
        self.paint.extend_from_slice(&others.paint);
        self
    }

    /// The summaries for paint and for clicks.
    pub fn summaries(self) -> (Option<HeldOutErrors>, Option<HeldOutErrors>) {
        (
            HeldOutErrors::from_errors(self.paint),
            HeldOutErrors::from_errors(self.clicks),
        )
    }
}

/// The observations of a frame that are used, each with the number of its hold-out group.
fn group_observations(frame: &FrameClicks) -> impl Iterator<Item = (usize, &Observation)> {
    frame.used_clicks().enumerate().map(|(index, observation)| {
        let group = if observation.is_paint() {
            index / PAINT_BLOCK
        } else {
            index
        };
        (group, observation)
    })
}

/// The used clicks of a frame, those of one fold held out. `index` is that of the frame.
fn hold_out_clicks(frame: &FrameClicks, index: usize, fold: usize) -> FrameClicks {
    let observations = group_observations(frame)
        .map(|(group, click)| {
            // Stagger the groups from frame to frame; otherwise one fold would hold out the first
            // click of every frame, and frames with few clicks would miss the later folds.
            if (group + index) % FOLDS == fold {
                click.hold_out()
            } else {
                *click
            }
        })
        .collect();
    FrameClicks {
        observations,
        start: frame.start,
    }
}

/// The shared parameters of an adjusted base, with position and rotation relative to the start.
/// Both bases are in the pan gauge; k₁ refers to the same focal length in every fold.
fn shared_difference(adjusted: &AdjustedBase, start: &CameraBase) -> SharedError {
    let base = &adjusted.base;
    let (moved_m, turned) = (
        base.position_m - start.position_m,
        base.rotation_from(start),
    );
    // In the order of the shared parameters (`parameters.rs`).
    SharedError::from([
        moved_m.x,
        moved_m.y,
        moved_m.z,
        turned.x,
        turned.y,
        base.distortion.value,
        base.distortion.per_1000_px,
        adjusted.crown_m,
        base.principal_point.x,
        base.principal_point.y,
    ])
}

/// Covariance of the shared parameters by the delete-a-group jackknife (Wolter, Introduction to
/// Variance Estimation, chapter 4). Unlike the covariance of an adjustment it includes errors that
/// the frames have in common and that the model does not describe.
fn jackknife(folds: &[Fold]) -> SharedCovariance {
    // C = (n − 1)/n Σ (θᵢ − θ̄) (θᵢ − θ̄)ᵀ over the estimates θᵢ with group i held out.
    let count = folds.len() as f64;
    let mean = folds.iter().map(|fold| fold.shared).sum::<SharedError>() / count;
    let squares: SharedCovariance = folds
        .iter()
        .map(|fold| (fold.shared - mean) * (fold.shared - mean).transpose())
        .sum();
    squares * ((count - 1.0) / count)
}

/// The fraction by which a richer model must be better, with many frames.
const WORTHWHILE: f64 = 0.005;

/// With few frames, the fraction by which another model must be better than the model of the usual
/// camera. Held-out clicks of few frames carry less information than the priors: smaller
/// differences are noise.
const CLEARLY_BETTER: f64 = 0.25;

/// With one or two frames, the fraction by which another model must be better. Their clicks hardly
/// separate the position from the lens, which makes a simpler model the safer one.
const BETTER_IN_TWO_FRAMES: f64 = 0.05;

/// With fewer frames the clicks hardly separate the position from the lens.
const TELL_LENS_FRAMES: usize = 3;

/// Why a model was chosen.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize)]
#[serde(rename_all = "snake_case")]
#[non_exhaustive]
pub enum ModelReason {
    /// No other was allowed.
    Prescribed,
    /// It has the smallest errors at held-out frames, or is as good and simpler.
    HeldOut,
    /// There are few frames: the usual lens and pitch are kept, as far as the clicks agree.
    UsualCamera {
        /// How many frames have a camera.
        frames: usize,
    },
    /// There are few frames, but their clicks contradict the usual lens or pitch.
    UnlikeUsual {
        /// How many frames have a camera.
        frames: usize,
    },
}

impl fmt::Display for ModelReason {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Prescribed => f.pad("the only one allowed"),
            Self::HeldOut => f.pad("the best in cross-validation, or as good and simpler"),
            Self::UsualCamera { frames } => write!(
                f,
                "{frames} of the {MIN_FRAMES} frames needed to compare models; lens and pitch are kept near their usual values"
            ),
            Self::UnlikeUsual { frames } => write!(
                f,
                "{frames} of the {MIN_FRAMES} frames needed to compare models, but their points fit it better than the usual lens and pitch"
            ),
        }
    }
}

/// The best model, and why.  With many frames, a richer model (later in the list) is chosen only if
/// it is better by [`WORTHWHILE`]. With few frames, the richest model that never folds is chosen:
/// its priors describe such cameras, and an adjustment under them weighs prior against clicks
/// better than a choice among models would. Another model must be clearly better.
pub(super) fn choose(
    scores: &[ModelScore],
    solved_frames: usize,
) -> Option<(BaseModel, ModelReason)> {
    // A single model: nothing to choose.
    if let [only] = scores {
        return Some((only.model, ModelReason::Prescribed));
    }
    let frames = solved_frames;
    if frames >= MIN_FRAMES {
        return Some((
            better_by(WORTHWHILE, scores.first()?, scores.iter()),
            ModelReason::HeldOut,
        ));
    }

    // Few frames: start from the model of the usual camera, which must be beaten clearly. Three to
    // five frames start from the richest lens that never folds.
    let richest = scores.last()?;
    let (usual, chosen) = if frames >= TELL_LENS_FRAMES {
        let usual = scores
            .iter()
            .rfind(|score| score.model.lens.never_folds())
            .unwrap_or(richest);
        (usual, better_by(CLEARLY_BETTER, usual, scores.iter().rev()))
    } else {
        // One or two frames cannot distinguish the two lenses that change with the focal length;
        // the later one in the list has smaller errors in that case.
        let others = scores.iter().rev().filter(|score| {
            score.model.lens != LensModel::K1FocalK2 || score.model.lens == richest.model.lens
        });
        (richest, better_by(BETTER_IN_TWO_FRAMES, richest, others))
    };
    let as_usual = chosen == usual.model;
    let reason = if as_usual {
        ModelReason::UsualCamera { frames }
    } else {
        ModelReason::UnlikeUsual { frames }
    };
    Some((chosen, reason))
}

/// The start, replaced in turn by each other model that is better than the current one by this
/// fraction.
fn better_by<'a>(
    share: f64,
    start: &'a ModelScore,
    others: impl Iterator<Item = &'a ModelScore>,
) -> BaseModel {
    // Each is compared with the best so far, so small gains of several models add up.
    let mut best = start;
    for other in others {
        if other.clipped_rms_px < best.clipped_rms_px * (1.0 - share) {
            best = other;
        }
    }
    best.model
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::geometry::Vec3;
    use crate::solve::fixtures::base;
    use crate::testing::TestBase;

    #[test]
    fn a_click_without_an_image_counts_as_infinitely_far() {
        let camera = base().aim(0.0, -12.0, 2300.0);
        let seen = Vec3::new(3.0, 5.0, 0.0);
        let image = camera.image_from_world(seen).unwrap();
        // The second one lies behind the camera.
        let clicks = [seen, Vec3::new(3.0, -150.0, 0.0)]
            .map(|at| Observation::from_point(at, image, 2.0, 0));
        let mut errors = Errors::default();
        errors.add(&camera, clicks.into_iter());
        let (_, at_clicks) = errors.summaries();
        let at_clicks = at_clicks.unwrap();
        assert_eq!((at_clicks.count, at_clicks.p90_px), (2, f64::INFINITY));
    }
}
