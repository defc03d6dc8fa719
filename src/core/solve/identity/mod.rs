//! The mistakes that people make with names: two landmarks swapped, the mirrored end or side, a
//! neighbouring line or landmark, one part of the field for another.
//!
//! # Problem
//!
//! A frame's clicks were solved. They may be exact and their names wrong. Three equations are
//! needed for a camera, so two points leave one surplus equation, and a wrong name often fits
//! nearly as well as the right one. Find other names that explain the clicks better, and say what
//! speaks for them.
//!
//! # Method
//!
//! An explanation is a *hypothesis*: the clicks with some names changed. Each is solved and scored
//! by χ² of its clicks, plus χ² of how far its camera is from what the camera usually does (the
//! motion prior), plus a penalty for each changed name. `hypotheses.rs` makes them, in this order:
//!
//! 1. From five clicks on, the camera of the majority is found by a robust loss; the clicks that
//!    contradict it get the nearest fitting names, and the oddest four are swapped pairwise.
//! 2. All names of the mirrored field, for each of its symmetries.
//! 3. Up to six clicks: every swap, and every click left out and renamed by the camera of the
//!    others.
//! 4. A whole part for another (goal area for penalty area), a line for a parallel one.
//!
//! A hypothesis counts as the truth if the clicks contradict each other as named (misfit of 2 and
//! more), fit when renamed (misfit below 2), and χ² falls by 25 and to a quarter. With an imperfect
//! base nothing fits that well; then χ² has to fall to a sixteenth.
//!
//! # What is said
//!
//! * [`Evidence::Clicks`]: the clicks contradict each other as named.
//! * [`Evidence::MotionPrior`]: both fit, and as named the camera does what it never does.
//! * [`Evidence::None`]: both fit and nothing decides. Both are shown, unless frames before and after have decided already.
//!
//! # What it is proof against
//!
//! A frame of many clicks that fit is left alone, which takes no time. It is not proof against a
//! set of wrong names that agree with each other and with the motion of the camera;
//! `calibrate::disagreements` compares frames for that.

mod hypotheses;

use super::{Evidence, FrameSolution, IdentityFinding, Loss, Observation, SolveContext};
use crate::camera::CameraBase;
use crate::field::FieldModel;
use hypotheses::{Hypothesis, Judged, Search};

/// Renaming must lower χ² by this much, and to this share.
const MIN_GAIN: f64 = 25.0;
const MAX_SHARE: f64 = 0.25;

/// As named, the clicks must contradict each other this much (see [`FrameSolution::misfit`]).
const MIN_MISFIT: f64 = 2.0;

/// Renamed, they must fit about as well as clicks do.
const MAX_RENAMED_MISFIT: f64 = 2.0;

/// With an imperfect base no clicks fit that well: then other names must lower χ² to this share,
/// and fit this well.
const CLEAR_SHARE: f64 = 1.0 / 16.0;
const MAX_CLEAR_MISFIT: f64 = 6.0;

/// From this many clicks on the majority is asked first which of them are odd.
const MAJORITY_CLICKS: usize = 5;

/// Up to this many clicks every swap and every single wrong name is tried.
const FEW_CLICKS: usize = 6;

/// With more clicks than this no mirrored side fits as well by chance.
const MIRRORS_FIT_UPTO: usize = 4;

/// Looks for a better or equally good set of names for a solved frame's clicks; the best, if there
/// is one.
///
/// `observations` are those that were solved, made from `field`; without their elements no other
/// name is found for them. A frame of many clicks that fit, and whose camera does what it usually
/// does, is left alone: that takes no time.
#[must_use]
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
    if !contradicted && surprise < MIN_GAIN {
        return if clicks.len() <= MIRRORS_FIT_UPTO {
            search.equal_mirror(solution, surprise)
        } else {
            None
        };
    }
    let as_named = solution.chi_squared + surprise;
    let expected = search.redundancy() as f64
        * (solution.expected_chi_squared / solution.redundancy as f64).max(1.0);
    let convinces = |judged: &Judged| {
        let renamed = judged.chi_squared + judged.surprise;
        let renamed_misfit = (judged.chi_squared / expected).sqrt();
        renamed + MIN_GAIN < as_named
            && (renamed < MAX_SHARE * as_named && renamed_misfit < MAX_RENAMED_MISFIT
                || renamed < CLEAR_SHARE * as_named && renamed_misfit < MAX_CLEAR_MISFIT)
    };
    let best = |hypotheses: Vec<Hypothesis>| {
        let judged = hypotheses
            .into_iter()
            .filter_map(|hypothesis| search.judged(hypothesis))
            .filter(convinces);
        judged.min_by(|a, b| a.penalty().total_cmp(&b.penalty()))
    };
    let by_majority = || {
        if clicks.len() < MAJORITY_CLICKS {
            return None;
        }
        let Some((majority, odd_ones)) = search.odd_ones() else {
            return best(search.sides().collect());
        };
        let fits = |hypothesis: &Hypothesis| {
            let chi_squared = search.chi_squared_near(&majority, hypothesis);
            chi_squared
                .is_some_and(|chi_squared| (chi_squared / expected).sqrt() < MAX_RENAMED_MISFIT)
        };
        // A few other names with which all clicks fit the camera of most of them: a mirrored side
        // is not asked then.
        let (fitting, others): (Vec<_>, Vec<_>) = odd_ones.into_iter().partition(fits);
        best(fitting).or_else(|| best(search.sides().chain(others).collect()))
    };
    // What takes longer is tried only where nothing simpler explains the clicks.
    let one_by_one = || {
        if clicks.len() <= FEW_CLICKS {
            best(search.single_mistakes())
        } else {
            None
        }
    };
    let found = by_majority()
        .or_else(one_by_one)
        .or_else(|| best(search.group_mistakes()))?;
    let evidence = if contradicted {
        Evidence::Clicks
    } else {
        Evidence::MotionPrior
    };
    Some(found.finding(evidence, base, solution))
}
