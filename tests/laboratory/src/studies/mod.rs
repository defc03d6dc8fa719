//! The experiments themselves, one a file or folder: each measures one table, figure or claim of
//! the paper. A study takes its inputs from `inputs.rs` and its data from `sets`, and returns a
//! report. Studies share nothing with each other but what stands beside this room.

pub mod annotator;
pub mod assumptions;
pub mod baselines;
pub mod descriptors;
pub mod errors;
pub mod fov;
pub mod homographies;
pub mod motion;
pub mod pose;
pub mod sequences;
pub mod synthetic;
pub mod threshold;
pub mod trees;
