//! From pictures and documents to cameras, from outside.
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
#[path = "../../../tests/shared/seeded.rs"]
mod seeded;

mod bad_documents;
mod burnt_in;
mod checked_documents;
mod coarse_to_fine;
mod document;
