//! From pictures and documents to cameras, from outside.
#![allow(
    clippy::unwrap_used,
    clippy::expect_used,
    clippy::panic,
    missing_docs,
    reason = "a test says what failed by failing"
)]

mod bad_documents;
mod burnt_in;
mod checked_documents;
mod coarse_to_fine;
mod document;
mod venues;
