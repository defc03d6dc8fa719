//! Hypotheses that all clicks on one part of the field, or on one line, have the names of another.

use super::hypotheses::{Hypothesis, Search};
use crate::field::{Curve, FieldElement};
use crate::solve::{IdentityKind, Observation};
use std::collections::BTreeSet;

/// Maximum number of hypotheses about parts of the field and lines; those with the most clicks come
/// first.
const MAX_GROUPS: usize = 12;

impl Search<'_> {
    /// All clicks on one part of the field, or on one line, renamed to another part or line.
    pub fn group_mistakes(&self) -> Vec<Hypothesis> {
        let mut found = self.other_parts();
        found.extend(self.parallel_lines());
        // Stable: the same order on every run.
        found.sort_by_key(|hypothesis| std::cmp::Reverse(hypothesis.renames.len()));
        found.truncate(MAX_GROUPS);
        found
    }

    /// Two or more clicks on a part of the field, renamed to the same points of another part. Parts
    /// are recognised by their ids: those of goal area and penalty area, for example, differ only
    /// in their beginning.
    fn other_parts(&self) -> Vec<Hypothesis> {
        // All pairs (part, other part): every prefix up to an underscore of a clicked id, with
        // every prefix that has the same rest in another id of the field.
        let mut parts: BTreeSet<(String, String)> = BTreeSet::new();
        for element in self.clicks.iter().filter_map(|click| click.element) {
            let Some(id) = element.name(self.field) else {
                continue;
            };
            for (end, _) in id.match_indices('_') {
                let (part, rest) = id.split_at(end);
                let ids = element
                    .alike(self.field)
                    .filter_map(|other| other.name(self.field));
                let others = ids.filter_map(|other| other.strip_suffix(rest));
                parts.extend(
                    others
                        .filter(|other| *other != part)
                        .map(|other| (part.to_owned(), other.to_owned())),
                );
            }
        }

        // A hypothesis for each pair. Different pairs may give the same renames; each set of
        // renames is tried once.
        let mut found: Vec<Hypothesis> = Vec::new();
        // In reverse order, of prefixes of one id the longest comes first: it describes the part
        // best.
        for (part, other) in parts.into_iter().rev() {
            let renamed = self
                .clicks
                .iter()
                .map(|click| self.in_part(click.element?, &part, &other));
            let [named, fits] = [&part, &other].map(|part| part.replace('_', " "));
            let kind = IdentityKind::OtherPart { named, fits };
            let Some(hypothesis) = self.with_names(kind, renamed) else {
                continue;
            };
            if hypothesis.renames.len() > 1
                && found
                    .iter()
                    .all(|known| known.renames != hypothesis.renames)
            {
                found.push(hypothesis);
            }
        }
        found
    }

    /// The element of the other part that has the same rest of its id.
    fn in_part(&self, element: FieldElement, part: &str, other: &str) -> Option<FieldElement> {
        let rest = element
            .name(self.field)?
            .strip_prefix(part)
            .filter(|rest| rest.starts_with('_'))?;
        let id = format!("{other}{rest}");
        element
            .alike(self.field)
            .find(|element| element.name(self.field) == Some(&id))
    }

    /// Two or more clicks on a straight line, renamed to a parallel line.
    fn parallel_lines(&self) -> Vec<Hypothesis> {
        let mut found = Vec::new();
        for (index, click) in self.clicks.iter().enumerate() {
            let Some(FieldElement::Line(line)) = click.element else {
                continue;
            };
            // Handle each line once, at its first click, and only with a second click on it.
            let on_it = |other: &Observation| other.element == click.element;
            let first = !self.clicks[..index].iter().any(on_it);
            if !first || !self.clicks[index + 1..].iter().any(on_it) {
                continue;
            }
            let Some(named) = self.field.lines.get(line) else {
                continue;
            };
            for (other, _) in self
                .field
                .lines
                .iter()
                .enumerate()
                .filter(|(_, other)| are_parallel(&named.curve, &other.curve))
            {
                let renamed = self
                    .clicks
                    .iter()
                    .map(|click| on_it(click).then_some(FieldElement::Line(other)));
                found.extend(self.with_names(IdentityKind::WrongName, renamed));
            }
        }
        found
    }
}

/// Whether both curves are straight lines and parallel.
fn are_parallel(one: &Curve, two: &Curve) -> bool {
    /// Maximum sine of the angle between parallel lines.
    const SAME_WAY: f64 = 1e-6;
    match (one, two) {
        (
            Curve::Segment { from, to },
            Curve::Segment {
                from: start,
                to: end,
            },
        ) => {
            (to - from)
                .normalize()
                .cross(&(end - start).normalize())
                .norm()
                < SAME_WAY
        }
        _ => false,
    }
}
