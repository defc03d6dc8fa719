//! The forest's answers so far, so that no frame is asked for twice without a reason.

use crate::app::AnswerKey;
use std::collections::BTreeMap;
use touchline_calibration::proposals::{Asked, NoProposal, Proposal, RefusedForests};
use touchline_documents::document::{Document, Frame, FrameId, SolutionSource};
use touchline_vision::relocalize::{CERTAIN, ForestModel};

/// The answers so far, by frame.
#[derive(Debug, Default)]
pub(super) struct AnswerCache {
    entries: BTreeMap<FrameId, Entry>,
    /// Forests before this one were trained with something that was withdrawn since.
    trusted_from: u64,
    /// Frames in which answers were discarded, and the newest forest that is not asked for them
    /// again.
    refused: BTreeMap<FrameId, u64>,
    /// Forests that go on under a later number, and that number.
    renumbered: BTreeMap<u64, u64>,
}

/// How a frame is asked for.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) struct Asking {
    /// Which forest answers: later ones have greater numbers.
    pub(super) generation: u64,
    /// Answers are snapped to the painted lines.
    pub(super) snapping: bool,
}

#[derive(Debug)]
struct Entry {
    asked: Asked,
    by: Asking,
    answer: CachedAnswer,
    /// The document holds it.
    recorded: bool,
}

/// An answer.
#[derive(Clone, Copy, Debug, PartialEq)]
enum CachedAnswer {
    /// A camera, right with this probability.
    Camera(f64),
    /// None that this forest knows; another may.
    NotFound,
    /// None that any forest could find.
    Never,
}

impl AnswerCache {
    /// Updates the cache for a new state of the document: drops answers that no longer apply or
    /// that the document has lost.
    pub(super) fn look_at(&mut self, document: &Document) {
        self.entries.retain(|id, entry| {
            let Some(frame) = document.frames.by_id(id) else {
                return false;
            };
            let held = is_by_forest(frame);
            let lost = entry.recorded && !held && frame.is_open();
            entry.recorded |= held;
            let is_edited = frame.is_open() && entry.asked.revision != frame.revision;
            !lost && !is_edited && entry.asked.is_still(document, frame)
        });
        for frame in &document.frames {
            // What an earlier session proposed.
            let confidence = frame
                .solution
                .as_ref()
                .and_then(|solution| solution.confidence);
            if is_by_forest(frame)
                && frame.ptz.is_some()
                && frame.is_open()
                && let Some(confidence) = confidence
            {
                self.entries
                    .entry(frame.id.clone())
                    .or_insert_with(|| Entry {
                        asked: Asked::of(document, frame),
                        by: Asking {
                            generation: 0,
                            snapping: frame.is_snapped_proposal(),
                        },
                        answer: CachedAnswer::Camera(confidence),
                        recorded: true,
                    });
            }
        }
    }

    /// Whether a forest is to be asked for a frame: not where an earlier one was sure, in the same
    /// way.
    pub(super) fn wants(
        &self,
        document: &Document,
        index: usize,
        model: &ForestModel,
        asking: Asking,
    ) -> bool {
        let Some(frame) = document.frames.get(index) else {
            return false;
        };
        if self.is_refused(&frame.id, asking.generation) {
            return false;
        }
        if !frame.is_open()
            || frame.is_answered_without_forest()
            || model.camera(frame.camera.as_str()).is_none()
        {
            return false;
        }
        let Some(entry) = self.entries.get(&frame.id) else {
            return true;
        };
        let is_older = entry.by.generation < asking.generation;
        match entry.answer {
            CachedAnswer::Camera(confidence) => {
                let is_doubtful = confidence < CERTAIN || entry.by.generation < self.trusted_from;
                entry.by.snapping != asking.snapping || is_older && is_doubtful
            }
            CachedAnswer::NotFound => is_older,
            CachedAnswer::Never => false,
        }
    }

    /// Stores an answer.
    pub(super) fn enter(&mut self, proposal: &Proposal, by: Asking) {
        let answer = match &proposal.outcome {
            Ok(answer) => CachedAnswer::Camera(answer.confidence),
            Err(NoProposal::NotFound(_) | NoProposal::NoReferences { .. }) => {
                CachedAnswer::NotFound
            }
            Err(_) => CachedAnswer::Never,
        };
        let asked = proposal.asked.clone();
        let entry = Entry {
            asked,
            by,
            answer,
            recorded: false,
        };
        self.entries.insert(proposal.frame.clone(), entry);
    }

    /// The document shows an answer.
    pub(super) fn note_shown(&mut self, key: &AnswerKey) {
        let is_it = |entry: &&mut Entry| {
            entry.asked.revision == key.revision && entry.by.generation == key.generation
        };
        if let Some(entry) = self.entries.get_mut(&key.frame).filter(is_it) {
            entry.recorded = true;
        }
    }

    /// Forests that are not asked for some frames again.
    pub(super) fn refuse(
        &mut self,
        RefusedForests {
            frames,
            mut generation,
        }: RefusedForests,
    ) {
        // Whoever refused it may not have heard of its later number.
        while let Some(later) = self.renumbered.get(&generation) {
            generation = *later;
        }
        for frame in frames {
            let newest = self.refused.entry(frame).or_default();
            *newest = generation.max(*newest);
        }
    }

    /// The forest of a generation goes on under the number of a later one: where it was refused, it
    /// still is.
    pub(super) fn keep_refusing(&mut self, generation: u64, later: u64) {
        self.renumbered.insert(generation, later);
        self.refused
            .values_mut()
            .filter(|refused| **refused == generation)
            .for_each(|refused| *refused = later);
    }

    /// Whether a forest is not to answer for a frame, because what it answered was discarded.
    pub(super) fn is_refused(&self, frame: &FrameId, generation: u64) -> bool {
        self.refused
            .get(frame)
            .is_some_and(|newest| generation <= *newest)
    }

    /// Answers of forests before this one are no longer reliable.
    pub(super) fn trust_from(&mut self, generation: u64) {
        self.trusted_from = generation;
    }

    /// How many answers a forest has given in one way.
    pub(super) fn given_by(&self, by: Asking) -> usize {
        self.entries.values().filter(|entry| entry.by == by).count()
    }

    /// How many open frames have a camera proposed.
    pub(super) fn answered(&self, document: &Document) -> usize {
        self.open(document)
            .filter(|entry| matches!(entry.answer, CachedAnswer::Camera(_)))
            .count()
    }

    /// How many open frames have no answer.
    pub(super) fn unanswered(&self, document: &Document) -> usize {
        self.open(document)
            .filter(|entry| entry.answer == CachedAnswer::NotFound)
            .count()
    }

    fn open<'a>(&'a self, document: &'a Document) -> impl Iterator<Item = &'a Entry> {
        let is_open = |id: &FrameId| {
            document
                .frames
                .by_id(id)
                .is_some_and(|frame| frame.is_open())
        };
        self.entries
            .iter()
            .filter(move |(id, _)| is_open(id))
            .map(|(_, entry)| entry)
    }
}

/// Whether its camera was proposed by the forest.
fn is_by_forest(frame: &Frame) -> bool {
    frame.source() == Some(SolutionSource::Forest)
}
