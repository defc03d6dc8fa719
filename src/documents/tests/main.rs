//! Documents and where they live, from outside.
#![allow(
    clippy::unwrap_used,
    clippy::expect_used,
    clippy::panic,
    missing_docs,
    reason = "a test says what failed by failing"
)]

mod oblong_pixels;
mod undo_after_restart;
