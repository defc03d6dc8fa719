//! What the program suggests, by frame.

use std::collections::BTreeMap;
use touchline_core::camera::CameraBase;
use touchline_documents::document::{FrameId, Suggestion};

/// Answers that are kept of a frame, each for another base of its camera: when undo brings a base back, what was suggested
/// for it holds again.
pub(super) const KEPT_BASES: usize = 4;

/// What the program suggests, by frame.
#[derive(Clone, Debug, Default, PartialEq)]
pub(super) struct Suggestions {
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
    pub(super) fn is_news(&self, frame: &FrameId, suggestion: &Suggestion) -> bool {
        let known = self.of(frame, suggestion.base.as_ref());
        known.is_none_or(|known| suggestion.revision >= known.revision && !says_the_same(suggestion, known))
    }

    /// Puts a suggestion in place of an earlier one for the same base.
    pub(super) fn put(&mut self, frame: &FrameId, suggestion: Suggestion) {
        let kept = self.by_frame.entry(frame.clone()).or_default();
        kept.retain(|known| known.base != suggestion.base);
        kept.push(suggestion);
        if kept.len() > KEPT_BASES {
            kept.remove(0);
        }
    }

    /// Forgets what is suggested for a frame while its camera has this base.
    pub fn forget(&mut self, frame: &FrameId, base: Option<&CameraBase>) {
        if let Some(kept) = self.by_frame.get_mut(frame) {
            kept.retain(|known| known.base.as_ref() != base);
        }
    }

    /// The frames that anything is suggested for, or was when their cameras had other bases.
    pub(super) fn frames(&self) -> impl Iterator<Item = &FrameId> {
        self.by_frame.keys()
    }
}

/// Whether two say the same; of two without an answer the reasons are compared, and not how long it took to find none.
fn says_the_same(new: &Suggestion, known: &Suggestion) -> bool {
    let reason = |suggestion: &Suggestion| Some(suggestion.solution.as_ref()?.warnings.first()?.message.clone());
    let both_unanswered = new.is_unanswered() && known.is_unanswered();
    (both_unanswered && reason(new) == reason(known)) || (new.ptz == known.ptz && new.solution == known.solution)
}
