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
//! Pictures and their features are in `pictures`, the forest is trained in `training` and queried in
//! `answers`; `label_advice` says where to label next.
//!
//! The trainer of the window and the command line both use this module. Nothing here starts a
//! thread of its own.

mod answers;
mod bases;
mod camera_of_size;
mod key_frames;
mod label_advice;
mod pictures;
mod training;

pub use answers::project::{Discarded, Project, RefusedForests, SuggestionUpdate};
pub use answers::proposal::{Answer, NoProposal, Proposal, Timings};
pub use answers::proposing::propose;
pub use answers::request::FrameRequest;
pub use answers::suggestions::{BatchId, Finder};
pub use camera_of_size::camera_of_size;
pub use label_advice::advice::label_advice;
pub use pictures::batches::FrameWithFeatures;
pub use pictures::features::{FrameFeatures, FramePictures, Resolution};
pub use pictures::picture::PictureError;
pub use pictures::store::{FeatureStore, WORK_FOLDER, WorkFolder};
pub use training::burnt_in::FoundMask;
pub use training::learning::{
    LearnError, LearnOptions, ReferenceSamples, TrainingSampleError, learn, study,
};
pub use training::quality::{FoundAgain, LeftOut, LeftOutBy, Quality, measure};
pub use training::training_frames::TrainingFrames;
pub use training::training_sample::{FeatureRays, TrainingSample};
// For the crates above alone: no promise to other programs.
#[doc(hidden)]
pub use {
    answers::expected_wrong::ExpectedWrong, answers::line_evidence::LineEvidence,
    answers::order::QueryOrder, answers::tracked::TrackedProposal,
    answers::tracked::suggest_tracked_clip, bases::BaseMismatch, bases::adopt_bases,
    camera_of_size::CameraOfSizeError, key_frames::KeyWindow, label_advice::advice::LabelAdvice,
    label_advice::advice::LabelNext, label_advice::coverage::Coverage,
    label_advice::coverage::CoverageCell, label_advice::label_needs::LabelNeeds,
    label_advice::label_needs::is_uncertain, pictures::picture::FramePicture,
    pictures::picture::PictureStream, pictures::picture::read_picture,
    pictures::used_features::FeatureUse, pictures::used_features::UsedFeatures,
    training::find_burnt_in::find_burnt_in, training::quality::WRONG_PX,
    training::quality::overlay_error_px, training::suspects::Suspect,
    training::suspects::find_suspects, training::training_set::TrainingSet,
};
