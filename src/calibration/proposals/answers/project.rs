//! A project: the user's edits, and beside them the suggestions of the program.
//!
//! Both are the state. The view ([`Project::view`]) is derived from them: a frame that the user has
//! not touched shows its topmost suggestion. The view is cached, so that a change recomputes only
//! the frames that it concerns. Files and the journal contain the view.
//!
//! All results of the program are handled alike, whichever method found them. They come in batches.
//! Accepting a suggestion is an ordinary edit, which copies the answer into the frame. Discarding a
//! batch removes its suggestions from the frames that the user has not touched since; these show
//! earlier suggestions again. Undo and redo change the user's edits, and the suggestions that a
//! command of the user made or discarded. When an acceptance is undone, the frame is untouched again
//! and shows whatever is suggested for it at that time.

use super::suggestions::{Novelty, RemovedBatch, Suggestions};
use crate::proposals::{BatchId, Finder, FrameRequest};
use std::collections::{BTreeMap, BTreeSet};
use touchline_core::camera::CameraBase;
use touchline_core::geometry::pluralise;
use touchline_documents::document::{
    Camera, CameraId, Document, Edit, Frame, FrameId, FramePtz, ImportedCamera, Shared, Solution,
    SolutionSource, Step, Suggestion, SuggestionChange,
};

/// A result for a frame, to be suggested.
#[derive(Clone, Debug, PartialEq)]
pub struct SuggestionUpdate {
    /// Id of the frame.
    pub(in crate::proposals) id: FrameId,
    /// The frame at the time of the request.
    pub(in crate::proposals) request: FrameRequest,
    /// The suggestion for it.
    pub(in crate::proposals) suggestion: Suggestion,
}

impl SuggestionUpdate {
    /// The suggestion that `record` writes into the frame at a position. None if there is no such
    /// frame, the user has decided on it, or what was written is no suggestion.
    pub fn from_recorded(
        document: &Document,
        position: usize,
        record: impl FnOnce(&mut Frame),
    ) -> Option<Self> {
        let frame = document
            .frames
            .get(position)
            .filter(|frame| frame.is_open())?;
        let request = FrameRequest::from_frame(document, frame);
        let mut with = Frame::clone(frame);
        record(&mut with);
        let suggestion = Suggestion::in_frame(&with, request.base.as_ref())?;
        Some(Self {
            id: frame.id.clone(),
            request,
            suggestion,
        })
    }
}

/// The effect of discarding a batch.
#[derive(Clone, Debug, PartialEq)]
pub struct Discarded {
    /// The edit to journal; none if no frame changes.
    pub edit: Option<Edit>,
    /// Number of frames that show no suggestion now.
    pub emptied: usize,
    /// Number of frames that show an earlier suggestion, or the camera of another program, again.
    pub given_back: usize,
    /// Frames in which forests up to a generation may not answer again; none if no forest found the
    /// batch.
    pub refused: Option<RefusedForests>,
}

impl Discarded {
    /// Number of frames that show something else now.
    pub const fn frames(&self) -> usize {
        self.emptied + self.given_back
    }
}

/// Frames in which the answers of a forest were discarded.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct RefusedForests {
    /// The frames.
    pub frames: Vec<FrameId>,
    /// Generation of the newest forest that may not answer there again.
    pub generation: u64,
}

/// The user's edits, the suggestions beside them, and the view that follows from both.
#[derive(Clone, Debug)]
pub struct Project {
    edited: Document,
    suggestions: Suggestions,
    /// Derived from both.
    view: Document,
}

impl Project {
    /// The project of a document as read from its file. Its suggestions become batches of an
    /// earlier session.
    pub fn from_document(document: Document) -> Self {
        let bases = Bases::in_document(&document);
        let mut suggestions = Suggestions::default();
        for frame in &document.frames {
            let Some(suggestion) = Suggestion::in_frame(frame, bases.for_frame(frame).as_ref())
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

    /// The document with the user's edits only, the state that undo and redo change. No frame shows
    /// a suggestion here.
    pub const fn edited_document(&self) -> &Document {
        &self.edited
    }

    /// The document with suggestions, as readers see it and as files contain it.
    pub const fn view(&self) -> &Document {
        &self.view
    }

    /// The user's edits in a document that was edited from [`Self::view`].
    pub fn edits_in(&self, now: &Document) -> Document {
        now.without_suggestions_since(&self.view, &self.edited)
    }

    /// The view of the state of the user's edits to which undo (`back`) or redo of a step leads:
    /// what the step suggested or discarded is given back, too.
    pub fn view_after(&mut self, edited: &Document, step: &Step, back: bool) -> Document {
        let bases = Bases::in_document(edited);
        let batch = Finder::Command {
            name: step.name.clone(),
        };
        for SuggestionChange { id, before, after } in step.suggestions.iter() {
            let [from, to] = if back {
                [after, before]
            } else {
                [before, after]
            };
            let Some(frame) = edited.frames.by_id(id).filter(|frame| frame.is_untouched()) else {
                continue;
            };
            let base = bases.for_frame(frame);
            let to = to.as_ref().map(|to| Suggestion {
                revision: frame.revision,
                base,
                ..to.clone()
            });
            let here = self.edited.frames.by_id(id);
            if here.is_some_and(|frame| frame.is_untouched()) {
                let from = from.as_ref();
                self.suggestions
                    .turn(id, base.as_ref(), [from, to.as_ref()], &batch);
            } else if let Some(to) = to
                && self.suggestions.topmost(id, base.as_ref()).is_none()
                && !self.suggestions.has_discarded(id)
            {
                // A decision is taken back: the frame shows whatever is suggested for it by now.
                let batch = self.suggestions.batch_of_finder(Finder::Earlier {
                    source: to.solution.as_ref().and_then(|solution| solution.source),
                });
                self.suggestions.put(id, batch, to);
            }
        }
        self.keep_answers_not_in(edited);
        let mut view = self.view_with(edited);
        for position in step
            .suggestions
            .iter()
            .filter_map(|change| edited.frames.position_of(&change.id))
        {
            view.frames[position] = self.with_suggestion(&edited.frames[position], &bases);
        }
        view
    }

    /// The view of another state of the user's edits.
    pub fn view_with(&self, edited: &Document) -> Document {
        let bases = Bases::in_document(edited);
        // If frames were added, removed or moved, rebuild all; otherwise only the frames that
        // changed, and, if a base changed, those with suggestions, because suggestions belong to a
        // base.
        let Some(changed) = edited.frames.changes_in_place(&self.edited.frames) else {
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

    /// Keeps the answers that frames have now and lack in another state of the user's edits. If the
    /// user undoes the acceptance or correction of an answer from an earlier session, the answer is
    /// suggested again, unless it was discarded in this session.
    fn keep_answers_not_in(&mut self, edited: &Document) {
        let bases = Bases::in_document(&self.edited);
        for position in edited
            .frames
            .changes_in_place(&self.edited.frames)
            .unwrap_or_default()
        {
            let (frame, gone) = (&edited.frames[position], &self.edited.frames[position]);
            let base = bases.for_frame(gone);
            // Only an answer that nothing else keeps: the other state leaves the frame untouched,
            // there is no suggestion for it, and none was discarded.
            if frame.is_untouched()
                && self.suggestions.topmost(&frame.id, base.as_ref()).is_none()
                && !self.suggestions.has_discarded(&frame.id)
                && let Some((ptz, solution)) = original_suggestion(gone)
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

    /// The frames that edits of [`Self::view`] left untouched and that do not show their
    /// suggestion: positions, and the frames that do show it.
    pub fn not_shown_in(&self, now: &Document) -> Vec<(usize, Shared<Frame>)> {
        let bases = Bases::in_document(now);
        let positions = self.affected_positions(now, &bases).into_iter();
        // Frames that show no suggestion although there is one for them.
        let lacking = positions.filter(|&position| {
            let frame = &now.frames[position];
            !frame.shows_suggestion() && self.suggestion_for(frame, &bases).is_some()
        });
        lacking
            .map(|position| {
                (
                    position,
                    self.with_suggestion(&now.frames[position], &bases),
                )
            })
            .collect()
    }

    /// Adopts a document that was edited from [`Self::view`], counts the edits in the frames'
    /// revisions and returns the edit to journal; none if nothing changed. New suggestions in the
    /// document form a batch. One that a frame still shows stays in its batch.
    pub fn take_in(&mut self, now: &mut Document, name: &str) -> Option<Edit> {
        now.count_edits_since(&self.view);
        let edit = Edit::between(&self.view, now, name);
        if edit.is_empty() {
            return None;
        }
        let (bases_before, bases) = (Bases::in_document(&self.edited), Bases::in_document(now));
        let mut new_batch = None;
        // A suggestion that was there before keeps its batch. One that undo or an edit restored
        // joins the batch that showed it. The others are new and form one batch with the edit's
        // name.
        for frame in self
            .affected_positions(now, &bases)
            .into_iter()
            .map(|position| &now.frames[position])
        {
            let Some(suggestion) = Suggestion::in_frame(frame, bases.for_frame(frame).as_ref())
            else {
                continue;
            };
            if self.suggestions.keep(&frame.id, &suggestion) {
                continue;
            }
            let batch = self
                .batch_that_showed(&suggestion, &frame.id, &bases_before)
                .unwrap_or_else(|| {
                    *new_batch.get_or_insert_with(|| {
                        self.suggestions.open_batch(Finder::Command {
                            name: name.to_owned(),
                        })
                    })
                });
            self.suggestions.put(&frame.id, batch, suggestion);
        }
        // `edits_in` compares with the view before, so it is called before that is replaced.
        self.edited = self.edits_in(now);
        self.view = now.clone();
        Some(edit)
    }

    /// Opens a new batch for the results of a finder.
    pub fn open_batch(&mut self, finder: Finder) -> BatchId {
        self.suggestions.open_batch(finder)
    }

    /// The batch of a finder that answers repeatedly.
    pub fn batch_of_finder(&mut self, finder: Finder) -> BatchId {
        self.suggestions.batch_of_finder(finder)
    }

    /// Adds results for frames to a batch and returns the edit to journal; none if the view does
    /// not change. `now` is the document of an edit in progress, which started from [`Self::view`];
    /// it shows the results too, except in frames that are being edited.
    pub fn suggest(
        &mut self,
        now: &mut Document,
        batch: BatchId,
        updates: &[SuggestionUpdate],
    ) -> Option<Edit> {
        let mut changed = Vec::new();
        for SuggestionUpdate {
            id,
            request,
            suggestion,
        } in updates
        {
            // Drop results for a frame if its picture or camera changed since the request.
            if self
                .edited
                .frames
                .by_id(id)
                .is_none_or(|frame| !request.is_of(frame))
            {
                continue;
            }
            match self.suggestions.novelty(id, batch, suggestion) {
                Novelty::Stale => {}
                Novelty::Same => {
                    self.suggestions
                        .move_to_batch(id, suggestion.base.as_ref(), batch);
                }
                Novelty::New => {
                    self.suggestions.put(id, batch, suggestion.clone());
                    changed.push(id.clone());
                }
            }
        }
        // Show the new answers and name the edit by their number.
        let UpdatedView { view, given, .. } = self.show_suggestions(now, &changed);
        let name = match self.suggestions.finder(batch) {
            Some(Finder::Command { name }) => name.clone(),
            _ => format!("Proposals for {}", pluralise(given, "frame")),
        };
        self.go_on_to(view, &name)
    }

    /// The batch of the suggestion that a frame of [`Self::view`] shows; none if it shows none.
    pub fn batch_shown_in(&self, frame: &Frame) -> Option<BatchId> {
        let base = Bases::in_document(&self.edited).for_frame(frame);
        self.suggestions
            .topmost_batch(&frame.id, base.as_ref())
            .filter(|_| frame.shows_suggestion())
    }

    /// Number of frames in which discarding a batch shows something else.
    pub fn frames_showing(&self, batch: BatchId) -> usize {
        let bases = Bases::in_document(&self.edited);
        let edited = self.edited.frames.iter();
        let shows_it = |frame: &&Shared<Frame>| {
            let base = bases.for_frame(frame);
            frame.is_untouched()
                && self.suggestions.topmost_batch(&frame.id, base.as_ref()) == Some(batch)
        };
        edited.filter(shows_it).count()
    }

    /// Discards a batch in the frames that the user has not touched since. If a forest found it,
    /// neither that forest nor any up to `newest_forest` may answer there again. `now` is as in
    /// [`Self::suggest`]; a frame with a camera of another program that was mended shows that one
    /// again there, which is an edit of `now` and not yet in the view.
    pub fn discard(&mut self, now: &mut Document, batch: BatchId, newest_forest: u64) -> Discarded {
        let edited = &self.edited.frames;
        let RemovedBatch { removed, refused } =
            self.suggestions.take_out(batch, newest_forest, |id| {
                edited.by_id(id).is_some_and(|frame| frame.is_untouched())
            });
        let frames: Vec<FrameId> = removed.iter().map(|(id, _)| id.clone()).collect();
        let UpdatedView {
            view,
            emptied,
            given,
        } = self.show_suggestions(now, &frames);
        let name = format!(
            "Discard the suggestions for {}",
            pluralise(emptied.len() + given, "frame")
        );
        let edit = self.go_on_to(view, &name);
        let came = removed
            .iter()
            .filter(|(id, gone)| emptied.contains(id) && self.give_back_imported(now, id, gone))
            .count();
        let refused = refused.map(|generation| RefusedForests { frames, generation });
        Discarded {
            edit,
            emptied: emptied.len() - came,
            given_back: given + came,
            refused,
        }
    }

    /// Shows the camera of another program again in a frame without a suggestion from which its
    /// replacement, `gone`, was discarded. False if there is no such camera.
    fn give_back_imported(&self, now: &mut Document, id: &FrameId, gone: &Suggestion) -> bool {
        let Some(frame) = now.frames.by_id(id).filter(|frame| frame.is_untouched()) else {
            return false;
        };
        let came = self
            .suggestions
            .imported_camera(id)
            .cloned()
            .or_else(|| recorded_import(gone, now.camera_of(frame)?));
        let Some((came, base)) = came.and_then(|came| came.base.map(|base| (came, base))) else {
            return false;
        };
        // Imported cameras of other places are cameras of their own in the document.
        let Some(camera) = now.camera_with_base(&frame.camera.clone(), &base) else {
            return false;
        };
        if let Some(frame) = now.frames.by_id_mut(id) {
            frame.camera = camera;
            came.show_in(frame);
        }
        true
    }

    /// The view with the current suggestions in some frames. `now` is updated in the same way,
    /// except in frames that are being edited.
    fn show_suggestions(&self, now: &mut Document, frames: &[FrameId]) -> UpdatedView {
        let bases = Bases::in_document(&self.edited);
        let mut shown = UpdatedView {
            view: self.view.clone(),
            emptied: BTreeSet::new(),
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
            // The edit in progress shows the suggestion too, unless it has changed this frame
            // itself.
            if let Some(here) = now.frames.position_of(&with.id)
                && now.frames[here] == *before
            {
                now.frames[here] = with.clone();
            }
            if with.shows_suggestion() {
                shown.given += 1;
            } else {
                shown.emptied.insert(with.id.clone());
            }
            shown.view.frames[position] = with;
        }
        shown
    }

    /// Replaces the view, with the same edits, and returns the edit to journal; none if the view
    /// does not change.
    fn go_on_to(&mut self, view: Document, name: &str) -> Option<Edit> {
        // The journal records the view, so the edit is computed before the view is replaced.
        let edit = Edit::between(&self.view, &view, name);
        self.view = view;
        Some(edit).filter(|edit| !edit.is_empty())
    }

    /// The batch of what a frame of [`Self::view`] shows, if that is the same camera, or the same
    /// lack of one.
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
                .topmost_batch(frame, bases.for_frame(known).as_ref())
        } else {
            None
        }
    }

    /// The positions at which a later state, with these bases, may differ from [`Self::view`] or
    /// have other suggestions.
    fn affected_positions(&self, now: &Document, bases: &Bases) -> BTreeSet<usize> {
        // Positions are comparable only if no frames were added, removed or moved.
        let Some(changed) = now.frames.changes_in_place(&self.view.frames) else {
            return (0..now.frames.len()).collect();
        };
        let mut positions: BTreeSet<usize> = changed.into_iter().collect();
        // A changed base makes other suggestions of a frame visible.
        if *bases != Bases::in_document(&self.edited) {
            positions.extend(
                self.suggestions
                    .frames()
                    .filter_map(|id| now.frames.position_of(id)),
            );
        }
        positions
    }

    /// The topmost suggestion for a frame that the user has not touched.
    fn suggestion_for(&self, frame: &Frame, bases: &Bases) -> Option<&Suggestion> {
        self.suggestions
            .topmost(&frame.id, bases.for_frame(frame).as_ref())
            .filter(|_| frame.is_untouched())
    }

    /// The frame, showing its suggestion if it has one.
    fn with_suggestion(&self, frame: &Shared<Frame>, bases: &Bases) -> Shared<Frame> {
        let mut with = frame.clone();
        if let Some(suggestion) = self.suggestion_for(frame, bases) {
            suggestion.show_in(&mut with);
        }
        with
    }
}

/// A view in which frames show other suggestions than before.
struct UpdatedView {
    view: Document,
    /// Frames that show no suggestion now.
    emptied: BTreeSet<FrameId>,
    /// Number of frames that show another suggestion now.
    given: usize,
}

/// The camera of another program that this suggestion replaced, from the record that it keeps: in a
/// project that was opened again, there is nothing else of it.
fn recorded_import(mended: &Suggestion, camera: &Camera) -> Option<Suggestion> {
    let imported = mended.solution.as_ref()?.imported.as_ref()?;
    let base = camera.base()?;
    Some(Suggestion {
        revision: 0,
        base: Some(base),
        // It stays a frame of this camera, and keeps the place that it came with: a camera for each
        // of thousands of frames could neither be tracked nor refined.
        ptz: Some(FramePtz {
            imported: Some(Box::new(ImportedCamera {
                moved_px: None,
                ..imported.clone()
            })),
            ..FramePtz::new(imported.ptz_on(&base), None)
        }),
        solution: Some(Solution {
            source: Some(SolutionSource::Import),
            ..Solution::default()
        }),
    })
}

/// The suggestion that a frame had before the user accepted, rejected or corrected it, if the frame
/// still contains all of it.
fn original_suggestion(frame: &Frame) -> Option<(FramePtz, Solution)> {
    let mut frame = frame.clone();
    // A frame that was corrected keeps its proposal beside its camera, from where it is restored in
    // a copy. A frame without clicks still has the proposal as its camera.
    let is_whole = frame.restore_proposed() || frame.clicks.is_empty();
    if is_whole && frame.is_suggestion() {
        frame.ptz.zip(frame.solution)
    } else {
        None
    }
}

/// The bases of a document's cameras; suggestions are valid for one base.
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

    /// The base of a frame's camera.
    fn for_frame(&self, frame: &Frame) -> Option<CameraBase> {
        self.0.get(&frame.camera).copied().flatten()
    }
}

#[cfg(test)]
mod tests;
