//! Edits of the user and suggestions: the view, the journal, and undo.

mod random;
mod undo;

use super::{Bases, Discarded, Project, SuggestionUpdate};
use crate::proposals::{Answer, BatchId, Finder, FrameRequest, Proposal, Timings};
use touchline_core::camera::CameraBase;
use touchline_core::geometry::ImageSize;
use touchline_core::testing::base_at;
use touchline_documents::document::{
    Document, Edit, Frame, FrameStatus, History, Shared, SolutionSource, Step, document_from_bytes,
    document_to_string,
};
use touchline_documents::testing::{WithFrames, match_from, solved_by};
use touchline_vision::relocalize::NotFound;

const SIZE: ImageSize = ImageSize::new(64, 36);

fn base(height_m: f64) -> CameraBase {
    base_at([0.0, -60.0, height_m], SIZE)
}

fn document(frames: usize) -> Document {
    match_from(&base(18.0), SIZE).with_numbered(frames, SIZE)
}

/// The forest's proposal for the present state of a frame: a camera, or none.
fn proposal(document: &Document, position: usize, pan_deg: Option<f64>) -> Proposal {
    let answer = |pan_deg| Answer::at_pan(pan_deg, 0.9);
    let outcome = pan_deg.map(answer).ok_or(
        NotFound::FewMatches {
            matched: 3,
            needed: 12,
        }
        .into(),
    );
    let frame = &document.frames[position];
    let request = FrameRequest::from_frame(document, frame);
    Proposal {
        frame: frame.id.clone(),
        request,
        generation: 1,
        outcome,
        timings: Timings::default(),
    }
}

/// Writes a suggested camera into a frame.
fn suggest_camera(frame: &mut Frame, pan_deg: f64, source: SolutionSource) {
    frame.ptz = Some(Answer::at_pan(pan_deg, 0.9).ptz);
    frame.solution = solved_by(source);
    frame.status = FrameStatus::Suggested;
}

/// A document as the window edits it, with its history and all journalled edits.
struct Desk {
    start: Document,
    project: Project,
    now: Document,
    history: History<Document>,
    journal: Vec<Edit>,
    /// Generation of the forest that answers.
    generation: u64,
}

impl Desk {
    fn of(start: Document) -> Self {
        let project = Project::from_document(start.clone());
        Self {
            now: start.clone(),
            start,
            project,
            history: History::default(),
            journal: Vec::new(),
            generation: 1,
        }
    }

    fn edit(&mut self, name: &str, change: impl FnOnce(&mut Document)) {
        self.history
            .begin(&self.project.edits_in(&self.now), Step::on_document(name));
        change(&mut self.now);
        self.history.commit(&self.project.edits_in(&self.now));
        self.take_in();
    }

    fn take_in(&mut self) {
        for (position, frame) in self.project.not_shown_in(&self.now) {
            self.now.frames[position] = frame;
        }
        self.journal
            .extend(self.project.take_in(&mut self.now, "Edit"));
    }

    fn suggest(&mut self, proposals: &[Proposal]) {
        let updates: Vec<_> = proposals.iter().filter_map(Proposal::update).collect();
        let Some(generation) = proposals.first().map(|proposal| proposal.generation) else {
            return;
        };
        let batch = self.project.batch_of_finder(Finder::Forest { generation });
        self.journal
            .extend(self.project.suggest(&mut self.now, batch, &updates));
    }

    /// Tracks cameras to frames: their positions and pans.
    fn carry(&mut self, cameras: &[(usize, f64)]) -> BatchId {
        let update = |(position, pan_deg): &(usize, f64)| {
            let record =
                |frame: &mut Frame| suggest_camera(frame, *pan_deg, SolutionSource::Tracking);
            SuggestionUpdate::from_recorded(&self.now, *position, record)
        };
        let updates: Vec<_> = cameras.iter().filter_map(update).collect();
        let batch = self.project.open_batch(Finder::Command {
            name: "Carry".to_owned(),
        });
        self.journal
            .extend(self.project.suggest(&mut self.now, batch, &updates));
        batch
    }

    fn discard(&mut self, batch: BatchId) -> Discarded {
        let discarded = self.project.discard(&mut self.now, batch, self.generation);
        self.journal.extend(discarded.edit.clone());
        discarded
    }

    /// Writes the document, and opens it again with its history.
    fn reopen(&mut self) {
        let text = document_to_string(self.project.view()).unwrap();
        self.now = document_from_bytes(text.as_bytes()).unwrap();
        self.project = Project::from_document(self.now.clone());
    }

    fn step(&mut self, back: bool) -> bool {
        let mut edited = self.project.edits_in(&self.now);
        let step = if back {
            self.history.undo(&mut edited)
        } else {
            self.history.redo(&mut edited)
        };
        let Some(step) = step else { return false };
        self.now = self.project.view_after(&edited, &step, back);
        self.take_in();
        true
    }

    fn accept(&mut self, position: usize) {
        self.edit("Accept", |document| {
            document.frames[position].status = FrameStatus::Reference;
        });
    }

    fn pans(&self) -> Vec<Option<f64>> {
        let pan_deg = |frame: &Shared<Frame>| {
            frame
                .ptz
                .as_ref()
                .map(|ptz| (1e6 * ptz.pan_deg).round() / 1e6)
        };
        self.now.frames.iter().map(pan_deg).collect()
    }

    fn check(&self) {
        let Self { project, now, .. } = self;
        for (edited, shown) in project.edited_document().frames.iter().zip(&now.frames) {
            assert!(!edited.shows_suggestion());
            let base = Bases::in_document(now).for_frame(edited);
            let suggestion = project
                .suggestions
                .topmost(&edited.id, base.as_ref())
                .filter(|_| edited.is_untouched());
            let mut expected = Frame::clone(edited);
            if let Some(suggestion) = suggestion {
                suggestion.show_in(&mut expected);
            }
            assert_eq!(
                **shown, expected,
                "people's work, and what is suggested where there is none"
            );
        }
        assert_eq!(*project.view(), *now);
        assert_eq!(project.view_with(project.edited_document()), *now);
        assert_eq!(project.edits_in(now), *project.edited_document());
        let mut read = self.start.clone();
        self.journal
            .iter()
            .for_each(|edit| edit.clone().apply(&mut read).unwrap());
        assert_eq!(read, *now, "the journal has it");
        let text = document_to_string(project.view()).unwrap();
        let reopened = Project::from_document(document_from_bytes(text.as_bytes()).unwrap());
        assert_eq!(
            (reopened.view(), reopened.edited_document()),
            (project.view(), project.edited_document())
        );
    }
}
