//! What an import made.

use crate::document::Document;
use std::path::PathBuf;

/// A document that was made of foreign files.
#[derive(Clone, Debug)]
pub struct Imported {
    /// The document; its relative paths start from `folder`.
    pub document: Document,
    /// Where its relative paths start.
    pub folder: PathBuf,
    /// What a user should know.
    pub notes: Vec<String>,
}
