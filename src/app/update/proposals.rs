//! Proposals of the forest, and which of them are outdated.

use super::App;
use crate::app::action::Effect;
use crate::app::session::{Level, Saving};
use crate::document::{Camera, CameraId, Document, Frame, FrameStatus};
use crate::proposals::{NoProposal, Proposal};
use std::collections::BTreeSet;

impl App {
    /// Takes proposals in: journalled, but not a step of undo. Those of an older forest than the last one are dropped.
    pub(super) fn take_proposals(&mut self, proposals: &[Proposal]) {
        let Some(open) = self.open.as_mut().filter(|open| open.read_only.is_none()) else { return };
        let Some(edit) = open.take_proposals(proposals) else { return };
        self.effects.push(Effect::Journal { edit, revision: open.revision });
        if !matches!(self.session.saving, Saving::Failed { .. }) {
            self.session.saving = Saving::Pending;
        }
        let mistake = proposals.iter().find_map(|proposal| match &proposal.outcome {
            Err(mistake @ NoProposal::Panicked { .. }) => Some(mistake.to_string()),
            _ => None,
        });
        if let Some(mistake) = mistake {
            self.session.notify(Level::Error, format!("No proposal: {mistake}."));
        }
    }

    /// Within a step that moved a camera: what was proposed for the old place goes, and accepted lines stay on the picture
    /// where they were.
    pub(super) fn follow_base(&mut self) {
        let Some(open) = &mut self.open else { return };
        if !open.history.is_open() {
            return;
        }
        let before = open.journalled.shown().clone();
        let moved = moved_frames(&before, &open.document);
        if moved.is_empty() {
            return;
        }
        let mut gone = 0;
        for index in moved {
            let Some(frame) = open.document.frames.get(index) else { continue };
            if frame.status == FrameStatus::Reference {
                if frame.is_suggestion() {
                    open.document.refit(index, &before);
                }
            } else if frame.is_suggestion() {
                withdraw(&mut open.document.frames[index]);
                gone += 1;
                continue;
            }
            // A later correction must not start from what was proposed for the old place.
            if keeps_proposal(&open.document.frames[index])
                && let Some(solution) = &mut open.document.frames[index].solution
            {
                solution.proposed = None;
            }
        }
        if gone > 0 {
            let (proposals, were) = if gone == 1 { ("proposal", "was") } else { ("proposals", "were") };
            let text = format!("{gone} {proposals} for the old base {were} discarded; proposing again.");
            self.session.notify(Level::Info, text);
        }
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

/// The frames with a camera that has moved since, ascending.
fn moved_frames(before: &Document, now: &Document) -> Vec<usize> {
    let base = |document: &Document, id: &CameraId| document.camera(id).and_then(Camera::base);
    let ids = now.cameras.iter().filter(|_| before.cameras != now.cameras).map(|camera| &camera.id);
    let moved: BTreeSet<&CameraId> = ids.filter(|id| base(before, id) != base(now, id)).collect();
    let given_away = |index: &usize| now.frames[*index].camera != before.frames[*index].camera;
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
