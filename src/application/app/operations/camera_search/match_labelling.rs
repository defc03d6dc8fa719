//! All cameras of a video, and those of all its frames: the same work as `touchline calibrate`.
//!
//! The result is one step of undo. *Stop* keeps what is found, and the same command goes on from
//! there, because finished parts of the work are kept beside the document.

use super::search_step::SearchSteps;
use super::{CameraSearch, NoAnswer, why_no_search_of_sport};
use crate::app::operation::{AsItWas, Context, Failure, Operation, Slot};
use crate::app::operations::{OperationStep, UnderWay};
use crate::app::window_state::session::Level;
use crate::app::{App, Command};
use std::ops::ControlFlow;
use std::path::PathBuf;
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};
use touchline_calibration::autocalibrate::{AutocalibrationAnswer, AutocalibrationError};
use touchline_calibration::calibrate::FoundCamera;
use touchline_calibration::pipelines::{
    LabelMatchError, LabelledMatch, MatchEvent, MatchLabels, MatchOptions, NoCamera, label_match,
};
use touchline_calibration::proposals::WorkFolder;
use touchline_core::geometry::{pluralise, thousands};
use touchline_core::progress::Progress;
use touchline_documents::document::{Camera, CameraId, Document, Frame};

/// The name of the step of undo, and of one with what was found until the user stopped the work.
/// The history, which outlives the program, says by it with what the command goes on.
const STEP: &str = "Find the cameras of the video";
const STOPPED_STEP: &str = "Find the cameras of the video until stopped";

/// Finds the cameras of a video, and labels its frames.
#[derive(Debug)]
pub struct MatchLabelling {
    /// The document from which the work starts.
    document: Document,
    /// The document whose labels the result replaces: the same, or what was found until the work
    /// was stopped before.
    replaces: Document,
    /// Its file: finished parts are kept beside it.
    file: PathBuf,
    /// The folder to which its relative paths refer.
    folder: PathBuf,
    /// The camera that all its frames are assigned to.
    camera: CameraId,
    /// Whether the user wants what was found until now.
    ends_early: AtomicBool,
}

/// The labelled document, or why it has no camera.
#[derive(Debug)]
pub struct LabelledDocument {
    /// The document.
    pub document: Document,
    /// What was found.
    pub labels: MatchLabels,
}

/// The labelling under way.
#[derive(Debug, Default)]
pub(in crate::app) struct MatchLabellingState {
    slot: Slot<MatchLabelling>,
}

/// Work that the user has stopped, with which the command goes on.
struct StoppedLabelling<'a> {
    /// The document from which it started.
    document: &'a Document,
    /// The document with what was found.
    with_found: &'a Document,
}

// ---- The work ----

impl Operation for MatchLabelling {
    type Progress = OperationStep;
    type Output = LabelledDocument;
    type Error = LabelMatchError;

    const NAME: &'static str = "label a match";

    fn run(
        &self,
        context: &Context<'_, OperationStep>,
    ) -> Result<LabelledDocument, LabelMatchError> {
        let mut reader = context.open_reader();
        let mut document = self.document.clone();
        let options = MatchOptions {
            work: Some(WorkFolder::beside(&self.file)),
            ..MatchOptions::default()
        };
        let steps = SearchSteps::default();
        let progress = Progress::new(|event: MatchEvent| {
            context.give_way_to_window();
            match steps.of_match(&event) {
                _ if self.ends_early.load(Ordering::Relaxed) => ControlFlow::Break(()),
                Some(step) => context.report(step),
                None => context.check(),
            }
        });
        let labels = label_match(
            &mut document,
            &self.folder,
            &self.camera,
            &mut *reader,
            &options,
            &progress,
        )?;
        Ok(LabelledDocument { document, labels })
    }

    fn slot(app: &mut App) -> &mut Slot<Self> {
        &mut app.operations.match_labelling.slot
    }

    fn must_wait(app: &App) -> bool {
        app.is_amid_change()
    }

    fn take_over(&self, app: &mut App, result: Result<LabelledDocument, Failure<LabelMatchError>>) {
        match result {
            Ok(LabelledDocument { document, labels }) => match labels {
                MatchLabels::Labelled(labelled) => app.take_labelled(self, &document, &labelled),
                MatchLabels::NoCamera(why) => self.report_no_camera(app, document, why),
            },
            Err(Failure::Failed(LabelMatchError::Search(AutocalibrationError::Stopped))) => {
                let text = "Stopped before a camera was found; nothing was changed. The same \
                            command goes on from here.";
                app.session.note(text);
            }
            Err(failure) => {
                let text = format!("The cameras were not found: {failure}.");
                app.session.notify(failure.level(), text);
            }
        }
    }
}

impl MatchLabelling {
    /// Says why there is no camera, as after a search for a single one.
    fn report_no_camera(&self, app: &mut App, document: Document, why: NoCamera) {
        let answer = match why {
            NoCamera::Abstained { why, clicks } => AutocalibrationAnswer::Abstained { why, clicks },
            NoCamera::Before { message, .. } => {
                let why = format!("No camera was found: {message}.");
                app.session.warn(why.clone());
                app.operations.camera_search.no_answer = Some(NoAnswer {
                    camera: self.camera.clone(),
                    why,
                    frame: None,
                });
                return;
            }
        };
        let search = CameraSearch {
            document,
            folder: self.folder.clone(),
            camera: self.camera.clone(),
        };
        search.take_over(app, Ok(answer));
    }
}

// ---- In the application ----

impl App {
    /// Why a command of the labelling is not available; none if it is.
    pub(in crate::app) fn why_not_match_labelling(&self, command: Command) -> Option<&'static str> {
        let is_running = self.operations.match_labelling.is_running();
        if command == Command::StopFindCameras {
            return (!is_running).then_some("No cameras are being found.");
        }
        let (open, frame) = (self.open.as_ref()?, self.frame()?);
        if self.is_read_only() {
            return Some("The document is read-only.");
        }
        if cfg!(not(feature = "opencv")) {
            return Some("This program was built without OpenCV and cannot find features.");
        }
        if is_running || self.operations.camera_search.is_running() {
            return Some("A camera is being found already.");
        }
        if frame.video.is_none() {
            return Some("This frame does not come from a video.");
        }
        let document = &open.document;
        let base = document.camera_of(frame).and_then(Camera::base);
        if base.is_some() && self.stopped_labelling().is_none() {
            return Some("This camera has a base already: track the cameras through its shots.");
        }
        if base.is_none() && open.counts().cameras_with_frames() > 1 {
            return Some("Its frames have several cameras: find them one by one.");
        }
        why_no_search_of_sport(document, &frame.camera)
    }

    /// Carries out a command of the labelling.
    pub(in crate::app) fn match_labelling_command(&mut self, command: Command) {
        match command {
            Command::FindCameras => self.label_match(),
            Command::StopFindCameras => {
                if let Some(running) = self.operations.match_labelling.slot.running() {
                    running
                        .operation()
                        .ends_early
                        .store(true, Ordering::Relaxed);
                }
            }
            _ => {}
        }
    }

    /// The stopped work with which the command goes on: its cameras are still those of the
    /// document.
    fn stopped_labelling(&self) -> Option<StoppedLabelling<'_>> {
        let open = self.open.as_ref()?;
        let now = &*open.document;
        let (step, document, after) = open.history.newest_named(STEP)?;
        let then = after.unwrap_or(now);
        let goes_on = step.name == STOPPED_STEP && AsItWas { then, now }.has_cameras();
        goes_on.then_some(StoppedLabelling {
            document,
            with_found: then,
        })
    }

    fn label_match(&mut self) {
        self.commit_open_step();
        let Some(open) = &self.open else { return };
        let (document, replaces) = match self.stopped_labelling() {
            Some(stopped) => (stopped.document.clone(), stopped.with_found.clone()),
            None => ((*open.document).clone(), (*open.document).clone()),
        };
        // The shown frame was assigned to one of the cameras that were found.
        let Some(frame) = document.frames.get(self.session.frame) else {
            return;
        };
        let camera = frame.camera.clone();
        let (file, folder) = (open.file.clone(), open.folder.clone());
        self.operations.camera_search.no_answer = None;
        // It looks for the cuts itself.
        self.operation_command(Command::StopShotSearch);
        self.start(MatchLabelling {
            document,
            replaces,
            file,
            folder,
            camera,
            ends_early: AtomicBool::new(false),
        });
    }

    /// Takes over a labelled document as one step of undo.
    fn take_labelled(
        &mut self,
        work: &MatchLabelling,
        document: &Document,
        labelled: &LabelledMatch,
    ) {
        let Some(open) = &self.open else { return };
        let (then, now) = (&work.replaces, &open.document);
        // What the forest suggested meanwhile is replaced.
        let Some(joined) = (AsItWas { then, now }).join(document, AsItWas::position_if_untouched)
        else {
            let text = "A camera or the field changed in the meantime; the cameras that were found \
                        were discarded.";
            let offers = [("Find them again", Command::FindCameras)];
            return self.session.notify_with(Level::Info, text, offers);
        };
        let text = describe_labelled(&joined, labelled);
        let step = if labelled.is_stopped {
            STOPPED_STEP
        } else {
            STEP
        };
        if !self.take_joined(step, joined) {
            return;
        }
        self.operations.camera_search.found = labelled.cameras.first().and_then(|found| {
            let camera = &document.frames[found.frames.first()?.index].camera;
            let found = (**found).clone();
            Some(Arc::new(FoundCamera::new(document, camera, found)))
        });
        for command in [
            Command::FindCameras,
            Command::FindCamera,
            Command::EstimateBase,
        ] {
            self.session.retract(command);
        }
        self.report_assumed_size();
        let next = if labelled.is_stopped {
            ("Go on", Command::FindCameras)
        } else {
            ("Review", Command::ReviewPanel)
        };
        let offers = [next, ("Undo", Command::Undo)];
        self.session.notify_with(Level::Info, text, offers);
    }
}

// ---- Words ----

impl MatchLabellingState {
    /// Whether cameras are being found.
    pub(in crate::app::operations) const fn is_running(&self) -> bool {
        self.slot.is_running()
    }

    /// Whether the running work will answer a frame.
    pub(in crate::app::operations) fn answers(&self, frame: &Frame) -> bool {
        let running = self.slot.running();
        running.is_some_and(|running| {
            running.operation().camera == frame.camera && frame.ptz.is_none()
        })
    }

    /// The labelling under way, with how far it has come.
    pub(in crate::app::operations) fn under_way(&self) -> Option<UnderWay> {
        let running = self.slot.running()?;
        let job = "Finding the cameras of the video";
        let mut card = UnderWay::from_running(running, job, Command::StopFindCameras);
        if running.operation().ends_early.load(Ordering::Relaxed) {
            "Ending".clone_into(&mut card.step);
        }
        Some(card)
    }
}

/// What was found, in a few sentences.
fn describe_labelled(document: &Document, labelled: &LabelledMatch) -> String {
    let frames = document.frames.iter();
    let with_camera = frames.filter(|frame| frame.ptz.is_some()).count();
    let cameras = document
        .cameras
        .iter()
        .filter(|camera| camera.base().is_some());
    let stopped = if labelled.is_stopped {
        "Stopped; the same command goes on from here. "
    } else {
        ""
    };
    format!(
        "{stopped}{} found; {} of {} frames have theirs. Check a few, then accept.",
        pluralise(cameras.count(), "camera"),
        thousands(with_camera),
        thousands(document.frames.len())
    )
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::app::{Action, ViewAction};
    use touchline_core::testing::base_at;
    use touchline_documents::testing::{SMALL, WithFrames, a_match, new_video_frame, ptz_at};

    /// An application with twelve frames of a video, of which nothing is known.
    fn app() -> App {
        let frames = (0..12).map(|index| new_video_frame("match.mp4", index, SMALL));
        App::with_document(a_match(SMALL).with_frames(frames))
    }

    /// The work of the command.
    fn start(app: &mut App) -> Arc<MatchLabelling> {
        assert_eq!(app.why_not(Command::FindCameras), None);
        app.update(Action::Command(Command::FindCameras));
        let document = (*app.open().unwrap().document).clone();
        let running = app.operations.match_labelling.slot.running().unwrap();
        assert_eq!(running.operation().document, document);
        Arc::new(MatchLabelling {
            replaces: document.clone(),
            document,
            file: PathBuf::new(),
            folder: PathBuf::new(),
            camera: "main".into(),
            ends_early: AtomicBool::new(false),
        })
    }

    fn last_notice(app: &App) -> &str {
        &app.session.messages.notices.last().unwrap().text
    }

    #[test]
    fn stop_waits_for_what_is_found_until_then() {
        let mut app = app();
        let work = start(&mut app);
        let frame = &app.open().unwrap().document.frames[3];
        assert!(app.operations.answering(frame).is_some());
        assert!(app.why_not(Command::FindCamera).is_some());
        app.update(Action::Command(Command::StopFindCameras));
        let card = app.operations.match_labelling.under_way().unwrap();
        assert_eq!(card.step, "Ending");

        let mut document = work.document.clone();
        document.frames[2].ptz = ptz_at(1.0, -12.0, 80.0);
        let labelled = LabelledMatch {
            cameras: Vec::new(),
            answered: 1,
            unanswered: 11,
            is_stopped: true,
        };
        let labels = MatchLabels::Labelled(labelled);
        document.cameras[0].set_base(&base_at([1.0, -62.0, 17.0], SMALL));
        app.operations.match_labelling.slot.cancel();
        work.take_over(&mut app, Ok(LabelledDocument { document, labels }));
        let found = (*app.open().unwrap().document).clone();
        assert!(found.frames[2].ptz.is_some());
        assert!(last_notice(&app).starts_with("Stopped; the same command goes on from here."));
        assert!(app.session.offers(Command::FindCameras));

        // It starts from where it did, and replaces what it found; not after that was undone.
        assert_eq!(app.why_not(Command::FindCameras), None);
        app.update(Action::Command(Command::FindCameras));
        let running = app.operations.match_labelling.slot.running().unwrap();
        assert_eq!(running.operation().document, work.document);
        assert_eq!(running.operation().replaces, found);
        app.operations.match_labelling.slot.cancel();
        app.update(Action::Command(Command::Undo));
        app.update(Action::Command(Command::FindCameras));
        let running = app.operations.match_labelling.slot.running().unwrap();
        assert!(running.operation().replaces.frames[2].ptz.is_none());
    }

    #[test]
    fn a_video_without_a_camera_says_why_and_stays_as_it_is() {
        let mut app = app();
        let work = start(&mut app);
        let before = (*app.open().unwrap().document).clone();
        let why = NoCamera::Before {
            message: "only 1 line can be seen".to_owned(),
            asks_for_clicks: false,
        };
        let labels = MatchLabels::NoCamera(why);
        let document = work.document.clone();
        work.take_over(&mut app, Ok(LabelledDocument { document, labels }));
        assert_eq!(*app.open().unwrap().document, before);
        let text = "No camera was found: only 1 line can be seen.";
        assert_eq!(last_notice(&app), text);
        let Some(NoAnswer { why, .. }) = &app.operations.camera_search.no_answer else {
            panic!("{:?}", app.operations.camera_search.no_answer)
        };
        assert_eq!(why, text);
    }

    #[test]
    fn it_is_for_a_video_of_one_camera_without_a_base() {
        let mut app = app();
        let open = app.open.as_mut().unwrap();
        open.document.frames[5].camera = "side".into();
        app.update(Action::View(ViewAction::CloseDialog));
        assert!(app.why_not(Command::FindCameras).is_some());
        assert!(app.why_not(Command::StopFindCameras).is_some());
    }
}
