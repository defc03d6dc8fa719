//! What every reader is held to, and what its inputs are made of.

mod bounds;
mod folder;
mod json;
#[path = "../../../src/documents/tests/hostile/json_values.rs"]
mod json_values;
#[path = "../../../src/documents/exchange/authors_mat/writer.rs"]
pub mod mat_writer;
#[path = "../../../src/documents/tests/hostile/samples.rs"]
pub mod samples;

pub use bounds::{one_line, run_in_bounds, run_in_bounds_beside};
pub use folder::Folder;
pub use json::mutate;
