//! From a document to a solved document: frames, bases, the field's size, names, which camera, click noise, and what is wrong with it.

mod base_change;
mod base_estimation;
mod calibration;
mod check;
mod disagreement;
mod from_proposal;
mod gold;
mod habits;
mod own_noise;
mod paint;
mod refit;
mod size_fit;
mod solve_all;
mod which_camera;

pub use base_change::{CameraChange, camera_change};
pub use base_estimation::{BaseEstimationError, BaseProblem, EstimatedBase, LandmarkFit, describe_mirrored};
pub(crate) use base_estimation::{LANDMARKS_ALONE, camera_alone};
pub(crate) use calibration::solved_neighbours;
pub use calibration::{CalibrationError, calibrate, observations};
pub use check::{Fault, Problem, check_cameras, check_pictures, check_values};
pub use disagreement::{Disagreement, Disagreements, disagreements};
pub(crate) use gold::can_choose_gold;
pub use gold::choose_gold;
pub use habits::habits;
pub use own_noise::{ENOUGH_REPEATS, LandmarkNoise, OwnNoise, RepeatOffset};
pub use paint::{SnapFrameError, check_frame, record_line_check, record_refusal, record_snapped, snap_frame};
pub(crate) use size_fit::describe_size;
pub use solve_all::{SolveOutcome, solve_document};
pub(crate) use which_camera::warn_of_better_camera;
pub use which_camera::{BetterCamera, GiveError, better_camera};
