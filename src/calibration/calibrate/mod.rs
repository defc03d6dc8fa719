//! From a document to a solved document: solves frames, estimates bases and the field's size,
//! tracks clips, suggests names and cameras, measures click noise, and checks what is wrong with
//! the document.

mod after_merge;
mod autocalibrated_camera;
mod base_change;
mod base_estimation;
mod base_on_paint;
mod base_readiness;
mod better_camera;
mod bulk;
mod calibration;
mod check;
mod clip;
mod disagreement;
mod field_size;
#[cfg(test)]
mod fixtures;
mod follow_base;
mod found_camera;
mod frame_lookup;
mod from_proposal;
mod gold;
mod known_frames;
mod length_on_lines;
mod on_paint;
mod own_cameras;
mod own_covariance;
mod own_noise;
mod paint;
mod record_found;
mod refit;
mod size_fit;
mod solve_all;
mod solve_frames;
mod unseen_length;
mod which_camera;

pub use after_merge::{SolvedAfterMerge, solve_after_merge};
pub use autocalibrated_camera::{
    AutocalibratedCamera, AutocalibratedFrame, AutocalibrationEvidence,
};
pub use base_change::{CameraChange, camera_change};
pub use base_estimation::{
    BaseEstimationError, BaseProblem, EstimatedBase, LandmarkFit, camera_alone, describe_mirrored,
};
pub use base_on_paint::{BaseOnPaint, PictureOf, PulledFrames, estimate_on_paint};
pub use base_readiness::{
    BaseReadiness, LANDMARKS_ALONE, WIDE_FRAMES, next_for_base, points_alone,
};
pub use better_camera::{BetterCamera, better_camera};
pub use bulk::{
    AssignedFrames, BulkChange, BulkError, BulkSolve, BulkSolved, JoinedChange, NewCamera,
};
pub use calibration::{CalibrationError, calibrate, observations, solved_neighbours};
pub use check::{
    Fault, PictureCheck, Problem, check_cameras, check_pictures, check_solutions, check_still_runs,
    check_values, impossible_camera,
};
pub(crate) use clip::record_tracked_frame;
pub use clip::{
    ClipEvidence, ClipFrame, ClipFrames, ClipProgress, ClipSpan, ClipStop, MovedReference,
    TrackClipError, TrackClipOptions, TrackedClip, TrackedFrame, clip_of_frame, clips, is_anchor,
    is_doubtful, record_tracked, take_doubtful_stretch, track_clip,
};
pub use disagreement::{Disagreement, Disagreements, disagreements};
pub(crate) use field_size::set_size;
pub use follow_base::follow_all_bases;
pub(crate) use follow_base::withdraw;
pub use found_camera::FoundCamera;
pub use frame_lookup::FrameLookup;
pub use gold::{can_choose_gold, choose_gold};
pub(crate) use known_frames::{
    ALONE_SIGMA_M, AT_ONCE, KnownCameras, KnownFrames, OpenField, PaintEstimate,
    as_paint_alone_gives,
};
pub use known_frames::{BaseOnPaintError, FRAMES_FOR_PAINT};
pub(crate) use length_on_lines::LENGTH_UNSEEN;
pub use length_on_lines::{LengthOnLines, length_on_lines, take_length};
pub use on_paint::{BasePaintAlignment, BasePaintEvidence, OnPaintErrors};
pub use own_cameras::{OwnCameraError, OwnCameras, give_own_cameras};
pub(crate) use own_covariance::{covariance_on_paint, own_covariance};
pub use own_noise::{ENOUGH_REPEATS, LandmarkNoise, OwnNoise, RepeatOffset};
pub use paint::{
    FindFrameError, LINE_CHECK, OnPaintError, SnapFrameError, camera_on_paint, check_frame,
    find_frame, record_found_by_paint, record_line_check, record_on_paint, record_snapped,
    snap_clicks, snap_frame,
};
pub(crate) use paint::{may_replace, paint_evidence};
pub use record_found::record_found;
pub(crate) use refit::{ground_moved_px, ptz_on_base};
pub(crate) use size_fit::OpenSize;
pub use size_fit::describe_size;
pub use solve_all::{SolveOutcome, solve_document};
pub use solve_frames::{is_by_clicks, record_outcome};
pub use which_camera::{AssignError, add_camera_like, assign_to_camera};
