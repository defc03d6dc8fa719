//! What people did and what is suggested, against what is shown, journalled and undone.

use super::super::suggestions::KEPT_BASES;
use super::*;
use crate::proposals::Proposal;
use crate::proposals::{Answer, Asked, Timings};
use proptest::prelude::*;
use touchline_core::camera::{BaseAngles, Ptz};
use touchline_core::geometry::{ImagePoint, ImageSize, Vec3};
use touchline_documents::document::{
    Click, FieldSpec, FramePtz, FrameStatus, History, SolutionSource, Step, document_from_bytes, document_to_string,
};
use touchline_vision::relocalize::NotFound;

const SIZE: ImageSize = ImageSize::new(64, 36);

fn base(height_m: f64) -> CameraBase {
    CameraBase::new(Vec3::new(0.0, -60.0, height_m), BaseAngles::default().base_from_world(), SIZE.centre())
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

/// What the forest says of a frame as it is now: a camera, or none.
fn proposal(document: &Document, position: usize, pan_deg: Option<f64>) -> Proposal {
    let answer = |pan_deg| Answer::at_pan(pan_deg, 0.9);
    let outcome = pan_deg.map(answer).ok_or(NotFound::FewMatches { matched: 3, needed: 12 }.into());
    let frame = &document.frames[position];
    let asked = Asked::of(document, frame);
    Proposal { frame: frame.id.clone(), asked, generation: 1, outcome, timings: Timings::default() }
}

/// A document as the window edits it, with its history and everything that was journalled.
struct Desk {
    start: Document,
    project: Project,
    now: Document,
    history: History<Document>,
    journal: Vec<Edit>,
}

impl Desk {
    fn of(start: Document) -> Self {
        let project = Project::from_document(start.clone());
        Self { now: start.clone(), start, project, history: History::default(), journal: Vec::new() }
    }

    fn edit(&mut self, name: &str, change: impl FnOnce(&mut Document)) {
        self.history.begin(&self.project.edits_in(&self.now), Step::on_document(name));
        change(&mut self.now);
        self.history.commit(&self.project.edits_in(&self.now));
        self.take_in();
    }

    fn take_in(&mut self) {
        for (position, frame) in self.project.not_shown_in(&self.now) {
            self.now.frames[position] = frame;
        }
        self.journal.extend(self.project.take_in(&mut self.now, "Edit"));
    }

    fn suggest(&mut self, proposals: &[Proposal]) {
        let offers: Vec<_> = proposals.iter().filter_map(Proposal::offer).collect();
        let batch = self.project.batch_of_finder(Finder::Forest { generation: 1 });
        self.journal.extend(self.project.suggest(&mut self.now, batch, &offers));
    }

    fn step(&mut self, back: bool) -> bool {
        let mut edited = self.project.edits_in(&self.now);
        let step = if back { self.history.undo(&mut edited) } else { self.history.redo(&mut edited) };
        self.project.keep_answers_not_in(&edited);
        self.now = self.project.view_with(&edited);
        self.take_in();
        step.is_some()
    }

    fn accept(&mut self, position: usize) {
        self.edit("Accept", |document| document.frames[position].status = FrameStatus::Reference);
    }

    fn pans(&self) -> Vec<Option<f64>> {
        let pan_deg = |frame: &Shared<Frame>| frame.ptz.as_ref().map(|ptz| (1e6 * ptz.pan_deg).round() / 1e6);
        self.now.frames.iter().map(pan_deg).collect()
    }

    fn check(&self) {
        let Self { project, now, .. } = self;
        assert!(project.edited().frames.iter().all(|frame| !frame.shows_suggestion()));
        assert_eq!(*project.view(), *now);
        assert_eq!(project.view_with(project.edited()), *now);
        assert_eq!(project.edits_in(now), *project.edited());
        let mut read = self.start.clone();
        self.journal.iter().for_each(|edit| edit.clone().apply(&mut read).unwrap());
        assert_eq!(read, *now, "the journal has it");
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
    let untouched: Vec<bool> = project.edited().frames.iter().map(|frame| frame.is_untouched()).collect();
    assert_eq!(untouched, [true, true, false, true]);
    assert_eq!(project.suggestions.frames().count(), 2);
    assert_eq!(document_to_string(project.view()).unwrap(), text);
    assert_eq!(document_to_string(&project.view_with(project.edited())).unwrap(), text);
}

#[test]
fn accepting_is_one_step_and_taking_it_back_shows_what_is_suggested_by_then() {
    let mut desk = Desk::of(document(2));
    desk.suggest(&[proposal(&desk.now, 0, Some(1.0))]);
    assert_eq!(desk.history.next_undo(), None, "a suggestion is not a step");
    desk.accept(0);
    let accepted = &desk.project.edited().frames[0];
    assert_eq!((accepted.status, accepted.revision), (FrameStatus::Reference, 1));
    let meanwhile =
        Proposal { asked: Asked::of(&desk.start, &desk.start.frames[0]), ..proposal(&desk.now, 0, Some(2.0)) };
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
    desk.suggest(&[proposal(&desk.now, 0, Some(1.0)), proposal(&desk.now, 1, Some(2.0))]);
    desk.accept(0);
    desk.edit("Click", |document| {
        let frame = &mut document.frames[1];
        let proposed = frame.proposed();
        frame.clicks.push(Click::unnamed(ImagePoint::new(3.0, 1.0)));
        frame.status = FrameStatus::Draft;
        frame.ptz = Some(FramePtz::new(Ptz::from_degrees(2.5, -9.0, 900.0), None));
        frame.solution = Some(Solution { source: Some(SolutionSource::Forest), proposed, ..Solution::default() });
    });
    desk.project = Project::from_document(desk.now.clone());
    while desk.step(true) {}
    assert_eq!(desk.pans(), [Some(1.0), Some(2.0)]);
    assert!(desk.now.frames.iter().all(|frame| frame.status == FrameStatus::Suggested));
    desk.check();
}

#[test]
fn an_answer_for_an_earlier_revision_does_not_replace_a_later_one() {
    let mut desk = Desk::of(document(1));
    let early = proposal(&desk.now, 0, Some(1.0));
    desk.edit("Comment", |document| document.frames[0].comment = Some("rain".to_owned()));
    let late = proposal(&desk.now, 0, Some(2.0));
    desk.suggest(&[late]);
    desk.suggest(&[early]);
    assert_eq!(desk.pans(), [Some(2.0)]);
    let mut other = proposal(&desk.now, 0, Some(3.0));
    other.asked.sha256 = Some("another picture".to_owned());
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
    assert_eq!(desk.project.suggestions.newest(id, Some(&base(18.0))), None, "it was too long ago");
    desk.check();
}

#[test]
fn frames_that_come_go_and_come_back_bring_what_is_suggested_for_them() {
    let mut desk = Desk::of(document(3));
    desk.suggest(&[proposal(&desk.now, 0, Some(1.0)), proposal(&desk.now, 2, Some(3.0))]);
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

proptest! {
    #![proptest_config(ProptestConfig::with_cases(64))]
    #[test]
    fn edits_and_suggestions_agree_with_what_is_shown_and_journalled(
        steps in prop::collection::vec((0u8..8, 0usize..4, 0u8..4), 1..40),
    ) {
        let mut desk = Desk::of(document(4));
        for (kind, at, value) in steps {
            match kind {
                0 | 1 => {
                    let known = desk.history.next_undo().cloned();
                    desk.suggest(&[proposal(&desk.now, at, (value > 0).then(|| f64::from(value)))]);
                    prop_assert_eq!(desk.history.next_undo(), known.as_ref());
                }
                2 if desk.now.frames[at].ptz.is_some() => desk.accept(at),
                2 | 3 => desk.edit("Comment", |document| document.frames[at].comment = Some(value.to_string())),
                4 => desk.edit("Click", |document| {
                    document.frames[at].clicks.push(Click::unnamed(ImagePoint::new(f64::from(value), 1.0)));
                    document.frames[at].status = FrameStatus::Draft;
                }),
                5 => desk.edit("Move camera", |document| {
                    document.cameras[0].set_base(&base(18.0 + f64::from(value)));
                    for frame in &mut document.frames {
                        **frame = frame.without_suggestion();
                    }
                }),
                _ => {
                    desk.step(kind == 6);
                }
            }
            desk.check();
        }
        while desk.step(true) {}
        for (frame, start) in desk.project.edited().frames.iter().zip(&desk.start.frames) {
            prop_assert_eq!(Frame { revision: 0, ..(**frame).clone() }, (**start).clone());
        }
    }
}
