//! Inserts a step of the program, computed while the user continued to work, beneath the user's
//! later steps. Undo then reverts the user's own steps first, and redo is kept.

use crate::document::{Document, Frame, History, Shared, Step};

impl History<Document> {
    /// The number of steps that can be undone.
    #[must_use]
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

    /// Inserts a step from `before` to `after` above the first `num_below` steps. Its changes are
    /// applied to all later states, including undone ones. The step must only change the `clip` of
    /// frames, in place, and the document's shots.
    pub fn insert_shots(
        &mut self,
        num_below: usize,
        step: Step,
        before: &Document,
        after: &Document,
    ) {
        let num_below = num_below.min(self.done.len());
        // The step starts from the state before the first step above it.
        let start = self
            .done
            .get(num_below)
            .map_or(before, |(_, state)| state)
            .clone();
        // States beneath the step keep their shots: undoing the step leads there. Undone states lie
        // above the current one and have the shots, too.
        let above = self.done.iter_mut().skip(num_below).map(|(_, state)| state);
        for state in above.chain(self.undone.iter_mut().map(|(_, state)| state)) {
            take_shots(state, before, after);
        }
        self.done.insert(num_below, (step, start));
    }
}

/// Applies the shots of `after` to a state. Frames shared with `before` are then shared with
/// `after`.
fn take_shots(state: &mut Document, before: &Document, after: &Document) {
    state.shots.clone_from(&after.shots);
    for position in 0..state.frames.len() {
        let frame = &state.frames[position];
        // Only frames with another shot are written to, so that all others stay shared between
        // states.
        let Some(marked) =
            find_frame(after, position, frame).filter(|marked| marked.clip != frame.clip)
        else {
            continue;
        };
        if find_frame(before, position, frame).is_some_and(|known| known.is_same(frame)) {
            state.frames[position] = marked.clone();
        } else {
            state.frames[position].clip.clone_from(&marked.clip);
        }
    }
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
    use crate::document::{Clip, FieldSpec, Shot, ShotEnd, ShotKind};
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
        let mut document = Document::new(FieldSpec::new("soccer"));
        let frame = |name| Frame::from_image(name, "main".into(), ImageSize::new(64, 48)).into();
        document.frames.extend(["a", "b"].map(frame));
        let mut history = History::default();
        comment(&mut history, &mut document, 0, "before");
        comment(&mut history, &mut document, 1, "meanwhile");
        comment(&mut history, &mut document, 1, "undone");
        history.undo(&mut document);
        let before = document.clone();
        document
            .frames
            .iter_mut()
            .for_each(|frame| frame.clip = Some(Clip::Number(1)));
        let ends = (ShotEnd::VideoFrame(0), ShotEnd::VideoFrame(1));
        let extra = crate::document::Extra::new();
        document.shots = vec![Shot {
            from: ends.0,
            to: ends.1,
            camera: None,
            kind: ShotKind::Cut,
            extra,
        }];
        history.insert_shots(1, Step::on_document("Mark the shot"), &before, &document);
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
