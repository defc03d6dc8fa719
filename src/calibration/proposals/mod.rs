//! From a document's references to proposed cameras: the training set, the forest, its answers, and
//! advice on where to label next.
//!
//! | what | where |
//! |---|---|
//! | [`read_picture`], [`PictureStream`], [`FramePictures`], [`FeatureStore`] | pictures of a document's frames, single or in sequence; their features, stored on disk |
//! | [`TrainingFrames`], [`study`], [`learn`] | the references used for training, their samples, the forest trained on them |
//! | [`find_burnt_in`], [`FoundMask`] | graphics burnt into a document's pictures, labelled or not |
//! | [`propose`], [`Proposal`], [`Proposal::record`] | a query of the forest for a frame; its answer; writing the answer into the frame |
//! | [`Project`] | the user's edits, the suggestions of the program in batches, and the view of both |
//! | [`LineEvidence`] | the check of an answer against the painted lines |
//! | `QueryOrder` | the order in which the forest is queried for frames |
//! | `KeyWindow`, [`TrackedProposal`] | key frames of a video; cameras tracked from them to the frames between |
//! | `TrainingSet` | identity of the references that a forest was trained on |
//! | [`measure`], [`Quality`] | cross-validation of the forest: references left out and queried |
//! | [`ExpectedWrong`] | the expected number of wrong answers |
//! | [`Coverage`], [`label_advice`] | the directions that references see; the frame to label next |
//! | `find_suspects` | references whose labels contradict others |
//! | [`UsedFeatures`] | the use of a picture's features by the forest |
//! | [`adopt_bases`] | check that a forest and a document have the same camera bases |
//! | [`camera_of_size`] | the camera of a picture that says nothing but its size |
//!
//! The trainer of the window and the command line both use this module. Nothing here starts a
//! thread of its own.

mod advice;
mod bases;
mod batches;
mod burnt_in;
mod camera_of_size;
mod coverage;
mod expected_wrong;
mod features;
mod find_burnt_in;
mod key_frames;
mod label;
mod label_needs;
mod learning;
mod line_evidence;
mod needing_frames;
mod order;
mod picture;
mod project;
mod proposal;
mod proposing;
mod quality;
mod request;
mod spread;
mod store;
mod suggestions;
mod suspects;
mod tracked;
mod training_frames;
mod training_sample;
mod training_set;
mod used_features;

pub use advice::{LabelAdvice, LabelNext, label_advice};
pub use bases::{BaseMismatch, adopt_bases};
pub use batches::FrameWithFeatures;
pub use burnt_in::FoundMask;
pub use camera_of_size::{CameraOfSizeError, camera_of_size};
pub use coverage::{Coverage, CoverageCell};
pub use expected_wrong::ExpectedWrong;
pub use features::{FrameFeatures, FramePictures, Resolution};
pub use find_burnt_in::find_burnt_in;
pub use key_frames::KeyWindow;
pub use label_needs::{LabelNeeds, is_uncertain};
pub use learning::{LearnError, LearnOptions, ReferenceSamples, TrainingSampleError, learn, study};
pub use line_evidence::LineEvidence;
pub use order::QueryOrder;
pub use picture::{FramePicture, PictureError, PictureStream, read_picture};
pub use project::{Discarded, Project, RefusedForests, SuggestionUpdate};
pub use proposal::{Answer, NoProposal, Proposal, Timings};
pub use proposing::propose;
pub use quality::{FoundAgain, LeftOut, LeftOutBy, Quality, WRONG_PX, measure, overlay_error_px};
pub use request::FrameRequest;
pub use store::{FeatureStore, WorkFolder};
pub use suggestions::{BatchId, Finder};
pub use suspects::{Suspect, find_suspects};
pub use tracked::{TrackedProposal, suggest_tracked_clip};
pub use training_frames::TrainingFrames;
pub use training_sample::{FeatureRays, TrainingSample};
pub use training_set::TrainingSet;
pub use used_features::{FeatureUse, UsedFeatures};
