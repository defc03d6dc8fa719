//! The mistakes that people make with names: two landmarks swapped, the mirrored end or side, a neighbouring line or
//! landmark, one part of the field for another.
//!
//! Every explanation is a set of clicks with some names changed. It counts as the truth where the clicks contradict each
//! other as named and fit when renamed; where a few clicks fit both ways, what the camera usually does decides, and where
//! that is not known either, both are shown.

mod describe;
mod hypotheses;

use super::{FrameSolution, Loss, Observation, SolveContext};
use crate::camera::{CameraBase, Ptz};
use crate::field::{FieldElement, FieldModel, LandmarkId, LineId, Symmetry};
use hypotheses::{Judged, Search};
use serde::{Serialize, Serializer};

/// Renaming must lower χ² by this much, and to this share.
const MIN_GAIN: f64 = 25.0;
const MAX_SHARE: f64 = 0.25;

/// As named, the clicks must contradict each other this much (see [`FrameSolution::misfit`]).
const MIN_MISFIT: f64 = 2.0;

/// Renamed, they must fit about as well as clicks do.
const MAX_RENAMED_MISFIT: f64 = 2.0;

/// With an imperfect base no clicks fit that well: then other names must lower χ² to this share, and fit this well.
const CLEAR_SHARE: f64 = 1.0 / 16.0;
const MAX_CLEAR_MISFIT: f64 = 6.0;

/// From this many clicks on the majority is asked first which of them are odd.
const MAJORITY_CLICKS: usize = 5;

/// Up to this many clicks every swap and every single wrong name is tried.
const FEW_CLICKS: usize = 6;

/// With more clicks than this no mirrored side fits as well by chance.
const MIRRORS_FIT_UPTO: usize = 4;

/// What is wrong with the names.
#[derive(Clone, Debug, PartialEq, Eq, Serialize)]
#[serde(rename_all = "snake_case")]
#[non_exhaustive]
pub enum IdentityKind {
    /// Two names are exchanged.
    Swapped,
    /// All names are of the mirrored side.
    Mirrored(Symmetry),
    /// One or more clicks are of another landmark or line.
    WrongName,
    /// One part of the field was taken for another that has points of the same names.
    OtherPart {
        /// The part as named, in words: "penalty area".
        named: String,
        /// The part that fits.
        fits: String,
    },
}

/// What speaks for the other names.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize)]
#[serde(rename_all = "snake_case")]
pub enum Evidence {
    /// The clicks contradict each other as named.
    Clicks,
    /// Both fit, but as named the camera does what it never does.
    MotionPrior,
    /// Nothing: both fit, and the picture alone cannot tell.
    None,
}

/// A new name for a click.
#[derive(Clone, Debug, PartialEq, Eq, Serialize)]
pub struct Rename {
    /// Which click, from 0.
    pub click: usize,
    /// What it shows.
    pub name: Name,
    /// What a person reads.
    pub label: String,
}

/// The name of a landmark or line.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum Name {
    /// A landmark.
    Landmark(LandmarkId),
    /// A line.
    Line(LineId),
}

impl Serialize for Name {
    fn serialize<S: Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        serializer.serialize_str(self.as_str())
    }
}

impl Name {
    /// The name of a field's landmark or line; none if the field has no such element.
    fn of(element: FieldElement, field: &FieldModel) -> Option<Self> {
        match element {
            FieldElement::Landmark(index) => field.landmarks.get(index).map(|known| Self::Landmark(known.id.clone())),
            FieldElement::Line(index) => field.lines.get(index).map(|known| Self::Line(known.id.clone())),
        }
    }

    /// As documents write it.
    #[must_use]
    pub fn as_str(&self) -> &str {
        match self {
            Self::Landmark(id) => id.as_str(),
            Self::Line(id) => id.as_str(),
        }
    }
}

/// Another set of names that fits better, or as well.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct IdentityFinding {
    /// What is wrong.
    pub kind: IdentityKind,
    /// What speaks for it.
    pub evidence: Evidence,
    /// What to change: apply all of them to mend it.
    pub renames: Vec<Rename>,
    /// The camera under the new names.
    pub ptz: Ptz,
    /// Root mean square distance of the clicks as named, px.
    pub as_named_px: f64,
    /// The same under the new names.
    pub renamed_px: f64,
}

/// Looks for a better or equally good set of names for a solved frame's clicks; the best, if there is one.
///
/// `observations` are those that were solved, made from `field`; without their elements no other name is found for them. A frame of many clicks that fit, and whose camera does
/// what it usually does, is left alone: that takes no time.
#[must_use]
pub fn check_identity(
    base: &CameraBase,
    field: &FieldModel,
    observations: &[Observation],
    solution: &FrameSolution,
    context: &SolveContext,
) -> Option<IdentityFinding> {
    let clicks: Vec<Observation> = observations.iter().filter(|click| !click.check).copied().collect();
    let slack = solution.slack();
    let search = Search {
        base,
        field,
        clicks: &clicks,
        context: SolveContext { loss: Loss::Squared, ..context.clone() },
        slack,
    };
    let misfit = solution.misfit()?;
    let surprise = context.motion.surprise(&solution.ptz, &slack);
    let contradicted = misfit >= MIN_MISFIT;
    if !contradicted && surprise < MIN_GAIN {
        return if clicks.len() <= MIRRORS_FIT_UPTO { search.equal_mirror(solution, surprise) } else { None };
    }
    let as_named = solution.chi_squared + surprise;
    let expected = search.redundancy() as f64 * (solution.expected_chi_squared / solution.redundancy as f64).max(1.0);
    let convinces = |judged: &Judged| {
        let renamed = judged.chi_squared + judged.surprise;
        let renamed_misfit = (judged.chi_squared / expected).sqrt();
        renamed + MIN_GAIN < as_named
            && (renamed < MAX_SHARE * as_named && renamed_misfit < MAX_RENAMED_MISFIT
                || renamed < CLEAR_SHARE * as_named && renamed_misfit < MAX_CLEAR_MISFIT)
    };
    let best = |hypotheses: Vec<hypotheses::Hypothesis>| {
        let judged = hypotheses.into_iter().filter_map(|hypothesis| search.judged(hypothesis)).filter(convinces);
        judged.min_by(|a, b| a.penalty().total_cmp(&b.penalty()))
    };
    // What takes longer is tried only where nothing simpler explains the clicks.
    let by_majority = || if clicks.len() >= MAJORITY_CLICKS { best(search.sides_and_odd_ones()) } else { None };
    let one_by_one = || if clicks.len() <= FEW_CLICKS { best(search.single_mistakes()) } else { None };
    let found = by_majority().or_else(one_by_one).or_else(|| best(search.group_mistakes()))?;
    let evidence = if contradicted { Evidence::Clicks } else { Evidence::MotionPrior };
    Some(found.finding(evidence, solution.rms_px))
}
