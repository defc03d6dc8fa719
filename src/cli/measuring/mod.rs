//! The commands that measure rather than change a document: `evaluate` compares two of them,
//! `synth` draws a match with exact truth, and `experiment` measures the paper's tables again.
//! Where the program is built without experiments, a stand-in says how to get them.

pub mod evaluate;
#[cfg(feature = "experiments")]
pub mod experiment;
#[cfg(not(feature = "experiments"))]
#[path = "no_experiments.rs"]
pub mod experiment;
pub mod synth;
