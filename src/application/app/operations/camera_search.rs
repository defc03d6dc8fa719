//! Autocalibration in the window: finds a camera from the pictures of its frames, without a click.
//!
//! The search ends in one of three ways: one camera, which is written into the document; two
//! cameras that explain the paint about equally well, between which the user or one further click
//! decides; or an abstention, with the reason and a remedy.

use crate::app::operation::{Context, Failure, Operation, Running, Slot};
use crate::app::operations::UnderWay;
use crate::app::window_state::session::{Dialog, Level, SidePanel};
use crate::app::{App, Command};
use std::path::PathBuf;
use std::sync::Arc;
use touchline_calibration::autocalibrate::{
    Abstention, AutocalibrationAnswer, AutocalibrationError, AutocalibrationProgress,
    DecidingLandmark, Doubt, WantedClicks, find_camera,
};
use touchline_calibration::calibrate::{
    AutocalibratedCamera, BulkChange, FoundCamera, describe_size,
};
use touchline_calibration::pipelines::MatchOptions;
use touchline_calibration::proposals::read_picture;
use touchline_core::camera::CameraBase;
use touchline_core::field::LandmarkId;
use touchline_core::geometry::ImagePoint;
use touchline_core::solve::base::FittedSize;
use touchline_documents::document::{Camera, CameraId, Document, FrameId, Step, Target};

/// Minimum number of frames. Fewer hardly separate what is painted on the ground from what moves
/// over it.
const FEWEST: usize = 3;

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
    /// What the last search left for the user to decide or to read.
    pub left: SearchFollowUp,
    /// The camera that was found last, for the panel's map.
    pub found: Option<Arc<FoundCamera>>,
}

/// What a search leaves for the user to decide or to read.
#[derive(Debug, Default)]
pub enum SearchFollowUp {
    /// Nothing.
    #[default]
    Nothing,
    /// Two positions explain the paint; the user decides.
    Two(Box<TwoCameras>),
    /// No answer was certain enough.
    Abstained {
        /// The camera that was searched for.
        camera: CameraId,
        /// The reason, and what would help.
        why: String,
        /// The frame in which clicks would help most.
        frame: Option<FrameId>,
    },
}

/// Two cameras that explain the paint about equally well.
#[derive(Debug)]
pub struct TwoCameras {
    /// The camera that explains more paint first.
    pub cameras: [Arc<FoundCamera>; 2],
    /// The click that would decide between them, if there is one.
    pub deciding: Option<DecidingClick>,
}

/// A click that would decide between two cameras.
#[derive(Clone, Debug, PartialEq)]
pub struct DecidingClick {
    /// The frame in which to click.
    pub frame: FrameId,
    /// The landmark to click there.
    pub landmark: LandmarkId,
    /// Where the first and the second camera project the landmark, px.
    image: [ImagePoint; 2],
    /// Both positions, as text.
    says: String,
}

// ---- The work ----

impl Operation for CameraSearch {
    type Progress = AutocalibrationProgress;
    type Output = AutocalibrationAnswer;
    type Error = AutocalibrationError;

    const NAME: &'static str = "find the camera";

    fn run(
        &self,
        context: &Context<'_, AutocalibrationProgress>,
    ) -> Result<AutocalibrationAnswer, AutocalibrationError> {
        let mut reader = context.open_reader();
        let mut picture = |index: usize| {
            read_picture(&mut *reader, &self.document.frames[index], &self.folder).ok()
        };
        let at = self.document.at(&self.folder);
        let sampled_frames = MatchOptions::default().sampled_frames;
        find_camera(
            at,
            &self.camera,
            sampled_frames,
            &mut picture,
            &context.progress(),
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
                app.camera_found(self.with_frame_ids(*found));
            }
            Ok(AutocalibrationAnswer::Two {
                best,
                other,
                deciding,
            }) => {
                let two = TwoCameras::new(self, [*best, *other], deciding, |deciding| {
                    app.label(&Target::Landmark(deciding.landmark.clone()))
                });
                app.ask_which_camera(two);
            }
            Ok(AutocalibrationAnswer::Abstained { why, clicks }) => {
                let help = clicks_that_help(&why, clicks.as_ref(), &self.document, |landmark| {
                    app.label(&Target::Landmark(landmark.clone()))
                });
                let why = describe_abstention(&why, &help);
                app.session.notify(Level::Warning, why.clone());
                app.operations.camera_search.left = SearchFollowUp::Abstained {
                    camera: self.camera.clone(),
                    why,
                    frame: clicks.map(|clicks| self.document.frames[clicks.frame].id.clone()),
                };
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

// ---- In the application ----

impl App {
    /// The camera that was found last, or of two the one that explains more paint.
    #[must_use]
    pub fn found_camera(&self) -> Option<Arc<FoundCamera>> {
        self.operations.camera_search.found.clone()
    }

    /// Why a command of the search is not available. None if it is.
    pub(in crate::app) fn why_not_camera_search(&self, command: Command) -> Option<&'static str> {
        let CameraSearchState { slot, left, .. } = &self.operations.camera_search;
        match command {
            Command::FindCamera => self.why_not_find_camera(),
            Command::StopFindCamera
                if !slot.is_running() && matches!(left, SearchFollowUp::Nothing) =>
            {
                Some("No search for a camera is running.")
            }
            Command::TryFirstCamera | Command::TryOtherCamera
                if !matches!(left, SearchFollowUp::Two(_)) =>
            {
                Some("There are no two cameras to choose from.")
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
        if self.operations.camera_search.slot.is_running() {
            return Some("A search for the camera is running.");
        }
        if self.current.base.is_some() {
            return Some("This camera has a base already.");
        }
        let few = open
            .document
            .frames
            .iter()
            .filter(|frame| frame.camera == *camera)
            .nth(FEWEST - 1)
            .is_none();
        few.then_some("The camera has too few frames: 3 or more that overlap are needed.")
    }

    /// Carries out a command of the search.
    pub(in crate::app) fn camera_search_command(&mut self, command: Command) {
        match command {
            Command::FindCamera => self.find_camera(),
            Command::StopFindCamera => self.stop_find_camera(),
            Command::TryFirstCamera => self.try_camera(0),
            Command::TryOtherCamera => self.try_camera(1),
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
        self.operations.camera_search.left = SearchFollowUp::Nothing;
        self.start(CameraSearch {
            document,
            folder,
            camera,
        });
    }

    /// Stops the search, or dismisses its pending choice. The document does not change.
    fn stop_find_camera(&mut self) {
        self.operations.camera_search.left = SearchFollowUp::Nothing;
        if self.operations.camera_search.slot.cancel() {
            self.session.notify(
                Level::Info,
                "The search for the camera was stopped; nothing was changed.",
            );
        }
    }

    /// Uses a found camera, unless the camera has a base by now.
    fn camera_found(&mut self, found: Arc<FoundCamera>) {
        // The user may have given the camera a base while the search ran. That base takes
        // precedence.
        let has_base = self
            .open
            .as_ref()
            .and_then(|open| open.document.camera(&found.camera)?.base())
            .is_some();
        if has_base {
            let text = "The camera was found, but it was given a base in the meantime; the result was discarded.";
            self.session.notify(Level::Info, text);
            return;
        }
        self.use_found_camera(found);
    }

    /// Asks the user which of two cameras is right.
    fn ask_which_camera(&mut self, two: TwoCameras) {
        let offers = [
            ("Try the first", Command::TryFirstCamera),
            ("Try the other", Command::TryOtherCamera),
        ];
        self.session
            .notify_with(Level::Warning, two.describe(), offers);
        self.session.panel = SidePanel::Camera;
        let state = &mut self.operations.camera_search;
        state.found = Some(Arc::clone(&two.cameras[0]));
        state.left = SearchFollowUp::Two(Box::new(two));
    }

    /// If the deciding click between two cameras has been made, uses the camera that it favours.
    /// Called after each action.
    pub(in crate::app) fn decide_camera_by_click(&mut self) {
        if self.is_amid_change() {
            return;
        }
        let (SearchFollowUp::Two(two), Some(open)) =
            (&self.operations.camera_search.left, &self.open)
        else {
            return;
        };
        let Some(which) = two
            .deciding
            .as_ref()
            .and_then(|deciding| deciding.favoured_camera(&open.document))
        else {
            return;
        };
        // A base that the user has found in another way since takes precedence over both.
        let camera = open.document.camera(&two.cameras[0].camera);
        if let Some(base) = camera.and_then(Camera::base)
            && two.cameras.iter().all(|found| !is_at(&found.found, &base))
        {
            return;
        }
        // The choice is settled before the camera is used, or this would run again after it.
        let found = Arc::clone(&two.cameras[which]);
        self.operations.camera_search.left = SearchFollowUp::Nothing;
        self.session.retract(Command::TryFirstCamera);
        self.session.retract(Command::TryOtherCamera);
        self.use_found_camera(found);
    }

    /// Uses one of the two cameras; each attempt is one step of undo.
    fn try_camera(&mut self, which: usize) {
        if let SearchFollowUp::Two(two) = &self.operations.camera_search.left {
            let found = Arc::clone(&two.cameras[which]);
            self.use_found_camera(found);
        }
    }

    /// Writes a found camera and the cameras of its frames into the document; one step of undo.
    fn use_found_camera(&mut self, found: Arc<FoundCamera>) {
        self.operations.camera_search.found = Some(Arc::clone(&found));
        self.change_in_bulk(
            Step::on_document("Find the camera"),
            BulkChange::Autocalibrated(found),
            |app, change| {
                if let BulkChange::Autocalibrated(found) = change {
                    app.tell_found_camera(found);
                }
            },
        );
    }

    /// Reports a camera that was written into the document.
    fn tell_found_camera(&mut self, found: &FoundCamera) {
        self.session.retract(Command::FindCamera);
        self.session.retract(Command::EstimateBase);
        self.tell_assumed_size();
        let offers = [("Review", Command::ReviewPanel), ("Undo", Command::Undo)];
        self.session
            .notify_with(Level::Info, describe_found(&found.found), offers);
        // What the user is doing in another dialog, and the choice between two cameras, come first;
        // the message remains.
        let is_choosing = matches!(self.operations.camera_search.left, SearchFollowUp::Two(_));
        if self.session.dialog.is_none() && !is_choosing {
            self.session.dialog = Some(Dialog::FoundCamera);
        }
    }
}

impl CameraSearchState {
    /// The running search with its progress, for the status row.
    #[must_use]
    pub fn under_way(&self) -> Option<UnderWay> {
        let progress = self.slot.running()?.progress();
        let far = progress
            .map(|progress| format!(": {progress}"))
            .unwrap_or_default();
        let text = format!("Finding the camera{far}…");
        let share = progress.map(|progress| progress.share_of_step() as f32);
        Some(UnderWay {
            text,
            share,
            stop: Command::StopFindCamera,
        })
    }

    /// The inputs of the running search.
    #[must_use]
    pub fn running(&self) -> Option<&CameraSearch> {
        self.slot.running().map(Running::operation)
    }
}

/// Whether a base is at the position of a found camera.
fn is_at(found: &AutocalibratedCamera, base: &CameraBase) -> bool {
    (found.base.position_m - base.position_m).norm() < 1e-6
}

// ---- Two answers ----

/// A click decides for a camera if the other camera's projection is more than this many times as
/// far away from it.
const NEARER: f64 = 2.0;

impl DecidingClick {
    /// The index of the camera that the document's click favours. None if the landmark is not
    /// clicked in that frame, or the click lies between the two projections.
    fn favoured_camera(&self, document: &Document) -> Option<usize> {
        let frame = &document.frames[document.frames.position_of(&self.frame)?];
        // Where the two projections are nearly equally far, the click noise would decide.
        let target = Some(Target::Landmark(self.landmark.clone()));
        let click = frame.clicks.iter().find(|click| click.target == target)?;
        let [here, there] = self.image.map(|image| image.distance_px(click.image));
        if NEARER * here < there {
            Some(0)
        } else if NEARER * there < here {
            Some(1)
        } else {
            None
        }
    }
}

impl TwoCameras {
    /// Two answers of a search. `label` returns the label of a landmark.
    fn new(
        search: &CameraSearch,
        cameras: [AutocalibratedCamera; 2],
        deciding: Option<DecidingLandmark>,
        label: impl Fn(&DecidingLandmark) -> String,
    ) -> Self {
        let deciding = deciding.map(|deciding| {
            let [here, there] = deciding
                .image
                .map(|image| format!("({:.0}, {:.0})", image.x, image.y));
            let frame = &search.document.frames[deciding.frame];
            let says = format!(
                "{} on frame {} is at {here} px with the first and at {there} px with the other",
                label(&deciding),
                frame.number_at(deciding.frame)
            );
            DecidingClick {
                frame: frame.id.clone(),
                landmark: deciding.landmark,
                image: deciding.image,
                says,
            }
        });
        Self {
            cameras: cameras.map(|found| search.with_frame_ids(found)),
            deciding,
        }
    }

    /// The question to the user, with the deciding click if there is one.
    #[must_use]
    pub fn describe(&self) -> String {
        let [best, other] = [0, 1].map(|which| place(&self.cameras[which].found));
        let by = self.deciding.as_ref().map_or_else(
            || "Try each and look at the lines.".to_owned(),
            |deciding| format!("One click decides: {}.", deciding.says),
        );
        format!("Two positions of the camera explain the painted lines: {best}, and {other}. {by}")
    }
}

// ---- Words ----

/// The result in two sentences: position, its 1-σ, and how many frames agree with their own paint.
pub fn describe_found(found: &AutocalibratedCamera) -> String {
    let sigma = found.base.sigma.position_m;
    let (aligned, frames) = (found.aligned_frame_count(), found.frames.len());
    let assumed: String = found
        .sizes
        .iter()
        .filter(|size| size.is_open)
        .map(describe_assumed)
        .collect();
    format!(
        "Camera found: {}, known to ±{:.1} m. {aligned} of {frames} frames agree with their own painted \
         lines; look at some before you accept them.{assumed}",
        place(found),
        sigma.norm()
    )
}

/// A further sentence for a length of the field that the frames do not determine.
fn describe_assumed(size: &FittedSize) -> String {
    format!(" The field's {}.", describe_size(size))
}

/// The position of a camera, as text.
fn place(found: &AutocalibratedCamera) -> String {
    let at = found.base.position_m;
    format!(
        "{:.1} m high, {:.1} m from the middle of the field",
        at.z,
        at.x.hypot(at.y)
    )
}

/// The reason for an abstention and a remedy, as text.
fn describe_abstention(why: &Abstention, clicks_that_help: &str) -> String {
    let (why_not, missing) = (why_not(why), missing_view(why));
    format!("No camera was found: {why_not}. {missing}, or {clicks_that_help}.")
}

/// The reason for an abstention, as a part of a sentence.
fn why_not(why: &Abstention) -> String {
    match why {
        Abstention::Uncertain { doubts, .. } => {
            let doubts: Vec<String> = doubts.iter().map(Doubt::to_string).collect();
            format!("the best answer is not certain ({})", doubts.join("; "))
        }
        Abstention::NotConnected { frames, connected } => {
            format!("only {connected} of {frames} frames overlap with each other")
        }
        Abstention::LittlePaint { places } => {
            format!("only {places} places of paint agree between the frames")
        }
        other => other.to_string(),
    }
}

/// The missing view.
fn missing_view(why: &Abstention) -> String {
    match why {
        Abstention::NotConnected { .. } => {
            "Add frames in which the camera pans from one view to the next, all of one camera that \
             does not move"
                .to_owned()
        }
        Abstention::LittlePaint { .. } => {
            "Add wide frames: the centre circle and both penalty areas".to_owned()
        }
        Abstention::Uncertain { doubts, .. } => view_missing(doubts),
        _ => "Check that the field's sport is the one in the pictures".to_owned(),
    }
}

/// The clicks in frames of `document` that would replace the missing view. `label` returns the
/// label of a landmark.
fn clicks_that_help(
    why: &Abstention,
    clicks: Option<&WantedClicks>,
    document: &Document,
    label: impl Fn(&LandmarkId) -> String,
) -> String {
    match (why, clicks) {
        (Abstention::NotConnected { .. } | Abstention::NotTurning(_), _) => {
            "click 4 landmarks on 2 wide frames".to_owned()
        }
        (_, Some(clicks)) => {
            let landmarks = clicks.describe_landmarks(|id| format!("“{}”", label(id)));
            let number = document.frames[clicks.frame].number_at(clicks.frame);
            format!("click {landmarks} on frame {number} and look again")
        }
        (_, None) => "click 2 landmarks far from each other and look again".to_owned(),
    }
}

/// The view that would resolve the doubts.
fn view_missing(doubts: &[Doubt]) -> String {
    let lines = doubts.iter().find_map(|doubt| match doubt {
        Doubt::LinesMissing { lines } => Some(lines.join(", ")),
        _ => None,
    });
    if let Some(lines) = lines {
        return format!("A view of {lines} is missing: add frames that show it");
    }
    // Paint that no line of the field explains, or that lies beside the lines, points to a wrong
    // field.
    let points_to_field = doubts
        .iter()
        .any(|doubt| matches!(doubt, Doubt::Unexplained { .. } | Doubt::OffLines { .. }));
    if points_to_field {
        return "Check the field's size and sport, and whether other lines are painted there; add wide frames"
            .to_owned();
    }
    "Wide views of both ends and of the middle are missing: add such frames".to_owned()
}

#[cfg(test)]
mod tests {
    use super::*;
    use touchline_core::geometry::ImageSize;
    use touchline_documents::document::{FieldSpec, Frame, VideoFrame};

    #[test]
    fn the_frame_to_click_in_has_the_number_that_the_window_shows() {
        let mut document = Document::new(FieldSpec::new("soccer"));
        for index in [0, 25, 50] {
            let video = VideoFrame::new("match.mp4", index, None);
            let frame = Frame::from_video(video, "main".into(), ImageSize::new(64, 36));
            document.frames.push(frame.into());
        }
        let clicks = WantedClicks {
            frame: 2,
            landmarks: 2,
            named: Vec::new(),
        };
        let why = Abstention::NothingFits;
        let says = clicks_that_help(&why, Some(&clicks), &document, |_| String::new());
        assert_eq!(
            says,
            "click 2 landmarks far from each other on frame 50 and look again"
        );
    }
}
