//! The experiments: the tables and figures of the paper, reproduced.
//!
//! | what | where |
//! |---|---|
//! | the experiments | [`Experiment`], [`SharedInputs`] |
//! | the matching of the baselines | [`nearest`] |
//! | the error of a camera at the corners of a picture | [`corners_apart_px`] |
//!
//! Each experiment is a file or folder of `studies`. Answers are scored in `scoring`, and `report`
//! makes statements from the scores.
//!
//! The paper: Chen, Zhu, Little, "A Two-point Method for PTZ Camera Calibration in Sports", WACV
//! 2018. All random numbers derive from one seed, so that the same seed gives the same bytes,
//! except for times.

mod calibme;
mod error;
mod given;
mod inputs;
#[cfg(test)]
#[allow(
    dead_code,
    clippy::unwrap_used,
    reason = "a writer for tests, which the program's own tests share"
)]
#[path = "../../../src/documents/exchange/authors_mat/writer.rs"]
mod mat_writer;
mod matching;
mod options;
mod progress;
mod ransac;
mod report;
mod run;
mod scoring;
mod sets;
mod setting;
mod studies;
mod surf;

pub use error::ExperimentError;
pub use inputs::SharedInputs;
pub use matching::{DescriptorRows, Nearest, nearest};
pub use options::{Experiment, ExperimentOptions, UnknownExperiment};
pub use progress::Progress;
pub use report::page::{claims_table, page, times_page};
pub use report::{Provenance, Report};
pub use sets::{OwnDocument, OwnDocuments};
pub use studies::annotator::corners_apart_px;
