//! From a document, or from pictures alone, to calibrated cameras.
//!
//! | floor | rooms |
//! |---|---|
//! | 6 | [`pipelines`] (whole jobs that window and command line share: the clips of a document tracked) |
//! | 5 | [`calibrate`] (document to solved document), [`autocalibrate`] (the base of a rotating camera from its frames alone), [`proposals`] (a forest trained on references proposes cameras for the other frames, in a layer beside what people did), [`evaluate`] (two documents against each other) |
//! | 4 | `evidence` (how likely the cameras of pictures are by the paint that these show, in nats) |
//!
//! Within floor 5, `autocalibrate`, `evaluate` and `proposals` use `calibrate`.

pub mod autocalibrate;
pub mod calibrate;
pub mod evaluate;
mod evidence;
pub mod pipelines;
pub mod proposals;
