//! The document: schema, reading and writing, history (undo), journal, atomic store, and what can be wrong with it.
//!
//! [`Document`] and what it holds mirror the JSON of a project or dataset key by key, in the document's own units
//! (degrees, metres, px), so that a number that is read is written back to the last digit; the doors to the mathematics
//! are [`Camera::base`], [`Camera::pointed`] and [`FramePtz::ptz`]. Unknown keys are kept at every level. A project is a
//! folder with `project.json`; a dataset is one file of the same schema, without unnamed clicks.
//!
//! The annotations that the method's authors published are read as a document, too: [`read_authors_folder`].

mod agreement;
mod atomic;
pub(crate) mod authors_mat;
mod base_change;
mod base_estimation;
mod calibration;
mod camera;
mod check;
mod click;
mod create;
mod disagreement;
mod document;
mod doors;
mod edit;
mod error;
mod evaluation;
mod field_size;
mod fields;
mod frame;
mod habits;
mod history;
mod journal;
mod location;
mod lock;
mod matching;
mod own_noise;
mod proposed;
mod read;
mod refit;
mod repeats;
mod shared;
mod shots;
mod size_fit;
mod solution;
mod solve_all;
mod store;
mod teaching;
mod unanswered;
mod which_camera;
mod write;

pub use agreement::{
    Agreement, CameraAgreement, ClickPair, FrameAgreement, LandmarkAgreement, LoneFrame, NameDispute, agreement,
};
pub use atomic::write_atomically;
pub use authors_mat::{
    AuthorsError, AuthorsFolder, AuthorsFrame, AuthorsSequence, MatError, read_authors_folder, read_authors_sequence,
};
pub use base_change::{CameraChange, camera_change};
pub use base_estimation::{
    BaseEstimationError, BaseProblem, EstimatedBase, LANDMARKS_ALONE, LandmarkFit, camera_alone, mirrored_words,
};
pub use calibration::{CalibrationError, calibrate, observations, solved_neighbours};
pub use camera::{Camera, CameraId, CameraSigma, Distortion, K1Curve};
pub use check::{Fault, Problem, check_cameras, check_pictures, check_values};
pub use click::{Click, Target};
pub use create::{NewDocument, document_from_frames};
pub use disagreement::{Disagreement, Disagreements, disagreements};
pub use document::{DOCUMENT_VERSION, Document, FORMAT_NAME, FieldSpec, generator};
pub use edit::{Change, Edit, EditMismatch};
pub use error::StoreError;
pub use evaluation::{
    Evaluation, EvaluationError, FrameResult, FrameScores, Group, GroupKind, Measure, Unscored, evaluate,
};
pub use field_size::FieldSize;
pub use fields::Fields;
pub use frame::{Clip, Frame, FrameStatus, RejectReason, VideoFrame};
pub use habits::habits;
pub use history::{History, Step};
pub use location::{Location, PROJECT_FILE, PROJECT_SUFFIX, path_between};
pub use lock::ReadOnly;
pub use own_noise::{ENOUGH_REPEATS, Hand, LandmarkNoise, OwnNoise, RepeatOffset};
pub use proposed::Proposed;
pub use read::{ReadError, document_from_bytes};
pub use repeats::{Repeat, can_choose_gold, choose_gold};
pub use shared::Shared;
pub use shots::shots;
pub use size_fit::size_words;
pub use solution::{BetterName, FramePtz, Solution, SolutionSource, SolutionWarning};
pub use solve_all::{SolveOutcome, solve_document};
pub use store::{Access, Opened, Recovery, Store, open, read, write_document};
pub use which_camera::{BetterCamera, GiveError, better_camera, warn_of_better_camera};
pub use write::{WriteError, document_to_string};

/// Keys that this program does not know, kept in their order and written back.
pub type Extra = serde_json::Map<String, serde_json::Value>;
