//! The search for the cuts of a video.

use std::ops::ControlFlow;
use std::path::{Path, PathBuf};
use thiserror::Error;
use touchline_documents::document::{Document, Frame, ShotKind};
use touchline_vision::media::{FrameReader, FrameRef, MediaError};
use touchline_vision::track::{CutFinder, Miniature};

/// A video whose cuts are to be found.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct ShotSearch {
    /// Which search it is: reports say it again.
    pub ticket: u64,
    /// The video as the document names it.
    pub video: String,
    /// Its file.
    pub path: PathBuf,
}

/// How far a search has come.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct ShotProgress {
    /// Frames that have been looked at.
    pub done: usize,
    /// All frames of the video.
    pub of: usize,
}

/// The cuts of a video.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct FoundShots {
    /// The video's last frame.
    pub last: u64,
    /// The first frame of every shot but the first, and how it was found.
    pub cuts: Vec<(u64, ShotKind)>,
}

/// Why cuts were not found.
#[derive(Clone, Debug, PartialEq, Eq, Error)]
pub enum ShotFailure {
    /// The video cannot be read.
    #[error(transparent)]
    Media(#[from] MediaError),
    /// The program made a mistake.
    #[error("internal error (please report it): {message}")]
    Panicked {
        /// The words of the panic.
        message: String,
    },
}

impl ShotSearch {
    /// Looks at every frame of the video. `watch` is told how far that has come and may end it: [`MediaError::Stopped`].
    ///
    /// # Errors
    /// The video cannot be opened, or `watch` ended the search.
    pub fn look(
        &self,
        reader: &mut FrameReader,
        watch: &dyn Fn(ShotProgress) -> ControlFlow<()>,
    ) -> Result<FoundShots, ShotFailure> {
        let of = reader.video_info(&self.path)?.decoded_frames;
        let mut finder = CutFinder::default();
        let mut last: Option<Miniature> = None;
        for done in 0..of {
            if watch(ShotProgress { done, of }).is_break() {
                return Err(MediaError::Stopped { path: self.path.clone() }.into());
            }
            // A frame that does not decode shows nothing new.
            if let Ok(picture) = reader.read(&FrameRef::video(self.path.as_path(), done)) {
                last = Some(Miniature::of(&picture));
            }
            if let Some(miniature) = &last {
                finder.push(miniature.clone());
            }
        }
        // Frames that did not decode at the start were not counted by the finder.
        let missing = of - finder.frames();
        let kind = |is_fade| if is_fade { ShotKind::Fade } else { ShotKind::Cut };
        let cuts = finder.cuts().into_iter().map(|cut| ((cut.frame + missing) as u64, kind(cut.is_fade)));
        Ok(FoundShots { last: of.saturating_sub(1) as u64, cuts: cuts.collect() })
    }
}

/// The videos of a document of which nobody has said what their shots are, by name and file: no frame of theirs belongs to one.
pub(super) fn without_shots(document: &Document, folder: &Path) -> Vec<(String, PathBuf)> {
    let mut videos: Vec<(String, PathBuf, bool)> = Vec::new();
    for frame in &document.frames {
        let Some(video) = &frame.video else { continue };
        let is_in_shot = frame.clip.is_some();
        match videos.iter_mut().find(|(name, ..)| *name == video.path) {
            Some((.., has_shots)) => *has_shots |= is_in_shot,
            None => videos.extend(file_of(frame, folder).map(|file| (video.path.clone(), file, is_in_shot))),
        }
    }
    videos.into_iter().filter(|(.., has_shots)| !has_shots).map(|(name, file, _)| (name, file)).collect()
}

/// The file of a frame's video.
pub(super) fn file_of(frame: &Frame, folder: &Path) -> Option<PathBuf> {
    match frame.picture_source(folder)? {
        FrameRef::Video { path, .. } => Some(path.to_path_buf()),
        FrameRef::Image(_) => None,
    }
}
