//! From a document to a solved document: solves frames, estimates bases and the field's size,
//! tracks clips, suggests names and cameras, measures click noise, and checks what is wrong with
//! the document.
//!
//! Single frames are solved in `frames`, bases estimated in `base`, clips tracked in `clip`;
//! `check` finds what is wrong, and `autocalibrated` records a camera that was found without a
//! click.

mod autocalibrated;
mod base;
mod base_change;
mod base_readiness;
mod bulk;
mod check;
mod clip;
mod disagreement;
mod frames;
mod gold;
mod own_noise;
mod paint;

pub use autocalibrated::autocalibrated_camera::{
    AutocalibratedCamera, AutocalibratedFrame, AutocalibrationEvidence,
};
pub use autocalibrated::found_camera::FoundCamera;
pub use autocalibrated::record_found::record_found;
pub use base::after_merge::{SolvedAfterMerge, solve_after_merge};
pub(crate) use base::base_estimation::rename_clicks;
pub use base::base_estimation::{
    BaseEstimationError, BaseProblem, EstimatedBase, LandmarkFit, Misnamed, camera_alone,
    describe_mirrored,
};
pub use base::base_on_paint::{BaseOnPaint, PictureOf, PulledFrames, estimate_on_paint};
pub use base::follow_base::follow_all_bases;
pub(crate) use base::follow_base::withdraw;
pub(crate) use base::known_frames::{KnownFrames, PaintEstimate};
pub use base::on_paint::{BasePaintAlignment, BasePaintEvidence, OnPaintErrors};
pub use base::own_cameras::{OwnCameraError, OwnCameras, give_own_cameras};
pub(crate) use base::paint_observations::{AT_ONCE, KnownCameras};
pub use base::paint_observations::{BaseOnPaintError, FRAMES_FOR_PAINT};
pub(crate) use base::refit::{OnBase, ground_moved_px, ptz_on_base};
pub(crate) use base::size_fit::OpenSize;
pub use base::size_fit::describe_size;
pub(crate) use base::size_on_paint::{
    OpenField, UNSTEADY_SHARE, alone_sigma_m, as_paint_alone_gives,
};
pub use base_change::{CameraChange, camera_change};
pub use base_readiness::{
    BaseReadiness, LANDMARKS_ALONE, WIDE_FRAMES, next_for_base, points_alone,
};
pub use bulk::{
    AssignedFrames, BulkChange, BulkError, BulkSolve, BulkSolved, JoinedChange, NewCamera,
};
pub use check::{
    Fault, PictureCheck, Problem, check_cameras, check_pictures, check_solutions, check_still_runs,
    check_values, impossible_camera,
};
pub(crate) use clip::measured_length::LENGTH_UNSEEN;
pub use clip::measured_length::{LengthOnLines, take_length};
pub(crate) use clip::record_tracked_frame;
pub use clip::{
    ClipEvidence, ClipFrame, ClipFrames, ClipProgress, ClipSpan, ClipStop, MovedReference,
    TrackClipError, TrackClipOptions, TrackedClip, TrackedFrame, clip_of_frame, clips, is_anchor,
    is_doubtful, record_tracked, take_doubtful_stretch, track_clip,
};
pub(crate) use disagreement::disagreement;
pub use disagreement::{Disagreement, Disagreements, disagreements};
pub use frames::better_camera::{BetterCamera, better_camera};
pub use frames::calibration::{CalibrationError, calibrate, observations, solved_neighbours};
pub use frames::frame_lookup::FrameLookup;
pub(crate) use frames::own_covariance::{covariance_on_paint, own_covariance};
pub use frames::solve_all::{
    DecidedFrames, SolveOutcome, is_decided, solve_document, solve_document_with,
};
pub use frames::solve_frames::{is_by_clicks, record_outcome};
pub use frames::which_camera::{AssignError, add_camera_like, assign_to_camera};
pub use gold::{can_choose_gold, choose_gold};
pub use own_noise::{ENOUGH_REPEATS, LandmarkNoise, OwnNoise, RepeatOffset};
pub use paint::{
    FindFrameError, LINE_CHECK, OnPaintError, SnapFrameError, camera_on_paint, check_frame,
    find_frame, record_found_by_paint, record_line_check, record_on_paint, record_snapped,
    snap_clicks, snap_frame,
};
pub(crate) use paint::{may_replace, paint_evidence};
