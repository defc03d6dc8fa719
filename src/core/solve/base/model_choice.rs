//! The choice of the lens and pitch model by its errors in cross-validation.

use super::cross_validation::{MIN_FRAMES, ModelScore};
use super::{BaseModel, LensModel};
use serde::Serialize;
use std::fmt;

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
