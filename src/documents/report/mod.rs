//! Tables, figures, contact sheets and Markdown reports: the presentation of measurements.
//!
//! | what | where |
//! |---|---|
//! | one table as text, Markdown, CSV and JSON | [`Table`] |
//! | one diagram as SVG and PNG | [`figure`] |
//! | frames with what was found in them, to look at | `contact_sheet` |
//! | text, tables and figures together, and the files they become | [`Report`] |

mod claim;
mod contact_sheet;
mod document;
pub mod figure;
mod provenance;
mod table;

pub use claim::{Claim, ClaimMeasurement, Source, Stated, Verdict};
pub use contact_sheet::{SheetFrame, contact_sheet};
pub use document::{Block, Report, ReportFile};
pub use provenance::Provenance;
pub use table::{Cell, Column, Table};
