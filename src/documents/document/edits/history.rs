//! Undo and redo by transactions, as snapshots of whole values; the number of steps is bounded.
//!
//! A transaction begins, changes the value any number of times, and commits or aborts. A drag is
//! one step; a commit without a change adds no step.

use super::suggestion_change::join_changes;
use crate::document::{Document, EditKind, FrameId, Shared, SuggestionChange};
use imbl::Vector;
use serde::{Deserialize, Serialize};

/// A step of the user, as undo names it.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Step {
    /// In words: "Move centre mark".
    pub name: String,
    /// The frame it concerns; none for a change of a camera or the field.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub frame: Option<FrameId>,
    /// What it did to the suggestions that frames show.
    #[serde(default, skip_serializing_if = "has_none")]
    pub suggestions: Shared<Vec<SuggestionChange>>,
}

fn has_none(changes: &Shared<Vec<SuggestionChange>>) -> bool {
    changes.is_empty()
}

impl Step {
    /// A step that concerns the document as a whole.
    pub fn on_document(name: impl Into<String>) -> Self {
        Self {
            name: name.into(),
            frame: None,
            suggestions: Shared::default(),
        }
    }

    /// Whether another step is by the same command on the same frame.
    pub fn is_alike(&self, other: &Self) -> bool {
        self.name == other.name && self.frame == other.frame
    }
}

/// A value with undo.
pub trait Undoable: Clone {
    /// Whether another value is the same for the user; counters may differ.
    fn is_same_state(&self, other: &Self) -> bool;
}

impl Undoable for Document {
    fn is_same_state(&self, other: &Self) -> bool {
        // Positions that differ are few; at each, revisions are left out of the comparison, because
        // undo raises them without a change that a person would see.
        let frames = self.frames.len() == other.frames.len() && {
            let mut differ = self.frames.differences(&other.frames).into_iter();
            differ.all(|position| self.frames[position].has_content_of(&other.frames[position]))
        };
        frames && self.same_beside_frames(other)
    }
}

/// The steps that can be undone and redone. Each step keeps a whole value; values share their parts
/// (`Arc` inside), which keeps them small. The steps are persistent vectors, so that a copy of the
/// history is cheap.
#[derive(Clone, Debug, PartialEq)]
pub struct History<T: Clone> {
    limit: usize,
    /// Oldest first; each with the value before the step.
    pub(in crate::document) done: Vector<(Step, T)>,
    /// Oldest last; each with the value after the step.
    pub(super) undone: Vector<(Step, T)>,
    open: Option<Transaction<T>>,
}

/// A step that is under way.
#[derive(Clone, Debug, PartialEq)]
struct Transaction<T> {
    step: Step,
    /// The value before the step.
    before: T,
    /// The value at which a committed step was resumed.
    resumed_at: Option<T>,
}

impl<T: Clone> Default for History<T> {
    fn default() -> Self {
        Self::new(Self::DEFAULT_LIMIT)
    }
}

impl<T: Clone> History<T> {
    /// The default number of steps that are kept. The memory of a step does not grow with the
    /// document.
    pub const DEFAULT_LIMIT: usize = 500;

    /// A history that keeps at most `limit` steps; the oldest are forgotten.
    pub fn new(limit: usize) -> Self {
        Self {
            limit,
            done: Vector::new(),
            undone: Vector::new(),
            open: None,
        }
    }

    /// Whether a transaction is open.
    pub const fn is_open(&self) -> bool {
        self.open.is_some()
    }

    /// The step whose transaction is open.
    pub fn open_step(&self) -> Option<&Step> {
        self.open.as_ref().map(|open| &open.step)
    }

    /// The kind of edit, for undo and redo, that the open transaction becomes when it is committed.
    pub fn open_kind(&self) -> EditKind {
        match &self.open {
            None => EditKind::NoStep,
            Some(Transaction {
                resumed_at: Some(_),
                ..
            }) => EditKind::Continued,
            Some(Transaction { step, .. }) => EditKind::Step {
                frame: step.frame.clone(),
            },
        }
    }

    /// The value as it was when the open transaction began.
    pub fn before(&self) -> Option<&T> {
        self.open.as_ref().map(|open| &open.before)
    }

    /// The step that undo would revert.
    pub fn next_undo(&self) -> Option<&Step> {
        self.done.back().map(|(step, _)| step)
    }

    /// The newest step whose name begins with `name`, with the values before and after it; the
    /// latter is none where that is the current one.
    pub fn newest_named(&self, name: &str) -> Option<(&Step, &T, Option<&T>)> {
        let is_named = |(step, _): &(Step, T)| step.name.starts_with(name);
        let index = self.done.iter().rposition(is_named)?;
        let (step, before) = &self.done[index];
        let after = self.done.get(index + 1).map(|(_, after)| after);
        Some((step, before, after))
    }

    /// The step that redo would repeat.
    pub fn next_redo(&self) -> Option<&Step> {
        self.undone.back().map(|(step, _)| step)
    }

    /// The history without the open transaction.
    #[must_use]
    pub fn without_open_transaction(&self) -> Self {
        Self {
            open: None,
            ..self.clone()
        }
    }

    /// Whether there is neither a step to undo nor one to redo.
    pub fn is_empty(&self) -> bool {
        self.done.is_empty() && self.undone.is_empty()
    }

    /// Forgets every step.
    pub fn clear(&mut self) {
        *self = Self::new(self.limit);
    }
}

impl<T: Undoable> History<T> {
    /// Opens a transaction on `current`; one that is still open is committed first.
    pub fn begin(&mut self, current: &T, step: Step) {
        self.commit(current);
        self.open = Some(Transaction {
            step,
            before: current.clone(),
            resumed_at: None,
        });
    }

    /// Reopens the transaction of the last step on `current`, if that step equals `step` and none
    /// is open. Further changes belong to it.
    pub fn resume(&mut self, current: &T, step: &Step) -> bool {
        let is_last = self.next_undo().is_some_and(|last| last.is_alike(step));
        if self.open.is_some() || !is_last {
            return false;
        }
        let last = self.done.pop_back();
        let resumed_at = Some(current.clone());
        self.open = last.map(|(step, before)| Transaction {
            step,
            before,
            resumed_at,
        });
        true
    }

    /// Closes the open transaction. True if it is now a step because it changed something; the
    /// undone steps are discarded then. A resumed step without further changes stays as it was;
    /// one that was changed back to the value before it is no step any more.
    pub fn commit(&mut self, current: &T) -> bool {
        self.commit_with(current, Vec::new())
    }

    /// [`Self::commit`] with what the step has done to suggestions since it began or was resumed,
    /// which is a change, too.
    pub fn commit_with(&mut self, current: &T, suggestions: Vec<SuggestionChange>) -> bool {
        let Some(Transaction {
            mut step,
            before,
            resumed_at,
        }) = self.open.take()
        else {
            return false;
        };
        // A resumed step without further changes is put back as it was; steps that can be redone
        // stay, as nothing new was done. The check comes before the next one, which compares with
        // the state before the whole step.
        let is_resumed = resumed_at.is_some();
        let is_same = |resumed: T| resumed.is_same_state(current);
        if suggestions.is_empty() && resumed_at.is_some_and(is_same) {
            self.done.push_back((step, before));
            return true;
        }
        if !suggestions.is_empty() {
            let known = std::mem::take(&mut *step.suggestions);
            *step.suggestions = join_changes(known, suggestions);
        }
        if before.is_same_state(current) && step.suggestions.is_empty() {
            // The undone steps start from the result of the resumed step: repeating one would
            // bring back what the user has just changed back.
            if is_resumed {
                self.undone.clear();
            }
            return false;
        }
        self.undone.clear();
        self.done.push_back((step, before));
        while self.done.len() > self.limit {
            self.done.pop_front();
        }
        true
    }

    /// Aborts the open transaction and restores the value. True if there was one.
    pub fn abort(&mut self, current: &mut T) -> bool {
        let Some(open) = self.open.take() else {
            return false;
        };
        *current = open.before;
        true
    }

    /// Reverts the last step and returns it; an open transaction is committed first.
    pub fn undo(&mut self, current: &mut T) -> Option<Step> {
        self.commit(current);
        let (step, before) = self.done.pop_back()?;
        let after = std::mem::replace(current, before);
        self.undone.push_back((step.clone(), after));
        Some(step)
    }

    /// Repeats the last undone step and returns it; none if an open transaction had changes,
    /// because committing it discards the undone steps.
    pub fn redo(&mut self, current: &mut T) -> Option<Step> {
        self.commit(current);
        let (step, after) = self.undone.pop_back()?;
        let before = std::mem::replace(current, after);
        self.done.push_back((step.clone(), before));
        Some(step)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    macro_rules! plain_values {
        ($($kind:ty),*) => {
            $(impl Undoable for $kind {
                fn is_same_state(&self, other: &Self) -> bool {
                    self == other
                }
            })*
        };
    }

    plain_values!(u8, i32);

    fn step(name: &str) -> Step {
        Step {
            frame: Some("7".into()),
            ..Step::on_document(name)
        }
    }

    #[test]
    fn a_drag_is_one_step() {
        let (mut history, mut value) = (History::default(), 0);
        history.begin(&value, step("drag"));
        for position in 1..100 {
            value = position;
        }
        assert!(history.commit(&value));
        assert_eq!(history.next_undo(), Some(&step("drag")));
        assert_eq!(history.undo(&mut value), Some(step("drag")));
        assert_eq!(value, 0);
        assert_eq!(history.next_redo().unwrap().frame, Some("7".into()));
        assert_eq!(history.redo(&mut value), Some(step("drag")));
        assert_eq!((value, history.redo(&mut value)), (99, None));
    }

    #[test]
    fn escape_and_a_change_of_nothing_are_no_steps() {
        let (mut history, mut value) = (History::default(), 1);
        history.begin(&value, step("drag"));
        value = 5;
        assert!(history.abort(&mut value));
        assert_eq!((value, history.undo(&mut value)), (1, None));
        history.begin(&value, step("there and back"));
        assert!(!history.commit(&value));
        assert!(!history.commit(&value) && !history.abort(&mut value));
        assert_eq!(history.next_undo(), None);
    }

    #[test]
    fn the_last_step_can_be_gone_on_with() {
        let (mut history, mut value) = (History::default(), 0);
        for next in 1..=3 {
            if !history.resume(&value, &step("nudge")) {
                history.begin(&value, step("nudge"));
            }
            value = next;
            assert!(history.commit(&value));
        }
        assert!(!history.resume(&value, &step("drag")), "another one");
        assert_eq!((history.undo(&mut value), value), (Some(step("nudge")), 0));
        assert!(!history.resume(&value, &step("nudge")), "it was taken back");
        history.begin(&value, step("nudge"));
        value = 1;
        assert!(history.commit(&value));
        history.begin(&value, step("drag"));
        value = 2;
        assert!(history.commit(&value));
        history.undo(&mut value);
        assert!(history.resume(&value, &step("nudge")) && history.commit(&value));
        assert_eq!(
            history.redo(&mut value),
            Some(step("drag")),
            "nothing more was changed"
        );
    }

    #[test]
    fn a_step_that_is_changed_back_does_not_return_with_a_redo() {
        let (mut history, mut value) = (History::default(), 0);
        for (next, name) in [(1, "nudge"), (2, "drag")] {
            history.begin(&value, step(name));
            value = next;
            assert!(history.commit(&value));
        }
        history.undo(&mut value);
        assert!(history.resume(&value, &step("nudge")));
        value = 0;
        assert!(!history.commit(&value) && history.next_undo().is_none());
        assert_eq!((history.redo(&mut value), value), (None, 0));
    }

    #[test]
    fn a_new_step_forgets_what_was_undone_and_the_oldest_goes_first() {
        let (mut history, mut value) = (History::new(2), 0);
        for next in 1..=4 {
            history.begin(&value, step(&next.to_string()));
            value = next;
        }
        assert_eq!(
            history.undo(&mut value).unwrap().name,
            "4",
            "an open transaction is committed first"
        );
        history.begin(&value, step("other"));
        value = 30;
        assert!(history.commit(&value));
        assert_eq!(history.redo(&mut value), None);
        let undone: Vec<_> =
            std::iter::from_fn(|| history.undo(&mut value).map(|step| step.name)).collect();
        assert_eq!(undone, ["other", "3"]);
        assert_eq!(value, 2, "step 1 and 2 were forgotten");
    }

    proptest! {
        #[test]
        fn undoing_everything_and_redoing_everything_come_back(values in prop::collection::vec(0u8..4, 1..40)) {
            let (mut history, mut value) = (History::default(), 0u8);
            for &next in &values {
                history.begin(&value, step("set"));
                value = next;
                history.commit(&value);
            }
            let last = value;
            let mut steps = 0;
            while history.undo(&mut value).is_some() {
                steps += 1;
            }
            prop_assert_eq!(value, 0);
            for _ in 0..steps {
                prop_assert!(history.redo(&mut value).is_some());
            }
            prop_assert_eq!(value, last);
        }
    }
}
