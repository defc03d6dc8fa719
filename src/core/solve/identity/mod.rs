//! Detection of wrong names: two landmarks swapped, the mirrored end or side, a neighbouring line
//! or landmark, one part of the field for another.
//!
//! # Problem
//!
//! Clicks may be exact and still have wrong names. Three equations determine a camera, so two
//! points leave one surplus equation, and a wrong name often fits nearly as well as the right one.
//! Find other names that explain the clicks better, and the evidence for them.
//!
//! # Method
//!
//! An explanation is a *hypothesis*: the clicks with some names changed. Each is solved and scored
//! by χ² of its clicks, plus χ² of its camera under the motion prior, plus a penalty for each
//! changed name. `hypotheses.rs` and `group_mistakes.rs` (4) generate them in this order:
//!
//! 1. From five clicks on, the camera of the majority is found by a robust loss; the clicks that
//!    contradict it get the nearest fitting names, and the oddest four are swapped pairwise.
//! 2. All names of the mirrored field, for each of its symmetries.
//! 3. Up to six clicks: every swap, and every click left out and renamed by the camera of the
//!    others.
//! 4. A whole part for another (goal area for penalty area), a line for a parallel one.
//!
//! A hypothesis is accepted if the clicks contradict each other as named (misfit of 2 and more),
//! fit when renamed (misfit below 2), and χ² falls by 25 and to a quarter. With an imperfect base
//! nothing fits that well; then χ² has to fall to a sixteenth.
//!
//! # What is said
//!
//! * [`Evidence::Clicks`]: the clicks contradict each other as named.
//! * [`Evidence::MotionPrior`]: both fit, but as named the camera is outside its usual range or
//!   motion.
//! * [`Evidence::None`]: both fit and nothing decides. Both are shown, unless frames
//!   before and after have decided already.
//!
//! # What it is proof against
//!
//! A frame of many clicks that fit is not searched, so that it costs no time. A set of wrong names
//! that agree with each other and with the motion of the camera is not detected here;
//! `calibrate::disagreements` compares frames for that.

mod group_mistakes;
mod hypotheses;

use super::{Evidence, FrameSolution, IdentityFinding, Loss, Observation, SolveContext};
use crate::camera::CameraBase;
use crate::field::FieldModel;
use hypotheses::{Hypothesis, ScoredHypothesis, Search};

/// Renaming must lower χ² by this amount, and to this fraction.
const MIN_GAIN: f64 = 25.0;
const MAX_SHARE: f64 = 0.25;

/// Minimum misfit of the clicks as named (see [`FrameSolution::misfit`]).
const MIN_MISFIT: f64 = 2.0;

/// Maximum misfit of the renamed clicks.
const MAX_RENAMED_MISFIT: f64 = 2.0;

/// With an imperfect base no clicks fit that well. Then other names must lower χ² to this fraction,
/// with at most this misfit.
const CLEAR_SHARE: f64 = 1.0 / 16.0;
const MAX_CLEAR_MISFIT: f64 = 6.0;

/// From this many clicks on, the outliers of the majority's camera are renamed first.
const MAJORITY_CLICKS: usize = 5;

/// Up to this many clicks, every swap and every single wrong name is tested.
const FEW_CLICKS: usize = 6;

/// With more clicks than this, a mirrored side does not fit as well by chance.
const MIRRORS_FIT_UPTO: usize = 4;

/// Looks for a better or equally good set of names for a solved frame's clicks; the best, if there
/// is one.
///
/// `observations` are those that were solved, made from `field`; clicks without an element get no
/// other name. A frame of many clicks that fit, with a camera that is usual under the motion prior,
/// returns at once.
pub fn check_identity(
    base: &CameraBase,
    field: &FieldModel,
    observations: &[Observation],
    solution: &FrameSolution,
    context: &SolveContext,
) -> Option<IdentityFinding> {
    let clicks: Vec<Observation> = observations
        .iter()
        .filter(|click| !click.check)
        .copied()
        .collect();
    let slack = solution.slack();
    let search = Search {
        base,
        field,
        clicks: &clicks,
        context: SolveContext {
            loss: Loss::Squared,
            ..context.clone()
        },
        slack,
    };
    let misfit = solution.misfit()?;
    let surprise = context.motion.surprise(&solution.ptz, &slack);
    let contradicted = misfit >= MIN_MISFIT;
    // Nothing contradicts the names: only a mirrored side that fits as well is reported, for few
    // clicks.
    if !contradicted && surprise < MIN_GAIN {
        return if clicks.len() <= MIRRORS_FIT_UPTO {
            search.equal_mirror(solution, surprise)
        } else {
            None
        };
    }

    // The redundancy is that of the clicks, without the equations of a prior; the effect of an
    // uncertain base is taken from the solution, as a factor.
    let as_named = FitAsNamed {
        cost: solution.chi_squared + surprise,
        expected_chi_squared: search.redundancy() as f64
            * (solution.expected_chi_squared / solution.redundancy as f64).max(1.0),
    };
    // Hypotheses 3 and 4 of the module page take longer, and are tested only if no simpler one
    // explains the clicks.
    let found = rename_outliers_or_mirror(&search, &as_named)
        .or_else(|| rename_one_by_one(&search, &as_named))
        .or_else(|| best_hypothesis(&search, &as_named, search.group_mistakes()))?;
    let evidence = if contradicted {
        Evidence::Clicks
    } else {
        Evidence::MotionPrior
    };
    Some(found.finding(evidence, base, solution))
}

/// How well the clicks fit as they are named: what other names are compared with.
struct FitAsNamed {
    /// χ² plus the cost of the camera under the motion prior.
    cost: f64,
    /// The expected χ² of clicks with the right names; larger under an uncertain base.
    expected_chi_squared: f64,
}

impl FitAsNamed {
    /// How many times larger than expected the residuals of renamed clicks are.
    fn renamed_misfit(&self, chi_squared: f64) -> f64 {
        (chi_squared / self.expected_chi_squared).sqrt()
    }

    /// Whether a hypothesis lowers the cost by a constant and by a factor, and fits in absolute
    /// terms.
    fn is_beaten_by(&self, scored: &ScoredHypothesis) -> bool {
        let renamed = scored.chi_squared + scored.surprise;
        let renamed_misfit = self.renamed_misfit(scored.chi_squared);
        renamed + MIN_GAIN < self.cost
            && (renamed < MAX_SHARE * self.cost && renamed_misfit < MAX_RENAMED_MISFIT
                || renamed < CLEAR_SHARE * self.cost && renamed_misfit < MAX_CLEAR_MISFIT)
    }
}

/// The convincing hypothesis of the lowest penalty; none if none convinces.
fn best_hypothesis(
    search: &Search<'_>,
    as_named: &FitAsNamed,
    hypotheses: impl IntoIterator<Item = Hypothesis>,
) -> Option<ScoredHypothesis> {
    hypotheses
        .into_iter()
        .filter_map(|hypothesis| search.score(hypothesis))
        .filter(|scored| as_named.is_beaten_by(scored))
        .min_by(|a, b| a.penalty().total_cmp(&b.penalty()))
}

/// The best of hypotheses 1 and 2 of the module page: the outliers of the majority renamed, or the
/// field mirrored. None for few clicks.
fn rename_outliers_or_mirror(
    search: &Search<'_>,
    as_named: &FitAsNamed,
) -> Option<ScoredHypothesis> {
    if search.clicks.len() < MAJORITY_CLICKS {
        return None;
    }
    let Some((majority, odd_ones)) = search.odd_ones() else {
        return best_hypothesis(search, as_named, search.sides());
    };
    // If a few new names make all clicks fit the majority's camera, the mirrored sides need not be
    // tested.
    let (fitting, others): (Vec<_>, Vec<_>) = odd_ones.into_iter().partition(|hypothesis| {
        let chi_squared = search.chi_squared_near(&majority, hypothesis);
        chi_squared
            .is_some_and(|chi_squared| as_named.renamed_misfit(chi_squared) < MAX_RENAMED_MISFIT)
    });
    best_hypothesis(search, as_named, fitting)
        .or_else(|| best_hypothesis(search, as_named, search.sides().chain(others)))
}

/// The best of hypothesis 3 of the module page: a single mistake. None for many clicks.
fn rename_one_by_one(search: &Search<'_>, as_named: &FitAsNamed) -> Option<ScoredHypothesis> {
    if search.clicks.len() <= FEW_CLICKS {
        best_hypothesis(search, as_named, search.single_mistakes())
    } else {
        None
    }
}
