//! Which lens and which pitch: every model is tried on clicks, or on paint where it is known, that
//! it has not seen.

use super::adjust::adjust_base;
use super::progress::Adjustments;
use super::{AdjustOptions, AdjustedBase, BaseModel, CameraClicks, FrameClicks, LensModel};
use crate::camera::{CameraBase, Ptz, PtzCamera, SharedCovariance, SharedError};
use crate::field::FieldModel;
use crate::geometry::quantile;
use crate::solve::{Loss, Observation, refine};
use rayon::prelude::*;
use serde::Serialize;
use std::fmt;

/// How a model does on clicks that it has not seen; where the frames' paint is known, on paint that
/// it has not seen.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct ModelScore {
    /// The model.
    pub model: BaseModel,
    /// Median error at what was held out, px.
    pub median_px: f64,
    /// The 90 % quantile of it, px.
    pub p90_px: f64,
    /// Root mean square with what is far off (wrong names, other paint) clipped, px: the choice is
    /// made by it.
    pub clipped_rms_px: f64,
    /// How many clicks, or places of paint, were held out, each once.
    pub held_out: usize,
    /// Where paint decides: the errors at held-out clicks.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub at_clicks: Option<HeldOutErrors>,
    /// Covariance of what the frames share by how it moves when a group is held out (jackknife).
    #[serde(skip)]
    pub spread: SharedCovariance,
}

/// Errors at clicks beyond this are wrong names, whatever the model, px at 1920 px width.
const CLIP_PX: f64 = 12.0;

/// Errors of paint beyond this are other paint, whatever the model, px at 1920 px width.
const PAINT_CLIP_PX: f64 = 4.0;

/// So many places of paint that follow each other are held out together: neighbours on one line
/// know too much of each other.
const PAINT_BLOCK: usize = 4;

/// A richer model must be better by this share.
const WORTHWHILE: f64 = 0.005;

/// With few frames another model must be better than that of the usual camera by this share.
/// Held-out clicks of so few frames tell less than is known beforehand: smaller differences are
/// noise.
const CLEARLY_BETTER: f64 = 0.25;

/// With one or two frames, whose clicks hardly tell the position from the lens, a simpler model is
/// the safer one from this share on.
const BETTER_IN_TWO_FRAMES: f64 = 0.05;

/// With fewer frames clicks hardly tell the position from the lens.
const TELL_LENS_FRAMES: usize = 3;

/// With fewer frames clicks are held out instead of frames.
pub(super) const MIN_FRAMES: usize = 6;

/// Why a model was chosen.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize)]
#[serde(rename_all = "snake_case")]
#[non_exhaustive]
pub enum ModelReason {
    /// No other was allowed.
    Prescribed,
    /// It is the best at frames held out.
    HeldOut,
    /// The frames are few: the usual lens and pitch hold, as far as the clicks agree.
    UsualCamera {
        /// How many frames have a camera.
        frames: usize,
    },
    /// The frames are few, but their clicks contradict the usual lens or pitch.
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

/// What cross-validation needs beside the model.
pub(super) struct CrossValidation<'a> {
    pub clicks: &'a CameraClicks<'a>,
    pub start: &'a CameraBase,
    pub start_ptz: &'a [Option<Ptz>],
    pub options: &'a AdjustOptions,
    pub adjustments: &'a Adjustments<'a>,
}

impl CrossValidation<'_> {
    /// Scores every model; the order stays.
    pub fn scores(&self, models: &[BaseModel]) -> Vec<ModelScore> {
        models.par_iter().map(|model| self.score(model)).collect()
    }

    /// Holds out groups of frames, or of clicks where frames are few.
    fn score(&self, model: &BaseModel) -> ModelScore {
        let enough = self.start_ptz.iter().flatten().count() >= MIN_FRAMES;
        let hold_out = |fold| {
            if self.adjustments.are_cancelled() {
                return Fold {
                    errors: Errors::default(),
                    shared: SharedError::zeros(),
                };
            }
            let tried = if enough {
                self.held_out_frames(model, fold)
            } else {
                self.held_out_clicks(model, fold)
            };
            // The next fold asks whether the estimation is cancelled.
            let _ = self.adjustments.count();
            tried
        };
        let folds: Vec<Fold> = (0..FOLDS).into_par_iter().map(hold_out).collect();
        let errors = folds
            .iter()
            .fold(Errors::default(), |sum, fold| sum.and(&fold.errors));
        let scale = self.clicks.image_size.scale_from_1920();
        let (deciding, clip_px, at_clicks) = if errors.paint.is_empty() {
            (errors.clicks, CLIP_PX * scale, None)
        } else {
            (
                errors.paint,
                PAINT_CLIP_PX * scale,
                HeldOutErrors::of(errors.clicks),
            )
        };
        let squares: f64 = deciding
            .iter()
            .map(|error| error.min(clip_px).powi(2))
            .sum();
        let clipped_rms_px = (squares / deciding.len().max(1) as f64).sqrt();
        let summary = HeldOutErrors::of(deciding).unwrap_or(HeldOutErrors::NONE);
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

    /// The base from the frames of the other groups; each frame of this one refined on half of its
    /// clicks and judged by the other half, both ways.
    fn held_out_frames(&self, model: &BaseModel, fold: usize) -> Fold {
        let held_out = |index: usize| index % FOLDS == fold;
        let ptz: Vec<Option<Ptz>> = self
            .start_ptz
            .iter()
            .enumerate()
            .map(|(index, ptz)| ptz.filter(|_| !held_out(index)))
            .collect();
        let (adjusted, field) = self.adjusted(self.clicks.frames, &ptz, model);
        let mut errors = Errors::default();
        for (index, frame) in self
            .clicks
            .frames
            .iter()
            .enumerate()
            .filter(|(index, _)| held_out(*index))
        {
            let Some(start) = self.start_ptz[index] else {
                continue;
            };
            errors.add_halves(&adjusted.base, start, frame, self.clicks.field, &field);
        }
        Fold {
            errors,
            shared: shared_difference(&adjusted, self.start),
        }
    }

    /// Everything from the clicks of the other groups, judged by the clicks of this one.
    fn held_out_clicks(&self, model: &BaseModel, fold: usize) -> Fold {
        let part = |(index, frame): (usize, &FrameClicks)| {
            let held_out = |group: usize| (group + index) % FOLDS == fold;
            let hold = |(group, click): (usize, &Observation)| {
                if held_out(group) {
                    click.held_out()
                } else {
                    *click
                }
            };
            let observations = grouped(frame).map(hold).collect();
            FrameClicks {
                observations,
                start: frame.start,
            }
        };
        let frames: Vec<FrameClicks> = self.clicks.frames.iter().enumerate().map(part).collect();
        let ptz: Vec<Option<Ptz>> = frames
            .iter()
            .zip(self.start_ptz)
            .map(|(frame, ptz)| ptz.filter(|_| frame.equations() >= 3))
            .collect();
        let (adjusted, field) = self.adjusted(&frames, &ptz, model);
        let mut errors = Errors::default();
        for (frame, ptz) in frames.iter().zip(&adjusted.ptz) {
            let Some(ptz) = ptz else { continue };
            let camera = PtzCamera::new(adjusted.base, *ptz);
            let held_out = frame.observations.iter().filter(|click| click.check);
            errors.add(
                &camera,
                held_out.map(|click| click.recrowned(self.clicks.field, &field)),
            );
        }
        Fold {
            errors,
            shared: shared_difference(&adjusted, self.start),
        }
    }

    fn adjusted(
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
        let field = FieldModel {
            crown_m: adjusted.crown_m,
            ..clicks.field.clone()
        };
        (adjusted, field)
    }
}

/// What one group's holding out gave.
struct Fold {
    errors: Errors,
    /// How far what the frames share is from the start's.
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

    /// Of errors in any order, px; none of none.
    fn of(mut errors: Vec<f64>) -> Option<Self> {
        errors.sort_by(f64::total_cmp);
        let at = |share| quantile(&errors, share);
        (!errors.is_empty()).then(|| Self {
            median_px: at(0.5),
            p90_px: at(0.9),
            count: errors.len(),
        })
    }
}

/// Errors held out, px: of clicks and of paint.
#[derive(Clone, Debug, Default)]
pub(super) struct Errors {
    clicks: Vec<f64>,
    paint: Vec<f64>,
}

impl Errors {
    /// Adds those of some observations.
    fn add(&mut self, camera: &PtzCamera, judged: impl Iterator<Item = Observation>) {
        for observation in judged {
            let of_kind = if observation.is_paint() {
                &mut self.paint
            } else {
                &mut self.clicks
            };
            of_kind.extend(observation.distance_px(camera));
        }
    }

    /// Adds those of a frame whose camera is refined on one half of what is known of it and judged
    /// by the other, both ways. Its observations are of the field `from`; the base was found with
    /// `to`.
    pub fn add_halves(
        &mut self,
        base: &CameraBase,
        start: Ptz,
        frame: &FrameClicks,
        from: &FieldModel,
        to: &FieldModel,
    ) {
        let half = |half: usize| -> Vec<Observation> {
            let of_half = grouped(frame).filter(|(group, _)| group % 2 == half);
            of_half
                .map(|(_, observation)| observation.recrowned(from, to))
                .collect()
        };
        let (even, odd) = (half(0), half(1));
        for (fitted, judged) in [(&even, &odd), (&odd, &even)] {
            let refined = refine(base, start, fitted, Loss::default(), None);
            self.add(&PtzCamera::new(*base, refined.ptz), judged.iter().copied());
        }
    }

    /// These and others.
    fn and(mut self, others: &Self) -> Self {
        self.clicks.extend_from_slice(&others.clicks);
        self.paint.extend_from_slice(&others.paint);
        self
    }

    /// Those of the paint, and those of the clicks.
    pub fn summaries(self) -> (Option<HeldOutErrors>, Option<HeldOutErrors>) {
        (
            HeldOutErrors::of(self.paint),
            HeldOutErrors::of(self.clicks),
        )
    }
}

/// What takes part of a frame, each with the number of the group that it is held out with.
fn grouped(frame: &FrameClicks) -> impl Iterator<Item = (usize, &Observation)> {
    let group = |(index, observation): (usize, &Observation)| {
        if observation.is_paint() {
            index / PAINT_BLOCK
        } else {
            index
        }
    };
    frame
        .used()
        .enumerate()
        .map(move |item| (group(item), item.1))
}

/// How far what an adjusted base's frames share is from a start's, both in the pan gauge and with
/// k₁ at the same focal length.
fn shared_difference(adjusted: &AdjustedBase, start: &CameraBase) -> SharedError {
    let base = &adjusted.base;
    let (moved_m, turned) = (
        base.position_m - start.position_m,
        base.rotation_from(start),
    );
    let curve = base.distortion;
    let centre = base.principal_point;
    let lens = [
        curve.value,
        curve.per_1000_px,
        adjusted.crown_m,
        centre.x,
        centre.y,
    ];
    SharedError::from_iterator(
        moved_m
            .iter()
            .copied()
            .chain([turned.x, turned.y])
            .chain(lens),
    )
}

/// Covariance of what the frames share: the delete-a-group jackknife (Wolter, Introduction to
/// Variance Estimation, chapter 4). Unlike the covariance of an adjustment it sees what the frames
/// have in common and the model has not.
fn jackknife(folds: &[Fold]) -> SharedCovariance {
    let count = folds.len() as f64;
    let mean = folds.iter().map(|fold| fold.shared).sum::<SharedError>() / count;
    let squares: SharedCovariance = folds
        .iter()
        .map(|fold| (fold.shared - mean) * (fold.shared - mean).transpose())
        .sum();
    squares * ((count - 1.0) / count)
}

/// Groups into which frames or clicks are dealt.
pub(super) const FOLDS: usize = 5;

/// The best model, and why. With many frames richer ones (later in the list) only where they are
/// worth it. With few frames the richest one that never folds: its priors are what is known of such
/// cameras, and adjusting under them weighs that against the clicks better than a choice among
/// models would; another one only where it is clearly better.
pub(super) fn choose(
    scores: &[ModelScore],
    solved_frames: usize,
) -> Option<(BaseModel, ModelReason)> {
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
    let richest = scores.last()?;
    let (usual, chosen) = if frames >= TELL_LENS_FRAMES {
        let usual = scores
            .iter()
            .rfind(|score| score.model.lens.never_folds())
            .unwrap_or(richest);
        (usual, better_by(CLEARLY_BETTER, usual, scores.iter().rev()))
    } else {
        // So few frames do not tell the two lenses that change with the zoom apart; the later one
        // of the list errs less with them.
        let apart = |score: &&ModelScore| {
            score.model.lens != LensModel::K1FocalK2 || score.model.lens == richest.model.lens
        };
        (
            richest,
            better_by(
                BETTER_IN_TWO_FRAMES,
                richest,
                scores.iter().rev().filter(apart),
            ),
        )
    };
    let as_usual = chosen == usual.model;
    let reason = if as_usual {
        ModelReason::UsualCamera { frames }
    } else {
        ModelReason::UnlikeUsual { frames }
    };
    Some((chosen, reason))
}

/// A model, unless others in turn are better by this share.
fn better_by<'a>(
    share: f64,
    start: &'a ModelScore,
    others: impl Iterator<Item = &'a ModelScore>,
) -> BaseModel {
    let better = |best: &'a ModelScore, other: &'a ModelScore| {
        if other.clipped_rms_px < best.clipped_rms_px * (1.0 - share) {
            other
        } else {
            best
        }
    };
    others.fold(start, better).model
}
