//! Whether features are kept beside the document.

use super::messages::Messages;
use crate::proposals::{FeatureStore, WorkFolder};
use std::path::Path;

/// Whether features are kept.
#[derive(clap::Args, Debug)]
pub struct FeaturesArg {
    /// Find every feature anew and keep none in the hidden folder beside the document.
    #[arg(long)]
    no_cache: bool,
}

impl FeaturesArg {
    /// Where the features of a document's pictures are kept; in memory where there is no document on disk.
    pub fn store(&self, document: Option<&Path>) -> FeatureStore {
        match document.filter(|_| !self.no_cache) {
            Some(file) => FeatureStore::on_disk(&WorkFolder::beside(file)),
            None => FeatureStore::in_memory(),
        }
    }
}

/// Says when the disk took no features.
pub fn tell_refusal(store: &FeatureStore, messages: Messages) {
    if let Some(reason) = store.refusal() {
        messages.note(&format!("features are not kept beside the document, the next run finds them again: {reason}"));
    }
}
