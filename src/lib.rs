//! `touchline` calibrates a pan-tilt-zoom sports camera from two clicks.
//!
//! A broadcast camera has a fixed position and only pans, tilts and zooms. If its position and base rotation are known, two
//! clicked points determine a frame's pan, tilt and focal length (Chen, Zhu, Little: "A Two-point Method for PTZ Camera Calibration in Sports",
//! WACV 2018). This crate is the library behind the desktop app and the command line of the same name.
//!
//! # As a library
//!
//! | what | begin with |
//! |---|---|
//! | a camera: base, pan, tilt, focal length, projection | [`camera::PtzCamera`] |
//! | a field: landmarks and lines by name, for a venue's size | [`field::builtin`] |
//! | a frame from two clicks and more | [`solve::solve_frame`] |
//! | a camera's base, from many frames | [`solve::base::estimate_base`], [`calibrate::BaseProblem`] for documents |
//! | the same without a click, from pictures alone; with two | [`calibrate::camera_without_clicks`], [`calibrate::camera_from_few_clicks`] |
//! | a document: reading, solving, writing | [`store::read`], [`calibrate::solve_document`], [`store::write_document`] |
//! | a forest, and frames without clicks | [`proposals::learn`], [`relocalize::relocalize()`] |
//! | a clip: known frames carried to all others | [`calibrate::track_clip`] |
//! | two documents compared | [`evaluate::evaluate`], [`score`] |
//!
//! Results are plain values that serde writes; their keys carry the units. Options are structs with documented defaults, made
//! with `..Default::default()`; errors and other enums that grow are `#[non_exhaustive]`. `tests/examples` has complete
//! programs. Without default features neither wgpu nor clap nor OpenCV is compiled. The rooms of the program itself (`app`, `cli`,
//! `experiments`, `jobs`, `render`, `report`, `scene`, `ui`) are public for its binary and tests alone and may change at any time.
//!
//! # Rooms and floors
//!
//! The top-level modules (rooms) are layered in floors: a room uses only rooms on lower floors, never one on its own floor
//! (`tests/suite/architecture.rs` reads this table and checks it). Frames, signs and units of all numbers: [`conventions`].
//!
//! | floor | rooms |
//! |---|---|
//! | 8 | `ui` (egui only here), `cli` (one file per command) |
//! | 7 | `jobs` (the only detached threads), `render` (wgpu, no egui) |
//! | 6 | `app` (the whole application without a window), `experiments` (tables and figures of what was measured) |
//! | 5 | [`calibrate`] (document to solved document), [`proposals`] (a forest trained on references proposes cameras for the other frames, in a layer beside what people did), [`evaluate`] (two documents against each other), [`exchange`] (foreign formats), [`store`] (where a document lives), `scene` (what is drawn, as plain data), `report` (tables, figures, Markdown) |
//! | 4 | [`document`] (typed schema, edits, history), [`relocalize`] (the pan-tilt forest, pose from its rays), [`paint`] (painted lines in pixels: the line check, snapping), [`track`] (frames of one camera tied to each other under rotation and zoom), [`synthetic`] (drawn matches with exact truth) |
//! | 3 | [`solve`] (observations to cameras), [`score`] (how far a camera is from the true one), [`features`] (SIFT of a picture) |
//! | 2 | [`markings`] (the field's lines as a camera sees them) |
//! | 1 | [`camera`], [`field`], [`media`] (frames of folders and videos) |
//! | 0 | [`geometry`], [`files`] (opening files that may come from anybody) |
//!
//! Within floor 5, `evaluate` uses `calibrate`.

#[doc = include_str!("conventions.md")]
pub mod conventions {}

#[doc(hidden)]
pub mod app;
pub mod calibrate;
pub mod camera;
#[doc(hidden)]
#[cfg(feature = "cli")]
pub mod cli;
pub mod document;
pub mod evaluate;
pub mod exchange;
#[doc(hidden)]
pub mod experiments;
pub mod features;
pub mod field;
pub mod files;
pub mod geometry;
#[doc(hidden)]
pub mod jobs;
pub mod markings;
pub mod media;
pub mod paint;
pub mod proposals;
pub mod relocalize;
#[doc(hidden)]
#[cfg(feature = "render")]
pub mod render;
#[doc(hidden)]
pub mod report;
#[doc(hidden)]
pub mod scene;
pub mod score;
pub mod solve;
pub mod store;
pub mod synthetic;
pub mod track;
#[doc(hidden)]
#[cfg(feature = "gui")]
pub mod ui;

/// The README's example is compiled with the tests.
#[cfg(doctest)]
#[doc = include_str!("../README.md")]
struct Readme;
