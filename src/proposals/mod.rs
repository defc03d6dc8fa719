//! From a document's references to proposed cameras: what teaches, what is learnt, what is proposed, what still lacks.
//!
//! | what | where |
//! |---|---|
//! | [`read_picture`], [`FramePictures`], [`FeatureStore`] | pictures of a document's frames; their features, kept on disk |
//! | [`Teachers`], [`study`], [`learn`] | the references that teach, what they teach, the forest of it |
//! | [`propose`], [`Proposal`], [`Proposal::record`] | the forest asked for a frame; what it answers; a frame with the answer |
//! | [`adopt_bases`] | whether a forest and a document mean the same cameras |
//!
//! The window's trainer and the command line both live on this room; nothing here starts a thread.

mod bases;
mod features;
mod learning;
mod picture;
mod proposal;
mod proposing;
mod store;
mod teachers;

pub use bases::{BaseMismatch, adopt_bases};
pub use features::{FrameFeatures, FramePictures};
pub use learning::{LearnError, LearnOptions, Lesson, LessonError, Studied, learn, study};
pub use picture::{PictureError, read_picture};
pub use proposal::{Answer, Asked, NoProposal, Proposal, Timings};
pub use proposing::{is_open, propose};
pub use store::{FeatureStore, WorkFolder};
pub use teachers::Teachers;
