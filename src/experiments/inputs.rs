//! What several experiments need, made once.

use super::given::folder_with;
use super::homographies::holds_homographies;
use super::progress::{Progress, counted};
use super::sets::{
    FrameSet, MOTION_FILE, OwnDocuments, PublishedKind, highlights, of_own, published, published_folder, worldcup,
};
use super::{Experiment, ExperimentError, ExperimentOptions};
use crate::synthetic::Preset;
use std::path::{Path, PathBuf};
use std::sync::OnceLock;

/// How experiments are run, and what they share: frames are drawn or read, and their features found, once.
#[derive(Debug, Default)]
pub struct SharedInputs {
    /// How they are run.
    pub options: ExperimentOptions,
    /// A user's own frames in place of drawn ones.
    own: Option<OwnDocuments>,
    /// A folder of published data.
    data: Option<PathBuf>,
    highlights: OnceLock<FrameSet>,
    distorted: OnceLock<FrameSet>,
    worldcup: OnceLock<FrameSet>,
}

impl SharedInputs {
    /// The inputs for these options, with a user's own frames and a folder of published data if they are given.
    #[must_use]
    pub fn new(options: ExperimentOptions, own: Option<OwnDocuments>, data: Option<&Path>) -> Self {
        Self { options, own, data: data.map(Path::to_path_buf), ..Self::default() }
    }

    /// The folder with what an experiment is about, in the given data.
    ///
    /// # Errors
    /// No data was given, or it holds nothing for this experiment.
    pub fn given_for(&self, experiment: Experiment) -> Result<PathBuf, ExperimentError> {
        let data = self.data.as_deref();
        let found = data.and_then(|data| match experiment {
            Experiment::Homographies => folder_with(data, holds_homographies),
            Experiment::Motion | Experiment::Annotator => {
                folder_with(data, |folder| folder.join(MOTION_FILE).is_file())
            }
            Experiment::Worldcup => published_folder(data, PublishedKind::WorldCup),
            Experiment::Synthetic | Experiment::Ransac => None,
            _ => published_folder(data, PublishedKind::Highlights),
        });
        found.ok_or_else(|| ExperimentError::NotGiven { experiment, folder: self.data.clone() })
    }

    /// The published sequences, sequences like them, or the user's own frames.
    pub(super) fn highlights(&self, progress: Progress) -> Result<&FrameSet, ExperimentError> {
        once(&self.highlights, || match (&self.own, self.given_for(Experiment::Highlights)) {
            (Some(own), _) => self.own_frames(own, progress),
            (None, Ok(folder)) => published(&folder, PublishedKind::Highlights, progress),
            (None, Err(_)) => highlights(&self.options, Preset::Paper, &counted(self.options.sized(116, 15), progress)),
        })
    }

    /// Sequences like the highlights through a lens with strong distortion, or the user's own frames.
    pub(super) fn distorted(&self, progress: Progress) -> Result<&FrameSet, ExperimentError> {
        once(&self.distorted, || match &self.own {
            Some(own) => self.own_frames(own, progress),
            None => highlights(&self.options, Preset::Hard, &counted(self.options.sized(116, 15), progress)),
        })
    }

    /// The published World Cup games, games like them, or the user's own frames.
    pub(super) fn worldcup(&self, progress: Progress) -> Result<&FrameSet, ExperimentError> {
        once(&self.worldcup, || match (&self.own, self.given_for(Experiment::Worldcup)) {
            (Some(own), _) => self.own_frames(own, progress),
            (None, Ok(folder)) => published(&folder, PublishedKind::WorldCup, progress),
            (None, Err(_)) => worldcup(&self.options, &counted(self.options.sized(75, 14), progress)),
        })
    }

    fn own_frames(&self, own: &OwnDocuments, progress: Progress) -> Result<FrameSet, ExperimentError> {
        if let Some(set) = [&self.highlights, &self.distorted, &self.worldcup].into_iter().find_map(OnceLock::get) {
            return Ok(set.clone());
        }
        of_own(own, &counted(own.frame_count(), progress))
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
