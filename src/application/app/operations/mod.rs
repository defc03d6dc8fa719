//! The operations, one file each: its input and its work, when it is available, what becomes of its result, and its words.
//!
//! To add one, write its file, give [`Operations`] a field for its state, and let a command or an action start it.

pub mod base_estimate;
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
pub use bulk_solve::BulkSolving;
pub use burnt_in::BurntInSearch;
pub use camera_search::CameraSearch;
pub use camera_watch::CameraWatch;
pub use clip_tracking::ClipTracking;
pub use comparison::{Compared, Comparison};
pub use frame_snap::FrameSnap;
pub use line_check::PaintSays;
pub use point_snap::PointSnap;
pub use shot_search::{FoundShots, ShotProgress, ShotSearch};

use super::Command;
#[cfg(test)]
use super::operation::probe::ProbeState;
use base_estimate::BaseEstimateState;
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
use transfer::TransferState;

/// The state of each operation on the open document. Another document begins with a new one: whatever runs is cancelled.
#[derive(Debug, Default)]
pub struct Operations {
    /// The estimation of a camera's base.
    pub base_estimate: BaseEstimateState,
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
            .or_else(|| self.clip_tracking.under_way())
            .or_else(|| self.frame_snap.under_way())
    }
}
