//! The document: typed schema, versions, edits, history (undo), reading and writing its text. No disk, no solver.
//!
//! [`Document`] and what it holds mirror the JSON of a project or dataset key by key, in the document's own units
//! (degrees, metres, px), so that a number that is read is written back to the last digit. The way to the mathematics
//! leads through [`Camera::base`], [`Camera::pointed`] and [`FramePtz::ptz`]. Unknown keys are kept at every level. A project is a
//! folder with `project.json`; a dataset is one file of the same schema, without unnamed clicks.

pub(crate) mod adapters;
mod at;
mod camera;
mod click;
mod click_noise;
mod create;
#[allow(clippy::module_inception, reason = "the room is named after what it is about")]
mod document;
mod edit;
mod field_size;
mod fields;
mod frame;
mod frame_changes;
mod frame_id;
mod frames;
mod history;
mod mask;
mod merge;
mod old_edit;
mod paths;
mod proposed;
mod read;
mod repeats;
mod shared;
mod shots;
mod solution;
mod step_edit;
mod unanswered;
mod uses;
mod write;

pub use at::DocumentAt;
pub use camera::{Camera, CameraId, CameraSigma, Distortion, K1Curve};
pub use click::{Click, Target};
pub(crate) use click_noise::CLICKING_SHARE;
pub use click_noise::{ClickNoise, StoredClickNoise};
pub(crate) use create::document_from_frames;
pub use document::{DOCUMENT_VERSION, Document, FORMAT_NAME, FieldSpec, generator};
pub use edit::{Change, Edit, EditKind, EditMismatch};
pub use field_size::FieldSize;
pub use fields::Fields;
pub use frame::{Clip, Edited, Frame, FrameStatus, RejectReason, VideoFrame};
pub use frame_changes::FrameChanges;
pub use frame_id::FrameId;
pub use frames::Frames;
pub use history::{History, Step, Undoable};
pub use mask::{MaskSource, RangedMask};
pub(crate) use merge::graft;
pub use merge::{Merged, merge};
pub use old_edit::OldChange;
pub(crate) use paths::path_between;
pub(crate) use paths::resolved;
pub use proposed::Proposed;
pub use read::{ReadError, document_from_bytes};
pub use repeats::Repeat;
pub use shared::Shared;
pub use shots::{Shot, ShotEnd, ShotKind, shots};
pub(crate) use solution::ENOUGH_EQUATIONS;
pub use solution::{BetterName, FramePtz, PaintEvidence, Solution, SolutionSource, SolutionWarning, TimingsMs};
pub use step_edit::{StepEdit, StepMisfit};
pub use write::{WriteError, document_to_string};

/// Keys that this program does not know, kept in their order and written back.
pub type Extra = serde_json::Map<String, serde_json::Value>;
