//! What every reader is held to, and what its inputs are made of.

mod bounds;
mod folder;
mod json;
#[path = "../../hostile/json_values.rs"]
mod json_values;
#[path = "../../../src/exchange/authors_mat/writer.rs"]
pub mod mat_writer;
#[path = "../../hostile/samples.rs"]
pub mod samples;

pub use bounds::{bounded, bounded_beside, one_line};
pub use folder::Folder;
pub use json::mutated;
