//! A project: what people did, and beside it what the program suggests.
//!
//! Both are the state. What a reader sees follows from them ([`Project::view`]): a frame that
//! nobody has touched shows the topmost suggestion for it. The view is kept, so that a change works
//! out only the frames that it concerns. A file holds the view, and so does the journal.
//!
//! Everything that the program finds has one life, whatever found it. It comes as a batch.
//! Accepting a suggestion is an edit like any other: it takes the answer into the frame. Discarding
//! a batch takes its suggestions out of the frames that nobody has touched since; they show what
//! was suggested before. Undo and redo go back and forth in what people did and in nothing else.
//! When an acceptance is undone, the frame is untouched again and shows what is suggested for it by
//! then.

use super::suggestions::{Novelty, Suggestions, TakenOut};
use super::{Asked, BatchId, Finder};
use std::collections::{BTreeMap, BTreeSet};
use touchline_core::camera::CameraBase;
use touchline_core::geometry::counted;
use touchline_documents::document::{
    Camera, CameraId, Document, Edit, Frame, FrameId, FramePtz, Shared, Solution, Suggestion,
};

/// Something that was found for a frame.
#[derive(Clone, Debug, PartialEq)]
pub struct Offer {
    /// The frame.
    pub(super) id: FrameId,
    /// What it was when it was asked for.
    pub(super) asked: Asked,
    /// What is suggested for it.
    pub(super) suggestion: Suggestion,
}

impl Offer {
    /// What `record` writes into the frame at a position; none where there is no such frame, a
    /// person decided on it, or nothing was written that is a suggestion.
    pub fn from_recorded(
        document: &Document,
        position: usize,
        record: impl FnOnce(&mut Frame),
    ) -> Option<Self> {
        let frame = document
            .frames
            .get(position)
            .filter(|frame| frame.is_open())?;
        let asked = Asked::of(document, frame);
        let mut with = Frame::clone(frame);
        record(&mut with);
        let suggestion = Suggestion::in_frame(&with, asked.base.as_ref())?;
        Some(Self {
            id: frame.id.clone(),
            asked,
            suggestion,
        })
    }
}

/// What discarding a batch changed.
#[derive(Clone, Debug, PartialEq)]
pub struct Discarded {
    /// What is to be journalled; none if no frame shows anything else now.
    pub edit: Option<Edit>,
    /// How many frames show no suggestion now.
    pub emptied: usize,
    /// How many frames show again what was suggested before.
    pub given_back: usize,
    /// Frames in which no forest up to a generation may answer again; none if no forest found the
    /// batch.
    pub refused: Option<RefusedForests>,
}

/// Frames in which a forest's answers were discarded.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct RefusedForests {
    /// The frames.
    pub frames: Vec<FrameId>,
    /// The newest forest that may not answer there again.
    pub generation: u64,
}

/// What people did, what is suggested beside it, and both together as a reader sees them.
#[derive(Clone, Debug)]
pub struct Project {
    edited: Document,
    suggestions: Suggestions,
    /// Follows from both.
    view: Document,
}

impl Project {
    /// A project as its file has it.
    pub fn from_document(document: Document) -> Self {
        let bases = Bases::in_document(&document);
        let mut suggestions = Suggestions::default();
        for frame in &document.frames {
            let Some(suggestion) = Suggestion::in_frame(frame, bases.of_frame(frame).as_ref())
            else {
                continue;
            };
            let batch = suggestions.batch_of_finder(Finder::Earlier {
                source: frame.source(),
            });
            suggestions.put(&frame.id, batch, suggestion);
        }
        Self {
            edited: document.without_suggestions(),
            suggestions,
            view: document,
        }
    }

    /// What people did: undo goes back and forth in it. No frame shows a suggestion here.
    pub const fn edited(&self) -> &Document {
        &self.edited
    }

    /// What people did with what is suggested: what readers see, and what is written.
    pub const fn view(&self) -> &Document {
        &self.view
    }

    /// What people did in a document that edits led to from [`Self::view`].
    pub fn edits_in(&self, now: &Document) -> Document {
        now.without_suggestions_since(&self.view, &self.edited)
    }

    /// What a reader sees of another state of what people did.
    pub fn view_with(&self, edited: &Document) -> Document {
        let bases = Bases::in_document(edited);
        let Some(changed) = edited.frames.changed_in_place(&self.edited.frames) else {
            let frames = edited
                .frames
                .iter()
                .map(|frame| self.with_suggestion(frame, &bases))
                .collect();
            return Document {
                frames,
                ..edited.clone()
            };
        };
        let mut frames = self.view.frames.clone();
        for position in changed {
            frames[position] = self.with_suggestion(&edited.frames[position], &bases);
        }
        if bases != Bases::in_document(&self.edited) {
            for position in self
                .suggestions
                .frames()
                .filter_map(|id| edited.frames.position_of(id))
            {
                frames[position] = self.with_suggestion(&edited.frames[position], &bases);
            }
        }
        Document {
            frames,
            ..edited.clone()
        }
    }

    /// Keeps the answers that are in frames now and not in another state of what people did: when
    /// an answer that was accepted or corrected in an earlier session is undone, it is suggested
    /// again, unless it was discarded in this one.
    pub fn keep_answers_not_in(&mut self, edited: &Document) {
        let bases = Bases::in_document(&self.edited);
        for position in edited
            .frames
            .changed_in_place(&self.edited.frames)
            .unwrap_or_default()
        {
            let (frame, gone) = (&edited.frames[position], &self.edited.frames[position]);
            let base = bases.of_frame(gone);
            if frame.is_untouched()
                && self.suggestions.topmost(&frame.id, base.as_ref()).is_none()
                && !self.suggestions.has_discarded(&frame.id)
                && let Some((ptz, solution)) = taken_from_suggestion(gone)
            {
                let batch = self.suggestions.batch_of_finder(Finder::Earlier {
                    source: solution.source,
                });
                let suggestion = Suggestion {
                    revision: frame.revision,
                    base,
                    ptz: Some(ptz),
                    solution: Some(solution),
                };
                self.suggestions.put(&frame.id, batch, suggestion);
            }
        }
    }

    /// Frames that edits of [`Self::view`] left untouched and that do not show what is suggested
    /// for them: their positions, and the frames that do.
    pub fn not_shown_in(&self, now: &Document) -> Vec<(usize, Shared<Frame>)> {
        let bases = Bases::in_document(now);
        let lacks = |frame: &Frame| {
            !frame.shows_suggestion() && self.suggestion_for(frame, &bases).is_some()
        };
        let positions = self.concerned_positions(now, &bases).into_iter();
        let lacking = positions.filter(|&position| lacks(&now.frames[position]));
        lacking
            .map(|position| {
                (
                    position,
                    self.with_suggestion(&now.frames[position], &bases),
                )
            })
            .collect()
    }

    /// Takes in what edits made of [`Self::view`], counts them in the frames' revisions and says
    /// what is to be journalled; none if nothing changed. Suggestions that came with the edits are
    /// a batch; one that a frame goes on showing stays in its own.
    pub fn take_in(&mut self, now: &mut Document, name: &str) -> Option<Edit> {
        now.count_edits_since(&self.view);
        let edit = Edit::between(&self.view, now, name);
        if edit.is_empty() {
            return None;
        }
        let (bases_before, bases) = (Bases::in_document(&self.edited), Bases::in_document(now));
        let mut new_batch = None;
        for frame in self
            .concerned_positions(now, &bases)
            .into_iter()
            .map(|position| &now.frames[position])
        {
            let Some(suggestion) = Suggestion::in_frame(frame, bases.of_frame(frame).as_ref())
            else {
                continue;
            };
            if self.suggestions.keep(&frame.id, &suggestion) {
                continue;
            }
            let batch = self
                .batch_that_showed(&suggestion, &frame.id, &bases_before)
                .unwrap_or_else(|| {
                    let open = || {
                        self.suggestions.open_batch(Finder::Command {
                            name: name.to_owned(),
                        })
                    };
                    *new_batch.get_or_insert_with(open)
                });
            self.suggestions.put(&frame.id, batch, suggestion);
        }
        self.edited = self.edits_in(now);
        self.view = now.clone();
        Some(edit)
    }

    /// Opens a batch for what a finder has found now.
    pub fn open_batch(&mut self, finder: Finder) -> BatchId {
        self.suggestions.open_batch(finder)
    }

    /// The batch of a finder that keeps answering.
    pub fn batch_of_finder(&mut self, finder: Finder) -> BatchId {
        self.suggestions.batch_of_finder(finder)
    }

    /// Takes what was found for frames into a batch and says what is to be journalled; none if a
    /// reader sees nothing new. `now` is what edits that are under way have made of [`Self::view`];
    /// it shows the answers too, except in frames that are being edited.
    pub fn suggest(
        &mut self,
        now: &mut Document,
        batch: BatchId,
        offers: &[Offer],
    ) -> Option<Edit> {
        let mut changed = Vec::new();
        for Offer {
            id,
            asked,
            suggestion,
        } in offers
        {
            if self
                .edited
                .frames
                .by_id(id)
                .is_none_or(|frame| !asked.is_of(frame))
            {
                continue;
            }
            match self.suggestions.novelty(id, batch, suggestion) {
                Novelty::Stale => {}
                Novelty::Same => {
                    self.suggestions
                        .move_to_batch(id, suggestion.base.as_ref(), batch)
                }
                Novelty::New => {
                    self.suggestions.put(id, batch, suggestion.clone());
                    changed.push(id.clone());
                }
            }
        }
        let Shown { view, given, .. } = self.show_suggestions(now, &changed);
        let name = match self.suggestions.finder(batch) {
            Some(Finder::Command { name }) => name.clone(),
            _ => format!("Proposals for {}", counted(given, "frame")),
        };
        self.go_on_to(view, &name)
    }

    /// The batch of the suggestion that a frame of [`Self::view`] shows.
    pub fn batch_shown_in(&self, frame: &Frame) -> Option<BatchId> {
        let base = Bases::in_document(&self.edited).of_frame(frame);
        self.suggestions
            .topmost_batch(&frame.id, base.as_ref())
            .filter(|_| frame.shows_suggestion())
    }

    /// Discards a batch in the frames that nobody has touched since. If a forest found it, neither
    /// that forest nor one up to `newest_forest` is listened to there again. `now` is as in
    /// [`Self::suggest`].
    pub fn discard(&mut self, now: &mut Document, batch: BatchId, newest_forest: u64) -> Discarded {
        let is_open = |id: &FrameId| {
            self.edited
                .frames
                .by_id(id)
                .is_some_and(|frame| frame.is_untouched())
        };
        let TakenOut { frames, refused } = self.suggestions.take_out(batch, newest_forest, is_open);
        let Shown {
            view,
            emptied,
            given: given_back,
        } = self.show_suggestions(now, &frames);
        let name = format!(
            "Discard the suggestions for {}",
            counted(emptied + given_back, "frame")
        );
        let edit = self.go_on_to(view, &name);
        let refused = refused.map(|generation| RefusedForests { frames, generation });
        Discarded {
            edit,
            emptied,
            given_back,
            refused,
        }
    }

    /// The view in which some frames show what is suggested for them now; so does `now`, except in
    /// frames that are being edited.
    fn show_suggestions(&self, now: &mut Document, frames: &[FrameId]) -> Shown {
        let bases = Bases::in_document(&self.edited);
        let mut shown = Shown {
            view: self.view.clone(),
            emptied: 0,
            given: 0,
        };
        for position in frames
            .iter()
            .filter_map(|id| self.edited.frames.position_of(id))
        {
            let with = self.with_suggestion(&self.edited.frames[position], &bases);
            let before = &self.view.frames[position];
            if with == *before {
                continue;
            }
            if let Some(here) = now.frames.position_of(&with.id)
                && now.frames[here] == *before
            {
                now.frames[here] = with.clone();
            }
            if with.shows_suggestion() {
                shown.given += 1;
            } else {
                shown.emptied += 1;
            }
            shown.view.frames[position] = with;
        }
        shown
    }

    /// Goes on to another view of the same edits, and says what is to be journalled; none if it is
    /// the same view.
    fn go_on_to(&mut self, view: Document, name: &str) -> Option<Edit> {
        let edit = Edit::between(&self.view, &view, name);
        self.view = view;
        Some(edit).filter(|edit| !edit.is_empty())
    }

    /// The batch of what a frame of [`Self::view`] shows, if that is the same camera or the same
    /// want of one.
    fn batch_that_showed(
        &self,
        suggestion: &Suggestion,
        frame: &FrameId,
        bases: &Bases,
    ) -> Option<BatchId> {
        let known = self.view.frames.by_id(frame)?;
        let is_same = known.ptz == suggestion.ptz && known.solution == suggestion.solution;
        if is_same {
            self.suggestions
                .topmost_batch(frame, bases.of_frame(known).as_ref())
        } else {
            None
        }
    }

    /// The positions at which a later state, whose cameras have these bases, may differ from
    /// [`Self::view`], or at which something else may be suggested.
    fn concerned_positions(&self, now: &Document, bases: &Bases) -> BTreeSet<usize> {
        let Some(changed) = now.frames.changed_in_place(&self.view.frames) else {
            return (0..now.frames.len()).collect();
        };
        let mut positions: BTreeSet<usize> = changed.into_iter().collect();
        if *bases != Bases::in_document(&self.edited) {
            positions.extend(
                self.suggestions
                    .frames()
                    .filter_map(|id| now.frames.position_of(id)),
            );
        }
        positions
    }

    /// What is suggested for a frame that nobody has touched.
    fn suggestion_for(&self, frame: &Frame, bases: &Bases) -> Option<&Suggestion> {
        self.suggestions
            .topmost(&frame.id, bases.of_frame(frame).as_ref())
            .filter(|_| frame.is_untouched())
    }

    fn with_suggestion(&self, frame: &Shared<Frame>, bases: &Bases) -> Shared<Frame> {
        let mut with = frame.clone();
        if let Some(suggestion) = self.suggestion_for(frame, bases) {
            suggestion.show_in(&mut with);
        }
        with
    }
}

/// A view in which frames show other suggestions than before.
struct Shown {
    view: Document,
    /// How many frames show no suggestion now.
    emptied: usize,
    /// How many frames show another suggestion now.
    given: usize,
}

/// What the program suggested for a frame that was accepted, rejected or corrected since, as far as
/// the frame has kept it.
fn taken_from_suggestion(frame: &Frame) -> Option<(FramePtz, Solution)> {
    let mut frame = frame.clone();
    let is_whole = frame.restore_proposed() || frame.clicks.is_empty();
    if is_whole && frame.is_suggestion() {
        frame.ptz.zip(frame.solution)
    } else {
        None
    }
}

/// The bases of a document's cameras.
#[derive(PartialEq)]
struct Bases(BTreeMap<CameraId, Option<CameraBase>>);

impl Bases {
    fn in_document(document: &Document) -> Self {
        Self(
            document
                .cameras
                .iter()
                .map(|camera| (camera.id.clone(), Camera::base(camera)))
                .collect(),
        )
    }

    /// That of a frame's camera.
    fn of_frame(&self, frame: &Frame) -> Option<CameraBase> {
        self.0.get(&frame.camera).copied().flatten()
    }
}

#[cfg(test)]
mod tests;
