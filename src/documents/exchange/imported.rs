//! The result of an import.

use crate::document::Document;
use std::path::PathBuf;

/// A document made from foreign files.
#[derive(Clone, Debug)]
pub struct Imported {
    /// The document; its relative paths start from `folder`.
    pub document: Document,
    /// The folder that its relative paths start from.
    pub folder: PathBuf,
    /// Notes for the user.
    pub notes: Vec<String>,
}
