//! Suggestions in the application: looked through in an order, accepted one by one and together, corrected, rejected.

use touchline::app::guidance::next_step;
use touchline::app::review::ReviewOrder;
use touchline::app::session::{Dialog, Filter, Mode, Panel, needs_me};
use touchline::app::{Action, App, Command, Effect, Opened, Settings};
use touchline::camera::{BaseAngles, CameraBase, Ptz, PtzCamera};
use touchline::field::builtin;
use touchline::geometry::{ImagePoint, ImageSize, Vec3};
use touchline::project::{
    Camera, Clip, Document, FieldSpec, Frame, FramePtz, FrameStatus, RejectReason, Solution, SolutionSource,
    SolutionWarning, Target,
};

const SIZE: ImageSize = ImageSize::new(1920, 1080);

fn base() -> CameraBase {
    CameraBase::new(Vec3::new(1.0, -62.0, 17.0), BaseAngles::default().base_from_world(), SIZE.centre())
}

/// The truth of frame `index`: a slow pan.
fn truth(index: usize) -> Ptz {
    Ptz::from_degrees(-4.0 + 0.2 * index as f64, -14.0, 2300.0)
}

fn blank(frames: usize) -> Document {
    let mut document = Document::new(FieldSpec::new("soccer"));
    let mut camera = Camera::new("main".into(), SIZE);
    camera.set_base(&base());
    document.cameras.push(camera.into());
    for index in 0..frames {
        let mut frame = Frame::from_image(&format!("images/{index:04}.jpg"), "main".into(), SIZE);
        frame.clip = Some(Clip::Number(1));
        document.frames.push(frame.into());
    }
    document
}

/// A document whose frames are suggested with these confidences; none: the forest has no answer.
fn suggested(confidences: &[Option<f64>]) -> Document {
    let mut document = blank(confidences.len());
    for (index, (frame, confidence)) in document.frames.iter_mut().zip(confidences).enumerate() {
        let mut solution =
            Solution { source: Some(SolutionSource::Forest), confidence: *confidence, ..Solution::default() };
        if confidence.is_some() {
            frame.ptz = Some(FramePtz::new(truth(index), None));
            frame.status = FrameStatus::Suggested;
        } else {
            solution.warnings.push(SolutionWarning::new("coverage", "3 features are too few".to_owned()));
        }
        frame.solution = Some(solution);
    }
    document
}

struct Bench {
    app: App,
    effects: Vec<Effect>,
}

impl Bench {
    fn new(document: Document) -> Self {
        let mut bench = Self { app: App::new(Settings::default()), effects: Vec::new() };
        bench.act(Action::Opened(Box::new(Opened {
            document,
            folder: "/nowhere".into(),
            file: "/nowhere/project.json".into(),
            read_only: None,
            notices: Vec::new(),
        })));
        bench.effects.clear();
        bench
    }

    fn act(&mut self, action: Action) {
        self.effects.extend(self.app.update(action));
    }

    fn command(&mut self, command: Command) {
        self.act(Action::Command(command));
    }

    fn frames(&self) -> &[touchline::project::Shared<Frame>] {
        &self.app.open().unwrap().document.frames
    }

    fn statuses(&self) -> String {
        let letter = |status| match status {
            FrameStatus::New => 'N',
            FrameStatus::Draft => 'D',
            FrameStatus::Suggested => 'S',
            FrameStatus::Reference => 'R',
            FrameStatus::Rejected => 'X',
        };
        self.frames().iter().map(|frame| letter(frame.status)).collect()
    }

    fn listed(&self) -> Vec<usize> {
        self.app.review().rows.iter().map(|row| row.frame).collect()
    }

    /// Clicks a landmark of the shown frame where the truth has it.
    fn place(&mut self, landmark: &str) {
        let field = builtin("soccer").unwrap().default_model().unwrap();
        let world = field.landmark_in_world(field.landmark(landmark).unwrap());
        let at = PtzCamera::new(base(), truth(self.app.session.frame)).image_from_world(world).unwrap();
        self.act(Action::Press { at, on: None });
        self.act(Action::Release);
        if let Mode::Naming(naming) = &self.app.session.mode {
            let click = naming.click;
            self.act(Action::Name { click, target: Target::Landmark(landmark.into()) });
        }
    }

    fn said(&self) -> String {
        next_step(&self.app).text
    }

    fn last_notice(&self) -> &str {
        self.app.session.notices.last().map_or("", |notice| notice.text.as_str())
    }
}

#[test]
fn enter_takes_a_suggestion_as_a_label_and_n_follows_the_list() {
    let mut bench = Bench::new(suggested(&[Some(0.7), Some(0.99), None, Some(0.9), Some(0.8)]));
    assert_eq!(bench.said(), "Dashed = proposed. Enter takes it, a click corrects it, X rejects it.");
    bench.command(Command::ReviewPanel);
    assert_eq!(bench.app.session.panel, Panel::Review);
    assert_eq!(bench.listed(), [1, 3, 4, 0]);
    bench.command(Command::NextNeedsMe);
    assert_eq!(bench.app.session.frame, 1, "round and round");
    bench.command(Command::Accept);
    assert_eq!(bench.app.session.frame, 3, "the next in the list");
    let accepted = &bench.frames()[1];
    assert_eq!(accepted.status, FrameStatus::Reference);
    assert_eq!(accepted.solution.as_ref().unwrap().source, Some(SolutionSource::Forest));
    assert!(!accepted.teaches(), "a label, no teacher");
    bench.command(Command::PreviousNeedsMe);
    assert_eq!(bench.app.session.frame, 0);
    bench.act(Action::SetReviewOrder(ReviewOrder::Time));
    assert_eq!(bench.listed(), [0, 3, 4]);
    bench.command(Command::Accept);
    bench.command(Command::Accept);
    bench.command(Command::Accept);
    assert_eq!(bench.statuses(), "RRNRR");
    assert_eq!(bench.last_notice(), "Nothing needs you. 1 frame has no answer: label one near pan -4°.");
    bench.command(Command::NextUnanswered);
    assert_eq!(bench.app.session.frame, 2);
    assert_eq!(bench.said(), "No proposal: 3 features are too few.");
}

#[test]
fn without_the_panel_n_goes_through_the_frames_and_passes_those_without_an_answer() {
    let mut bench = Bench::new(suggested(&[Some(0.7), None, Some(0.99)]));
    bench.command(Command::NextNeedsMe);
    assert_eq!(bench.app.session.frame, 2);
    assert!(!needs_me(&bench.frames()[1]) && Filter::Unanswered.shows(&bench.frames()[1]));
}

#[test]
fn several_are_accepted_in_one_step_after_a_preview() {
    let mut bench = Bench::new(suggested(&[Some(0.7), Some(0.99), None, Some(0.96), Some(0.8)]));
    bench.command(Command::AcceptAllAbove);
    assert_eq!(bench.app.session.dialog, Some(Dialog::AcceptAll));
    bench.act(Action::SetReviewThreshold(0.75));
    let bulk = bench.app.review().bulk(&bench.app.session.review);
    assert_eq!(bulk.rows.iter().map(|row| row.frame).collect::<Vec<_>>(), [4, 3, 1], "the least certain first");
    bench.act(Action::AcceptAll);
    assert_eq!(bench.statuses(), "SRNRR");
    assert_eq!(bench.effects.iter().filter(|effect| matches!(effect, Effect::Journal { .. })).count(), 1);
    assert!(bench.last_notice().starts_with("3 suggestions accepted."), "{}", bench.last_notice());
    bench.command(Command::Undo);
    assert_eq!(bench.statuses(), "SSNSS");
    bench.act(Action::SetReviewThreshold(0.999));
    bench.act(Action::AcceptAll);
    assert_eq!(bench.statuses(), "SSNSS", "none is that certain");
}

#[test]
fn one_that_jumps_out_of_its_neighbours_is_not_accepted_with_the_others() {
    let mut document = suggested(&[Some(0.99); 5]);
    document.frames[2].ptz = Some(FramePtz::new(Ptz::from_degrees(7.0, -14.0, 2300.0), None));
    let mut bench = Bench::new(document);
    bench.command(Command::AcceptAllAbove);
    let rows = &bench.app.review().rows;
    assert!(rows.iter().find(|row| row.frame == 2).unwrap().disagreement_px.unwrap() > 300.0, "{rows:?}");
    bench.act(Action::AcceptAll);
    // Its neighbours lie between it and the others: they are to be looked at, too.
    assert_eq!(bench.statuses(), "RSSSR");
    bench.command(Command::AcceptAllAbove);
    bench.act(Action::SetWithDisagreeing(true));
    bench.act(Action::AcceptAll);
    assert_eq!(bench.statuses(), "RRRRR");
}

#[test]
fn a_click_corrects_and_taking_it_away_leaves_the_suggestion() {
    let mut bench = Bench::new(suggested(&[Some(0.9), Some(0.9)]));
    let before = bench.frames()[0].clone();
    bench.place("centre_mark");
    assert_eq!(bench.statuses(), "DS");
    assert_eq!(bench.frames()[0].clicks[0].target, Some(Target::Landmark("centre_mark".into())));
    bench.act(Action::DeleteClick(0));
    assert_eq!(bench.frames()[0].status, FrameStatus::Suggested);
    bench.place("centre_mark");
    bench.place("halfway_far");
    let corrected = &bench.frames()[0];
    assert_eq!(corrected.solution.as_ref().unwrap().source, Some(SolutionSource::Clicks));
    bench.command(Command::AcceptAndStay);
    assert!(bench.frames()[0].teaches(), "clicked by a person");
    for _ in 0..5 {
        bench.command(Command::Undo);
    }
    assert_eq!(bench.frames()[0], before);
}

#[test]
fn a_rejected_suggestion_comes_back_as_one() {
    let mut bench = Bench::new(suggested(&[Some(0.9), Some(0.8), Some(0.7)]));
    bench.command(Command::ReviewPanel);
    bench.command(Command::Reject);
    bench.act(Action::RejectAs(RejectReason::Replay));
    assert_eq!((bench.statuses().as_str(), bench.app.session.frame), ("XSS", 1));
    bench.act(Action::GoTo(0));
    bench.command(Command::Reject);
    assert_eq!(bench.statuses(), "SSS");
}

#[test]
fn a_label_teaches_when_a_person_says_so_and_that_is_one_step() {
    let mut bench = Bench::new(suggested(&[Some(0.9)]));
    bench.command(Command::Teaches);
    assert!(!bench.frames()[0].teaches());
    bench.command(Command::AcceptAndStay);
    bench.act(Action::SetTeaches { frame: 0, teaches: true });
    assert!(bench.frames()[0].teaches());
    let name = bench.app.open().unwrap().history.next_undo().unwrap().name.clone();
    assert_eq!(name, "Let it teach");
    bench.command(Command::Undo);
    assert!(!bench.frames()[0].teaches());
    bench.command(Command::Teaches);
    assert!(bench.frames()[0].teaches());
}

#[test]
fn ten_thousand_suggestions_are_listed_and_accepted_together() {
    let confidences: Vec<Option<f64>> =
        (0..10_000).map(|index| (index % 10 != 0).then_some(0.5 + 0.05 * f64::from(index % 10))).collect();
    let mut bench = Bench::new(suggested(&confidences));
    bench.command(Command::ReviewPanel);
    assert_eq!(bench.listed().len(), 9_000);
    bench.act(Action::SetReviewThreshold(0.9));
    bench.act(Action::SetWithDisagreeing(true));
    bench.act(Action::AcceptAll);
    assert_eq!(bench.app.open().unwrap().count(FrameStatus::Reference), 2_000);
    bench.act(Action::Press { at: ImagePoint::new(700.0, 700.0), on: None });
    bench.command(Command::Cancel);
    bench.command(Command::Undo);
    assert_eq!(bench.app.open().unwrap().count(FrameStatus::Reference), 0);
}
