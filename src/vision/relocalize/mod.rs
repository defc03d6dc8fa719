//! Relocalization: cameras of frames without clicks.
//!
//! A pan-tilt forest learns from references which ray a descriptor shows ([`train`]). The features
//! of a new picture get candidate rays from it, and [`pose_from_candidates`] finds the camera that
//! most of them agree on, or the reason why there is none ([`NotFound`]). [`relocalize()`] does
//! both; [`ForestModel`] is a forest on disk. [`adjust_labels`] adjusts the labels of references to
//! each other; [`contradictions()`] finds those that do not agree at all.

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
mod pose;
mod reference_pairs;
mod standing;

pub use alignment::{Label, Misfit};
pub use answer::relocalize;
pub use answer::{RelocalizeOptions, Relocalized};
pub use confidence::{Evidence, FromReference};
pub use forest::{
    Forest, ForestFileError, PredictOptions, RayCandidate, Samples, Search, SplitRule, Stopped,
    TrainOptions, TrainProgress, train,
};
pub use model::{
    CERTAIN, CameraForest, CertainAnswerCounts, FOREST_VERSION, ForestModel, SeenRange,
};
pub use pose::{NotFound, Pose};

pub use consensus::PoseOptions;
pub use reference_pairs::Reference;
// For the crates above alone: no promise to other programs.
#[doc(hidden)]
pub use alignment::adjust_labels;
pub use answer::candidates_of;
pub use contradictions::contradictions;
pub use contradictions::suspects;
pub use contradictions::{Contradiction, ContradictionOptions};
pub use forest::train_without;
pub use matches::RayMatches;
pub use pose::pose_from_candidates;
pub use standing::pose_of_moving;
