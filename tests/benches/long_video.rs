//! A whole match in one document: 300,000 frames of one video, a match at 50 frames a second, and
//! what a person's edits cost in it.
#![allow(
    missing_docs,
    clippy::unwrap_used,
    clippy::panic,
    reason = "a bench says what failed by failing"
)]

use divan::{Bencher, black_box};
use std::path::Path;
use touchline::app::{
    Action, App, Command, EditAction, Effect, Navigation, Opened, PointerAction, Settings,
};
use touchline::calibrate::{FrameLookup, check_cameras, solve_document};
use touchline::camera::{BaseAngles, CameraBase, Ptz, PtzCamera};
use touchline::document::{
    Camera, Click, Document, FieldSpec, Frame, FramePtz, FrameStatus, Solution, SolutionSource,
    VideoFrame,
};
use touchline::field::builtin;
use touchline::geometry::{ImagePoint, ImageSize, Vec3};
use touchline::progress::Progress;
use touchline::store::{Location, open, write_document};

const FRAMES: usize = 300_000;
const SHOWN: usize = FRAMES / 2;
const SIZE: ImageSize = ImageSize::new(1920, 1080);

/// What has been done in a document.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum State {
    /// Every frame is clicked, solved and accepted.
    Solved,
    /// Every frame is clicked, and none is solved.
    Clicked,
    /// Every 200th frame is clicked, and none is solved.
    Begun,
    /// Every 200th frame is clicked, and a camera is suggested for every other.
    Suggested,
    /// Every 200th frame is clicked, solved and accepted, and the forest was asked in vain for
    /// every other.
    Unanswered,
}

const STATES: [State; 5] = [
    State::Solved,
    State::Clicked,
    State::Begun,
    State::Suggested,
    State::Unanswered,
];

fn main() {
    divan::main();
}

/// Where the camera looks in a frame: to and fro, a tenth of a degree a frame at most.
fn ptz(index: usize) -> Ptz {
    let time = index as f64 / 300.0;
    Ptz::from_degrees(
        25.0 * time.sin(),
        -13.0 + (0.7 * time).cos(),
        2400.0 + 500.0 * (0.3 * time).sin(),
    )
}

fn document(state: State) -> Document {
    let field = builtin("soccer").unwrap().default_model().unwrap();
    let base = CameraBase::new(
        Vec3::new(1.5, -66.0, 18.0),
        BaseAngles::default().base_from_world(),
        SIZE.centre(),
    );
    let mut document = Document::new(FieldSpec::new("soccer"));
    let mut camera = Camera::new("main".into(), SIZE);
    camera.set_base(&base);
    document.cameras.push(camera.into());
    let frame = |index: usize| {
        let pointed = PtzCamera::new(base, ptz(index));
        let video = VideoFrame::new("match.mp4", index as u64, Some(0.04 * index as f64));
        let mut frame = Frame::from_video(video, "main".into(), SIZE);
        let is_rarely_clicked =
            matches!(state, State::Begun | State::Suggested | State::Unanswered);
        if !is_rarely_clicked || index.is_multiple_of(200) {
            let image = |landmark| {
                pointed
                    .image_from_world(field.landmark_in_world(landmark))
                    .ok()
            };
            let shown = field
                .landmarks
                .iter()
                .filter_map(|landmark| Some((landmark, image(landmark)?)));
            let shown = shown.filter(|(_, image)| SIZE.contains(*image)).take(4);
            frame.clicks = shown
                .map(|(landmark, image)| Click::landmark(landmark.id.clone(), image))
                .collect();
            frame.status = FrameStatus::Draft;
        }
        if state == State::Solved || state == State::Unanswered && !frame.clicks.is_empty() {
            frame.status = FrameStatus::Reference;
            frame.ptz = Some(FramePtz::new(pointed.ptz(), None));
            frame.solution = Some(Solution {
                source: Some(SolutionSource::Clicks),
                ..Solution::default()
            });
        }
        if state == State::Suggested && frame.clicks.is_empty() {
            let (source, confidence) = (Some(SolutionSource::Forest), Some(0.9));
            frame.status = FrameStatus::Suggested;
            frame.ptz = Some(FramePtz::new(pointed.ptz(), None));
            frame.solution = Some(Solution {
                source,
                confidence,
                ..Solution::default()
            });
        }
        if state == State::Unanswered && frame.clicks.is_empty() {
            frame.solution = Some(Solution {
                source: Some(SolutionSource::Forest),
                ..Solution::default()
            });
        }
        frame.into()
    };
    document.frames.extend((0..FRAMES).map(frame));
    document
}

/// The application on a clicked frame in the middle.
fn app(state: State) -> App {
    let mut app = App::new(Settings::default());
    app.update(Action::Opened(Box::new(Opened::new(
        document(state),
        "/match/project.json",
    ))));
    app.update(Action::Navigate(Navigation::GoTo(SHOWN)));
    app.update(Action::Navigate(Navigation::Select(Some(0))));
    app
}

/// A click follows the pointer: the frame is solved, everything that is shown is derived.
#[divan::bench(args = STATES)]
fn a_drag_event(bencher: Bencher, state: State) {
    let mut app = app(state);
    let at = app.frame().unwrap().clicks[0].image;
    app.update(Action::Pointer(PointerAction::Press { at, on: Some(0) }));
    let mut right = 0.0;
    bencher.bench_local(|| {
        right = 1.0 - right;
        app.update(Action::Pointer(PointerAction::Drag(ImagePoint::new(
            at.x + right,
            at.y,
        ))))
    });
}

/// A click is moved by a key: a step of undo, and the edit's record as the journal has it.
#[divan::bench(args = STATES)]
fn an_edit_with_its_journal_record(bencher: Bencher, state: State) {
    let mut app = app(state);
    let mut right = -1.0;
    bencher.bench_local(|| {
        right = -right;
        let effects = app.update(Action::Edit(EditAction::Nudge {
            dx_px: right,
            dy_px: 0.0,
            held: false,
        }));
        let edits = effects.iter().filter_map(|effect| match effect {
            Effect::Journal { edit, .. } => Some(serde_json::to_string(edit).unwrap()),
            _ => None,
        });
        let records: Vec<String> = edits.collect();
        assert_eq!(records.len(), 1);
        records
    });
}

#[divan::bench(args = STATES, sample_count = 20)]
fn undo(bencher: Bencher, state: State) {
    let mut app = app(state);
    app.update(Action::Edit(EditAction::Nudge {
        dx_px: 1.0,
        dy_px: 0.0,
        held: false,
    }));
    bencher.bench_local(|| {
        app.update(Action::Command(Command::Undo));
        app.update(Action::Command(Command::Redo))
    });
}

/// From the file to the application.
#[divan::bench(args = STATES, sample_count = 5)]
fn opening(bencher: Bencher, state: State) {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("match");
    write_document(
        &Location::for_new_document(&path.join("")).unwrap(),
        &document(state),
        false,
    )
    .unwrap();
    bencher.bench_local(|| {
        let opened = open(&path).unwrap();
        let mut app = App::new(Settings::default());
        app.update(Action::Opened(Box::new(Opened::new(
            opened.document,
            path.join("project.json"),
        ))));
        app
    });
}

/// The part of opening that keeps the window waiting: the application takes in what a job has made
/// ready.
#[divan::bench(args = STATES, sample_count = 5)]
fn taking_in(bencher: Bencher, state: State) {
    let opened = Opened::new(document(state), "/match/project.json");
    bencher
        .with_inputs(|| (App::new(Settings::default()), Box::new(opened.clone())))
        .bench_local_values(|(mut app, opened)| {
            app.update(Action::Opened(opened));
            app
        });
}

/// What calibrating looks up: derived anew, and brought up to date after one frame has changed.
#[divan::bench(args = STATES, sample_count = 20)]
fn lookup_anew(bencher: Bencher, state: State) {
    let document = document(state);
    bencher.bench_local(|| FrameLookup::from_document(&document));
}

#[divan::bench(args = STATES)]
fn lookup_after_an_edit(bencher: Bencher, state: State) {
    let mut document = document(state);
    let mut lookup = FrameLookup::from_document(&document);
    let mut turned = 0.0;
    bencher.bench_local(|| {
        turned = 1.0 - turned;
        document.frames[SHOWN].ptz = Some(FramePtz::new(
            Ptz::from_degrees(turned, -13.0, 2400.0),
            None,
        ));
        lookup.update(&document);
        black_box(lookup.prior(SHOWN))
    });
}

/// `touchline solve`, without reading and writing.
#[divan::bench(args = STATES, sample_count = 1)]
fn solve(bencher: Bencher, state: State) {
    let document = document(state);
    bencher.bench_local(|| {
        solve_document(&mut document.clone(), Path::new("."), &Progress::default()).unwrap()
    });
}

/// What `touchline check` looks for in the clicks.
#[divan::bench(args = STATES, sample_count = 1)]
fn check(bencher: Bencher, state: State) {
    let document = document(state);
    bencher.bench_local(|| check_cameras(document.at(Path::new("."))));
}
