//! Pictures of frames as the window needs them: the shown one, and thumbnails.

use crate::media::Picture;
use std::collections::BTreeMap;

/// The shown frame's picture.
#[derive(Clone, Debug)]
pub enum PictureState {
    /// There is no frame.
    None,
    /// It is being decoded; the picture before it may be shown dimmed meanwhile.
    Loading,
    /// It is here; the number tells pictures apart (for upload caches).
    Ready(u64, Picture),
    /// It cannot be shown, and why.
    Failed(String),
}

/// Pictures and thumbnails of the open document's frames.
#[derive(Default)]
pub struct Pictures {
    current: Option<PictureState>,
    thumbnails: BTreeMap<usize, egui::TextureHandle>,
    wanted: Vec<usize>,
}

impl Pictures {
    /// The shown frame's picture.
    #[must_use]
    pub fn current(&self) -> PictureState {
        self.current.clone().unwrap_or(PictureState::None)
    }

    /// A frame's thumbnail; if it is not there yet it is made in the background.
    pub fn thumbnail(&mut self, frame: usize) -> Option<egui::TextureHandle> {
        let known = self.thumbnails.get(&frame).cloned();
        if known.is_none() {
            self.wanted.push(frame);
        }
        known
    }
}
