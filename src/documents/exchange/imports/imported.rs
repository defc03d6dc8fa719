//! The result of an import.

use crate::document::Document;
use crate::exchange::format::Format;
use std::path::PathBuf;

/// A document made from foreign files.
#[derive(Clone, Debug, PartialEq)]
pub struct Imported {
    /// The document; its relative paths start from `folder`.
    pub document: Document,
    /// The folder that its relative paths start from.
    pub folder: PathBuf,
    /// The format of the files.
    pub format: Format,
    /// Notes for the user.
    pub notes: Vec<String>,
    /// What could not be read of the files, counted and named; empty if everything was.
    pub failures: Vec<String>,
}
