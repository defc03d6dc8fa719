//! From numbers to statements: means with their intervals, contrasts between methods, the numbers
//! of the paper, the page that lists what the paper says beside what we measure, and the report of
//! an experiment with its files. No experiment runs here.

mod claim;
mod contact_sheet;
pub mod contrast;
mod document;
pub mod lost_iou;
pub mod page;
pub mod paper;
mod provenance;
pub mod statistics;

pub use claim::{Claim, ClaimMeasurement, Source, Stated, Verdict};
pub use contact_sheet::{SheetFrame, contact_sheet};
pub use document::Report;
pub use provenance::Provenance;
