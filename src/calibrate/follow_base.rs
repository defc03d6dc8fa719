//! What becomes of frames whose camera has moved, where no clicks say it.

use crate::document::{Camera, CameraId, Document, Frame, FrameStatus};
use std::collections::BTreeSet;

/// The frames, ascending, whose camera has another base than in `before`, or that another camera has now.
pub(crate) fn moved_frames(before: &Document, now: &Document) -> Vec<usize> {
    let base = |document: &Document, id: &CameraId| document.camera(id).and_then(Camera::base);
    let ids = now.cameras.iter().filter(|_| before.cameras != now.cameras).map(|camera| &camera.id);
    let moved: BTreeSet<&CameraId> = ids.filter(|id| base(before, id) != base(now, id)).collect();
    let given_away = |index: &usize| {
        let frame = &now.frames[*index];
        before.frames.get(*index).is_some_and(|known| known.id == frame.id && known.camera != frame.camera)
    };
    let given_away = now.frames.differences(&before.frames).into_iter().filter(given_away);
    if moved.is_empty() {
        return given_away.collect();
    }
    let of_moved = |index: &usize| moved.contains(&now.frames[*index].camera);
    let mut frames: Vec<usize> = (0..now.frames.len()).filter(of_moved).chain(given_away).collect();
    frames.sort_unstable();
    frames.dedup();
    frames
}

impl Document {
    /// Lets a frame follow its camera, which was elsewhere in `before`: what was proposed for the old place is withdrawn, and
    /// accepted lines stay on the picture where they were. True where a proposal was withdrawn.
    pub(crate) fn follow_base(&mut self, index: usize, before: &Self) -> bool {
        let Some(frame) = self.frames.get(index) else { return false };
        if frame.status == FrameStatus::Reference {
            if frame.is_suggestion() {
                self.refit(index, before);
            }
        } else if frame.is_suggestion() {
            withdraw(&mut self.frames[index]);
            return true;
        }
        // A later correction must not start from what was proposed for the old place.
        if keeps_proposal(&self.frames[index])
            && let Some(solution) = &mut self.frames[index].solution
        {
            solution.proposed = None;
        }
        false
    }
}

/// Takes back what was proposed for a frame.
fn withdraw(frame: &mut Frame) {
    frame.ptz = None;
    frame.solution = None;
    if frame.status != FrameStatus::Rejected {
        frame.status = frame.undecided();
    }
}

/// Whether a person corrected a proposal that the frame still keeps.
fn keeps_proposal(frame: &Frame) -> bool {
    frame.solution.as_ref().is_some_and(|solution| solution.proposed.is_some())
}
