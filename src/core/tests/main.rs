//! The mathematics from outside, against exact truth and published figures.
#![allow(
    clippy::unwrap_used,
    clippy::expect_used,
    clippy::panic,
    missing_docs,
    reason = "a test says what failed by failing"
)]

mod bad_fields;
mod base_truth;
mod few_frames;
mod field_size;
mod fields;
mod given_cameras;
mod identity;
mod lines_truth;
mod picture_shapes;
mod published_figures;
mod trust;
mod two_point_truth;
