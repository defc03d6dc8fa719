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
mod not_found;
mod pose;
mod reference_pairs;
mod standing;

pub use alignment::{Label, Misfit};
pub use answer::{RelocalizeOptions, Relocalized, relocalize};
pub use confidence::{Evidence, FromReference};
pub use consensus::PoseOptions;
pub use forest::{
    Forest, ForestFileError, PredictOptions, RayCandidate, Samples, Search, SplitRule, Stopped,
    TrainOptions, TrainProgress, train,
};
pub use model::{CameraForest, CertainAnswerCounts, ForestModel, SeenRange};
pub use not_found::NotFound;
pub use pose::Pose;
pub use reference_pairs::Reference;
// For the crates above alone: no promise to other programs.
#[doc(hidden)]
pub use {
    alignment::adjust_labels,
    answer::candidates_of,
    contradictions::{Contradiction, ContradictionOptions, contradictions, suspects},
    forest::train_without,
    matches::RayMatches,
    model::{CERTAIN, FOREST_VERSION},
    pose::pose_from_candidates,
    standing::pose_of_moving,
};
