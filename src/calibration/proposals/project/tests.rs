//! Edits of the user and suggestions: the view, the journal, and undo.

use super::super::suggestions::KEPT_BASES;
use super::*;
use crate::proposals::Proposal;
use crate::proposals::{Answer, FrameRequest, Timings};
use proptest::prelude::*;
use proptest::test_runner::RngSeed;
use touchline_core::camera::{BaseAngles, Ptz};
use touchline_core::geometry::{ImagePoint, ImageSize, Vec3};
use touchline_documents::document::{
    Click, FieldSpec, FramePtz, FrameStatus, History, SolutionSource, Step, document_from_bytes,
    document_to_string,
};
use touchline_vision::relocalize::NotFound;

const SIZE: ImageSize = ImageSize::new(64, 36);

fn base(height_m: f64) -> CameraBase {
    CameraBase::new(
        Vec3::new(0.0, -60.0, height_m),
        BaseAngles::default().base_from_world(),
        SIZE.centre(),
    )
}

fn document(frames: usize) -> Document {
    let mut document = Document::new(FieldSpec::new("soccer"));
    let mut camera = Camera::new("main".into(), SIZE);
    camera.set_base(&base(18.0));
    document.cameras.push(camera.into());
    let frame = |index| Frame::from_image(&format!("{index}.jpg"), "main".into(), SIZE).into();
    document.frames.extend((0..frames).map(frame));
    document
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
    frame.solution = Some(Solution {
        source: Some(source),
        ..Solution::default()
    });
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
        self.project.keep_answers_not_in(&edited);
        self.now = self.project.view_with(&edited);
        self.take_in();
        step.is_some()
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
        for (edited, shown) in project.edited().frames.iter().zip(&now.frames) {
            assert!(!edited.shows_suggestion());
            let base = Bases::in_document(now).of_frame(edited);
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
        assert_eq!(project.view_with(project.edited()), *now);
        assert_eq!(project.edits_in(now), *project.edited());
        let mut read = self.start.clone();
        self.journal
            .iter()
            .for_each(|edit| edit.clone().apply(&mut read).unwrap());
        assert_eq!(read, *now, "the journal has it");
        let text = document_to_string(project.view()).unwrap();
        let reopened = Project::from_document(document_from_bytes(text.as_bytes()).unwrap());
        assert_eq!(
            (reopened.view(), reopened.edited()),
            (project.view(), project.edited())
        );
    }
}

#[test]
fn a_file_is_split_and_written_as_it_was() {
    let mut document = document(4);
    proposal(&document, 0, Some(1.0)).record(&mut document.frames[0]);
    proposal(&document, 1, None).record(&mut document.frames[1]);
    proposal(&document, 2, Some(2.0)).record(&mut document.frames[2]);
    document.frames[2].status = FrameStatus::Reference;
    let text = document_to_string(&document).unwrap();
    let project = Project::from_document(document_from_bytes(text.as_bytes()).unwrap());
    let untouched: Vec<bool> = project
        .edited()
        .frames
        .iter()
        .map(|frame| frame.is_untouched())
        .collect();
    assert_eq!(untouched, [true, true, false, true]);
    assert_eq!(project.suggestions.frames().count(), 2);
    assert_eq!(document_to_string(project.view()).unwrap(), text);
    assert_eq!(
        document_to_string(&project.view_with(project.edited())).unwrap(),
        text
    );
}

#[test]
fn accepting_is_one_step_and_taking_it_back_shows_what_is_suggested_by_then() {
    let mut desk = Desk::of(document(2));
    desk.suggest(&[proposal(&desk.now, 0, Some(1.0))]);
    assert_eq!(desk.history.next_undo(), None, "a suggestion is not a step");
    desk.accept(0);
    let accepted = &desk.project.edited().frames[0];
    assert_eq!(
        (accepted.status, accepted.revision),
        (FrameStatus::Reference, 1)
    );
    let meanwhile = Proposal {
        request: FrameRequest::from_frame(&desk.start, &desk.start.frames[0]),
        ..proposal(&desk.now, 0, Some(2.0))
    };
    desk.suggest(&[meanwhile]);
    assert_eq!(desk.pans(), [Some(1.0), None], "what was accepted stays");
    assert!(desk.step(true));
    assert_eq!(desk.now.frames[0].status, FrameStatus::Suggested);
    assert_eq!(desk.pans(), [Some(2.0), None]);
    assert!(desk.step(false));
    assert_eq!(desk.pans(), [Some(1.0), None]);
    desk.check();
}

#[test]
fn what_was_accepted_or_corrected_before_a_restart_is_suggested_again_when_that_is_undone() {
    let mut desk = Desk::of(document(2));
    desk.suggest(&[
        proposal(&desk.now, 0, Some(1.0)),
        proposal(&desk.now, 1, Some(2.0)),
    ]);
    desk.accept(0);
    desk.edit("Click", |document| {
        let frame = &mut document.frames[1];
        let proposed = frame.proposed();
        frame.clicks.push(Click::unnamed(ImagePoint::new(3.0, 1.0)));
        frame.status = FrameStatus::Draft;
        frame.ptz = Some(FramePtz::new(Ptz::from_degrees(2.5, -9.0, 900.0), None));
        frame.solution = Some(Solution {
            source: Some(SolutionSource::Forest),
            proposed,
            ..Solution::default()
        });
    });
    desk.project = Project::from_document(desk.now.clone());
    while desk.step(true) {}
    assert_eq!(desk.pans(), [Some(1.0), Some(2.0)]);
    assert!(
        desk.now
            .frames
            .iter()
            .all(|frame| frame.status == FrameStatus::Suggested)
    );
    desk.check();
}

#[test]
fn an_answer_for_an_earlier_revision_does_not_replace_a_later_one() {
    let mut desk = Desk::of(document(1));
    let early = proposal(&desk.now, 0, Some(1.0));
    desk.edit("Comment", |document| {
        document.frames[0].comment = Some("rain".to_owned());
    });
    let late = proposal(&desk.now, 0, Some(2.0));
    desk.suggest(&[late]);
    desk.suggest(&[early]);
    assert_eq!(desk.pans(), [Some(2.0)]);
    let mut other = proposal(&desk.now, 0, Some(3.0));
    other.request.sha256 = Some("another picture".to_owned());
    desk.suggest(&[other]);
    assert_eq!(desk.pans(), [Some(2.0)], "it is of another picture");
    let journalled = desk.journal.len();
    desk.suggest(&[proposal(&desk.now, 0, Some(2.0))]);
    assert_eq!(desk.journal.len(), journalled, "the same is not said twice");
    desk.check();
}

#[test]
fn each_base_has_what_was_suggested_for_it() {
    let mut desk = Desk::of(document(1));
    let moved = |desk: &mut Desk, height_m| {
        desk.edit("Move camera", |document| {
            document.cameras[0].set_base(&base(height_m));
            document.frames[0] = document.frames[0].without_suggestion().into();
        });
    };
    desk.suggest(&[proposal(&desk.now, 0, Some(1.0))]);
    moved(&mut desk, 20.0);
    assert_eq!(desk.pans(), [None]);
    desk.suggest(&[proposal(&desk.now, 0, Some(2.0))]);
    assert_eq!(desk.pans(), [Some(2.0)]);
    moved(&mut desk, 18.0);
    assert_eq!(desk.pans(), [Some(1.0)]);
    desk.step(true);
    assert_eq!(desk.pans(), [Some(2.0)]);
    for height in 21..21 + KEPT_BASES {
        moved(&mut desk, height as f64);
        desk.suggest(&[proposal(&desk.now, 0, Some(3.0))]);
    }
    let id = &desk.now.frames[0].id;
    assert_eq!(
        desk.project.suggestions.topmost(id, Some(&base(18.0))),
        None,
        "it was too long ago"
    );
    desk.check();
}

#[test]
fn frames_that_come_go_and_come_back_bring_what_is_suggested_for_them() {
    let mut desk = Desk::of(document(3));
    desk.suggest(&[
        proposal(&desk.now, 0, Some(1.0)),
        proposal(&desk.now, 2, Some(3.0)),
    ]);
    desk.edit("Remove", |document| {
        document.frames.remove(0);
        let mut coming = Frame::from_image("new.jpg", "main".into(), SIZE);
        proposal(document, 0, Some(4.0)).record(&mut coming);
        document.frames.push(coming.into());
    });
    desk.check();
    assert_eq!(desk.pans(), [None, Some(3.0), Some(4.0)]);
    desk.step(true);
    assert_eq!(desk.pans(), [Some(1.0), None, Some(3.0)]);
    desk.step(false);
    assert_eq!(desk.pans(), [None, Some(3.0), Some(4.0)]);
    desk.check();
}

#[test]
fn a_discarded_batch_gives_back_what_was_suggested_before() {
    let mut desk = Desk::of(document(3));
    desk.suggest(&[
        proposal(&desk.now, 0, Some(1.0)),
        proposal(&desk.now, 1, Some(2.0)),
    ]);
    let before = desk.now.clone();
    let batch = desk.carry(&[(0, 5.0), (1, 6.0), (2, 7.0)]);
    desk.accept(1);
    assert_eq!(desk.pans(), [Some(5.0), Some(6.0), Some(7.0)]);
    let discarded = desk.discard(batch);
    assert_eq!(
        (discarded.emptied, discarded.given_back, discarded.refused),
        (1, 1, None)
    );
    assert_eq!(
        desk.pans(),
        [Some(1.0), Some(6.0), None],
        "what was accepted stays"
    );
    assert_eq!(
        desk.history.next_undo().map(|step| step.name.as_str()),
        Some("Accept"),
        "it is no step"
    );
    assert_eq!(desk.now.frames[0], before.frames[0]);
    assert!(desk.step(true));
    assert_eq!(
        desk.pans(),
        [Some(1.0), Some(6.0), None],
        "the camera that the frame shows again was not discarded"
    );
    desk.discard(batch);
    assert_eq!(desk.now.frames[1].ptz, before.frames[1].ptz);
    desk.check();
}

#[test]
fn what_was_discarded_does_not_come_back_when_its_acceptance_is_redone_and_undone() {
    let mut desk = Desk::of(document(1));
    desk.suggest(&[proposal(&desk.now, 0, Some(1.0))]);
    desk.accept(0);
    assert!(desk.step(true));
    let batch = desk.project.batch_shown_in(&desk.now.frames[0]).unwrap();
    desk.discard(batch);
    assert!(desk.step(false));
    assert_eq!(desk.now.frames[0].status, FrameStatus::Reference);
    assert!(desk.step(true));
    assert_eq!(desk.pans(), [None]);
    desk.check();
}

#[test]
fn a_forest_that_answers_late_does_not_cover_a_camera_that_was_tracked_meanwhile() {
    let mut desk = Desk::of(document(2));
    let late = [
        proposal(&desk.now, 0, Some(1.0)),
        proposal(&desk.now, 1, Some(2.0)),
    ];
    let batch = desk.carry(&[(0, 5.0)]);
    desk.suggest(&late);
    assert_eq!(desk.pans(), [Some(5.0), Some(2.0)]);
    desk.discard(batch);
    assert_eq!(
        desk.pans(),
        [Some(1.0), Some(2.0)],
        "beneath it the answer was kept"
    );
    desk.check();
}

#[test]
fn a_forest_whose_answers_were_discarded_is_not_listened_to_again() {
    let mut desk = Desk::of(document(2));
    desk.suggest(&[
        proposal(&desk.now, 0, Some(1.0)),
        proposal(&desk.now, 1, None),
    ]);
    let batch = desk.project.batch_shown_in(&desk.now.frames[0]).unwrap();
    assert_eq!(
        desk.project.batch_shown_in(&desk.now.frames[1]),
        Some(batch)
    );
    let refused = desk.discard(batch).refused.unwrap();
    assert_eq!((refused.frames.len(), refused.generation), (2, 1));
    assert_eq!(desk.project.batch_shown_in(&desk.now.frames[0]), None);
    desk.suggest(&[
        proposal(&desk.now, 0, Some(1.0)),
        proposal(&desk.now, 1, Some(2.0)),
    ]);
    assert_eq!(desk.pans(), [None, None]);
    let later = Proposal {
        generation: 2,
        ..proposal(&desk.now, 0, Some(1.0))
    };
    desk.suggest(&[later]);
    assert_eq!(desk.pans(), [Some(1.0), None]);
    desk.check();
}

/// An event of a project.
#[derive(Clone, Copy, Debug)]
enum Happening {
    /// The forest answers for a frame: a pan, or no camera.
    Answer(usize, Option<f64>),
    /// Another forest is trained.
    Learn,
    /// Cameras are tracked from a frame to the frames after it.
    Carry(usize, f64),
    /// Autocalibration finds the camera at a height, with its frames.
    Find(f64, f64),
    /// The user discards the batch that a frame shows.
    Discard(usize),
    Accept(usize),
    Comment(usize, u8),
    Click(usize, f64),
    /// The base moves to a height, and the suggestions for the old one are withdrawn.
    Move(f64),
    Undo,
    Redo,
    /// The document is written and opened again with its history.
    Reopen,
}

fn happenings() -> impl Strategy<Value = Vec<Happening>> {
    let (frame, number) = (0usize..4, (0u8..4).prop_map(f64::from));
    let pan = prop_oneof![1 => Just(None), 3 => number.clone().prop_map(Some)];
    prop::collection::vec(
        prop_oneof![
            4 => (frame.clone(), pan).prop_map(|(frame, pan)| Happening::Answer(frame, pan)),
            1 => Just(Happening::Learn),
            2 => (frame.clone(), number.clone()).prop_map(|(frame, pan)| Happening::Carry(frame, pan)),
            1 => (number.clone(), number.clone()).prop_map(|(more_m, pan)| Happening::Find(18.0 + more_m, pan)),
            2 => frame.clone().prop_map(Happening::Discard),
            2 => frame.clone().prop_map(Happening::Accept),
            1 => (frame.clone(), 0u8..4).prop_map(|(frame, text)| Happening::Comment(frame, text)),
            2 => (frame, number.clone()).prop_map(|(frame, x)| Happening::Click(frame, x)),
            1 => number.prop_map(|more_m| Happening::Move(18.0 + more_m)),
            3 => Just(Happening::Undo),
            2 => Just(Happening::Redo),
            1 => Just(Happening::Reopen),
        ],
        1..40,
    )
}

impl Desk {
    fn happen(&mut self, happening: Happening) {
        match happening {
            Happening::Answer(frame, pan_deg) => {
                self.suggest(&[Proposal {
                    generation: self.generation,
                    ..proposal(&self.now, frame, pan_deg)
                }]);
            }
            Happening::Learn => self.generation += 1,
            Happening::Carry(first, pan_deg) => {
                let cameras: Vec<_> = (first..self.now.frames.len())
                    .map(|frame| (frame, pan_deg))
                    .collect();
                self.carry(&cameras);
            }
            Happening::Find(height_m, pan_deg) => self.edit("Find the camera", |document| {
                document.cameras[0].set_base(&base(height_m));
                for frame in document.frames.iter_mut().filter(|frame| frame.is_open()) {
                    suggest_camera(frame, pan_deg, SolutionSource::Markings);
                }
            }),
            Happening::Discard(frame) => {
                if let Some(batch) = self.project.batch_shown_in(&self.now.frames[frame]) {
                    self.discard(batch);
                }
            }
            Happening::Accept(frame) if self.now.frames[frame].ptz.is_none() => {}
            Happening::Accept(frame) => self.accept(frame),
            Happening::Comment(frame, text) => {
                self.edit("Comment", |document| {
                    document.frames[frame].comment = Some(text.to_string());
                });
            }
            Happening::Click(frame, x) => self.edit("Click", |document| {
                document.frames[frame]
                    .clicks
                    .push(Click::unnamed(ImagePoint::new(x, 1.0)));
                document.frames[frame].status = FrameStatus::Draft;
            }),
            Happening::Move(height_m) => self.edit("Move camera", |document| {
                document.cameras[0].set_base(&base(height_m));
                for frame in &mut document.frames {
                    **frame = frame.without_suggestion();
                }
            }),
            Happening::Undo => drop(self.step(true)),
            Happening::Redo => drop(self.step(false)),
            Happening::Reopen => self.reopen(),
        }
    }
}

/// Number of random cases per property. The seeds are fixed.
fn trials(seed: u64) -> ProptestConfig {
    ProptestConfig {
        rng_seed: RngSeed::Fixed(seed),
        ..ProptestConfig::with_cases(96)
    }
}

proptest! {
    #![proptest_config(trials(0x7072_6f6a))]
    #[test]
    fn the_view_is_what_people_did_with_what_is_suggested(happenings in happenings()) {
        let mut desk = Desk::of(document(4));
        for happening in happenings {
            let (edited, step) = (desk.project.edited().clone(), desk.history.next_undo().cloned());
            desk.happen(happening);
            desk.check();
            if matches!(happening, Happening::Answer(..) | Happening::Carry(..) | Happening::Discard(_)) {
                prop_assert_eq!(desk.project.edited(), &edited, "people did nothing");
                prop_assert_eq!(desk.history.next_undo(), step.as_ref());
            }
        }
        while desk.step(true) {
            desk.check();
        }
        for (frame, start) in desk.project.edited().frames.iter().zip(&desk.start.frames) {
            prop_assert_eq!(Frame { revision: 0, ..(**frame).clone() }, (**start).clone());
        }
    }

    #[test]
    fn a_batch_that_is_discarded_leaves_no_trace(happenings in happenings(), first in 0usize..4, pan_deg in 5.0f64..9.0) {
        let mut desk = Desk::of(document(4));
        for happening in happenings {
            desk.happen(happening);
        }
        let before = desk.now.clone();
        let cameras: Vec<_> = (first..4).map(|frame| (frame, pan_deg)).collect();
        let batch = desk.carry(&cameras);
        let shows_it = |desk: &Desk, frame: &Frame| desk.project.batch_shown_in(frame) == Some(batch);
        let given = desk.now.frames.iter().filter(|frame| shows_it(&desk, frame)).count();
        let discarded = desk.discard(batch);
        prop_assert_eq!(discarded.emptied + discarded.given_back, given);
        prop_assert_eq!(&desk.now, &before);
        prop_assert!(!desk.now.frames.iter().any(|frame| shows_it(&desk, frame)));
        desk.check();
    }
}
