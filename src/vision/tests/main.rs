//! What is seen in pictures, from outside.
#![allow(
    clippy::unwrap_used,
    clippy::expect_used,
    clippy::panic,
    missing_docs,
    reason = "a test says what failed by failing"
)]

mod alignment;
mod bad_images;
mod contradictions;
mod features;
mod forest;
mod pose;
mod synthetic;
