//! What a step did to the suggestions that frames show. Undo and redo work on the document without
//! suggestions, because those of the forest come and go by themselves; what a command of the user
//! suggested or discarded is kept with its step, so that undo gives it back.

use crate::document::{Document, Frame, FrameId, Shared, Suggestion};
use serde::{Deserialize, Serialize};
use std::collections::BTreeMap;

/// The suggestion that a frame shows before a step and after it. It has no base and no revision:
/// both are those of the frame to which it is given back.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct SuggestionChange {
    /// Which frame.
    pub id: FrameId,
    /// Before the step; none where the frame showed none, or did not exist.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub before: Option<Suggestion>,
    /// After it.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub after: Option<Suggestion>,
}

impl SuggestionChange {
    /// The change of a frame between two states; none if it shows the same in both.
    fn between(before: Option<&Shared<Frame>>, after: Option<&Shared<Frame>>) -> Option<Self> {
        let id = after.or(before)?.id.clone();
        let [before, after] = [before, after].map(|frame| {
            let suggestion = Suggestion::in_frame(frame?, None)?;
            Some(Suggestion {
                revision: 0,
                ..suggestion
            })
        });
        (before != after).then_some(Self { id, before, after })
    }
}

impl Document {
    /// How the suggestions that frames show differ from those in an earlier state.
    pub fn suggestion_changes_since(&self, before: &Self) -> Vec<SuggestionChange> {
        if let Some(changed) = self.frames.changes_in_place(&before.frames) {
            let pairs = changed
                .into_iter()
                .map(|position| (before.frames.get(position), self.frames.get(position)));
            return pairs
                .filter_map(|(before, after)| SuggestionChange::between(before, after))
                .collect();
        }
        let here = self
            .frames
            .iter()
            .map(|frame| (before.frames.by_id(&frame.id), Some(frame)));
        let gone = before.frames.iter().map(|frame| (Some(frame), None));
        let gone = gone
            .filter(|(frame, _)| frame.is_some_and(|frame| self.frames.by_id(&frame.id).is_none()));
        here.chain(gone)
            .filter_map(|(before, after)| SuggestionChange::between(before, after))
            .collect()
    }
}

/// What a step and its continuation did to suggestions.
pub(super) fn join_changes(
    known: Vec<SuggestionChange>,
    continued: Vec<SuggestionChange>,
) -> Vec<SuggestionChange> {
    let known = known.into_iter().map(|known| (known.id.clone(), known));
    let mut all: BTreeMap<FrameId, SuggestionChange> = known.collect();
    for change in continued {
        match all.get_mut(&change.id) {
            Some(known) => known.after = change.after,
            None => drop(all.insert(change.id.clone(), change)),
        }
    }
    all.retain(|_, change| change.before != change.after);
    all.into_values().collect()
}
