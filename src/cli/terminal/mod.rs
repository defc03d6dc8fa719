//! What commands share: reading and writing documents, results on standard output or in files,
//! messages on standard error, Ctrl-C, and options that several commands take. No command is
//! written here, and nothing here calculates.

pub mod attached_labels;
pub mod by_name;
pub mod document;
pub mod features;
pub mod interrupt;
pub mod messages;
pub mod output;
