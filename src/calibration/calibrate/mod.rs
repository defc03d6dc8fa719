//! From a document to a solved document: solves frames, estimates bases and the field's size,
//! tracks clips, suggests names and cameras, measures click noise, and checks what is wrong with
//! the document.
//!
//! Single frames are solved in `frames`, bases estimated in `base`, the sizes of fields in
//! `field_size`, clips tracked in `clip`;
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
mod field_size;
mod frames;
mod gold;
pub(crate) mod kept;
mod own_noise;
mod paint;

pub use autocalibrated::autocalibrated_camera::{
    AutocalibratedCamera, AutocalibratedFrame, AutocalibrationEvidence,
};
pub(crate) use base::base_estimation::rename_clicks;
pub use base::base_estimation::{
    BaseEstimationError, BaseProblem, EstimatedBase, LandmarkFit, Misnamed,
};
pub(crate) use base::follow_base::withdraw;
pub(crate) use base::known_frames::{KnownFrames, PaintEstimate};
pub use base::on_paint::{BasePaintAlignment, BasePaintEvidence, OnPaintErrors};
pub(crate) use base::paint_observations::{AT_ONCE, KnownCameras};
pub use base::paint_observations::{BaseOnPaintError, FRAMES_FOR_PAINT};
pub(crate) use base::refit::{OnBase, ground_moved_px, ptz_on_base};
pub use base_readiness::BaseReadiness;
pub use check::{Fault, Problem};
pub use clip::{
    ClipEvidence, ClipFrame, ClipFrames, ClipProgress, ClipSpan, ClipStop, MovedReference,
    TrackClipError, TrackClipOptions, TrackedClip, TrackedFrame, track_clip,
};
pub(crate) use clip::{EvidenceBytes, record_tracked_frame};
pub(crate) use disagreement::disagreement;
pub(crate) use field_size::on_lines::LENGTH_UNSEEN;
pub use field_size::on_lines::LengthOnLines;
pub(crate) use field_size::{OpenSize, UNSTEADY_SHARE, alone_sigma_m, as_paint_alone_gives};
pub use frames::calibration::{CalibrationError, calibrate, observations};
pub use frames::frame_lookup::FrameLookup;
pub(crate) use frames::own_covariance::{covariance_on_paint, own_covariance};
pub use frames::solve_all::{SolveOutcome, solve_document};
pub(crate) use paint::{may_replace, paint_evidence};
// For the crates above alone: no promise to other programs.
#[doc(hidden)]
pub use {
    autocalibrated::found_camera::FoundCamera,
    autocalibrated::record_found::record_found,
    base::after_merge::{SolvedAfterMerge, solve_after_merge},
    base::base_estimation::{camera_alone, describe_mirrored},
    base::base_on_paint::{BaseOnPaint, PictureOf, PulledFrames, estimate_on_paint},
    base::follow_base::follow_all_bases,
    base::own_cameras::{OwnCameraError, OwnCameras, give_own_cameras},
    base_change::{CameraChange, camera_change},
    base_readiness::{LANDMARKS_ALONE, WIDE_FRAMES, next_for_base, points_alone},
    bulk::{AssignedFrames, BulkChange, BulkError, BulkSolve, BulkSolved, JoinedChange, NewCamera},
    check::{
        PictureCheck, check_cameras, check_pictures, check_solutions, check_still_runs,
        check_values, impossible_camera,
    },
    clip::{clip_of_frame, clips, is_anchor, is_doubtful, record_tracked, take_doubtful_stretch},
    disagreement::{Disagreement, Disagreements, disagreements},
    field_size::describe_size,
    field_size::on_lines::take_length,
    frames::better_camera::{BetterCamera, better_camera},
    frames::calibration::solved_neighbours,
    frames::solve_all::{DecidedFrames, is_decided, solve_document_with},
    frames::solve_frames::{is_by_clicks, record_outcome},
    frames::which_camera::{AssignError, add_camera_like, assign_to_camera},
    gold::{can_choose_gold, choose_gold},
    own_noise::{ENOUGH_REPEATS, LandmarkNoise, OwnNoise, RepeatOffset},
    paint::{
        FindFrameError, LINE_CHECK, OnPaintError, SnapFrameError, camera_on_paint, check_frame,
        find_frame, record_found_by_paint, record_line_check, record_on_paint, record_snapped,
        snap_clicks, snap_frame,
    },
};
