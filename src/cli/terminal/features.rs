//! The command-line option for storing features beside the document.

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
    /// The store for the features of a document's pictures. In memory if there is no document on
    /// disk, or with `--no-cache`.
    pub fn store(&self, document: Option<&Path>) -> FeatureStore {
        match document.filter(|_| !self.no_cache) {
            Some(file) => FeatureStore::on_disk(&WorkFolder::beside(file)),
            None => FeatureStore::in_memory(),
        }
    }
}

/// Reports why features could not be stored, if they could not.
pub fn report_refusal(store: &FeatureStore, messages: Messages) {
    if let Some(reason) = store.refusal() {
        messages.note(&format!(
            "features cannot be stored beside the document; the next run has to find them again: {reason}"
        ));
    }
}
