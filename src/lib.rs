//! `touchline` calibrates a pan-tilt-zoom sports camera from two clicks.
//!
//! A broadcast camera has a fixed position and only pans, tilts and zooms. If its position and base
//! rotation are known, two clicked points determine a frame's pan, tilt and focal length (Chen,
//! Zhu, Little: "A Two-point Method for PTZ Camera Calibration in Sports", WACV 2018). This crate
//! is the library behind the desktop app and the command line of the same name.
//!
//! # As a library
//!
//! | what | begin with |
//! |---|---|
//! | a camera: base, pan, tilt, focal length, projection | [`camera::PtzCamera`] |
//! | a field: landmarks and lines by name, for a venue's size | [`field::builtin`] |
//! | a frame from two clicks and more | [`solve::solve_frame`] |
//! | a camera's base, from many frames | [`solve::base::estimate_base`], [`calibrate::BaseProblem`] for documents |
//! | the same without a click, from pictures alone; with the few that there are | [`autocalibrate::camera_without_clicks`], [`autocalibrate::find_camera`] |
//! | a document: reading, solving, writing | [`store::read`], [`calibrate::solve_document`], [`store::write_document`] |
//! | a forest, and frames without clicks | [`proposals::learn`], [`relocalize::relocalize()`] |
//! | a clip: known cameras propagated to all frames | [`calibrate::track_clip`] |
//! | a whole match, from its pictures to its labels | [`pipelines::label_match`] |
//! | two documents compared | [`evaluate::evaluate`], [`score`] |
//!
//! Results are plain values that serde writes; their keys carry the units. Options are structs with
//! documented defaults, made with `..Default::default()`; errors and other enums that grow are
//! `#[non_exhaustive]`. `tests/examples` has complete programs. Without default features neither
//! wgpu nor clap nor OpenCV is compiled. The rooms of the program itself (`app`, `cli`, `jobs`,
//! `render`, `report`, `scene`, `season`, `ui`) are public for its binary and tests alone and may
//! change at any time. `tests/laboratory` measures the paper's tables and figures again, as a program
//! of its own on this library.
//!
//! # Crates, rooms and floors
//!
//! The library is several crates in one workspace, each a folder below `src` with the same version;
//! this one hands all of them out under the names of their rooms, so that `touchline` is the only
//! one to depend on. Cargo sees to it that none uses what stands above it:
//!
//! | crate | rooms |
//! |---|---|
//! | `touchline` | `ui`, `cli` |
//! | `touchline-python` | the library as a Python module |
//! | `touchline-application` | `app` (the whole application without a window), `jobs` (the only detached threads), `render` (wgpu, no egui), `scene` (what is drawn, as plain data) |
//! | `touchline-season` | `season` (a season of matches in shards that any engine runs: plan, shard, collect) |
//! | `touchline-calibration` | [`calibrate`] (document to solved document), [`autocalibrate`] (the base of a rotating camera from its frames alone), [`proposals`] (a forest trained on references proposes cameras for the other frames, in a layer beside what people did), [`evaluate`] (two documents against each other), `evidence` (how likely the cameras of pictures are by the paint that these show, in nats), [`pipelines`] (whole jobs that window and command line share) |
//! | `touchline-documents` | [`document`] (typed schema, edits, history), [`store`] (where a document lives), [`exchange`] (foreign formats), `report` (tables, figures, Markdown) |
//! | `touchline-vision` | [`media`] (frames of folders and videos), [`features`] (SIFT of a picture), [`paint`] (painted lines in pixels: the line check, snapping), [`relocalize`] (the pan-tilt forest, pose from its rays), [`track`] (frames of one camera matched to each other under rotation and zoom), [`synthetic`] (drawn matches with exact truth) |
//! | `touchline-core` | [`camera`], [`field`], [`markings`] (the field's lines as a camera sees them), [`solve`] (observations to cameras), [`score`] (how far a camera is from the true one), [`geometry`], [`files`] (opening files that may come from anybody), [`progress`] (what long functions report to, and what cancels them) |
//!
//! What the program ships beside its code (fields, schema, guide, shaders) are the crates
//! `touchline-assets` and `touchline-shaders` in `assets` and `shaders`. Within a crate the rooms
//! stand on floors, which its `lib.rs` draws: a room uses only rooms on lower floors, never one on
//! its own floor (`tests/suite/architecture.rs` reads those tables and checks them). The rooms of
//! this crate:
//!
//! | floor | rooms |
//! |---|---|
//! | 8 | `ui` (egui only here), `cli` (one file per command) |
//!
//! Frames, signs and units of all numbers: [`conventions`].

#[doc(hidden)]
#[cfg(feature = "cli")]
pub mod cli;
#[doc(hidden)]
#[cfg(feature = "gui")]
pub mod ui;

#[cfg(feature = "render")]
#[doc(hidden)]
pub use touchline_application::render;
#[doc(hidden)]
pub use touchline_application::{app, jobs, scene};
#[doc(inline)]
pub use touchline_calibration::{autocalibrate, calibrate, evaluate, pipelines, proposals};
#[doc(inline)]
pub use touchline_core::{
    camera, conventions, field, files, geometry, markings, progress, score, solve,
};
#[doc(hidden)]
pub use touchline_documents::report;
#[doc(inline)]
pub use touchline_documents::{document, exchange, store};
#[cfg(feature = "cli")]
#[doc(hidden)]
pub use touchline_season as season;
#[doc(inline)]
pub use touchline_vision::{features, media, paint, relocalize, synthetic, track};

/// The guide's example is compiled with the tests.
#[cfg(doctest)]
#[doc = include_str!("../assets/guide/library.md")]
struct Guide;
