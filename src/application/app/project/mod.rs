//! The open document: its history of undo, its suggestions, and the values that are kept up to date
//! with every edit. Opening a document prepares these values on the thread that reads it. A
//! selection of frames refers to this document, and a review queue names several. What is derived
//! for the shown frame alone is in `panel_values`.

pub mod derived;
pub mod open_project;
pub mod opened;
pub mod review_queue;
pub mod selection;
pub mod versioned;
