//! The suggestions of the program, by frame and in batches.
//!
//! A frame keeps a stack of a few suggestions. Readers see the topmost that was made for the
//! present base of the frame's camera. Discarding a batch removes its suggestions, which uncovers
//! those beneath them.

use std::collections::BTreeMap;
use touchline_core::camera::CameraBase;
use touchline_documents::document::{FrameId, SolutionSource, Suggestion};

/// Number of bases for which a frame keeps suggestions: when undo restores a base, its suggestions
/// are valid again.
pub(super) const KEPT_BASES: usize = 4;

/// Number of suggestions that a frame keeps for each base, the visible one included.
pub(super) const KEPT_SUGGESTIONS: usize = 4;

/// Identifies a batch of suggestions while its document is open.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub struct BatchId(u64);

/// The source of a batch of suggestions.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum Finder {
    /// An earlier session: the document had them when it was opened.
    Earlier {
        /// Their source in that session.
        source: Option<SolutionSource>,
    },
    /// The forest of the background trainer, including cameras that were tracked from its answers.
    Forest {
        /// Generation of the forest: later ones have greater numbers.
        generation: u64,
    },
    /// A command of the user.
    Command {
        /// Name of the command.
        name: String,
    },
}

impl Finder {
    /// Whether a forest gave these answers, in this session or in an earlier one.
    const fn is_forest(&self) -> bool {
        matches!(
            self,
            Self::Forest { .. }
                | Self::Earlier {
                    source: Some(SolutionSource::Forest)
                }
        )
    }
}

/// How a new answer relates to the suggestions for its frame.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(in crate::proposals) enum Novelty {
    /// It differs from the topmost suggestion.
    New,
    /// It equals the topmost suggestion.
    Same,
    /// It was made for an earlier revision of the frame, or by a forest with answers that were
    /// discarded there.
    Stale,
}

/// The suggestions of the program, by frame.
#[derive(Clone, Debug, Default)]
pub(in crate::proposals) struct Suggestions {
    /// The stack of each frame, with the topmost suggestion last.
    by_frame: BTreeMap<FrameId, Vec<KeptSuggestion>>,
    finders: BTreeMap<BatchId, Finder>,
    /// Number of the last batch.
    last: u64,
    /// Frames in which suggestions were discarded, with the generation of the newest forest that
    /// may not answer there again; 0 if any may.
    discarded: BTreeMap<FrameId, u64>,
}

/// A suggestion in its batch.
#[derive(Clone, Debug)]
struct KeptSuggestion {
    batch: BatchId,
    suggestion: Suggestion,
}

impl KeptSuggestion {
    fn source(&self) -> Option<SolutionSource> {
        self.suggestion.solution.as_ref()?.source
    }

    /// Whether it is a camera that another program gave.
    fn is_imported(&self) -> bool {
        self.suggestion.ptz.is_some() && self.source() == Some(SolutionSource::Import)
    }

    /// Whether it is a camera from a command of the user that did not use a forest.
    fn is_found_without_forest(&self, finder: Option<&Finder>) -> bool {
        let is_by_command = matches!(finder, Some(Finder::Command { .. }));
        is_by_command
            && self.suggestion.ptz.is_some()
            && self.source() != Some(SolutionSource::Forest)
    }
}

/// The frames from which a batch was removed.
#[derive(Clone, Debug, Default, PartialEq)]
pub(in crate::proposals) struct RemovedBatch {
    /// Which frames, each with what was removed last.
    pub removed: Vec<(FrameId, Suggestion)>,
    /// Generation of the newest forest that may not answer there again; none if no forest found the
    /// batch.
    pub refused: Option<u64>,
}

impl Suggestions {
    /// Opens a new batch.
    pub fn open_batch(&mut self, finder: Finder) -> BatchId {
        self.last += 1;
        let batch = BatchId(self.last);
        self.finders.insert(batch, finder);
        batch
    }

    /// The batch of a finder that answers repeatedly; a new one if it has none.
    pub fn batch_of_finder(&mut self, finder: Finder) -> BatchId {
        // Of several batches of a finder the latest, so that new answers join those shown last.
        let known = self
            .finders
            .iter()
            .rev()
            .find(|(_, known)| **known == finder);
        let known = known.map(|(batch, _)| *batch);
        known.unwrap_or_else(|| self.open_batch(finder))
    }

    /// The finder of a batch.
    pub fn finder(&self, batch: BatchId) -> Option<&Finder> {
        self.finders.get(&batch)
    }

    /// The topmost suggestion for a frame, if its camera has this base.
    pub fn topmost(&self, frame: &FrameId, base: Option<&CameraBase>) -> Option<&Suggestion> {
        self.topmost_kept(frame, base).map(|kept| &kept.suggestion)
    }

    /// The batch of [`Self::topmost`].
    pub fn topmost_batch(&self, frame: &FrameId, base: Option<&CameraBase>) -> Option<BatchId> {
        self.topmost_kept(frame, base).map(|kept| kept.batch)
    }

    fn topmost_kept(&self, frame: &FrameId, base: Option<&CameraBase>) -> Option<&KeptSuggestion> {
        self.by_frame
            .get(frame)?
            .iter()
            .rev()
            .find(|kept| kept.suggestion.base.as_ref() == base)
    }

    fn topmost_kept_mut(
        &mut self,
        frame: &FrameId,
        base: Option<&CameraBase>,
    ) -> Option<&mut KeptSuggestion> {
        self.by_frame
            .get_mut(frame)?
            .iter_mut()
            .rev()
            .find(|kept| kept.suggestion.base.as_ref() == base)
    }

    /// How an answer for a batch relates to the suggestions for its frame.
    pub fn novelty(&self, frame: &FrameId, batch: BatchId, suggestion: &Suggestion) -> Novelty {
        // Answers of a forest that was refused in this frame come too late.
        if let Some(Finder::Forest { generation }) = self.finder(batch)
            && self
                .discarded
                .get(frame)
                .is_some_and(|refused| generation <= refused)
        {
            return Novelty::Stale;
        }
        match self.topmost(frame, suggestion.base.as_ref()) {
            Some(known) if suggestion.revision < known.revision => Novelty::Stale,
            Some(known) if says_the_same(suggestion, known) => Novelty::Same,
            _ => Novelty::New,
        }
    }

    /// Puts a suggestion on top of a frame's stack. It replaces what the same batch suggested for
    /// the same base, and a forest's answer replaces that of an earlier forest.
    ///
    /// A forest's answer goes beneath a camera that a command of the user found without a forest.
    /// Forests are not queried for such frames, so the answer belongs to a request from before.
    pub fn put(&mut self, frame: &FrameId, batch: BatchId, suggestion: Suggestion) {
        let Self {
            by_frame, finders, ..
        } = self;
        let is_of_forest = finders.get(&batch).is_some_and(Finder::is_forest);
        let kept = by_frame.entry(frame.clone()).or_default();
        // One suggestion per batch and base, and one of all forests.
        kept.retain(|known| {
            let are_of_forests =
                is_of_forest && finders.get(&known.batch).is_some_and(Finder::is_forest);
            let is_replaced = known.suggestion.base == suggestion.base
                && (known.batch == batch || are_of_forests);
            !is_replaced
        });
        // Insert below the cameras that stay above, else on top.
        let lowest_above = kept.iter().position(|known| {
            is_of_forest
                && known.suggestion.base == suggestion.base
                && known.is_found_without_forest(finders.get(&known.batch))
        });
        let at = lowest_above.unwrap_or(kept.len());
        kept.insert(at, KeptSuggestion { batch, suggestion });
        forget_oldest(kept);
    }

    /// Changes a frame from what it shows on one side of a step to what it shows on the other. What
    /// the step, or another command since, has put on top goes with its batch; answers of a forest
    /// that came meanwhile stay beneath what is given back.
    pub fn turn(
        &mut self,
        frame: &FrameId,
        base: Option<&CameraBase>,
        [from, to]: [Option<&Suggestion>; 2],
        finder: &Finder,
    ) {
        let is_shown = |known: Option<&Suggestion>, side: Option<&Suggestion>| match (known, side) {
            (Some(known), Some(side)) => has_same_camera(known, side),
            (known, side) => known.is_none() && side.is_none(),
        };
        if is_shown(self.topmost(frame, base), to) {
            return;
        }
        if let Some(top) = self.topmost_kept(frame, base) {
            let batch = top.batch;
            let is_by_command = matches!(self.finder(batch), Some(Finder::Command { .. }));
            let goes = is_by_command || is_shown(Some(&top.suggestion), from);
            if let Some(kept) = self.by_frame.get_mut(frame).filter(|_| goes) {
                kept.retain(|kept| kept.batch != batch || kept.suggestion.base.as_ref() != base);
            }
        }
        if let Some(to) = to
            && !is_shown(self.topmost(frame, base), Some(to))
        {
            let batch = self.batch_of_finder(finder.clone());
            self.put(frame, batch, to.clone());
        }
    }

    /// Moves a forest's answer to the batch of a later forest that gave the same answer.
    pub fn move_to_batch(&mut self, frame: &FrameId, base: Option<&CameraBase>, batch: BatchId) {
        let is_forest = |batch| self.finder(batch).is_some_and(Finder::is_forest);
        let Some(known) = self.topmost_batch(frame, base) else {
            return;
        };
        if is_forest(batch)
            && is_forest(known)
            && let Some(kept) = self.topmost_kept_mut(frame, base)
        {
            kept.batch = batch;
        }
    }

    /// Marks the topmost suggestion of a frame as valid for the frame's present revision. False if
    /// another suggestion is shown.
    pub fn keep(&mut self, frame: &FrameId, shown: &Suggestion) -> bool {
        let Some(kept) = self.topmost_kept_mut(frame, shown.base.as_ref()) else {
            return false;
        };
        let known = &mut kept.suggestion;
        // The revision is left out of the comparison: it is what changed.
        let is_same = has_same_camera(known, shown);
        if is_same {
            known.revision = shown.revision;
        }
        is_same
    }

    /// Removes a batch from the frames for which `is_open` is true, except cameras of other
    /// programs: nothing was suggested instead of these. If a forest found it, neither
    /// that forest nor any up to `newest_forest` may answer there again.
    pub fn take_out(
        &mut self,
        batch: BatchId,
        newest_forest: u64,
        is_open: impl Fn(&FrameId) -> bool,
    ) -> RemovedBatch {
        let mut taken = RemovedBatch::default();
        for (frame, kept) in self.by_frame.iter_mut().filter(|(frame, _)| is_open(frame)) {
            let goes = |kept: &KeptSuggestion| kept.batch == batch && !kept.is_imported();
            if let Some(last) = kept.iter().rfind(|kept| goes(kept)) {
                taken.removed.push((frame.clone(), last.suggestion.clone()));
                kept.retain(|kept| !goes(kept));
            }
        }
        // Forests that are already trained would give the discarded answers again.
        taken.refused = match self.finders.get(&batch) {
            Some(Finder::Forest { generation }) => Some(newest_forest.max(*generation)),
            Some(finder) if finder.is_forest() => Some(newest_forest),
            _ => None,
        };
        for (frame, _) in &taken.removed {
            // Batches may be discarded in any order, so the refusal of a newer forest stays.
            let newest = self.discarded.entry(frame.clone()).or_default();
            *newest = taken.refused.unwrap_or(0).max(*newest);
        }
        taken
    }

    /// The latest camera of another program for a frame, for any base.
    pub fn imported_camera(&self, frame: &FrameId) -> Option<&Suggestion> {
        let kept = self.by_frame.get(frame)?.iter();
        let imported = kept.rev().find(|kept| kept.is_imported());
        imported.map(|kept| &kept.suggestion)
    }

    /// Whether any suggestion for a frame has been discarded.
    pub fn has_discarded(&self, frame: &FrameId) -> bool {
        self.discarded.contains_key(frame)
    }

    /// The frames with suggestions for any base.
    pub fn frames(&self) -> impl Iterator<Item = &FrameId> {
        self.by_frame.keys()
    }
}

/// Drops the oldest suggestions beyond [`KEPT_SUGGESTIONS`] for each of the latest [`KEPT_BASES`]
/// bases.
fn forget_oldest(kept: &mut Vec<KeptSuggestion>) {
    let mut bases: Vec<Option<CameraBase>> = Vec::new();
    let mut left = Vec::with_capacity(kept.len());
    // From the top, so that the latest bases and suggestions are kept.
    for topmost in kept.drain(..).rev() {
        let base = topmost.suggestion.base;
        if !bases.contains(&base) {
            bases.push(base);
        }
        let for_base = left
            .iter()
            .filter(|kept: &&KeptSuggestion| kept.suggestion.base == base)
            .count();
        if bases.len() <= KEPT_BASES && for_base < KEPT_SUGGESTIONS {
            left.push(topmost);
        }
    }
    kept.extend(left.into_iter().rev());
}

/// Whether two suggestions are equal. Two without an answer are equal if their reasons are; timings
/// are ignored.
fn says_the_same(new: &Suggestion, known: &Suggestion) -> bool {
    let both_unanswered = new.is_unanswered() && known.is_unanswered();
    (both_unanswered && reason(new) == reason(known)) || has_same_camera(new, known)
}

/// Whether two suggestions are the same camera, found in the same way, or the same lack of one.
fn has_same_camera(one: &Suggestion, other: &Suggestion) -> bool {
    one.ptz == other.ptz && one.solution == other.solution
}

/// Why a suggestion has no answer: its first warning.
fn reason(suggestion: &Suggestion) -> Option<&str> {
    let solution = suggestion.solution.as_ref()?;
    Some(solution.warnings.first()?.message.as_str())
}
