//! The layer of suggestions: what the program suggests, beside what people did.
//!
//! An answer is not a step of undo. Undo and redo go back and forth in what people did; a frame that nobody has touched
//! shows what is suggested for it. Accepting a suggestion is an edit like any other: it takes the answer into the frame. When that
//! edit is undone, the frame is untouched again and shows what is suggested for it now.
//!
//! A file has both in one: [`Layered::shown`]. That is also what every reader reads and what the journal keeps.

use super::Asked;
use super::suggestions::Suggestions;
use std::collections::BTreeMap;
use touchline_core::camera::CameraBase;
use touchline_core::geometry::counted;
use touchline_documents::document::{
    Camera, CameraId, Document, Edit, Frame, FrameId, FramePtz, Shared, Solution, SplitDocument, Suggestion,
};

/// Something that was found for a frame.
pub struct Offer<'a> {
    /// The frame.
    pub(super) id: &'a FrameId,
    /// What it was when it was asked for.
    pub(super) asked: &'a Asked,
    /// What is suggested for it.
    pub(super) suggestion: Suggestion,
}

/// A document in two layers, what people did and what is suggested, and both together as a reader sees them.
#[derive(Clone, Debug)]
pub struct Layered {
    split: SplitDocument,
    suggestions: Suggestions,
}

impl Layered {
    /// A document as a file has it.
    pub fn of(document: Document) -> Self {
        let bases = Bases::of(&document);
        let mut suggestions = Suggestions::default();
        for frame in &document.frames {
            if let Some(suggestion) = Suggestion::in_frame(frame, bases.of_frame(frame).as_ref()) {
                suggestions.put(&frame.id, suggestion);
            }
        }
        Self { split: SplitDocument::of(document), suggestions }
    }

    /// What people did: what undo goes back and forth in. No frame shows a suggestion here.
    pub const fn edited(&self) -> &Document {
        self.split.edited()
    }

    /// Both layers: what readers see, and what is written.
    pub const fn shown(&self) -> &Document {
        self.split.shown()
    }

    /// What people did in a document that edits led to from [`Self::shown`].
    pub fn edited_of(&self, now: &Document) -> Document {
        self.split.edited_of(now)
    }

    /// What a reader sees of another state of what people did.
    pub fn shown_of(&self, edited: &Document) -> Document {
        let bases = Bases::of(edited);
        let Some(changed) = edited.frames.changed_in_place(&self.edited().frames) else {
            let frames = edited.frames.iter().map(|frame| self.with_suggestion(frame, &bases)).collect();
            return Document { frames, ..edited.clone() };
        };
        let mut frames = self.shown().frames.clone();
        for position in changed {
            frames[position] = self.with_suggestion(&edited.frames[position], &bases);
        }
        if bases != Bases::of(self.edited()) {
            for position in self.suggestions.frames().filter_map(|id| edited.frames.position_of(id)) {
                frames[position] = self.with_suggestion(&edited.frames[position], &bases);
            }
        }
        Document { frames, ..edited.clone() }
    }

    /// Keeps the answers that are in frames now and not in another state of what people did: when an answer that was accepted or
    /// corrected in an earlier session is undone, it is suggested again.
    pub fn keep_answers_not_in(&mut self, edited: &Document) {
        let bases = Bases::of(self.edited());
        for position in edited.frames.changed_in_place(&self.edited().frames).unwrap_or_default() {
            let (frame, gone) = (&edited.frames[position], &self.split.edited().frames[position]);
            let base = bases.of_frame(gone);
            if frame.is_untouched()
                && self.suggestions.of(&frame.id, base.as_ref()).is_none()
                && let Some((ptz, solution)) = taken_from_suggestion(gone)
            {
                let suggestion =
                    Suggestion { revision: frame.revision, base, ptz: Some(ptz), solution: Some(solution) };
                self.suggestions.put(&frame.id, suggestion);
            }
        }
    }

    /// Frames that edits of [`Self::shown`] left untouched and that do not show what is suggested for them: their positions, and
    /// the frames that do.
    pub fn not_shown_in(&self, now: &Document) -> Vec<(usize, Shared<Frame>)> {
        let bases = Bases::of(now);
        let lacks = |frame: &Frame| !frame.shows_suggestion() && self.suggestion_for(frame, &bases).is_some();
        let lacking = self.changed(now).into_iter().filter(|&position| lacks(&now.frames[position]));
        lacking.map(|position| (position, self.with_suggestion(&now.frames[position], &bases))).collect()
    }

    /// Takes in what edits made of [`Self::shown`], counts them in the frames' revisions and says what is to be journalled; none
    /// if nothing changed.
    pub fn settle(&mut self, now: &mut Document, name: &str) -> Option<Edit> {
        now.count_edits_since(self.shown());
        let edit = Edit::between(self.shown(), now, name);
        if edit.is_empty() {
            return None;
        }
        let bases = Bases::of(now);
        for frame in self.changed(now).into_iter().map(|position| &now.frames[position]) {
            if let Some(suggestion) = Suggestion::in_frame(frame, bases.of_frame(frame).as_ref()) {
                self.suggestions.put(&frame.id, suggestion);
            }
        }
        self.split.go_on_to(now.clone());
        Some(edit)
    }

    /// Takes in what was found for frames and says what is to be journalled; none if a reader sees nothing new. `now` is what edits
    /// that are under way have made of [`Self::shown`]; it shows the answers too, except in frames that are being edited.
    pub fn suggest(&mut self, now: &mut Document, offers: &[Offer<'_>]) -> Option<Edit> {
        let mut shown = self.shown().clone();
        let bases = Bases::of(self.edited());
        let mut count = 0;
        for Offer { id, asked, suggestion } in offers {
            let Some(position) = self.edited().frames.position_of(id) else { continue };
            let frame = self.edited().frames[position].clone();
            if !asked.is_of(&frame) || !self.suggestions.is_news(id, suggestion) {
                continue;
            }
            self.suggestions.put(id, suggestion.clone());
            let with = self.with_suggestion(&frame, &bases);
            if with == shown.frames[position] {
                continue;
            }
            if let Some(here) = now.frames.position_of(id)
                && now.frames[here] == shown.frames[position]
            {
                now.frames[here] = with.clone();
            }
            shown.frames[position] = with;
            count += 1;
        }
        let name = format!("Proposals for {}", counted(count, "frame"));
        let edit = Edit::between(self.shown(), &shown, &name);
        self.split.go_on_to(shown);
        Some(edit).filter(|edit| !edit.is_empty())
    }

    /// Forgets what is suggested for a frame now. Readers see it until an edit shows something else there.
    pub fn forget(&mut self, frame: &Frame) {
        let base = Bases::of(self.edited()).of_frame(frame);
        self.suggestions.forget(&frame.id, base.as_ref());
    }

    /// The positions at which a later state may differ from [`Self::shown`].
    fn changed(&self, now: &Document) -> Vec<usize> {
        now.frames.changed_in_place(&self.shown().frames).unwrap_or_else(|| (0..now.frames.len()).collect())
    }

    /// What is suggested for a frame that nobody has touched.
    fn suggestion_for(&self, frame: &Frame, bases: &Bases) -> Option<&Suggestion> {
        self.suggestions.of(&frame.id, bases.of_frame(frame).as_ref()).filter(|_| frame.is_untouched())
    }

    fn with_suggestion(&self, frame: &Shared<Frame>, bases: &Bases) -> Shared<Frame> {
        let mut with = frame.clone();
        if let Some(suggestion) = self.suggestion_for(frame, bases) {
            suggestion.show_in(&mut with);
        }
        with
    }
}

/// What the program suggested for a frame that was accepted, rejected or corrected since, as far as the frame has kept it.
fn taken_from_suggestion(frame: &Frame) -> Option<(FramePtz, Solution)> {
    let mut frame = frame.clone();
    let is_whole = frame.restore_proposed() || frame.clicks.is_empty();
    if is_whole && frame.is_suggestion() { frame.ptz.zip(frame.solution) } else { None }
}

/// The bases of a document's cameras.
#[derive(PartialEq)]
struct Bases(BTreeMap<CameraId, Option<CameraBase>>);

impl Bases {
    fn of(document: &Document) -> Self {
        Self(document.cameras.iter().map(|camera| (camera.id.clone(), Camera::base(camera))).collect())
    }

    /// That of a frame's camera.
    fn of_frame(&self, frame: &Frame) -> Option<CameraBase> {
        self.0.get(&frame.camera).copied().flatten()
    }
}

#[cfg(test)]
mod tests;
