//! The syntax of foreign files, below any format: JSON with a path for each value, tables of text,
//! `NumPy`'s arrays and archives. Readers here check shape, size and syntax, name the place of a
//! mistake, and never trust a length that a file states. They know nothing of cameras, clicks or
//! fields. What a value means belongs to the format that reads it.

pub mod node;
pub mod npy;
pub mod npz;
pub mod samples;
mod strict_json;
pub mod table;
pub mod values;
