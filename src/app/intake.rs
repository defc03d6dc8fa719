//! Proposals taken into the document, its history and what is journalled.
//!
//! A proposal is not a step of undo, so it has to be in every kept state: otherwise undoing an
//! older step would lose it or bring an outdated one back. It is therefore written into each kept state of the document by
//! the same rule: only where the frame is the one that was asked for, seen from the same place, and nobody has clicked,
//! accepted or rejected it. What is journalled is one of these states too, so a step that is under way stays out of the
//! journal until it is committed.

use crate::document::{Camera, Document, Frame, Shared};
use crate::proposals::{NoProposal, Proposal};

/// Writes a batch of proposals into states of a document that share most of their frames.
pub(super) struct Intake<'a> {
    proposals: &'a [&'a Proposal],
    /// The cameras of the state that was looked at last.
    cameras: Vec<Shared<Camera>>,
    /// For each proposal the frame that was looked at last, and what it becomes.
    known: Vec<Option<Known>>,
}

struct Known {
    before: Shared<Frame>,
    after: Option<Shared<Frame>>,
}

impl<'a> Intake<'a> {
    /// Nothing has been looked at.
    pub(super) fn new(proposals: &'a [&'a Proposal]) -> Self {
        Self { proposals, cameras: Vec::new(), known: proposals.iter().map(|_| None).collect() }
    }

    /// What a state of the document becomes: frames by their places.
    pub(super) fn changes(&mut self, document: &Document) -> Vec<(usize, Shared<Frame>)> {
        if self.cameras != document.cameras {
            self.cameras.clone_from(&document.cameras);
            self.known.iter_mut().for_each(|known| *known = None);
        }
        let mut changes = Vec::new();
        for (proposal, known) in self.proposals.iter().zip(&mut self.known) {
            let Some(position) = document.frames.position_of(&proposal.frame) else { continue };
            let frame = &document.frames[position];
            let known = match known {
                Some(known) if known.before.is_same(frame) => known,
                _ => known.insert(Known { before: frame.clone(), after: answered(proposal, document, frame) }),
            };
            changes.extend(known.after.as_ref().map(|after| (position, after.clone())));
        }
        changes
    }
}

/// The frame with its answer; none where the answer does not concern it or says nothing new.
fn answered(proposal: &Proposal, document: &Document, frame: &Shared<Frame>) -> Option<Shared<Frame>> {
    // Nothing was asked: there is nothing to say about the frame.
    if matches!(proposal.outcome, Err(NoProposal::NoBase { .. })) || !proposal.fits(document) {
        return None;
    }
    let mut after = (**frame).clone();
    proposal.record(&mut after);
    let still_unanswered = after.is_unanswered() && after.no_answer() == frame.no_answer();
    (!still_unanswered).then(|| after.into())
}

/// Writes changes into a state of the document.
pub(super) fn write(document: &mut Document, changes: &[(usize, Shared<Frame>)]) {
    for (index, frame) in changes {
        if let Some(place) = document.frames.get_mut(*index) {
            *place = frame.clone();
        }
    }
}

/// What the edit of some changes is called.
pub(super) fn name(changes: &[(usize, Shared<Frame>)]) -> String {
    match changes.len() {
        1 => "Proposal for 1 frame".to_owned(),
        count => format!("Proposals for {count} frames"),
    }
}
