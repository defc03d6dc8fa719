//! The pan-tilt forest: from a descriptor to the rays it may show (section 3.2 of the paper).
//!
//! A split tests one byte of the descriptor against a threshold, chosen among random candidates so that the unit rays of
//! the two sides deviate least from their means. A leaf keeps its mean descriptor, its mean ray and how far its rays
//! spread. A descriptor is looked up in all trees best-first, going back to the branches that it missed by least; the
//! distance to a leaf's descriptor gates what is no match.
//!
//! Rays are directions in `base`, exact, so that one scene point has one label whichever frame saw it.

mod file;
mod options;
mod predict;
mod split;
mod train;
mod tree;

pub use file::ForestFileError;
pub(super) use file::{Reader, write_forest};
pub use options::{PredictOptions, TrainOptions};
pub use predict::{RayCandidate, Search};
pub use train::{Samples, Stopped, TrainProgress, train};
pub use tree::Forest;
