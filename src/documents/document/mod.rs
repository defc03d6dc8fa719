//! The document: typed schema, versions, edits, history (undo), reading and writing its text. No
//! disk, no solver.
//!
//! [`Document`] and what it holds mirror the JSON of a project or dataset key by key, in the
//! document's own units (degrees, metres, px), so that a number that is read is written back to the
//! last digit. The way to the mathematics leads through [`Camera::base`], [`Camera::ptz_camera`]
//! and [`FramePtz::ptz`]. Unknown keys are kept at every level. A project is a folder with
//! `project.json`; a dataset is one file of the same schema, without unnamed clicks.
//!
//! # Files
//!
//! | room or files | subject |
//! |---|---|
//! | `model` | the types of the schema, and the containers that undo states share |
//! | `text` | from text to these types and back |
//! | `edits` | edits as the journal has them, undo |
//! | `versions` | several versions of a document joined |
//! | `frame_state` | what a frame's records mean, and the program's suggestion for it |
//! | `create`, `new_images`, `dataset`, `paths`, `fields`, `at`, `shots`, `video_shots` | whole documents |
//!
//! Methods of one type lie in several of these files, each by its subject: files beside each other
//! may not use each other in a circle (`tests/suite/architecture.rs`).
//!
//! # Schema
//!
//! Every key that this program knows is typed, checked when it is read, and is listed here; the
//! linked items give details. A key with `?` may be absent. Whatever else a file holds is kept as
//! it is.
//!
//! The document ([`Document`]):
//!
//! | key | what it is |
//! |---|---|
//! | `format`, `version` | [`FORMAT_NAME`] and at most [`DOCUMENT_VERSION`]; a newer version is refused and left as it is |
//! | `generator` | the program that wrote the file |
//! | `conventions?` | world, image, rotation and angles in words, for people |
//! | `field` | `template`, `params?` by name, and `size?`: whether its size is `assumed`, `confirmed` or `fitted` ([`FieldSpec`], [`FieldSize`]) |
//! | `cameras`, `frames` | below |
//! | `click_noise?` | the annotator's own click noise: `use`, `hand_factor`, `hand_factor_by_landmark?`, `sigma_px`, `sigma_interval_95_px`, `repeats` ([`ClickNoise`]) |
//! | `shots?` | `from`, `to` (frame ids or video frame numbers), `camera?`, `kind`: `cut`, `fade`, `by_hand` ([`Shot`]) |
//!
//! A camera ([`Camera`]):
//!
//! | key | what it is |
//! |---|---|
//! | `id` | the name that frames refer to |
//! | `image_size_px`, `principal_point_px` | of its pictures, px |
//! | `pixel_aspect?` | fy / fx, 0.25 to 4; absent: 1, square pixels. Focal lengths are fx |
//! | `position_m?`, `base_from_world?` | its base; absent: not known yet |
//! | `distortion?` | `k1`: `at_focal_px`, `value`, `per_1000_px` ([`K1Curve`]); `k2_per_k1_squared?`: k₂ = this · k₁² ([`Distortion`]) |
//! | `sigma?` | prior 1-σ of the base: `position_m`, `rotation_deg`, `k1?`, `k1_per_1000_px?`, `crown_m?`, `crown_width_m?`, `principal_point_px?`, `correlation?`, `length?`, `width?` ([`CameraSigma`]) |
//! | `masks_px?` | boxes `[x, y, width, height]` that give no features in any frame, px |
//! | `masks?` | boxes for some frames, or found by the program: `box_px`, `from?`, `to?` (video frames), `source`: `found`, `by_hand` ([`RangedMask`]) |
//! | `click_noise_px?` | 1-σ of a click in its pictures, px |
//! | `sensor_width_mm?` | the width of its sensor, mm |
//! | `stage?` | the stage in whose axes its tracks are written: `origin_m`, `heading_deg?` ([`Stage`]) |
//! | `field?` | its own field, where that is not the document's |
//!
//! A frame ([`Frame`]):
//!
//! | key | what it is |
//! |---|---|
//! | `id` | unique in the document, 1 to 128 bytes; a file without ids gets them from its pictures ([`FrameId`]) |
//! | `revision?` | counts its edits, by people and by commands, undo included; absent: 0 |
//! | `image?`, `video?` | where its picture is: a path; `path`, `frame_index`, `pts_s?` ([`VideoFrame`]). Paths are relative to the document's folder or absolute |
//! | `sha256?` | of the image file, hexadecimal |
//! | `camera`, `image_size_px` | its camera's `id`, and the size of its picture, px |
//! | `status`, `reason?` | `new`, `draft`, `suggested`, `reference`, `rejected` and why ([`FrameStatus`], [`RejectReason`]) |
//! | `clip?` | its shot, a number or a word ([`Clip`]) |
//! | `comment?` | a note by a person |
//! | `use_for_base?` | `false` leaves it out when a base is estimated |
//! | `use_for_training?` | whether the forest is trained with it; read also as `teaches`; absent: accepted suggestions are not used |
//! | `gold?`, `repeats?` | clicked again, blind: `landmark`, `image_px`, `round`, `at?` ([`Repeat`]) |
//! | `edited?` | `by?`, `at?`, `seconds?`, `version?` ([`Edited`]) |
//! | `clicks` | `landmark` or `line`, `image_px`, `check?`, `snapped_sigma_px?`: moved to the paint, known to this 1-σ ([`Click`]) |
//! | `clicks[].origin?` | of a point that another program's model gave ([`ClickOrigin`]) |
//! | `refused_points?` | points of models that a person took away; no labels |
//! | `masks_px?` | boxes that give no features in this frame, px |
//! | `labels_name?` | its name in another program's files, where that is not its picture's |
//! | `lens?` | what its lens is known to be before it is solved: `focal_px`, `principal_point_px`, `k1?`, `k2?`, `pixel_aspect?` ([`FrameLens`]) |
//! | `ptz?` | `pan_deg`, `tilt_deg`, `focal_px`, `k1?`, `k2?`, `imported?`; absent: unsolved ([`FramePtz`]) |
//! | `ptz.imported?` | the camera that came, beside that on the base ([`ImportedCamera`]) |
//! | `solution?` | below |
//!
//! A solution ([`Solution`]):
//!
//! | key | what it is |
//! |---|---|
//! | `covariance?`, `own_covariance?` | 3 × 3 in the order `pan_deg`, `tilt_deg`, `focal_px`; the second with the camera's base taken as exact |
//! | `rms_px?`, `worst_corner_sigma_px?` | residuals, and 1-σ of the overlay at the worst corner, px |
//! | `source?` | [`SolutionSource`] |
//! | `ground?` | what the camera is good for on the ground, written by exports: `grade`, `sigma_m?`, `visible_area_m` ([`Ground`]) |
//! | `confidence?` | 0 to 1: that the overlay is right within 10 px at 1920 px width |
//! | `samples?` | how many samples of painted lines took part |
//! | `line_check?` | the evidence of the paint: `score`, `predicted`, `found`, `bare`, … ([`PaintEvidence`]) |
//! | `proposed?` | what the program proposed before a person corrected it ([`Proposed`]) |
//! | `imported?` | the camera that another program gave the frame, where another one replaced it ([`ImportedCamera`]) |
//! | `timings_ms?` | `features`, `predict`, `pose` ([`TimingsMs`]) |
//! | `verdict?` | on the clicks when they were solved |
//! | `disputed?` | indices of clicks that disagree with the others |
//! | `warnings` | `code`, `message`, `clicks?` and `renames?`: names that fit better ([`SolutionWarning`]) |
//!
//! `edited` is for programs and people who keep account of their work: it is read, checked and
//! written back, and the program fills nothing in. It does not know the annotator's name, and the
//! same input gives the same bytes.

mod at;
mod create;
mod dataset;
mod edits;
mod fields;
mod frame_state;
mod model;
mod new_images;
mod path_hint;
mod paths;
mod shots;
mod text;
mod versions;
mod video_shots;

pub use at::DocumentAt;
pub use edits::edit::{Change, Edit, EditKind};
pub use edits::edit_mismatch::EditMismatch;
pub use edits::frame_changes::FrameChanges;
pub use edits::history::{History, Step};
pub use edits::step_edit::{StepEdit, StepMisfit};
pub use edits::suggestion_change::SuggestionChange;
pub use frame_state::gold::RepeatedClicks;
pub use frame_state::moment::Moment;
pub use frame_state::overlay_sigma::OverlaySigma;
pub use frame_state::suggestion::Suggestion;
pub use model::camera::{Camera, CameraSigma, Distortion, K1Curve, Stage};
pub use model::camera_id::CameraId;
pub use model::click::{Click, Target};
pub use model::click_noise::{ClickNoise, StoredClickNoise};
pub use model::click_origin::ClickOrigin;
pub use model::document::{DOCUMENT_VERSION, Document, FORMAT_NAME};
pub use model::extra::Extra;
pub use model::field_spec::{FieldSize, FieldSpec};
pub use model::frame::{Clip, Edited, Frame, FrameStatus, RejectReason, VideoFrame};
pub use model::frame_id::FrameId;
pub use model::frame_lens::FrameLens;
pub use model::frames::Frames;
pub use model::ground::{Ground, GroundGrade};
pub use model::imported_camera::ImportedCamera;
pub use model::mask::{MaskSource, RangedMask};
pub use model::repeat::Repeat;
pub use model::shared::Shared;
pub use model::shot::{Shot, ShotContent, ShotEnd, ShotKind};
pub use model::solution::{
    BetterName, FramePtz, PaintEvidence, Proposed, Solution, SolutionSource, SolutionWarning,
    TimingsMs,
};
pub use new_images::FolderChanges;
pub use text::read::ReadError;
#[cfg(feature = "schema")]
pub use text::schema::schema_of_types;
pub use text::write::WriteError;
pub(crate) use versions::common_base::common_base;
pub(crate) use versions::graft::graft;
pub use versions::merge::{Merged, merge};
pub(crate) use versions::merge::{join_result, merge_newer};
pub use versions::restored::OtherPictures;
// For the crates above alone: no promise to other programs.
#[doc(hidden)]
pub use {
    create::document_from_frames,
    edits::history::Undoable,
    fields::Fields,
    frame_state::frame_solution::ENOUGH_EQUATIONS,
    model::document::generator,
    model::field_spec::CROWN,
    model::frame::MAX_CLICKS,
    path_hint::hint_for_missing,
    paths::{path_between, resolve_path},
    shots::shots,
    text::read::document_from_bytes,
    text::schema::SCHEMA,
    text::write::document_to_string,
    versions::package::{restore_package, split_into_packages},
    versions::restored::Restored,
    video_shots::{FoundCuts, ShotsError, VideoShots, frames_in_transitions, shots_of_frames},
};
