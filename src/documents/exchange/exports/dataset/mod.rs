//! A dataset: a folder with the labelled frames of a document, their pictures and everything needed
//! to use them.
//!
//! | file | what it holds |
//! |---|---|
//! | `README.md` | the dataset card: counts, field, conventions, quality with its coverage, provenance, licence |
//! | `dataset.json` | the document of the chosen frames, raw clicks included, with the pictures of this folder |
//! | `schema.json` | the JSON Schema of `dataset.json` |
//! | `frames.csv` | a row a frame: split, where its label comes from, match, camera, clip, quality, SHA-256 |
//! | `images/` | the pictures under their own names, in a folder a split where there are splits |
//! | `splits/*.txt` | the pictures of each split |
//! | `undistorted/` | on request: pictures without lens distortion, and their own `dataset.json` |
//! | `fields.json` | landmarks and lines of each camera's field in world coordinates |
//! | `fields/` | field templates of the user's own |
//! | `touchline_dataset.py` | reads it with numpy |
//! | `manifest.sha256` | every other file: `sha256sum -c manifest.sha256` |
//!
//! [`plan_dataset`] plans what will be written; [`write_dataset`] writes it into a temporary folder
//! beside the target and renames it at the end. The same document, pictures and options give the
//! same bytes.

mod card;
mod field_lines;
mod frames_table;
mod label_origin;
mod matches;
mod names;
mod old_dataset;
mod options;
mod outside;
mod pictures;
mod plan;
mod split;
mod templates;
mod undistorted;
mod write;

pub use label_origin::LabelOrigin;
pub use old_dataset::folder_for_new;
pub use options::{DatasetOptions, PictureFormat, Pictures, SplitBy, Splitting};
pub(in crate::exchange) use outside::OwnPlaces;
pub use pictures::encode_picture;
pub use plan::{DatasetDone, DatasetPlan, PlannedFrame, plan_dataset};
pub use split::Split;
pub(super) use templates::with_templates;
pub use write::write_dataset;
