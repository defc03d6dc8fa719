//! Hypotheses about wrong names: sets of clicks with some names changed, and the cameras that fit
//! them. Those about a whole part of the field or a whole line are in `group_mistakes.rs`.

use crate::camera::{CameraBase, Ptz, PtzCamera};
use crate::field::{Curve, FieldElement, FieldModel, Symmetry};
use crate::solve::frame::{best_fit, fit_from};
use crate::solve::{
    ClickResidual, Evidence, FrameSolution, IdentityFinding, IdentityKind, Loss, Name, Observation,
    ObservedShape, PtzStep, Rename, SolveContext,
};

/// A name fits a click that lies within this many sigmas of it.
const FITS_SIGMAS: f64 = 4.0;

/// Clicks with some names changed.
pub(super) struct Hypothesis {
    kind: IdentityKind,
    clicks: Vec<Observation>,
    pub renames: Vec<Rename>,
}

/// A hypothesis with the camera that fits it best.
pub(super) struct ScoredHypothesis {
    hypothesis: Hypothesis,
    ptz: Ptz,
    rms_px: f64,
    pub chi_squared: f64,
    /// The cost of the camera under the motion prior, in units of χ².
    pub surprise: f64,
}

impl ScoredHypothesis {
    /// The cost that ranks hypotheses. Each rename costs 4 (2 σ), so that of equally good
    /// explanations the one that changes least wins.
    pub fn penalty(&self) -> f64 {
        self.chi_squared + self.surprise + 4.0 * self.hypothesis.renames.len() as f64
    }

    /// Reports the hypothesis, with the distance (px) of the farthest renamed click under the
    /// user's names and under the new ones.
    pub fn finding(
        self,
        evidence: Evidence,
        base: &CameraBase,
        solution: &FrameSolution,
    ) -> IdentityFinding {
        let Hypothesis {
            kind,
            renames,
            clicks,
        } = self.hypothesis;
        // Both distances are of the renamed clicks alone: the others fit either way. Where none of
        // them has an image, the mean of all clicks is the best figure there is.
        let is_renamed = |click: usize| renames.iter().any(|rename| rename.click == click);
        let named = solution
            .residuals
            .iter()
            .filter(|residual| is_renamed(residual.click));
        let as_named_px = named
            .filter_map(ClickResidual::distance_px)
            .max_by(f64::total_cmp);
        let camera = PtzCamera::new(*base, self.ptz);
        let renamed = clicks.iter().filter(|click| is_renamed(click.click));
        let renamed_px = renamed
            .filter_map(|click| click.distance_px(&camera))
            .max_by(f64::total_cmp);
        IdentityFinding {
            kind,
            evidence,
            ptz: self.ptz,
            as_named_px: as_named_px.unwrap_or(solution.rms_px),
            renamed_px: renamed_px.unwrap_or(self.rms_px),
            renames,
        }
    }
}

pub(super) struct Search<'a> {
    pub base: &'a CameraBase,
    pub field: &'a FieldModel,
    pub clicks: &'a [Observation],
    pub context: SolveContext,
    /// The deviation of the camera that the motion prior does not penalise.
    pub slack: PtzStep,
}

impl Search<'_> {
    /// Surplus equations, at least 1.
    pub fn redundancy(&self) -> usize {
        let equations: usize = self.clicks.iter().map(Observation::equations).sum();
        equations.saturating_sub(3).max(1)
    }

    pub fn score(&self, hypothesis: Hypothesis) -> Option<ScoredHypothesis> {
        // Other names must not be explained by a camera that this one cannot be.
        let best =
            best_fit(self.base, &hypothesis.clicks, &self.context).filter(|best| best.plausible)?;
        let surprise = self.context.motion.surprise(&best.ptz, &self.slack);
        Some(ScoredHypothesis {
            ptz: best.ptz,
            rms_px: best.rms_px,
            chi_squared: best.chi_squared,
            surprise,
            hypothesis,
        })
    }

    /// Other names for the clicks that contradict the majority, and swaps among the clicks that are
    /// farthest off; with them the camera that fits the majority.
    pub fn odd_ones(&self) -> Option<(PtzCamera, Vec<Hypothesis>)> {
        // Under a heavy-tailed loss the clicks that agree determine the camera; the misnamed ones
        // show as large residuals.
        let majority = self.camera_of(self.clicks, Loss::Cauchy { c: 2.0 })?;
        let off: Vec<f64> = self
            .clicks
            .iter()
            .map(|click| click.distance_sigmas(&majority))
            .collect();
        let found = self
            .by_majority(&majority, &off)
            .into_iter()
            .chain(self.swaps_of_the_oddest(&off))
            .collect();
        Some((majority, found))
    }

    /// χ² of a hypothesis after refinement from a known camera. Takes a fraction of the time of a
    /// search from all starts.
    pub fn chi_squared_near(&self, known: &PtzCamera, hypothesis: &Hypothesis) -> Option<f64> {
        Some(fit_from(self.base, known.ptz(), &hypothesis.clicks, &self.context)?.chi_squared)
    }

    /// All hypotheses of a single mistake: the mirrored sides, every swap of two landmarks, and
    /// every single click with another name.
    pub fn single_mistakes(&self) -> Vec<Hypothesis> {
        self.sides()
            .chain(self.swaps())
            .chain(self.leave_one_out())
            .collect()
    }

    /// All clicks renamed by a symmetry of the field, for each symmetry.
    pub fn sides(&self) -> impl Iterator<Item = Hypothesis> {
        Symmetry::ALL
            .into_iter()
            .filter_map(|side| self.mirror_names(side))
    }

    /// The mirrored side that fits as well as the solution, if any. This matters for few clicks,
    /// which cannot decide between the two sides.
    pub fn equal_mirror(&self, solution: &FrameSolution, surprise: f64) -> Option<IdentityFinding> {
        /// A hypothesis whose χ² is larger by less than this fits as well.
        const EQUAL_FIT: f64 = 4.0;
        // A camera expected from the start or the neighbouring frames decides the side already.
        if self.context.expected_ptz().is_some() {
            return None;
        }
        self.sides()
            .filter_map(|side| self.score(side))
            .filter(|scored| {
                scored.chi_squared + scored.surprise < solution.chi_squared + surprise + EQUAL_FIT
            })
            .min_by(|a, b| a.penalty().total_cmp(&b.penalty()))
            .map(|scored| scored.finding(Evidence::None, self.base, solution))
    }

    /// All clicks renamed by a symmetry; none if an element has no mirror image on this field, or
    /// if nothing would change.
    fn mirror_names(&self, symmetry: Symmetry) -> Option<Hypothesis> {
        let twins: Option<Vec<FieldElement>> = self
            .clicks
            .iter()
            .map(|click| click.element?.twin(symmetry, self.field))
            .collect();
        let Hypothesis {
            clicks, renames, ..
        } = self.with_names(
            IdentityKind::Mirrored(symmetry),
            twins?.into_iter().map(Some),
        )?;
        // If all clicks but two lie on the mirror axis, the renaming only exchanges those two.
        let kind = if self.exchanges_two(&clicks) {
            IdentityKind::Swapped
        } else {
            IdentityKind::Mirrored(symmetry)
        };
        Some(Hypothesis {
            kind,
            clicks,
            renames,
        })
    }

    /// The clicks under new names; a click whose new name is none keeps its own. None if nothing
    /// changes, or if an element does not exist.
    pub fn with_names(
        &self,
        kind: IdentityKind,
        names: impl Iterator<Item = Option<FieldElement>>,
    ) -> Option<Hypothesis> {
        let mut clicks = self.clicks.to_vec();
        let mut renames = Vec::new();
        for (click, element) in clicks.iter_mut().zip(names) {
            let Some(element) = element.filter(|element| click.element != Some(*element)) else {
                continue;
            };
            *click = click.with_element(self.field, element)?;
            let label = element.label(self.field)?.to_owned();
            renames.push(Rename {
                click: click.click,
                name: Name::from_element(element, self.field)?,
                label,
            });
        }
        (!renames.is_empty()).then_some(Hypothesis {
            kind,
            clicks,
            renames,
        })
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
        let (one, two) = (self.landmark_of(i)?, self.landmark_of(j)?);
        let named = (0..self.clicks.len()).map(|index| match index {
            _ if index == i => Some(two),
            _ if index == j => Some(one),
            _ => None,
        });
        self.with_names(IdentityKind::Swapped, named)
    }

    /// The landmark that a click is named; none for a line.
    fn landmark_of(&self, index: usize) -> Option<FieldElement> {
        self.clicks[index]
            .element
            .filter(|element| matches!(element, FieldElement::Landmark(_)))
    }

    /// Leaves out each click in turn, solves the camera from the others, and names the click by
    /// what that camera sees there.
    fn leave_one_out(&self) -> Vec<Hypothesis> {
        let mut found = Vec::new();
        for left_out in 0..self.clicks.len() {
            let mut others = self.clicks.to_vec();
            others.remove(left_out);
            // The remaining clicks are presumed right, so a plain square uses all of their
            // information.
            if let Some(camera) = self.camera_of(&others, Loss::Squared) {
                found.extend(self.rename_odd_clicks(&camera, &[left_out]));
            }
        }
        found
    }

    /// New names for the clicks that contradict the majority's camera; `off` is each click's
    /// distance there, sigmas.
    fn by_majority(&self, camera: &PtzCamera, off: &[f64]) -> Option<Hypothesis> {
        let odd: Vec<usize> = (0..off.len()).filter(|&i| off[i] > FITS_SIGMAS).collect();
        // Without a majority on the other side, nothing contradicts them.
        if odd.is_empty() || 2 * odd.len() > self.clicks.len() {
            return None;
        }
        self.rename_odd_clicks(camera, &odd)
    }

    /// Every swap among the clicks that are farthest off in the majority's camera. Where the base
    /// is imperfect, correct clicks are off as well and no new name fits within [`FITS_SIGMAS`],
    /// but the wrong ones are still the farthest off.
    fn swaps_of_the_oddest(&self, off: &[f64]) -> Vec<Hypothesis> {
        const ODDEST: usize = 4;
        let mut order: Vec<usize> = (0..off.len()).collect();
        order.sort_by(|&a, &b| off[b].total_cmp(&off[a]));
        order.truncate(ODDEST);
        // In the order of the clicks again: of equally good swaps the first one wins.
        order.sort_unstable();
        let pairs = order
            .iter()
            .enumerate()
            .flat_map(|(k, &i)| order[k + 1..].iter().map(move |&j| (i, j)));
        pairs.filter_map(|(i, j)| self.swap(i, j)).collect()
    }

    fn camera_of(&self, clicks: &[Observation], loss: Loss) -> Option<PtzCamera> {
        let context = SolveContext {
            loss,
            ..self.context.clone()
        };
        let best = best_fit(self.base, clicks, &context).filter(|best| best.plausible)?;
        Some(PtzCamera::new(*self.base, best.ptz))
    }

    /// The clicks with new names for the odd ones, those that fit in `camera`; none if one of them
    /// fits nothing.
    fn rename_odd_clicks(&self, camera: &PtzCamera, odd: &[usize]) -> Option<Hypothesis> {
        let mut named = vec![None; self.clicks.len()];
        for &index in odd {
            named[index] = Some(self.name_for(camera, &self.clicks[index])?);
        }
        let found = self.with_names(IdentityKind::WrongName, named.into_iter())?;
        let kind = if self.exchanges_two(&found.clicks) {
            IdentityKind::Swapped
        } else {
            IdentityKind::WrongName
        };
        Some(Hypothesis { kind, ..found })
    }

    /// Whether the clicks differ from the user's only in two exchanged names.
    fn exchanges_two(&self, clicks: &[Observation]) -> bool {
        let changed: Vec<usize> = (0..clicks.len())
            .filter(|&i| clicks[i].element != self.clicks[i].element)
            .collect();
        matches!(*changed, [i, j]
            if clicks[i].element == self.clicks[j].element && clicks[j].element == self.clicks[i].element)
    }

    /// The nearest other landmark (for a click on a line: the nearest other line) within
    /// [`FITS_SIGMAS`] of a click.
    fn name_for(&self, camera: &PtzCamera, click: &Observation) -> Option<FieldElement> {
        let named = click.element?;
        let others = named.alike(self.field).filter(|element| *element != named);
        let fitting = others.filter_map(|element| {
            let renamed = click.with_element(self.field, element)?;
            let distance = renamed
                .distance_px(camera)
                .filter(|distance| *distance < FITS_SIGMAS * click.sigma_px)?;
            reaches(camera, &renamed).then_some((distance, element))
        });
        fitting
            .min_by(|a, b| a.0.total_cmp(&b.0))
            .map(|(_, element)| element)
    }
}

/// Whether the paint of a line reaches the click. Beyond its ends, the straight continuation shows
/// another line, or none. True for points and arcs.
fn reaches(camera: &PtzCamera, click: &Observation) -> bool {
    /// Tolerance beyond either end, as a fraction of the line's length.
    const END_TOLERANCE: f64 = 0.1;
    let ObservedShape::Curve(curve) = &click.shape else {
        return true;
    };
    if !matches!(curve.nominal(), Curve::Segment { .. }) {
        return true;
    }
    let nearest = click.shape.jacobian(camera, click.image);
    nearest.is_some_and(|here| (-END_TOLERANCE..=1.0 + END_TOLERANCE).contains(&here.parameter))
}
