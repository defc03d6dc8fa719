//! The paper's tables and figures, measured again, and evaluations written as reports.
//!
//! | what | where |
//! |---|---|
//! | the experiments | [`Experiment`], [`SharedInputs`] |
//! | the matching of the baselines | [`nearest`] |
//! | two annotators' agreement | [`agreement_tables`], [`agreement_json`] |
//! | an evaluation for people | [`evaluation_report`], [`evaluation_tables`] |
//!
//! The paper: Chen, Zhu, Little, "A Two-point Method for PTZ Camera Calibration in Sports", WACV 2018. Everything here draws
//! its chance from one seed: the same seed gives the same bytes, times apart.

mod agreement;
mod annotator;
mod answers;
mod baselines;
mod descriptors;
mod error;
mod errors;
mod evaluation;
mod forests;
mod fov;
mod given;
mod homographies;
mod inputs;
mod lost_iou;
mod matching;
mod motion;
mod options;
mod overlays;
mod page;
mod paper;
mod pose;
mod progress;
mod ransac;
mod run;
mod sequences;
mod sets;
mod setting;
mod synthetic;
mod threshold;
mod trees;

pub use agreement::{agreement_by_frame, agreement_by_landmark, agreement_json, agreement_tables};
pub use error::ExperimentError;
pub use evaluation::{evaluation_report, evaluation_tables, frame_scores};
pub use inputs::SharedInputs;
pub use matching::{DescriptorRows, Nearest, nearest};
pub use options::{Experiment, ExperimentOptions, UnknownExperiment};
pub use page::page;
pub use progress::Progress;
pub use sets::{OwnDocument, OwnDocuments};
