//! The operations: slow work of the application. Each has one file or folder with its input and its
//! work, the condition under which it is available, the use of its result, and its messages.
//!
//! To add an operation, write its file, give [`Operations`] a field for its state, and let a
//! command or an action start it. The commands of operations, and the operations that start without
//! a command, are listed in this file, so that the rest of the application names none. A result
//! joins the document as `as_it_was` says.

pub mod base_estimate;
mod base_refinement;
pub mod bulk_solve;
mod burnt_in;
pub mod camera_search;
mod camera_watch;
mod clip_tracking;
pub mod comparison;
pub mod frame_snap;
mod line_check;
mod mending;
mod new_images;
mod path_sorting;
mod picture_check;
mod point_snap;
pub mod shot_search;
pub mod transfer;

pub use base_estimate::BaseEstimate;
pub use base_refinement::BaseRefinement;
pub use bulk_solve::BulkSolving;
pub use burnt_in::BurntInSearch;
pub use camera_search::{CameraSearch, LabelledDocument, MatchLabelling, describe_found};
pub use camera_watch::CameraWatch;
pub use clip_tracking::ClipTracking;
pub use comparison::{Comparison, ComparisonResult};
pub use frame_snap::FrameSnap;
pub use line_check::{BESIDE_PX, LineCheckSummary, LineOffset};
pub use mending::Mending;
pub use new_images::NewImages;
pub use path_sorting::{ForeignLabels, PathSorting};
pub use point_snap::PointSnap;
pub use shot_search::{FoundShots, ShotSearch};

use super::effect::Effect;
#[cfg(test)]
use super::operation::probe::ProbeState;
use super::operation::{Operation, Running, Slot};
use super::{App, Command, Question};
use base_estimate::BaseEstimateState;
use base_refinement::BaseRefinementState;
use burnt_in::BurntInState;
use camera_search::{CameraSearchState, MatchLabellingState};
use camera_watch::CameraWatchState;
use clip_tracking::ClipTrackingState;
use comparison::ComparisonState;
use frame_snap::FrameSnapState;
use line_check::LineChecks;
use mending::MendingState;
use new_images::NewImagesState;
use picture_check::PictureComparisonState;
use point_snap::PointSnapState;
use shot_search::ShotSearchState;
use std::sync::Arc;
use touchline_calibration::autocalibrate::SearchedPanorama;
use touchline_calibration::calibrate::EstimatedBase;
use touchline_documents::document::{Document, Frame, Step};
use transfer::TransferState;

/// The state of each operation on the open document. Opening another document replaces this value,
/// which cancels whatever runs.
#[derive(Debug, Default)]
pub struct Operations {
    /// The estimation of a camera's base from clicks and painted lines.
    pub base_estimate: BaseEstimateState,
    /// The refinement of a base on the shot that is shown.
    pub(in crate::app) base_refinement: BaseRefinementState,
    /// Changes after which many frames are solved again.
    pub bulk_solve: Slot<BulkSolving>,
    /// The search for graphics that are burned into the pictures.
    pub(in crate::app) burnt_in: BurntInState,
    /// Autocalibration: the search for a camera from pictures alone.
    pub camera_search: CameraSearchState,
    /// The check whether one base fits all frames of the shown frame's camera.
    pub(in crate::app) camera_watch: CameraWatchState,
    /// The tracking of cameras through a clip.
    pub(in crate::app) clip_tracking: ClipTrackingState,
    /// The comparison with another annotator's document.
    pub comparison: ComparisonState,
    /// The alignment of frames to their painted lines.
    pub frame_snap: FrameSnapState,
    /// The search for all cameras of a video.
    pub(in crate::app) match_labelling: MatchLabellingState,
    /// The mending of imported cameras.
    pub(in crate::app) mending: MendingState,
    /// The search for images that came to the folders of the document.
    pub(in crate::app) new_images: NewImagesState,
    /// The sorting of dropped paths.
    pub(in crate::app) path_sorting: Slot<PathSorting>,
    /// The comparison of the frames' cameras with the painted lines.
    pub(in crate::app) line_checks: LineChecks,
    /// The check whether the pictures on disk are those that the document was made with.
    pub(in crate::app) picture_comparison: PictureComparisonState,
    /// The alignment of clicked points to the paint that they name.
    pub(in crate::app) point_snap: PointSnapState,
    /// The search for the cuts of a video.
    pub shot_search: ShotSearchState,
    /// Exports and imports: what the user chose, and what is running.
    pub transfer: TransferState,
    #[cfg(test)]
    pub(crate) probe: ProbeState,
}

/// Work that the user started and waits for, as its card in the side panel shows it.
#[derive(Clone, Debug, PartialEq)]
pub struct UnderWay {
    /// The name of the whole work, a few words.
    pub job: String,
    /// The present step and how far it has come, in one sentence.
    pub step: String,
    /// The share of the present step that is done, 0 to 1; none if it is unknown.
    pub share: Option<f32>,
    pub stop: Command,
    /// The panorama of the camera that is being searched; none in other work.
    pub panorama: Option<Arc<SearchedPanorama>>,
}

/// What an operation does at present.
#[derive(Clone, Debug, PartialEq)]
pub struct OperationStep {
    /// In one sentence.
    step: String,
    /// The share of the step that is done, 0 to 1; none if it is unknown.
    share: Option<f32>,
    /// The panorama of the camera that is being searched; none while its frames are not matched.
    panorama: Option<Arc<SearchedPanorama>>,
}

impl OperationStep {
    fn new(step: impl Into<String>, share: Option<f32>) -> Self {
        Self {
            step: step.into(),
            share,
            panorama: None,
        }
    }
}

impl UnderWay {
    pub(super) fn new(job: impl Into<String>, step: impl Into<String>, stop: Command) -> Self {
        Self {
            job: job.into(),
            step: step.into(),
            share: None,
            stop,
            panorama: None,
        }
    }

    pub(super) fn with_share(self, share: Option<f32>) -> Self {
        Self { share, ..self }
    }

    /// Work on pictures at its present step, before the first of which they are opened.
    fn from_running<O>(running: &Running<O>, job: &str, stop: Command) -> Self
    where
        O: Operation<Progress = OperationStep>,
    {
        let Some(at) = running.progress() else {
            return Self::new(job, "Opening the pictures", stop);
        };
        Self {
            panorama: at.panorama.clone(),
            ..Self::new(job, &at.step, stop).with_share(at.share)
        }
    }
}

impl Operations {
    /// Whether an export or a dataset is being written.
    pub fn is_export_under_way(&self) -> bool {
        self.transfer.writing().is_some()
    }

    /// The work that the side panel shows, with its progress.
    pub fn under_way(&self) -> impl Iterator<Item = UnderWay> {
        [
            self.bulk_solve.under_way(),
            self.camera_search.under_way(),
            self.match_labelling.under_way(),
            self.base_estimate.under_way(),
            self.base_refinement.under_way(),
            self.clip_tracking.under_way(),
            self.mending.under_way(),
            self.frame_snap.under_way(),
            self.transfer.under_way(),
        ]
        .into_iter()
        .flatten()
    }

    /// Whether a base is being estimated.
    pub const fn is_estimating_base(&self) -> bool {
        self.base_estimate.running().is_some()
    }

    /// Whether a camera or a base is being looked for, or an estimated one waits for a decision.
    pub(super) const fn is_base_open(&self) -> bool {
        self.base_estimate.is_open()
            || self.camera_search.is_running()
            || self.match_labelling.is_running()
    }

    /// The running work that will give a frame its camera: what it does, and which frames it
    /// answers.
    pub(super) fn answering(&self, frame: &Frame) -> Option<(&'static str, AnswersFrame<'_>)> {
        let search = self.camera_search.running();
        if let Some(search) = search.filter(|search| search.camera == frame.camera) {
            let answers = |frame: &Frame| frame.camera == search.camera;
            return Some(("Finding the camera", Box::new(answers)));
        }
        if self.match_labelling.answers(frame) {
            return Some((
                "Finding the cameras",
                Box::new(|frame: &Frame| self.match_labelling.answers(frame)),
            ));
        }
        if self.mending.is_running() && frame.has_imported_camera() {
            return Some(("Mending the cameras", Box::new(Frame::has_imported_camera)));
        }
        if self.frame_snap.is_searching(frame) {
            let id = frame.id.clone();
            let answers = move |frame: &Frame| frame.id == id;
            return Some(("Searching the painted lines", Box::new(answers)));
        }
        let tracked = self
            .clip_tracking
            .tracked_frame()
            .or_else(|| self.base_refinement.tracked_frame())?;
        is_in_shot_of(tracked, frame).then(|| {
            let answers = |frame: &Frame| is_in_shot_of(tracked, frame);
            ("Tracking cameras", Box::new(answers) as AnswersFrame<'_>)
        })
    }

    /// The estimated base that waits for the user's decision.
    pub const fn proposed_base(&self) -> Option<&Arc<EstimatedBase>> {
        self.base_estimate.proposed_base()
    }
}

/// Says which frames running work gives their cameras.
type AnswersFrame<'a> = Box<dyn Fn(&Frame) -> bool + 'a>;

/// Whether two frames belong to one shot of one camera.
fn is_in_shot_of(one: &Frame, other: &Frame) -> bool {
    let file = |frame: &Frame| frame.video.as_ref().map(|video| video.path.clone());
    one.camera == other.camera && one.clip == other.clip && file(one) == file(other)
}

impl App {
    /// Why a command of an operation is not available. None if it is, or if it belongs to no
    /// operation.
    pub(super) fn why_not_operation(&self, command: Command) -> Option<&'static str> {
        use Command as C;
        match command {
            C::EstimateBase | C::FitFieldSize | C::UseEstimatedBase | C::DropEstimatedBase => {
                self.why_not_base_estimate(command)
            }
            C::StopSolving => self.why_not_stop_bulk(),
            C::KeepBurntIn | C::ChangeBurntIn => self.why_not_decide_burnt_in(),
            C::FindCamera | C::StopFindCamera => self.why_not_camera_search(command),
            C::FindCameras | C::StopFindCameras => self.why_not_match_labelling(command),
            C::Track
            | C::DiscardTracked
            | C::StopTracking
            | C::TakeLength
            | C::RefineBaseOnShot => self.why_not_clip_tracking(command),
            C::MendCameras | C::StopMending => self.why_not_mending(command),
            C::AddNewImages => self.why_not_add_images(),
            C::ShowExported => self.why_not_show_exported(),
            C::StopExport => self.why_not_stop_export(),
            C::CompareAnnotators => self.why_not_compare(),
            C::Snap | C::SearchLines | C::StopSearch => self.why_not_frame_snap(command),
            C::FindShots | C::StopShotSearch => self.why_not_shot_search(command),
            _ => None,
        }
    }

    /// Carries out a command of an operation; ignores other commands.
    pub(super) fn operation_command(&mut self, command: Command) {
        use Command as C;
        match command {
            C::EstimateBase | C::FitFieldSize | C::UseEstimatedBase | C::DropEstimatedBase => {
                self.base_estimate_command(command);
            }
            C::StopSolving => self.stop_bulk(),
            C::KeepBurntIn => self.keep_burnt_in(),
            C::ChangeBurntIn => self.change_burnt_in(),
            C::FindCamera | C::StopFindCamera => {
                self.camera_search_command(command);
            }
            C::FindCameras | C::StopFindCameras => self.match_labelling_command(command),
            C::Track
            | C::DiscardTracked
            | C::StopTracking
            | C::TakeLength
            | C::RefineBaseOnShot => {
                self.clip_tracking_command(command);
            }
            C::MendCameras | C::StopMending => self.mending_command(command),
            C::AddNewImages => self.add_new_images(),
            C::CompareAnnotators => self.effects.push(Effect::Ask(Question::CompareWith)),
            C::Snap | C::SearchLines | C::StopSearch => self.frame_snap_command(command),
            C::FindShots | C::StopShotSearch => self.shot_search_command(command),
            _ => {}
        }
    }

    /// Makes a document that was joined with a result the present one, as one step of undo. Returns
    /// false, with a message, if no step can begin.
    fn take_joined(&mut self, step: &'static str, joined: Document) -> bool {
        if !self.begin_step(Step::on_document(step)) {
            return false;
        }
        if let Some(open) = &mut self.open {
            let Document {
                field,
                cameras,
                frames,
                shots,
                ..
            } = joined;
            let now = &mut open.document;
            (now.field, now.cameras, now.frames, now.shots) = (field, cameras, frames, shots);
        }
        // The frames belong to their new cameras already: they must not be turned to them again.
        self.close_step();
        true
    }

    /// Starts the operations that run once on a document that was just opened.
    pub(super) fn start_on_opening(&mut self) {
        self.find_burnt_in();
        self.find_shots_of_new();
        self.compare_pictures();
        self.look_for_new_images();
    }

    /// Starts the operations that follow every change of the document.
    pub(super) fn start_after_change(&mut self) {
        self.watch_camera();
        self.snap_points();
        self.check_lines();
    }
}
