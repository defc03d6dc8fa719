//! The commands that measure rather than change a document: `evaluate` compares two of them,
//! `synth` draws a match with exact truth, and `experiment` hands over to the laboratory.

mod broadcast;
mod drawn_folder;
pub mod evaluate;
pub mod experiment;
pub mod synth;
