//! References that contradict each other.
//!
//! Two references that look the same way share features. The features of one, with the rays that
//! its label gives them, say where the other looks, as the forest would; where that is not what the
//! other's label says, one of the two labels is wrong. Which one, a third reference tells: the
//! label that contradicts most others is the one to look at.
//!
//! A grossly wrong label, as one with mirrored names, says that it looks where none of the pictures
//! is like its own: nothing there contradicts it. A reference that shares nothing with those that
//! look nearest is therefore compared with all others, and believed to be wrong if two of them at
//! least say so: one alone may be like it by chance, as repeated boards are.

use super::reference_pairs::{Reference, pairs, seen_from};
use rayon::prelude::*;
use std::collections::BTreeSet;

/// Two references whose labels do not agree.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Contradiction {
    /// Their places among the references, in ascending order.
    pub references: [usize; 2],
    /// How far the overlay of the second lies from where the first says it is, at the worst corner,
    /// px at 1920 px width.
    pub disagreement_px: f64,
    /// Features that the two share.
    pub shared: usize,
}

/// When references contradict each other.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ContradictionOptions {
    /// Labels that differ by less agree, px at 1920 px width. 15 by default: people's clicks make
    /// references differ by about a third of that.
    pub tolerance_px: f64,
    /// Every reference is compared with as many that look nearest to where it looks. 4 by default.
    pub neighbours: usize,
    /// Features compared of each, the strongest. 400 by default.
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

/// At most this many references that share nothing with those beside them are compared with all
/// others.
const MOST_ALONE: usize = 16;

/// At least this many others, far from where a label says that it looks, have to contradict it.
const MANY: usize = 2;

/// The references whose labels contradict each other, the greatest disagreement first.
#[must_use]
pub fn contradictions(
    references: &[Reference],
    options: &ContradictionOptions,
) -> Vec<Contradiction> {
    let near = pairs(references, options.neighbours);
    let mut compared = compare(references, &near, options);
    let alone = (0..references.len()).filter(|index| {
        !compared
            .iter()
            .any(|found| found.references.contains(index))
    });
    let alone: Vec<usize> = alone.take(MOST_ALONE).collect();
    let everywhere: Vec<[usize; 2]> = alone
        .iter()
        .flat_map(|&one| (0..references.len()).map(move |other| [one.min(other), one.max(other)]))
        .filter(|pair| pair[0] != pair[1] && near.binary_search(pair).is_err())
        .collect::<BTreeSet<_>>()
        .into_iter()
        .collect();
    let far = compare(references, &everywhere, options);
    let contradicts = |found: &&Contradiction| !(found.disagreement_px <= options.tolerance_px);
    let by = |index: usize| {
        far.iter()
            .filter(contradicts)
            .filter(|found| found.references.contains(&index))
            .count()
    };
    let wrong: Vec<usize> = alone
        .into_iter()
        .filter(|&index| by(index) >= MANY)
        .collect();
    compared.extend(
        far.iter()
            .filter(|found| wrong.iter().any(|index| found.references.contains(index))),
    );
    let mut found: Vec<Contradiction> = compared.iter().filter(contradicts).copied().collect();
    found.sort_by(|a, b| {
        b.disagreement_px
            .total_cmp(&a.disagreement_px)
            .then(a.references.cmp(&b.references))
    });
    found
}

/// The references to look at: again and again the one that most of the remaining contradictions
/// name, the one with the greater disagreement of equals. Without it they would be gone.
#[must_use]
pub fn suspects(contradictions: &[Contradiction]) -> Vec<usize> {
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

/// How far the labels of pairs are apart, as far as their pictures tell.
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

/// How far a pair's labels are apart; none where the pictures do not tell.
fn disagreement(
    references: &[Reference],
    pair: [usize; 2],
    options: &ContradictionOptions,
) -> Option<Contradiction> {
    let [first, second] = pair.map(|index| &references[index]);
    let pose = seen_from(first, second, options.features)?;
    let disagreement_px = second.disagreement_px(&pose.ptz);
    Some(Contradiction {
        references: pair,
        disagreement_px,
        shared: pose.inliers.len(),
    })
}
