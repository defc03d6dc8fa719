//! The application without its window, driven by actions.
#![allow(
    clippy::unwrap_used,
    clippy::expect_used,
    clippy::panic,
    missing_docs,
    reason = "a test says what failed by failing"
)]

#[allow(dead_code, reason = "shared by several crates")]
#[path = "../../../tests/shared/bench.rs"]
mod bench;
#[allow(dead_code, reason = "shared by several crates")]
#[path = "../../../tests/shared/headless.rs"]
mod headless;

mod app;
mod around_the_field;
mod beside_paint;
mod bulk_in_app;
mod burnt_in_in_app;
mod clicking;
mod find_camera_in_app;
mod journal;
mod kept_edits;
mod nothing_unasked;
mod operations_in_app;
mod outside;
mod places_in_app;
mod queue_in_app;
mod reviewing;
mod session;
mod shots_in_app;
mod transfer_in_app;
mod undo_in_app;
#[cfg(feature = "opencv")]
mod undo_of_commands;
mod which_camera;
