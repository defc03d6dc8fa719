//! The operations, one file each: its input and its work, when it is available, what becomes of its
//! result, and its words.
//!
//! To add one, write its file, give [`Operations`] a field for its state, and let a command or an
//! action start it: commands of operations and what starts unasked are listed here, so that the
//! rest of the application names none.

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
mod picture_check;
mod point_snap;
pub mod shot_search;
pub mod transfer;

pub use base_estimate::BaseEstimate;
pub use base_refinement::BaseRefinement;
pub use bulk_solve::BulkSolving;
pub use burnt_in::BurntInSearch;
pub use camera_search::CameraSearch;
pub use camera_watch::CameraWatch;
pub use clip_tracking::ClipTracking;
pub use comparison::{Compared, Comparison};
pub use frame_snap::FrameSnap;
pub use line_check::PaintSays;
pub use point_snap::PointSnap;
pub use shot_search::{FoundShots, ShotSearch};

use super::effect::Effect;
#[cfg(test)]
use super::operation::probe::ProbeState;
use super::{App, Command, Question};
use base_estimate::BaseEstimateState;
use base_refinement::BaseRefinementState;
use bulk_solve::BulkSolveState;
use burnt_in::BurntInState;
use camera_search::CameraSearchState;
use camera_watch::CameraWatchState;
use clip_tracking::ClipTrackingState;
use comparison::ComparisonState;
use frame_snap::FrameSnapState;
use line_check::LineChecks;
use picture_check::PictureComparisonState;
use point_snap::PointSnapState;
use shot_search::ShotSearchState;
use std::sync::Arc;
use touchline_calibration::calibrate::EstimatedBase;
use transfer::TransferState;

/// The state of each operation on the open document. Another document begins with a new one:
/// whatever runs is cancelled.
#[derive(Debug, Default)]
pub struct Operations {
    /// The estimation of a camera's base.
    pub base_estimate: BaseEstimateState,
    /// A base refined on a shot.
    pub(in crate::app) base_refinement: BaseRefinementState,
    /// A change after which many frames are solved again.
    pub bulk_solve: BulkSolveState,
    /// The search for graphics that are burned into the pictures.
    pub(in crate::app) burnt_in: BurntInState,
    /// The search for a camera by pictures alone.
    pub camera_search: CameraSearchState,
    /// Whether the shown frame's camera fits all of its frames.
    pub(in crate::app) camera_watch: CameraWatchState,
    /// Cameras carried through a clip.
    pub(in crate::app) clip_tracking: ClipTrackingState,
    /// The comparison with another annotator's document.
    pub comparison: ComparisonState,
    /// Frames aligned to the painted lines.
    pub frame_snap: FrameSnapState,
    /// What the painted lines say about the frames' cameras.
    pub(in crate::app) line_checks: LineChecks,
    /// Whether the pictures are those that the document means.
    pub(in crate::app) picture_comparison: PictureComparisonState,
    /// Points that go to the paint that they name.
    pub(in crate::app) point_snap: PointSnapState,
    /// The search for the cuts of a video.
    pub shot_search: ShotSearchState,
    /// Exports and imports: what was chosen, and what is under way.
    pub transfer: TransferState,
    #[cfg(test)]
    pub(crate) probe: ProbeState,
}

/// Something that the user has asked for and waits for.
#[derive(Clone, Debug, PartialEq)]
pub struct UnderWay {
    /// What is being done and how far it has come, in one sentence.
    pub text: String,
    /// How much of the present step is done, 0 to 1; none where that is not known.
    pub share: Option<f32>,
    /// What stops it.
    pub stop: Command,
}

impl Operations {
    /// What the status row says is under way.
    #[must_use]
    pub fn under_way(&self) -> Option<UnderWay> {
        self.bulk_solve
            .under_way()
            .or_else(|| self.camera_search.under_way())
            .or_else(|| self.base_refinement.under_way())
            .or_else(|| self.clip_tracking.under_way())
            .or_else(|| self.frame_snap.under_way())
    }

    /// The estimation of a base that is under way: the status row speaks of it once nothing is
    /// being clicked.
    pub(super) fn base_under_way(&self) -> Option<UnderWay> {
        self.base_estimate.under_way()
    }

    /// The base that was estimated and waits for a decision.
    #[must_use]
    pub const fn proposed_base(&self) -> Option<&Arc<EstimatedBase>> {
        self.base_estimate.proposed()
    }
}

impl App {
    /// Why a command of an operation is not available; none if it is, and for other commands.
    pub(super) fn why_not_operation(&self, command: Command) -> Option<&'static str> {
        use Command as C;
        match command {
            C::EstimateBase | C::FitFieldSize | C::UseEstimatedBase | C::DropEstimatedBase => {
                self.why_not_base_estimate(command)
            }
            C::StopSolving => self.why_not_stop_bulk(),
            C::KeepBurntIn | C::ChangeBurntIn => self.why_not_decide_burnt_in(),
            C::FindCamera | C::StopFindCamera | C::TryFirstCamera | C::TryOtherCamera => {
                self.why_not_camera_search(command)
            }
            C::Track
            | C::DiscardCarried
            | C::StopTracking
            | C::TakeLength
            | C::RefineBaseOnShot => self.why_not_clip_tracking(command),
            C::CompareAnnotators => self.why_not_compare(),
            C::Snap | C::SearchLines | C::StopSearch => self.why_not_frame_snap(command),
            C::FindShots | C::StopShotSearch => self.why_not_shot_search(command),
            _ => None,
        }
    }

    /// Carries out a command of an operation.
    pub(super) fn operation_command(&mut self, command: Command) {
        use Command as C;
        match command {
            C::EstimateBase | C::FitFieldSize | C::UseEstimatedBase | C::DropEstimatedBase => {
                self.base_estimate_command(command);
            }
            C::StopSolving => self.stop_bulk(),
            C::KeepBurntIn => self.keep_burnt_in(),
            C::ChangeBurntIn => self.change_burnt_in(),
            C::FindCamera | C::StopFindCamera | C::TryFirstCamera | C::TryOtherCamera => {
                self.camera_search_command(command);
            }
            C::Track
            | C::DiscardCarried
            | C::StopTracking
            | C::TakeLength
            | C::RefineBaseOnShot => {
                self.clip_tracking_command(command);
            }
            C::CompareAnnotators => self.effects.push(Effect::Ask(Question::CompareWith)),
            C::Snap | C::SearchLines | C::StopSearch => self.frame_snap_command(command),
            C::FindShots | C::StopShotSearch => self.shot_search_command(command),
            _ => {}
        }
    }

    /// Starts what is worked out unasked of a document that has just been opened.
    pub(super) fn start_on_opening(&mut self) {
        self.find_burnt_in();
        self.find_shots_of_new();
        self.compare_pictures();
    }

    /// Takes over what waited for the end of what the user was doing, and what a click has decided.
    pub(super) fn take_over_what_waited(&mut self) {
        self.deliver_waiting_reports();
        self.decide_camera_by_click();
    }

    /// Starts what is worked out unasked of the document as it is now.
    pub(super) fn start_unasked(&mut self) {
        self.watch_camera();
        self.snap_points();
        self.check_lines();
    }
}
