//! From a document's references to proposed cameras: what teaches, what is learnt, what is proposed, what still lacks.
//!
//! | what | where |
//! |---|---|
//! | [`read_picture`], [`FramePictures`], [`FeatureStore`] | pictures of a document's frames; their features, kept on disk |
//! | [`Teachers`], [`study`], [`learn`] | the references that teach, what they teach, the forest of it |
//! | [`FoundMask`] | graphics found burnt into the references' pictures |
//! | [`propose`], [`Proposal`], [`Proposal::record`] | the forest asked for a frame; what it answers; a frame with the answer |
//! | [`LineWitness`] | what the painted lines say about an answer |
//! | `AskingOrder` | which frames the forest is asked for first |
//! | `Curriculum` | what a forest was taught |
//! | [`measure`], [`Quality`] | references left out and asked for |
//! | [`Coverage`], [`label_advice`] | where references look; which frame to label next |
//! | `find_suspects` | references whose labels contradict others |
//! | [`UsedFeatures`] | what the forest made of a picture's features |
//! | [`adopt_bases`] | whether a forest and a document mean the same cameras |
//!
//! The window's trainer and the command line both live on this room; nothing here starts a thread.

mod advice;
mod bases;
mod burnt_in;
mod coverage;
mod curriculum;
mod features;
mod learning;
mod lesson;
mod line_witness;
mod order;
mod picture;
mod proposal;
mod proposing;
mod quality;
mod store;
mod suspects;
mod teachers;
mod used_features;

pub(crate) use advice::LabelAdvice;
pub use advice::{LabelNext, SURE, label_advice};
pub use bases::{BaseMismatch, adopt_bases};
pub use burnt_in::FoundMask;
pub use coverage::{Cell, Coverage};
pub(crate) use curriculum::Curriculum;
pub use features::{FrameFeatures, FramePictures};
pub use learning::{LearnError, LearnOptions, LessonError, Studied, learn, study};
pub use lesson::Lesson;
pub use line_witness::LineWitness;
pub(crate) use order::AskingOrder;
pub use picture::{PictureError, read_picture};
pub use proposal::{Answer, Asked, NoProposal, Proposal, Timings, is_open};
pub use proposing::propose;
pub use quality::WRONG_PX;
pub use quality::{FoundAgain, LeftOut, LeftOutBy, Quality, measure, overlay_error_px};
pub use store::{FeatureStore, WorkFolder};
pub(crate) use suspects::{Suspect, find_suspects};
pub use teachers::Teachers;
pub use used_features::{FeatureUse, UsedFeatures};
