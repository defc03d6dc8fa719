//! The mistakes that people make with names: two landmarks swapped, the mirrored end or side, a neighbouring line or
//! landmark.
//!
//! Every explanation is a set of clicks with some names changed. It counts as the truth where the clicks contradict each
//! other as named and fit when renamed; where a few clicks fit both ways, the picture alone cannot tell and both are shown.

use super::frame::best_fit;
use super::refine::distance_px;
use super::{FrameSolution, Loss, Observation, SolveContext, Target, Warning, WarningCode, WorldCurve};
use crate::camera::{CameraBase, Ptz, PtzCamera};
use crate::field::{FieldModel, LandmarkId, LineId, Symmetry};
use crate::geometry::Vec3;

/// Renaming must lower χ² by this much, and to this share.
const MIN_GAIN: f64 = 25.0;
const MAX_SHARE: f64 = 0.25;

/// As named, the clicks must contradict each other this much (see [`FrameSolution::misfit`]).
const MIN_MISFIT: f64 = 2.0;

/// Renamed, they must fit about as well as clicks do.
const MAX_RENAMED_MISFIT: f64 = 2.0;

/// A name fits a click that lies within this many sigmas of it.
const FITS_SIGMAS: f64 = 4.0;

/// Up to this many clicks every swap and every single wrong name is tried; with more the majority finds the odd ones.
const FEW_CLICKS: usize = 6;

/// What is wrong with the names.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum IdentityKind {
    /// Two names are exchanged.
    Swapped,
    /// All names are of the mirrored side.
    Mirrored(Symmetry),
    /// One or more clicks are of another landmark or line.
    WrongName,
}

/// A new name for a click.
#[derive(Clone, Debug, PartialEq)]
pub struct Rename {
    /// Which click, from 0.
    pub click: usize,
    /// What it shows.
    pub name: Name,
}

/// The name of a landmark or line.
#[derive(Clone, Debug, PartialEq)]
pub enum Name {
    /// A landmark.
    Landmark(LandmarkId),
    /// A line.
    Line(LineId),
}

impl Name {
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
#[derive(Clone, Debug, PartialEq)]
pub struct IdentityFinding {
    /// What is wrong.
    pub kind: IdentityKind,
    /// The clicks contradict each other as named; otherwise both sets of names fit.
    pub certain: bool,
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
/// `observations` are those that were solved, made from `field`. A frame whose three or more clicks fit is left alone: that
/// takes no time.
#[must_use]
pub fn check_identity(
    base: &CameraBase,
    field: &FieldModel,
    observations: &[Observation],
    solution: &FrameSolution,
    context: &SolveContext,
) -> Option<IdentityFinding> {
    let clicks: Vec<Observation> = observations.iter().filter(|click| !click.check).copied().collect();
    let search =
        Search { base, field, clicks: &clicks, context: SolveContext { loss: Loss::Squared, ..context.clone() } };
    let misfit = solution.misfit()?;
    if misfit < MIN_MISFIT {
        return if clicks.len() <= 3 { search.equal_mirror(solution) } else { None };
    }
    let mut hypotheses = Vec::new();
    hypotheses.extend(Symmetry::ALL.into_iter().filter_map(|symmetry| search.mirrored(symmetry)));
    if clicks.len() <= FEW_CLICKS {
        hypotheses.extend(search.swaps());
        hypotheses.extend(search.left_out_one_by_one());
    } else {
        hypotheses.extend(search.by_majority());
    }
    let best = hypotheses.into_iter().filter_map(|hypothesis| search.judged(hypothesis)).min_by(|a, b| {
        // Of equally good explanations the one that changes least.
        let penalty = |judged: &Judged| judged.chi_squared + 4.0 * judged.hypothesis.renames.len() as f64;
        penalty(a).total_cmp(&penalty(b))
    })?;
    let expected = search.redundancy() as f64 * (solution.expected_chi_squared / solution.redundancy as f64).max(1.0);
    let convinces = best.chi_squared + MIN_GAIN < solution.chi_squared
        && best.chi_squared < MAX_SHARE * solution.chi_squared
        && (best.chi_squared / expected).sqrt() < MAX_RENAMED_MISFIT;
    convinces.then(|| best.finding(true, solution.rms_px))
}

/// Clicks with some names changed.
struct Hypothesis {
    kind: IdentityKind,
    clicks: Vec<Observation>,
    renames: Vec<Rename>,
}

/// A hypothesis with the camera that fits it best.
struct Judged {
    hypothesis: Hypothesis,
    ptz: Ptz,
    rms_px: f64,
    chi_squared: f64,
}

impl Judged {
    fn finding(self, certain: bool, as_named_px: f64) -> IdentityFinding {
        let Hypothesis { kind, renames, .. } = self.hypothesis;
        IdentityFinding { kind, certain, renames, ptz: self.ptz, as_named_px, renamed_px: self.rms_px }
    }
}

struct Search<'a> {
    base: &'a CameraBase,
    field: &'a FieldModel,
    clicks: &'a [Observation],
    context: SolveContext,
}

impl Search<'_> {
    fn redundancy(&self) -> usize {
        let equations: usize = self.clicks.iter().map(|click| click.target.equations()).sum();
        equations.saturating_sub(3).max(1)
    }

    fn judged(&self, hypothesis: Hypothesis) -> Option<Judged> {
        let best = best_fit(self.base, &hypothesis.clicks, &self.context).filter(|best| best.plausible)?;
        Some(Judged { ptz: best.ptz, rms_px: best.rms_px, chi_squared: best.chi_squared, hypothesis })
    }

    /// Two or three clicks that fit: does the mirrored side fit them as well?
    fn equal_mirror(&self, solution: &FrameSolution) -> Option<IdentityFinding> {
        /// χ² that is no evidence against a set of names.
        const AS_WELL: f64 = 4.0;
        // What the frames before and after saw, or the camera's range, has decided already.
        if self.context.expected().is_some() {
            return None;
        }
        let mirrors = Symmetry::ALL.into_iter().filter_map(|symmetry| self.judged(self.mirrored(symmetry)?));
        mirrors
            .filter(|judged| judged.chi_squared < solution.chi_squared + AS_WELL)
            .min_by(|a, b| a.chi_squared.total_cmp(&b.chi_squared))
            .map(|judged| judged.finding(false, solution.rms_px))
    }

    /// All names of the mirrored side; none if the field lacks one of them, or nothing would change.
    fn mirrored(&self, symmetry: Symmetry) -> Option<Hypothesis> {
        let mut clicks = self.clicks.to_vec();
        let mut renames = Vec::new();
        for click in &mut clicks {
            let (name, target) = match click.target {
                Target::Landmark(at) => {
                    let twin = symmetry.landmark_twin(self.field, self.landmark_at(at)?)?;
                    (Name::Landmark(twin.id.clone()), Target::Landmark(self.field.landmark_in_world(twin)))
                }
                Target::Line(curve) => {
                    let line = self.field.lines.iter().find(|line| line.curve == *curve.nominal())?;
                    let twin = symmetry.line_twin(self.field, line)?;
                    (Name::Line(twin.id.clone()), Target::Line(WorldCurve::on_field(self.field, twin.curve)))
                }
            };
            if target != click.target {
                click.target = target;
                renames.push(Rename { click: click.click, name });
            }
        }
        // Where all but two clicks lie on the mirror, it is a swap.
        let kind = if self.exchanges_two(&clicks) { IdentityKind::Swapped } else { IdentityKind::Mirrored(symmetry) };
        (!renames.is_empty()).then_some(Hypothesis { kind, clicks, renames })
    }

    fn landmark_at(&self, at: Vec3) -> Option<&crate::field::Landmark> {
        const SAME_PLACE_M: f64 = 1e-6;
        self.field.landmarks.iter().find(|landmark| (self.field.landmark_in_world(landmark) - at).norm() < SAME_PLACE_M)
    }

    /// Every pair of landmarks exchanged.
    fn swaps(&self) -> Vec<Hypothesis> {
        let mut found = Vec::new();
        for i in 0..self.clicks.len() {
            for j in i + 1..self.clicks.len() {
                found.extend(self.swap(i, j));
            }
        }
        found
    }

    fn swap(&self, i: usize, j: usize) -> Option<Hypothesis> {
        let (Target::Landmark(one), Target::Landmark(two)) = (self.clicks[i].target, self.clicks[j].target) else {
            return None;
        };
        let mut clicks = self.clicks.to_vec();
        (clicks[i].target, clicks[j].target) = (Target::Landmark(two), Target::Landmark(one));
        let rename = |index: usize, at: Vec3| {
            let name = Name::Landmark(self.landmark_at(at)?.id.clone());
            Some(Rename { click: self.clicks[index].click, name })
        };
        Some(Hypothesis { kind: IdentityKind::Swapped, clicks, renames: vec![rename(i, two)?, rename(j, one)?] })
    }

    /// Each click left out in turn: what would it show in the camera that the others see?
    fn left_out_one_by_one(&self) -> Vec<Hypothesis> {
        let mut found = Vec::new();
        for left_out in 0..self.clicks.len() {
            let mut others = self.clicks.to_vec();
            others.remove(left_out);
            if let Some(camera) = self.camera_of(&others, Loss::Squared) {
                found.extend(self.renamed(&camera, &[left_out]));
            }
        }
        found
    }

    /// The camera that most clicks agree on, and new names for the others.
    fn by_majority(&self) -> Option<Hypothesis> {
        let camera = self.camera_of(self.clicks, Loss::Cauchy { c: 2.0 })?;
        let odd: Vec<usize> = (0..self.clicks.len())
            .filter(|&i| {
                let click = &self.clicks[i];
                distance_px(&camera, click).is_none_or(|distance| distance > FITS_SIGMAS * click.sigma_px)
            })
            .collect();
        // More odd ones than others are no majority.
        if odd.is_empty() || 2 * odd.len() > self.clicks.len() {
            return None;
        }
        self.renamed(&camera, &odd)
    }

    fn camera_of(&self, clicks: &[Observation], loss: Loss) -> Option<PtzCamera> {
        let context = SolveContext { loss, ..self.context.clone() };
        let best = best_fit(self.base, clicks, &context).filter(|best| best.plausible)?;
        Some(PtzCamera::new(*self.base, best.ptz))
    }

    /// The clicks with the odd ones named as they fit; none if one of them fits nothing.
    fn renamed(&self, camera: &PtzCamera, odd: &[usize]) -> Option<Hypothesis> {
        let mut clicks = self.clicks.to_vec();
        let mut renames = Vec::new();
        for &index in odd {
            let (name, target) = self.name_for(camera, &self.clicks[index])?;
            clicks[index].target = target;
            renames.push(Rename { click: clicks[index].click, name });
        }
        let kind = if self.exchanges_two(&clicks) { IdentityKind::Swapped } else { IdentityKind::WrongName };
        Some(Hypothesis { kind, clicks, renames })
    }

    /// Whether clicks differ from the given ones in two names that changed places.
    fn exchanges_two(&self, clicks: &[Observation]) -> bool {
        let changed: Vec<usize> = (0..clicks.len()).filter(|&i| clicks[i].target != self.clicks[i].target).collect();
        matches!(*changed, [i, j]
            if clicks[i].target == self.clicks[j].target && clicks[j].target == self.clicks[i].target)
    }

    /// The landmark (for a click on a line: the line) nearest to a click, if it fits.
    fn name_for(&self, camera: &PtzCamera, click: &Observation) -> Option<(Name, Target)> {
        let candidates: Vec<(Name, Target)> = match click.target {
            Target::Landmark(_) => self
                .field
                .landmarks
                .iter()
                .map(|landmark| {
                    (Name::Landmark(landmark.id.clone()), Target::Landmark(self.field.landmark_in_world(landmark)))
                })
                .collect(),
            Target::Line(_) => self
                .field
                .lines
                .iter()
                .map(|line| (Name::Line(line.id.clone()), Target::Line(WorldCurve::on_field(self.field, line.curve))))
                .collect(),
        };
        candidates
            .into_iter()
            .filter(|(_, target)| *target != click.target)
            .filter_map(|(name, target)| {
                let distance = distance_px(camera, &Observation { target, ..*click })?;
                (distance < FITS_SIGMAS * click.sigma_px).then_some((distance, name, target))
            })
            .min_by(|a, b| a.0.total_cmp(&b.0))
            .map(|(_, name, target)| (name, target))
    }
}

impl IdentityFinding {
    /// What a person reads.
    #[must_use]
    pub fn warning(&self) -> Warning {
        let (before, after) = (self.as_named_px, self.renamed_px);
        let clicks: Vec<usize> = self.renames.iter().map(|rename| rename.click).collect();
        let numbers = clicks.iter().map(|click| (click + 1).to_string()).collect::<Vec<_>>();
        let (code, message) = match self.kind {
            IdentityKind::Swapped => (
                WarningCode::Swapped,
                format!(
                    "Points {} look swapped: {before:.0} px as named, {after:.1} px swapped.",
                    numbers.join(" and ")
                ),
            ),
            IdentityKind::Mirrored(symmetry) => {
                let (end, what) = match symmetry {
                    Symmetry::MirrorX => ("other end", "left/right"),
                    Symmetry::MirrorY => ("other side", "near/far"),
                    Symmetry::Turn180 => ("opposite corner", "left/right and near/far"),
                };
                let message = if self.certain {
                    format!(
                        "The names look mirrored: {before:.0} px as named, {after:.1} px on the {end}. Check {what}."
                    )
                } else {
                    format!("The {end} fits as well. Check {what}.")
                };
                (WarningCode::Mirrored, message)
            }
            IdentityKind::WrongName => {
                let names = self.renames.iter().map(|rename| rename.name.as_str()).collect::<Vec<_>>().join(", ");
                let numbers = numbers.join(", ");
                let points = match clicks.len() {
                    1 => format!("Point {numbers} fits"),
                    _ => format!("Points {numbers} fit"),
                };
                let message = format!("{points} elsewhere: {before:.0} px as named, {after:.1} px as {names}.");
                (WarningCode::WrongLine, message)
            }
        };
        let clicks = if matches!(self.kind, IdentityKind::Mirrored(_)) { Vec::new() } else { clicks };
        Warning { code, message, clicks }
    }
}
