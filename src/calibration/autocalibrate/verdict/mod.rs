//! The verdict: which candidate becomes the answer, if any, and which clicks would help: stage 9.

pub mod checks;
pub mod deciding_landmark;
pub mod decision;
pub mod faint_lines;
pub mod wanted_clicks;
