//! Damaged and hostile files for every importer: what is said of each, and that none of them costs
//! a panic or all memory. And which options each heeds.
//!
//! A binary of its own, because it counts what is allocated.

#![allow(
    clippy::unwrap_used,
    clippy::expect_used,
    clippy::panic,
    missing_docs,
    reason = "a test says what failed by failing"
)]

#[path = "../../exchange/authors_mat/writer.rs"]
mod mat_writer;

mod damage;
mod damage_cameras;
mod damage_clicks;
mod json_values;
mod memory;
mod messages;
mod mutations;
mod options;
mod samples;
