//! The forest's answers so far, so that it is queried again only for a reason.
//!
//! A frame is queried again if it or its camera has changed, if the document has lost the answer,
//! if snapping was switched, or if a newer forest exists and the answer was missing, uncertain, or
//! given by a forest with training samples that have since been withdrawn.

use crate::app::AnswerKey;
use std::collections::BTreeMap;
use touchline_calibration::proposals::{FrameRequest, NoProposal, Proposal, RefusedForests};
use touchline_documents::document::{Document, Frame, FrameId, SolutionSource};
use touchline_vision::relocalize::{CERTAIN, ForestModel};

/// The last answer for each frame.
#[derive(Debug, Default)]
pub(super) struct AnswerCache {
    entries: BTreeMap<FrameId, Entry>,
    /// The first generation since the last withdrawal of a training sample. Answers of older
    /// forests are unreliable.
    trusted_from: u64,
    /// Frames of which answers were discarded, and the newest forest that is not queried for them
    /// again.
    refused: BTreeMap<FrameId, u64>,
    /// Old and new generation of forests that were renumbered.
    renumbered: BTreeMap<u64, u64>,
}

/// How the forest is queried.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) struct ForestQuerySettings {
    /// The forest: a later one has a greater number.
    pub(super) generation: u64,
    /// Whether answers are aligned to the painted lines.
    pub(super) snapping: bool,
}

#[derive(Debug)]
struct Entry {
    /// The state of the frame when the forest was queried.
    request: FrameRequest,
    by: ForestQuerySettings,
    answer: CachedAnswer,
    /// Whether the document has shown the answer.
    recorded: bool,
}

/// What the forest answered.
#[derive(Clone, Copy, Debug, PartialEq)]
enum CachedAnswer {
    /// A camera, right with this probability.
    Camera(f64),
    /// This forest finds no camera; another one may.
    NotFound,
    /// No forest can find a camera.
    Never,
}

impl AnswerCache {
    /// Takes in a new state of the document: drops answers that no longer apply or that the
    /// document has lost.
    pub(super) fn look_at(&mut self, document: &Document) {
        self.entries.retain(|id, entry| {
            let Some(frame) = document.frames.by_id(id) else {
                return false;
            };
            // Lost: the document once showed the answer, does not show it any more, and the frame
            // is undecided, as after an undone edit. An answer that was never shown may still be
            // on its way.
            let held = is_by_forest(frame);
            let lost = entry.recorded && !held && frame.is_open();
            entry.recorded |= held;
            // A decision of the user changes the revision, too, but says nothing against the
            // answer: it is dropped only if picture, camera or base have changed.
            let is_edited = frame.is_open() && entry.request.revision != frame.revision;
            !lost && !is_edited && entry.request.is_still(document, frame)
        });
        for frame in &document.frames {
            // Proposals that the document already had when it was opened count as answers of
            // generation 0.
            let confidence = frame.confidence();
            if is_by_forest(frame)
                && frame.ptz.is_some()
                && frame.is_open()
                && let Some(confidence) = confidence
            {
                self.entries
                    .entry(frame.id.clone())
                    .or_insert_with(|| Entry {
                        request: FrameRequest::from_frame(document, frame),
                        by: ForestQuerySettings {
                            generation: 0,
                            snapping: frame.is_snapped_proposal(),
                        },
                        answer: CachedAnswer::Camera(confidence),
                        recorded: true,
                    });
            }
        }
    }

    /// Whether the forest is to be queried for a frame (see the page of the module).
    pub(super) fn wants(
        &self,
        document: &Document,
        index: usize,
        model: &ForestModel,
        asking: ForestQuerySettings,
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
    pub(super) fn enter(&mut self, proposal: &Proposal, by: ForestQuerySettings) {
        let answer = match &proposal.outcome {
            Ok(answer) => CachedAnswer::Camera(answer.confidence),
            Err(NoProposal::NotFound(_) | NoProposal::NoReferences { .. }) => {
                CachedAnswer::NotFound
            }
            Err(_) => CachedAnswer::Never,
        };
        let request = proposal.request.clone();
        let entry = Entry {
            request,
            by,
            answer,
            recorded: false,
        };
        self.entries.insert(proposal.frame.clone(), entry);
    }

    /// Records that the document shows an answer.
    pub(super) fn note_shown(&mut self, key: &AnswerKey) {
        if let Some(entry) = self.entries.get_mut(&key.frame)
            && entry.request.revision == key.revision
            && entry.by.generation == key.generation
        {
            entry.recorded = true;
        }
    }

    /// Records that forests up to a generation are not queried for some frames again.
    pub(super) fn refuse(
        &mut self,
        RefusedForests {
            frames,
            mut generation,
        }: RefusedForests,
    ) {
        // The sender may not know yet that the forest was renumbered. Each entry leads to a greater
        // number, so that the loop ends.
        while let Some(later) = self.renumbered.get(&generation) {
            generation = *later;
        }
        for frame in frames {
            let newest = self.refused.entry(frame).or_default();
            *newest = generation.max(*newest);
        }
    }

    /// Renumbers a forest from `generation` to `later` (the same trees, other stated probabilities,
    /// or read from disk) and keeps its refusals.
    pub(super) fn keep_refusing(&mut self, generation: u64, later: u64) {
        self.renumbered.insert(generation, later);
        self.refused
            .values_mut()
            .filter(|refused| **refused == generation)
            .for_each(|refused| *refused = later);
    }

    /// Whether a forest is not queried for a frame because its answer was discarded.
    pub(super) fn is_refused(&self, frame: &FrameId, generation: u64) -> bool {
        self.refused
            .get(frame)
            .is_some_and(|newest| generation <= *newest)
    }

    /// Marks the answers of all forests before `generation` as unreliable.
    pub(super) fn trust_from(&mut self, generation: u64) {
        self.trusted_from = generation;
    }

    /// Number of answers to one kind of query.
    pub(super) fn count_answers(&self, by: ForestQuerySettings) -> usize {
        self.entries.values().filter(|entry| entry.by == by).count()
    }

    /// Number of undecided frames with a proposed camera.
    pub(super) fn count_answered(&self, document: &Document) -> usize {
        self.open(document)
            .filter(|entry| matches!(entry.answer, CachedAnswer::Camera(_)))
            .count()
    }

    /// Number of undecided frames for which the forest finds no camera.
    pub(super) fn count_unanswered(&self, document: &Document) -> usize {
        self.open(document)
            .filter(|entry| entry.answer == CachedAnswer::NotFound)
            .count()
    }

    fn open<'a>(&'a self, document: &'a Document) -> impl Iterator<Item = &'a Entry> {
        self.entries
            .iter()
            .filter(move |(id, _)| {
                let frame = document.frames.by_id(id);
                frame.is_some_and(|frame| frame.is_open())
            })
            .map(|(_, entry)| entry)
    }
}

/// Whether the frame's camera is a proposal of the forest.
fn is_by_forest(frame: &Frame) -> bool {
    frame.source() == Some(SolutionSource::Forest)
}
