//! The experiments: the tables and figures of the paper, reproduced.
//!
//! | what | where |
//! |---|---|
//! | the experiments | [`Experiment`], [`SharedInputs`] |
//! | the matching of the baselines | [`nearest`] |
//! | the error of a camera at the corners of a picture | [`corners_apart_px`] |
//!
//! The paper: Chen, Zhu, Little, "A Two-point Method for PTZ Camera Calibration in Sports", WACV
//! 2018. All random numbers derive from one seed, so that the same seed gives the same bytes,
//! except for times.

mod annotator;
mod answers;
mod assumptions;
mod baselines;
mod calibme;
mod contrast;
mod coverage;
mod descriptors;
mod error;
mod errors;
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
mod sheet;
mod statistics;
mod surf;
mod synthetic;
mod threshold;
mod trees;

pub use annotator::corners_apart_px;
pub use error::ExperimentError;
pub use inputs::SharedInputs;
pub use matching::{DescriptorRows, Nearest, nearest};
pub use options::{Experiment, ExperimentOptions, UnknownExperiment};
pub use page::{claims_table, page, times_page};
pub use progress::Progress;
pub use sets::{OwnDocument, OwnDocuments};
