//! Tables, figures and Markdown reports: the presentation of measurements.
//!
//! | what | where |
//! |---|---|
//! | one table as text, Markdown, CSV and JSON | [`Table`] |
//! | one diagram as SVG and PNG | [`figure`] |
//! | text and figures together, and the files they become | [`Report`] |

mod document;
pub mod figure;
mod table;

pub use document::{Report, ReportFile};
pub use table::{Cell, Column, Table, significant};
