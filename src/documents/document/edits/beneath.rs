//! Inserts a step of the program, computed while the user continued to work, beneath the user's
//! later steps. Undo then reverts the user's own steps first, and redo is kept.

use crate::document::{Document, Frame, History, Shared, Step};

impl History<Document> {
    /// The number of steps that can be undone.
    pub fn num_done(&self) -> usize {
        self.done.len()
    }

    /// Changes the document in all states, for a change of the program that is no step.
    pub fn update_states(&mut self, update: impl Fn(&Document) -> Document) {
        let undone = self.undone.iter_mut();
        for (_, state) in self.done.iter_mut().chain(undone) {
            *state = update(state);
        }
    }

    /// Inserts a step from `before` to `after` above the first `num_below` steps. `mark` applies it
    /// to the later states, the undone ones included: to each by itself, so that what the user did
    /// in it stays. The step must only change the `clip` of frames, in place, and the document's
    /// shots.
    pub fn insert_shots(
        &mut self,
        num_below: usize,
        step: Step,
        [before, after]: [&Document; 2],
        mark: impl Fn(&mut Document),
    ) {
        let num_below = num_below.min(self.done.len());
        // The step starts from the state before the first step above it.
        let start = self
            .done
            .get(num_below)
            .map_or(before, |(_, state)| state)
            .clone();
        // States beneath the step keep their shots: undoing the step leads there. Undone states lie
        // above the current one and have the shots, too. In both directions from the current state,
        // because neighbouring states share most of their frames.
        let mut known = [before.clone(), after.clone()];
        for (_, state) in self.done.iter_mut().skip(num_below).rev() {
            known = mark_sharing(state, &known, &mark);
        }
        known = [before.clone(), after.clone()];
        for (_, state) in self.undone.iter_mut().rev() {
            known = mark_sharing(state, &known, &mark);
        }
        self.done.insert(num_below, (step, start));
    }
}

/// Applies the step to a state and returns the state before and after. A frame that it shares with
/// a state that is `known` before and after the step is then shared with that one after it, too.
fn mark_sharing(
    state: &mut Document,
    known: &[Document; 2],
    mark: &impl Fn(&mut Document),
) -> [Document; 2] {
    let before = state.clone();
    mark(state);
    for position in state.frames.differences(&before.frames) {
        let frame = &before.frames[position];
        let [known_before, known_after] =
            [&known[0], &known[1]].map(|known| find_frame(known, position, frame));
        if let Some((_, after)) = known_before
            .zip(known_after)
            .filter(|(before, after)| before.is_same(frame) && **after == state.frames[position])
        {
            state.frames[position] = after.clone();
        }
    }
    [before, state.clone()]
}

/// A frame in another state; the same position is tried first.
fn find_frame<'a>(
    document: &'a Document,
    position: usize,
    frame: &Frame,
) -> Option<&'a Shared<Frame>> {
    let there = document
        .frames
        .get(position)
        .filter(|there| there.id == frame.id);
    there.or_else(|| document.frames.by_id(&frame.id))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::document::{Clip, Shot, ShotEnd, ShotKind};
    use crate::testing::{new_frame, soccer_document};
    use touchline_core::geometry::ImageSize;

    fn comment(history: &mut History<Document>, document: &mut Document, frame: usize, text: &str) {
        history.begin(document, Step::on_document(text));
        document.frames[frame].comment = Some(text.to_owned());
        history.commit(document);
    }

    fn comments(document: &Document) -> Vec<&str> {
        document
            .frames
            .iter()
            .filter_map(|frame| frame.comment.as_deref())
            .collect()
    }

    #[test]
    fn what_a_person_did_meanwhile_is_taken_back_first() {
        let mut document = soccer_document();
        let frame = |name| new_frame(name, ImageSize::new(64, 48)).into();
        document.frames.extend(["a", "b"].map(frame));
        let mut history = History::default();
        comment(&mut history, &mut document, 0, "before");
        comment(&mut history, &mut document, 1, "meanwhile");
        comment(&mut history, &mut document, 1, "undone");
        history.undo(&mut document);
        let before = document.clone();
        let mark = |document: &mut Document| {
            for frame in &mut document.frames {
                frame.clip = Some(Clip::Number(1));
            }
            document.shots = vec![Shot {
                from: ShotEnd::VideoFrame(0),
                to: ShotEnd::VideoFrame(1),
                camera: None,
                kind: ShotKind::Cut,
                content: None,
                extra: crate::document::Extra::new(),
            }];
        };
        mark(&mut document);
        let step = Step::on_document("Mark the shot");
        history.insert_shots(1, step, [&before, &document], mark);
        let [(_, below), (_, above)] = [&history.done[1], &history.done[2]];
        assert!(above.frames[0].is_same(&document.frames[0]), "one copy");
        assert!(below.frames[0].is_same(&before.frames[0]));
        let mut undo = |document: &mut Document| history.undo(document).unwrap().name;
        assert_eq!(
            (undo(&mut document), comments(&document)),
            ("meanwhile".to_owned(), vec!["before"])
        );
        assert!(
            document.shots.len() == 1 && document.frames.iter().all(|frame| frame.clip.is_some())
        );
        assert_eq!(
            (undo(&mut document), comments(&document)),
            ("Mark the shot".to_owned(), vec!["before"])
        );
        assert!(
            document.shots.is_empty() && document.frames.iter().all(|frame| frame.clip.is_none())
        );
        let redone: Vec<String> = std::iter::from_fn(|| history.redo(&mut document))
            .map(|step| step.name)
            .collect();
        assert_eq!(redone, ["Mark the shot", "meanwhile", "undone"]);
        assert_eq!(
            (comments(&document), document.shots.len()),
            (vec!["before", "undone"], 1)
        );
    }
}
