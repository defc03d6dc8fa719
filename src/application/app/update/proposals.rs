//! Proposals of the forest, and which of them are outdated.

use super::App;
use crate::app::session::Level;
use touchline_calibration::calibrate::follow_all_bases;
use touchline_calibration::proposals::{CarriedProposal, NoProposal, Proposal};

impl App {
    /// Takes proposals in: journalled, but not a step of undo. Those of an older forest than the last one are dropped.
    pub(super) fn take_proposals(&mut self, proposals: &[Proposal]) {
        let Some(open) = self.open.as_mut().filter(|open| open.read_only.is_none()) else { return };
        let Some(edit) = open.take_proposals(proposals) else { return };
        self.journal_edit(edit);
        let mistake = proposals.iter().find_map(|proposal| match &proposal.outcome {
            Err(mistake @ NoProposal::Panicked { .. }) => Some(mistake.to_string()),
            _ => None,
        });
        if let Some(mistake) = mistake {
            self.session.notify(Level::Error, format!("No proposal: {mistake}."));
        }
    }

    /// Takes in cameras that were carried from what the forest proposed, in the same way.
    pub(super) fn take_carried(&mut self, carried: &[CarriedProposal]) {
        let open = self.open.as_mut().filter(|open| open.read_only.is_none());
        if let Some(edit) = open.and_then(|open| open.take_carried(carried)) {
            self.journal_edit(edit);
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
        let withdrawn = follow_all_bases(&mut open.document, &before);
        self.tell_withdrawn(withdrawn);
    }

    /// Tells of proposals that were made for an old base.
    pub(in crate::app) fn tell_withdrawn(&mut self, withdrawn: usize) {
        if withdrawn > 0 {
            let (proposals, were) = if withdrawn == 1 { ("proposal", "was") } else { ("proposals", "were") };
            let text = format!("{withdrawn} {proposals} for the old base {were} discarded; proposing again.");
            self.session.notify(Level::Info, text);
        }
    }
}
