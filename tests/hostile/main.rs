//! Hostile files for every importer: none of them costs a panic or all memory, and what is imported is a document that opens.
//!
//! A binary of its own, because it counts what is allocated.

#![allow(
    clippy::unwrap_used,
    clippy::expect_used,
    clippy::panic,
    missing_docs,
    reason = "a test says what failed by failing"
)]

#[path = "../../src/exchange/authors_mat/writer.rs"]
mod mat_writer;

mod memory;
mod mutations;
mod samples;
