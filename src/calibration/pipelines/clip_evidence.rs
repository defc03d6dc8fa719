//! The evidence of clips between passes: in memory, or on disk with the results of the passes, so
//! that memory does not grow with the length of a video.

use super::kept_work::{KeptWork, WorkKey};
use crate::calibrate::{ClipEvidence, ClipFrames, EvidenceBytes, TrackClipOptions, TrackedClip};
use std::sync::Arc;
use touchline_core::field::FieldModel;
use touchline_documents::document::DocumentAt;

/// The evidence of each clip of a document.
pub(super) struct ClipEvidences {
    work: Arc<KeptWork>,
    clips: Vec<OneClip>,
}

/// The evidence of one clip.
#[derive(Default)]
struct OneClip {
    held: ClipEvidence,
    state: State,
}

/// Where the evidence of a clip comes from. Together with the inputs of a pass it determines the
/// result.
#[derive(Clone, Default)]
enum State {
    /// There is none yet.
    #[default]
    Empty,
    /// It is on disk since the pass with this key.
    After(WorkKey),
    /// It is in memory alone, and passes over it cannot be kept.
    Held,
}

impl ClipEvidences {
    /// Evidence in memory; passes are not kept.
    pub fn in_memory(evidence: Vec<ClipEvidence>) -> Self {
        let clips = evidence.into_iter().map(|held| OneClip {
            held,
            state: State::Held,
        });
        Self {
            work: Arc::new(KeptWork::none()),
            clips: clips.collect(),
        }
    }

    /// No evidence yet; passes and evidence are kept where `work` is.
    pub const fn in_work(work: Arc<KeptWork>) -> Self {
        Self {
            work,
            clips: Vec::new(),
        }
    }

    /// The evidence in memory.
    pub fn into_memory(self) -> Vec<ClipEvidence> {
        self.clips.into_iter().map(|clip| clip.held).collect()
    }

    /// Makes room for a number of clips.
    pub fn resize(&mut self, clips: usize) {
        self.clips.resize_with(clips, OneClip::default);
    }

    /// The finished work.
    pub fn work(&self) -> &KeptWork {
        &self.work
    }

    /// The key of a pass over a clip; none if it is not kept.
    pub fn key(
        &self,
        at: DocumentAt<'_>,
        clip: &ClipFrames,
        (index, field): (usize, &FieldModel),
        options: &TrackClipOptions,
    ) -> Option<WorkKey> {
        let before = match &self.clips[index].state {
            State::Empty => "",
            State::After(key) => key.name(),
            State::Held => return None,
        };
        let mut parts = self.work.begin_key("clip")?;
        parts.add_text(before);
        parts.add_text(&format!("{options:?}"));
        parts.add(field);
        parts.add_document(at);
        parts.add_clip(at, clip);
        parts.finish()
    }

    /// The kept result of a pass, after which the evidence is that of this pass.
    pub fn recall(&mut self, index: usize, key: &WorkKey) -> Option<TrackedClip> {
        let tracked = self.work.recall(key)?;
        self.clips[index] = OneClip {
            held: ClipEvidence::default(),
            state: State::After(key.clone()),
        };
        Some(tracked)
    }

    /// The evidence of a clip, to be used and added to in a pass.
    pub fn load(&mut self, index: usize, clip: &ClipFrames) -> &mut ClipEvidence {
        let OneClip { held, state } = &mut self.clips[index];
        if let State::After(key) = state
            && let Some(kept) = read(&self.work, key, clip)
        {
            *held = kept;
        }
        held
    }

    /// Keeps the result of a pass with its evidence, which leaves the memory. Without a result
    /// there is no evidence either, as if the pass had not been.
    pub fn keep(&mut self, index: usize, key: Option<&WorkKey>, tracked: Option<&TrackedClip>) {
        let Some(key) = key else { return };
        let OneClip { held, state } = &mut self.clips[index];
        let Some(tracked) = tracked else {
            *held = ClipEvidence::default();
            return;
        };
        // The result last: where it is, the evidence is, too.
        if write(&self.work, key, held).is_some() {
            self.work.keep(key, tracked);
            *held = ClipEvidence::default();
            *state = State::After(key.clone());
        } else {
            *state = State::Held;
        }
    }
}

/// The name of the file with the evidence after a pass.
fn name_of_evidence(key: &WorkKey) -> String {
    format!("{}-evidence", key.name())
}

/// Writes evidence; none if that is not possible. The points are the same in each pass, and their
/// file is named by what it holds.
fn write(work: &KeptWork, key: &WorkKey, evidence: &ClipEvidence) -> Option<()> {
    let EvidenceBytes { points, paint } = evidence.to_bytes()?;
    let points = work.keep_content(&points)?;
    let file = [points.as_bytes(), &paint].concat();
    work.keep_bytes(&name_of_evidence(key), &file).then_some(())
}

fn read(work: &KeptWork, key: &WorkKey, clip: &ClipFrames) -> Option<ClipEvidence> {
    /// Length of the name of a file.
    const NAME_BYTES: usize = 32;
    let file = work.recall_bytes(&name_of_evidence(key))?;
    let (points, paint) = file.split_at_checked(NAME_BYTES)?;
    let bytes = EvidenceBytes {
        points: work.recall_bytes(std::str::from_utf8(points).ok()?)?,
        paint: paint.to_vec(),
    };
    ClipEvidence::from_bytes(&bytes, clip)
}
