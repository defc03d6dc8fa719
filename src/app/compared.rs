//! Another annotator's document, compared with the open one.

use crate::evaluate::Agreement;
use std::path::PathBuf;
use std::sync::Arc;

/// How far a comparison has come.
#[derive(Clone, Debug, Default, PartialEq)]
pub enum Comparison {
    /// Nobody asked for one.
    #[default]
    None,
    /// It is under way.
    UnderWay,
    /// It was made.
    Made(Arc<Compared>),
}

/// What a comparison gave: derived, never stored.
#[derive(Clone, Debug, PartialEq)]
pub struct Compared {
    /// The other document's file, as it was chosen.
    pub file: PathBuf,
    /// The revision of the open document that was compared.
    pub revision: u64,
    /// How the two agree; the open document is the first.
    pub agreement: Agreement,
}
