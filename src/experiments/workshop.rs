//! What several experiments need, made once.

use super::sets::{FrameSet, OwnDocuments, highlights, of_documents, worldcup};
use super::{ExperimentError, ExperimentOptions};
use crate::synthetic::Preset;
use std::sync::OnceLock;
use std::sync::atomic::{AtomicUsize, Ordering};

/// How experiments are run, and what they share: frames are drawn, and their features found, once.
#[derive(Debug, Default)]
pub struct Workshop {
    /// How they are run.
    pub options: ExperimentOptions,
    /// A user's own frames in place of drawn ones.
    pub own: Option<OwnDocuments>,
    highlights: OnceLock<FrameSet>,
    distorted: OnceLock<FrameSet>,
    worldcup: OnceLock<FrameSet>,
}

/// Called from any thread: how many steps are done, of how many.
pub type Progress<'a> = &'a (dyn Fn(usize, usize) + Sync);

impl Workshop {
    /// A workshop for these options, with a user's own frames if they are given.
    #[must_use]
    pub fn new(options: ExperimentOptions, own: Option<OwnDocuments>) -> Self {
        Self { options, own, ..Self::default() }
    }

    /// Sequences like the paper's highlights, or the user's own frames.
    pub(super) fn highlights(&self, progress: Progress) -> Result<&FrameSet, ExperimentError> {
        once(&self.highlights, || match &self.own {
            Some(own) => self.own_frames(own, progress),
            None => highlights(&self.options, Preset::Paper, &counted(self.options.sized(116, 15), progress)),
        })
    }

    /// The same through a lens with strong distortion, or the user's own frames.
    pub(super) fn distorted(&self, progress: Progress) -> Result<&FrameSet, ExperimentError> {
        once(&self.distorted, || match &self.own {
            Some(own) => self.own_frames(own, progress),
            None => highlights(&self.options, Preset::Hard, &counted(self.options.sized(116, 15), progress)),
        })
    }

    /// Games like the paper's World Cup set, or the user's own frames.
    pub(super) fn worldcup(&self, progress: Progress) -> Result<&FrameSet, ExperimentError> {
        once(&self.worldcup, || match &self.own {
            Some(own) => self.own_frames(own, progress),
            None => worldcup(&self.options, &counted(self.options.sized(75, 14), progress)),
        })
    }

    fn own_frames(&self, own: &OwnDocuments, progress: Progress) -> Result<FrameSet, ExperimentError> {
        if let Some(set) = [&self.highlights, &self.distorted, &self.worldcup].into_iter().find_map(OnceLock::get) {
            return Ok(set.clone());
        }
        let frames = own.train.0.frames.len() + own.test.0.frames.len();
        of_documents(own, &counted(frames, progress))
    }
}

/// What is in the cell; it is made first where there is nothing.
fn once(
    cell: &OnceLock<FrameSet>,
    make: impl FnOnce() -> Result<FrameSet, ExperimentError>,
) -> Result<&FrameSet, ExperimentError> {
    if let Some(set) = cell.get() {
        return Ok(set);
    }
    let made = make()?;
    Ok(cell.get_or_init(|| made))
}

/// Progress for work that only says when it has done one more.
fn counted(total: usize, progress: Progress<'_>) -> impl Fn() + Sync {
    let done = AtomicUsize::new(0);
    move || progress(done.fetch_add(1, Ordering::Relaxed) + 1, total)
}
