//! The open document beside another annotator's.

use super::App;
use crate::app::effect::Effect;
use crate::app::{Compared, Comparison};
use std::path::PathBuf;
use std::sync::Arc;

impl App {
    /// Compares the document as it is now with another one, on the quality page.
    pub(super) fn compare(&mut self, with: PathBuf) {
        if !self.session.quality.open {
            self.toggle_quality();
        }
        let Some(open) = &self.open else { return };
        self.session.comparison = Comparison::UnderWay;
        self.effects.push(Effect::Compare {
            document: (*open.document).clone(),
            folder: open.folder.clone(),
            revision: open.revision,
            with,
        });
    }

    pub(super) fn compared(&mut self, compared: Compared) {
        self.session.comparison = Comparison::Made(Arc::new(compared));
    }
}
