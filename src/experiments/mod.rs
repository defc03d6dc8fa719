//! Numbers for people: tables and figures of what was measured.
//!
//! [`Table`] is one table as text, Markdown, CSV and JSON.

mod table;

pub use table::{Cell, Column, Table};
