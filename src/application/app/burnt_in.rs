//! The search for graphics that are burned into the pictures of the open document.

use std::ops::ControlFlow;
use std::path::PathBuf;
use touchline_calibration::proposals::{FeatureStore, FoundMask, FramePictures, find_burnt_in};
use touchline_documents::document::Document;
use touchline_vision::features::FeatureOptions;
use touchline_vision::media::ReadFrames;

/// What a search needs.
#[derive(Clone, Debug, PartialEq)]
pub struct BurntInSearch {
    /// The document.
    pub document: Document,
    /// Its file.
    pub file: PathBuf,
    /// Where its relative paths start.
    pub folder: PathBuf,
}

impl BurntInSearch {
    /// Looks into a few pictures of each camera; none where `watch`, which is asked after each picture, ended it.
    #[must_use]
    pub fn look(
        &self,
        reader: &mut dyn ReadFrames,
        store: &FeatureStore,
        watch: &(dyn Fn() -> ControlFlow<()> + Sync),
    ) -> Option<Vec<FoundMask>> {
        let pictures =
            FramePictures { document: &self.document, folder: &self.folder, options: FeatureOptions::default(), store };
        find_burnt_in(&pictures, reader, watch)
    }
}
