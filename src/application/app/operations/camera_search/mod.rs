//! Autocalibration in the window: finds a camera from the pictures of its frames, without a click.
//!
//! The search ends in one camera, which is written into the document, or in an abstention, with the
//! reason and a remedy.

mod match_labelling;
mod search_step;
mod words;

use crate::app::operation::{Context, Failure, Operation, Running, Slot};
use crate::app::operations::{OperationStep, UnderWay};
use crate::app::window_state::session::{Dialog, Level};
use crate::app::{App, Command};
pub(in crate::app) use match_labelling::MatchLabellingState;
pub use match_labelling::{LabelledDocument, MatchLabelling};
pub use search_step::SearchSteps;
use std::collections::BTreeSet;
use std::path::PathBuf;
use std::sync::{Arc, LazyLock};
use touchline_calibration::autocalibrate::{
    AutocalibrationAnswer, AutocalibrationError, find_camera, is_court,
};
use touchline_calibration::calibrate::{AutocalibratedCamera, BulkChange, FoundCamera};
use touchline_calibration::pipelines::MatchOptions;
use touchline_calibration::proposals::read_picture;
use touchline_core::field::{Template, builtin, builtin_names};
use touchline_documents::document::{CameraId, Document, FrameId, Step, Target};
pub use words::describe_found;
use words::{clicks_that_help, describe_abstention};

/// Minimum number of frames. Fewer hardly separate what is painted on the ground from what moves
/// over it.
const MIN_FRAMES: usize = 3;

/// Number of landmarks in one frame with which the search begins, in place of trying all positions.
const CLICKS_TO_BEGIN: usize = 2;

/// Finds the base of a camera from the pictures of its frames.
#[derive(Debug)]
pub struct CameraSearch {
    /// The document when the search started.
    pub document: Document,
    /// The folder to which its relative paths refer.
    pub folder: PathBuf,
    /// The camera to be found.
    pub camera: CameraId,
}

/// The search on the open document, and the outcome of the last one.
#[derive(Debug, Default)]
pub struct CameraSearchState {
    slot: Slot<CameraSearch>,
    /// Why the last search found no camera.
    pub no_answer: Option<NoAnswer>,
    /// The camera that was found last, for the panel's map.
    pub found: Option<Arc<FoundCamera>>,
}

/// Why a search found no camera.
#[derive(Debug)]
pub struct NoAnswer {
    /// The camera that was searched for.
    pub camera: CameraId,
    /// The reason, and what would help.
    pub why: String,
    /// The frame in which clicks would help most.
    pub frame: Option<FrameId>,
}

impl Operation for CameraSearch {
    type Progress = OperationStep;
    type Output = AutocalibrationAnswer;
    type Error = AutocalibrationError;

    const NAME: &'static str = "find the camera";

    fn run(
        &self,
        context: &Context<'_, OperationStep>,
    ) -> Result<AutocalibrationAnswer, AutocalibrationError> {
        let mut reader = context.open_reader();
        let mut picture = |index: usize| {
            read_picture(&mut *reader, &self.document.frames[index], &self.folder).ok()
        };
        let at = self.document.at(&self.folder);
        let sampled_frames = MatchOptions::default().sampled_frames;
        let steps = SearchSteps::default();
        let progress = context.progress();
        find_camera(
            at,
            &self.camera,
            sampled_frames,
            &mut picture,
            &progress.part(|event| steps.of_search(&event)),
        )
    }

    fn slot(app: &mut App) -> &mut Slot<Self> {
        &mut app.operations.camera_search.slot
    }

    fn must_wait(app: &App) -> bool {
        app.is_amid_change()
    }

    fn take_over(
        &self,
        app: &mut App,
        result: Result<AutocalibrationAnswer, Failure<AutocalibrationError>>,
    ) {
        match result {
            Ok(AutocalibrationAnswer::Found(found)) => {
                app.camera_found(&self.document, self.with_frame_ids(*found));
            }
            Ok(AutocalibrationAnswer::Abstained { why, clicks }) => {
                let help = clicks_that_help(&why, clicks.as_ref(), &self.document, |landmark| {
                    app.label(&Target::Landmark(landmark.clone()))
                });
                let why = describe_abstention(&why, &help);
                app.session.warn(why.clone());
                app.operations.camera_search.no_answer = Some(NoAnswer {
                    camera: self.camera.clone(),
                    why,
                    frame: clicks.map(|clicks| self.document.frames[clicks.frame].id.clone()),
                });
            }
            Err(failure) => {
                let text = format!("The search for the camera failed: {failure}.");
                app.session.notify(failure.level(), text);
            }
        }
    }
}

impl CameraSearch {
    /// Replaces frame indices in a found camera by ids, because frames may be added or removed
    /// until the user decides.
    fn with_frame_ids(&self, found: AutocalibratedCamera) -> Arc<FoundCamera> {
        Arc::new(FoundCamera::new(&self.document, &self.camera, found))
    }
}

/// Why the search does not know a camera's sport. None for soccer, for courts, for a template of
/// the user's own, and for any sport once two landmarks are clicked, from which the search then
/// begins.
fn why_no_search_of_sport(document: &Document, camera: &CameraId) -> Option<&'static str> {
    /// The names of the built-in templates of the other sports. A template of the user's own is not
    /// among them: the search looks whether it is of a court.
    static UNKNOWN: LazyLock<BTreeSet<&str>> = LazyLock::new(|| {
        let mut names: BTreeSet<&str> = builtin_names().into_iter().collect();
        names.retain(|name| {
            let field = builtin(name).and_then(Template::default_model);
            *name != "soccer" && field.is_ok_and(|field| !is_court(&field))
        });
        names
    });
    if !UNKNOWN.contains(&*document.field_of_camera(camera).template) {
        return None;
    }
    let mut frames = document.frames.iter();
    let is_clicked =
        frames.any(|frame| frame.camera == *camera && frame.landmark_clicks() >= CLICKS_TO_BEGIN);
    (!is_clicked).then_some(
        "Without a click only soccer fields and courts are found. Click 2 landmarks far from each \
         other in one frame, then look; or 4 in 3 frames.",
    )
}

impl App {
    /// The camera that was found last.
    pub fn found_camera(&self) -> Option<Arc<FoundCamera>> {
        self.operations.camera_search.found.clone()
    }

    /// Why a command of the search is not available. None if it is.
    pub(in crate::app) fn why_not_camera_search(&self, command: Command) -> Option<&'static str> {
        let CameraSearchState {
            slot, no_answer, ..
        } = &self.operations.camera_search;
        match command {
            Command::FindCamera => self.why_not_find_camera(),
            Command::StopFindCamera if !slot.is_running() && no_answer.is_none() => {
                Some("No search for a camera is running.")
            }
            _ => None,
        }
    }

    /// Why no search can be started. None if it can.
    fn why_not_find_camera(&self) -> Option<&'static str> {
        let (open, camera) = (self.open.as_ref()?, self.camera_id()?);
        if open.read_only.is_some() {
            return Some("The document is read-only.");
        }
        if cfg!(not(feature = "opencv")) {
            return Some("This program was built without OpenCV and cannot find features.");
        }
        if self.operations.camera_search.slot.is_running()
            || self.operations.match_labelling.is_running()
        {
            return Some("A search for the camera is running.");
        }
        if self.current.base.is_some() {
            return Some("This camera has a base already.");
        }
        if let Some(why) = why_no_search_of_sport(&open.document, camera) {
            return Some(why);
        }
        let few = open
            .document
            .frames
            .iter()
            .filter(|frame| frame.camera == *camera)
            .nth(MIN_FRAMES - 1)
            .is_none();
        few.then_some("The camera has too few frames: 3 or more that overlap are needed.")
    }

    /// Carries out a command of the search.
    pub(in crate::app) fn camera_search_command(&mut self, command: Command) {
        match command {
            Command::FindCamera => self.find_camera(),
            Command::StopFindCamera => self.stop_find_camera(),
            _ => {}
        }
    }

    /// Starts a search for the shown frame's camera.
    fn find_camera(&mut self) {
        self.commit_open_step();
        let (Some(open), Some(camera)) = (&self.open, self.camera_id().cloned()) else {
            return;
        };
        let (document, folder) = ((*open.document).clone(), open.folder.clone());
        self.operations.camera_search.no_answer = None;
        self.start(CameraSearch {
            document,
            folder,
            camera,
        });
    }

    /// Stops the search, or dismisses why there is no camera. The document does not change.
    fn stop_find_camera(&mut self) {
        self.operations.camera_search.no_answer = None;
        if self.operations.camera_search.slot.cancel() {
            self.session
                .note("The search for the camera was stopped; nothing was changed.");
        }
    }

    /// Uses a found camera, unless the camera has a base by now, or another field than `then`.
    fn camera_found(&mut self, then: &Document, found: Arc<FoundCamera>) {
        if self.refuses_other_field(then, &found.camera) {
            return;
        }
        // The user may have given the camera a base while the search ran. That base takes
        // precedence.
        let has_base = self
            .open
            .as_ref()
            .and_then(|open| open.document.camera(&found.camera)?.base())
            .is_some();
        if has_base {
            let text = "The camera was found, but it was given a base in the meantime; the result was discarded.";
            self.session.note(text);
            return;
        }
        self.use_found_camera(found);
    }

    /// Whether the camera's field has changed since the search began; shows a message if so.
    fn refuses_other_field(&mut self, then: &Document, camera: &CameraId) -> bool {
        let is_other = !self.has_field_of(then, camera);
        if is_other {
            let text =
                "The field changed in the meantime; the camera that was found was discarded.";
            self.session
                .notify_with(Level::Info, text, [("Find it again", Command::FindCamera)]);
        }
        is_other
    }

    /// Writes a found camera and the cameras of its frames into the document; one step of undo.
    fn use_found_camera(&mut self, found: Arc<FoundCamera>) {
        self.operations.camera_search.found = Some(Arc::clone(&found));
        self.change_in_bulk(
            Step::on_document("Find the camera"),
            BulkChange::Autocalibrated(found),
            |app, change| {
                if let BulkChange::Autocalibrated(found) = change {
                    app.report_found_camera(found);
                }
            },
        );
    }

    /// Reports a camera that was written into the document.
    fn report_found_camera(&mut self, found: &FoundCamera) {
        self.session.retract(Command::FindCamera);
        self.session.retract(Command::EstimateBase);
        self.report_assumed_size();
        let offers = [("Review", Command::ReviewPanel), ("Undo", Command::Undo)];
        self.session
            .notify_with(Level::Info, describe_found(&found.found), offers);
        // What the user is doing in another dialog comes first; the message remains.
        if self.session.dialog.is_none() {
            self.session.dialog = Some(Dialog::FoundCamera);
        }
    }
}

impl CameraSearchState {
    /// The running search with its progress, for the status row.
    pub fn under_way(&self) -> Option<UnderWay> {
        let (running, stop) = (self.slot.running()?, Command::StopFindCamera);
        Some(UnderWay::from_running(running, "Finding the camera", stop))
    }

    /// Whether a search is running.
    pub(super) const fn is_running(&self) -> bool {
        self.slot.is_running()
    }

    /// The inputs of the running search.
    pub fn running(&self) -> Option<&CameraSearch> {
        self.slot.running().map(Running::operation)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use touchline_documents::document::FieldSpec;
    use touchline_documents::testing::soccer_document;

    #[test]
    fn soccer_courts_and_fields_of_ones_own_are_searched_without_a_click() {
        let is_searched = |template: &str| {
            let mut document = soccer_document();
            document.field = FieldSpec::new(template);
            why_no_search_of_sport(&document, &"main".into()).is_none()
        };
        for template in ["soccer", "tennis", "my_court.json"] {
            assert!(is_searched(template), "{template}");
        }
        assert!(!is_searched("american_football_nfl"));
    }
}
