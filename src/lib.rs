//! `touchline` calibrates a pan-tilt-zoom sports camera from two clicks.
//!
//! A broadcast camera stands still and turns. If its position and base orientation are known, two clicked points fix a
//! frame's pan, tilt and focal length (Chen, Zhu, Little: "A Two-point Method for PTZ Camera Calibration in Sports",
//! WACV 2018). This crate is the library behind the desktop app and the command line of the same name.
//!
//! # The house
//!
//! Rooms stand on floors; a room uses only rooms below it, and rooms on one floor do not see each other
//! (`tests/architecture.rs` checks it).
//!
//! | floor | rooms |
//! |---|---|
//! | 8 | `ui` (egui only here), [`cli`] (one file per command) |
//! | 7 | [`jobs`] (the only detached threads), [`render`] (wgpu, no egui) |
//! | 6 | [`app`] (the whole application without a window), [`experiments`] (tables and figures of what was measured) |
//! | 5 | [`calibrate`] (document to solved document), [`proposals`] (references teach, the other frames get a camera proposed), [`evaluate`] (two documents against each other), [`exchange`] (foreign formats), [`store`] (where a document lives), [`scene`] (what is drawn, as plain data), [`report`] (tables, figures, Markdown) |
//! | 4 | [`document`] (typed schema, edits, history), [`relocalize`] (the pan-tilt forest, pose from its rays), [`synthetic`] (drawn matches with exact truth) |
//! | 3 | [`solve`] (observations to cameras), [`score`] (how far a camera is from the true one), [`features`] (SIFT of a picture) |
//! | 2 | [`markings`] (the field's lines as a camera sees them) |
//! | 1 | [`camera`], [`field`], [`media`] (frames of folders and videos) |
//! | 0 | [`geometry`] |
//!
//! Within floor 5, `calibrate` is used by `proposals` and `evaluate`.

pub mod app;
pub mod calibrate;
pub mod camera;
#[cfg(feature = "cli")]
pub mod cli;
pub mod document;
pub mod evaluate;
pub mod exchange;
pub mod experiments;
pub mod features;
pub mod field;
pub mod geometry;
pub mod jobs;
pub mod markings;
pub mod media;
pub mod proposals;
pub mod relocalize;
#[cfg(feature = "render")]
pub mod render;
pub mod report;
pub mod scene;
pub mod score;
pub mod solve;
pub mod store;
pub mod synthetic;
#[cfg(feature = "gui")]
pub mod ui;

/// The README's example is compiled with the tests.
#[cfg(doctest)]
#[doc = include_str!("../README.md")]
struct Readme;
