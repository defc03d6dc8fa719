//! References that contradict each other.
//!
//! Two references with overlapping views share features. The features of one, with the rays from
//! its label, determine where the other looks, as a forest would; if its label says otherwise, one
//! of the two labels is wrong. A third reference decides which: the label that contradicts most
//! others is the suspect.
//!
//! A grossly wrong label, for instance with mirrored names, points where no other picture is
//! similar, so no neighbour contradicts it. A reference that shares nothing with its neighbours is
//! therefore compared with all others, and reported if at least two of them contradict it: a single
//! one may be similar by chance, as repeated boards are.

use super::reference_pairs::{Reference, pairs, pose_from_reference};
use rayon::prelude::*;
use std::collections::BTreeSet;

/// Two references whose labels do not agree.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Contradiction {
    /// Their indices, ascending.
    pub references: [usize; 2],
    /// The distance between the overlay of the second and where the first places it, at the worst
    /// corner, px at 1920 px width.
    pub disagreement_px: f64,
    /// Number of inliers that the two share.
    pub shared: usize,
}

impl Contradiction {
    fn exceeds(&self, tolerance_px: f64) -> bool {
        // The negated comparison also counts NaN and infinity as contradictions.
        !(self.disagreement_px <= tolerance_px)
    }
}

/// Options of [`contradictions()`].
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ContradictionOptions {
    /// Labels that differ by less agree, px at 1920 px width. Default: 15; click noise makes
    /// references differ by about a third of that.
    pub tolerance_px: f64,
    /// Number of nearest neighbours with which each reference is compared. Default: 4.
    pub neighbours: usize,
    /// Number of features of each that are compared, the strongest. Default: 400.
    pub features: usize,
}

impl Default for ContradictionOptions {
    fn default() -> Self {
        Self {
            tolerance_px: 15.0,
            neighbours: 4,
            features: 400,
        }
    }
}

/// Maximum number of isolated references that are compared with all others.
const MOST_ALONE: usize = 16;

/// Minimum number of distant references that must contradict an isolated one.
const MIN_AGAINST: usize = 2;

/// Pairs of references whose labels contradict each other, the greatest disagreement first.
pub fn contradictions(
    references: &[Reference],
    options: &ContradictionOptions,
) -> Vec<Contradiction> {
    // Compare neighbours first; references that gave no result are isolated.
    let near = pairs(references, options.neighbours);
    let mut compared = compare(references, &near, options);
    let alone = (0..references.len()).filter(|index| {
        !compared
            .iter()
            .any(|found| found.references.contains(index))
    });
    let alone: Vec<usize> = alone.take(MOST_ALONE).collect();
    // Compare isolated references with all others; keep a comparison only if enough others
    // contradict the label. `pairs` returns its pairs ascending, which the search relies on; the
    // set removes pairs of two isolated references that come from both.
    let everywhere: Vec<[usize; 2]> = alone
        .iter()
        .flat_map(|&one| (0..references.len()).map(move |other| [one.min(other), one.max(other)]))
        .filter(|pair| pair[0] != pair[1] && near.binary_search(pair).is_err())
        .collect::<BTreeSet<_>>()
        .into_iter()
        .collect();
    let far = compare(references, &everywhere, options);
    let wrong: Vec<usize> = alone
        .into_iter()
        .filter(|index| {
            let against = far.iter().filter(|found| {
                found.exceeds(options.tolerance_px) && found.references.contains(index)
            });
            against.count() >= MIN_AGAINST
        })
        .collect();
    compared.extend(
        far.iter()
            .filter(|found| wrong.iter().any(|index| found.references.contains(index))),
    );
    let mut found: Vec<Contradiction> = compared
        .into_iter()
        .filter(|found| found.exceeds(options.tolerance_px))
        .collect();
    found.sort_by(|a, b| {
        b.disagreement_px
            .total_cmp(&a.disagreement_px)
            .then(a.references.cmp(&b.references))
    });
    found
}

/// The suspects: repeatedly the reference with the most remaining contradictions, of equals the one
/// with the greatest disagreement. Its contradictions are removed before the next. A greedy vertex
/// cover: without the suspects no contradiction remains.
pub fn suspects(contradictions: &[Contradiction]) -> Vec<usize> {
    // The smallest cover is NP-hard to find, and a greedy one is found at once. The map is ordered,
    // so that equal counts give the same suspect in every run.
    let mut rest = contradictions.to_vec();
    let mut suspects = Vec::new();
    while !rest.is_empty() {
        let mut counts = std::collections::BTreeMap::<usize, (usize, f64)>::new();
        for contradiction in &rest {
            for reference in contradiction.references {
                let (count, most) = counts.entry(reference).or_default();
                (*count, *most) = (*count + 1, most.max(contradiction.disagreement_px));
            }
        }
        let worst = counts
            .iter()
            .max_by(|(_, a), (_, b)| a.0.cmp(&b.0).then(a.1.total_cmp(&b.1)));
        let Some((&worst, _)) = worst else { break };
        suspects.push(worst);
        rest.retain(|contradiction| !contradiction.references.contains(&worst));
    }
    suspects
}

/// The disagreement of each pair of labels, where their pictures determine it.
fn compare(
    references: &[Reference],
    pairs: &[[usize; 2]],
    options: &ContradictionOptions,
) -> Vec<Contradiction> {
    pairs
        .par_iter()
        .filter_map(|pair| disagreement(references, *pair, options))
        .collect()
}

/// The disagreement of a pair of labels; `None` if their pictures do not determine it.
fn disagreement(
    references: &[Reference],
    pair: [usize; 2],
    options: &ContradictionOptions,
) -> Option<Contradiction> {
    let [first, second] = pair.map(|index| &references[index]);
    let pose = pose_from_reference(first, second, options.features)?;
    let disagreement_px = second.disagreement_px(&pose.ptz);
    Some(Contradiction {
        references: pair,
        disagreement_px,
        shared: pose.inliers.len(),
    })
}
