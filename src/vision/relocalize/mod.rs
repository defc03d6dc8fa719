//! Relocalization: cameras of frames without clicks.
//!
//! A pan-tilt forest learns from references which ray a descriptor shows ([`train`]). The features
//! of a new picture get candidate rays from it, and [`pose_from_candidates`] finds the camera that
//! most of them agree on, or the reason why there is none ([`NotFound`]). [`relocalize()`] does
//! both; [`ForestModel`] is a forest on disk. [`adjust_labels`] adjusts the labels of references to each
//! other; [`contradictions()`] finds those that do not agree at all.

mod alignment;
mod answer;
mod confidence;
mod consensus;
mod contradictions;
mod forest;
mod labels;
mod matches;
mod model;
mod nearest_references;
mod not_found;
mod pose;
mod pose_options;
mod reference_pairs;
mod shown;
mod standing;

pub use alignment::{Label, Misfit, adjust_labels};
pub use answer::{RelocalizeOptions, Relocalized, candidates_of, relocalize};
pub use confidence::{Evidence, FromReference};
pub use contradictions::{Contradiction, ContradictionOptions, contradictions, suspects};
pub use forest::{
    Forest, ForestFileError, PredictOptions, RayCandidate, Samples, Search, SplitRule, Stopped,
    TrainOptions, TrainProgress, train, train_without,
};

pub use matches::RayMatches;
pub use model::{CameraForest, FOREST_VERSION, ForestModel, SeenRange};
pub use not_found::NotFound;
pub use pose::{Pose, pose_from_candidates};
pub use pose_options::PoseOptions;
pub use reference_pairs::Reference;
pub use shown::{CERTAIN, CertainAnswerCounts};
pub use standing::pose_of_moving;
