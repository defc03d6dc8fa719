//! The mathematics from outside, against exact truth and published figures.
#![allow(
    clippy::unwrap_used,
    clippy::expect_used,
    clippy::panic,
    missing_docs,
    reason = "a test says what failed by failing"
)]

#[allow(dead_code, reason = "shared by several crates")]
#[path = "../../../tests/shared/seeded.rs"]
mod seeded;

mod bad_fields;
mod base_truth;
mod field_size;
mod fields;
mod identity;
mod lines_truth;
mod published_figures;
mod trust;
mod two_point_truth;
