//! Cameras of frames that nobody clicked.
//!
//! References teach a pan-tilt forest ([`train`]) which ray a descriptor shows; a new picture's features get candidate
//! rays from it, and [`pose_from_candidates`] finds the camera that most of them agree on, or says by name why there is
//! none ([`NotFound`]). [`relocalize()`] is both together; [`ForestModel`] is a forest on disk.

mod answer;
mod consensus;
mod forest;
mod matches;
mod model;
mod not_found;
mod pose;

pub use answer::{RelocalizeOptions, Relocalized, candidates_of, relocalize};
pub use forest::{
    Forest, ForestFileError, PredictOptions, RayCandidate, Samples, Search, Stopped, TrainOptions, TrainProgress, train,
};
pub use matches::RayMatches;
pub use model::{CameraForest, FOREST_VERSION, ForestModel, SeenRange};
pub use not_found::NotFound;
pub use pose::{Pose, PoseOptions, pose_from_candidates};
