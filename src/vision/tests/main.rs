//! What is seen in pictures, from outside.
#![allow(
    clippy::unwrap_used,
    clippy::expect_used,
    clippy::panic,
    missing_docs,
    reason = "a test says what failed by failing"
)]

#[allow(dead_code, reason = "shared by several crates")]
#[path = "../../../tests/shared/described_scene.rs"]
mod described_scene;
#[allow(dead_code, reason = "shared by several crates")]
#[path = "../../../tests/shared/files.rs"]
mod files;
#[allow(dead_code, reason = "shared by several crates")]
#[path = "../../../tests/shared/seeded.rs"]
mod seeded;

mod alignment;
mod bad_images;
mod contradictions;
mod features;
mod forest;
mod pose;
mod synthetic;
