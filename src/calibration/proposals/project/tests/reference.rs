//! The model that [`Project`](super::Project) replaces: one suggestion a frame and base, and no batches.

use super::super::super::suggestions::KEPT_BASES;
use super::super::{Bases, Offer, taken_from_suggestion};
use std::collections::BTreeMap;
use touchline_core::camera::CameraBase;
use touchline_core::geometry::counted;
use touchline_documents::document::{Document, Edit, Frame, FrameId, Shared, Suggestion};

/// A document in two layers, what people did and what is suggested, and both together as a reader sees them.
#[derive(Clone, Debug)]
pub struct Layered {
    split: SplitDocument,
    suggestions: Suggestions,
}

impl Layered {
    /// A document as a file has it.
    pub fn of(document: Document) -> Self {
        let bases = Bases::in_document(&document);
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
        let bases = Bases::in_document(edited);
        let Some(changed) = edited.frames.changed_in_place(&self.edited().frames) else {
            let frames = edited.frames.iter().map(|frame| self.with_suggestion(frame, &bases)).collect();
            return Document { frames, ..edited.clone() };
        };
        let mut frames = self.shown().frames.clone();
        for position in changed {
            frames[position] = self.with_suggestion(&edited.frames[position], &bases);
        }
        if bases != Bases::in_document(self.edited()) {
            for position in self.suggestions.frames().filter_map(|id| edited.frames.position_of(id)) {
                frames[position] = self.with_suggestion(&edited.frames[position], &bases);
            }
        }
        Document { frames, ..edited.clone() }
    }

    /// Keeps the answers that are in frames now and not in another state of what people did: when an answer that was accepted or
    /// corrected in an earlier session is undone, it is suggested again.
    pub fn keep_answers_not_in(&mut self, edited: &Document) {
        let bases = Bases::in_document(self.edited());
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
        let bases = Bases::in_document(now);
        let lacks = |frame: &Frame| !frame.shows_suggestion() && self.suggestion_for(frame, &bases).is_some();
        let mut positions: std::collections::BTreeSet<usize> = self.changed(now).into_iter().collect();
        if bases != Bases::in_document(self.edited()) {
            positions.extend(self.suggestions.frames().filter_map(|id| now.frames.position_of(id)));
        }
        let lacking = positions.into_iter().filter(|&position| lacks(&now.frames[position]));
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
        let bases = Bases::in_document(now);
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
    pub fn suggest(&mut self, now: &mut Document, offers: &[Offer]) -> Option<Edit> {
        let mut shown = self.shown().clone();
        let bases = Bases::in_document(self.edited());
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

#[derive(Clone, Debug)]
struct SplitDocument {
    shown: Document,
    edited: Document,
}

impl SplitDocument {
    fn of(shown: Document) -> Self {
        Self { edited: shown.without_suggestions(), shown }
    }

    const fn shown(&self) -> &Document {
        &self.shown
    }

    const fn edited(&self) -> &Document {
        &self.edited
    }

    fn edited_of(&self, now: &Document) -> Document {
        now.without_suggestions_since(&self.shown, &self.edited)
    }

    fn go_on_to(&mut self, now: Document) {
        self.edited = self.edited_of(&now);
        self.shown = now;
    }
}

/// What the program suggests, by frame.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Suggestions {
    /// Of each frame the newest last.
    by_frame: BTreeMap<FrameId, Vec<Suggestion>>,
}

impl Suggestions {
    /// What is suggested for a frame while its camera has this base.
    pub fn of(&self, frame: &FrameId, base: Option<&CameraBase>) -> Option<&Suggestion> {
        self.by_frame.get(frame)?.iter().find(|suggestion| suggestion.base.as_ref() == base)
    }

    /// Whether a suggestion says something that is not known: not where it was made for an earlier revision of the frame than the
    /// one that is there, or says the same.
    pub fn is_news(&self, frame: &FrameId, suggestion: &Suggestion) -> bool {
        let known = self.of(frame, suggestion.base.as_ref());
        known.is_none_or(|known| suggestion.revision >= known.revision && !says_the_same(suggestion, known))
    }

    /// Puts a suggestion in place of an earlier one for the same base.
    pub fn put(&mut self, frame: &FrameId, suggestion: Suggestion) {
        let kept = self.by_frame.entry(frame.clone()).or_default();
        kept.retain(|known| known.base != suggestion.base);
        kept.push(suggestion);
        if kept.len() > KEPT_BASES {
            kept.remove(0);
        }
    }

    /// The frames that anything is suggested for, or was when their cameras had other bases.
    pub fn frames(&self) -> impl Iterator<Item = &FrameId> {
        self.by_frame.keys()
    }
}

/// Whether two say the same; of two without an answer the reasons are compared, and not how long it took to find none.
fn says_the_same(new: &Suggestion, known: &Suggestion) -> bool {
    let reason = |suggestion: &Suggestion| Some(suggestion.solution.as_ref()?.warnings.first()?.message.clone());
    let both_unanswered = new.is_unanswered() && known.is_unanswered();
    (both_unanswered && reason(new) == reason(known)) || (new.ptz == known.ptz && new.solution == known.solution)
}
