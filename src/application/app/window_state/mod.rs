//! The state of the window, which is neither saved nor undone. [`session::Session`] holds what is
//! shown and what the user is doing; the other files are its parts, such as dialogs, modes and
//! filters. They are plain values with few methods. The document and its history are in `project`,
//! and values that are derived from both are in `panel_values`.

pub mod choices;
pub mod corner_looks;
pub mod field_draft;
pub mod naming;
pub mod place;
pub mod reclick;
pub mod session;
pub mod video;
