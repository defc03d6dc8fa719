//! Training of the forest: which references it is trained on, their samples, and the graphics burnt
//! into pictures that must not be learnt. Cross-validation measures its quality, and references
//! that contradict the others are found. Asking a trained forest is in `answers`.

pub mod burnt_in;
pub mod find_burnt_in;
mod label;
pub mod learning;
pub mod quality;
mod spread;
pub mod suspects;
pub mod training_frames;
pub mod training_sample;
pub mod training_set;
