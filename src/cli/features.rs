//! Whether features are kept beside the document.

use super::messages::Messages;
use std::path::Path;
use touchline_calibration::proposals::{FeatureStore, WorkFolder};

/// Whether features are kept.
#[derive(clap::Args, Debug)]
pub struct FeaturesArg {
    /// Find all features again and store none in the hidden folder beside the document.
    #[arg(long)]
    no_cache: bool,
}

impl FeaturesArg {
    /// Where the features of a document's pictures are kept; in memory where there is no document
    /// on disk.
    pub fn store(&self, document: Option<&Path>) -> FeatureStore {
        match document.filter(|_| !self.no_cache) {
            Some(file) => FeatureStore::on_disk(&WorkFolder::beside(file)),
            None => FeatureStore::in_memory(),
        }
    }
}

/// Reports if features could not be stored.
pub fn tell_refusal(store: &FeatureStore, messages: Messages) {
    if let Some(reason) = store.refusal() {
        messages.note(&format!(
            "features cannot be stored beside the document; the next run has to find them again: {reason}"
        ));
    }
}
