//! What several experiments need, made once.

use super::answers::AskedFrame;
use super::forests::{ForestKind, ask_all};
use super::given::folder_with;
use super::homographies::holds_homographies;
use super::progress::{Progress, counted};
use super::sets::{
    FrameSet, MOTION_FILE, OwnDocuments, PublishedKind, SetKind, frames_a_game, frames_a_sequence,
    highlights, of_own, published, published_folder, worldcup,
};
use super::{Experiment, ExperimentError, ExperimentOptions};
use std::path::{Path, PathBuf};
use std::sync::OnceLock;
use touchline_vision::synthetic::Preset;

/// How experiments are run, and what they share: frames are drawn or read, and their features
/// found, once; so are the answers of the forests to them.
#[derive(Debug, Default)]
pub struct SharedInputs {
    /// How they are run.
    pub options: ExperimentOptions,
    /// A user's own frames in place of drawn ones.
    own: Option<OwnDocuments>,
    /// A folder of published data.
    data: Option<PathBuf>,
    highlights: OnceLock<Vec<FrameSet>>,
    distorted: OnceLock<Vec<FrameSet>>,
    worldcup: OnceLock<Vec<FrameSet>>,
    answers: [OnceLock<Vec<AskedFrame>>; 8],
}

/// Sequences in a drawn set like the highlights.
const SEQUENCES: usize = super::paper::TABLE_2.len();

/// Draws a set with a seed; calls back after each frame.
type Drawing<'a> = dyn Fn(u64, &(dyn Fn() + Sync)) -> Result<FrameSet, ExperimentError> + 'a;

/// Which of the two kinds of sets.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Sets {
    Highlights,
    WorldCup,
}

/// Whether features on players and graphics take part, where that is a choice.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Masks {
    /// As the set has them: drawn frames with their players.
    AsTheyAre,
    /// Without.
    Masked,
}

impl SharedInputs {
    /// The inputs for these options, with a user's own frames and a folder of published data if
    /// they are given.
    #[must_use]
    pub fn new(options: ExperimentOptions, own: Option<OwnDocuments>, data: Option<&Path>) -> Self {
        Self {
            options,
            own,
            data: data.map(Path::to_path_buf),
            ..Self::default()
        }
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
        found.ok_or_else(|| ExperimentError::NotGiven {
            experiment,
            folder: self.data.clone(),
        })
    }

    /// The published sequences, sequences like them, or the user's own frames; drawn ones once for
    /// every seed.
    pub(super) fn highlights(&self, progress: Progress) -> Result<&[FrameSet], ExperimentError> {
        once(&self.highlights, || {
            match (&self.own, self.given_for(Experiment::Highlights)) {
                (Some(own), _) => Ok(vec![self.own_frames(own, progress)?]),
                (None, Ok(folder)) => Ok(vec![published(
                    &folder,
                    PublishedKind::Highlights,
                    progress,
                )?]),
                (None, Err(_)) => self.drawn(
                    SEQUENCES * frames_a_sequence(&self.options),
                    progress,
                    &|seed, step| highlights(&self.options, Preset::Paper, seed, step),
                ),
            }
        })
    }

    /// Sequences like the highlights through a lens with strong distortion, or the user's own
    /// frames.
    pub(super) fn distorted(&self, progress: Progress) -> Result<&FrameSet, ExperimentError> {
        let sets = once(&self.distorted, || {
            if let Some(own) = &self.own {
                return Ok(vec![self.own_frames(own, progress)?]);
            }
            let step = counted(SEQUENCES * frames_a_sequence(&self.options), progress);
            Ok(vec![highlights(
                &self.options,
                Preset::Hard,
                self.options.seed,
                &step,
            )?])
        })?;
        Ok(&sets[0])
    }

    /// The published World Cup games, games like them, or the user's own frames.
    pub(super) fn worldcup(&self, progress: Progress) -> Result<&[FrameSet], ExperimentError> {
        once(&self.worldcup, || {
            match (&self.own, self.given_for(Experiment::Worldcup)) {
                (Some(own), _) => Ok(vec![self.own_frames(own, progress)?]),
                (None, Ok(folder)) => {
                    Ok(vec![published(&folder, PublishedKind::WorldCup, progress)?])
                }
                (None, Err(_)) => self.drawn(
                    frames_a_game(&self.options).iter().sum(),
                    progress,
                    &|seed, step| worldcup(&self.options, seed, step),
                ),
            }
        })
    }

    pub(super) fn sets(
        &self,
        sets: Sets,
        progress: Progress,
    ) -> Result<&[FrameSet], ExperimentError> {
        match sets {
            Sets::Highlights => self.highlights(progress),
            Sets::WorldCup => self.worldcup(progress),
        }
    }

    /// The answers of a forest to all test frames of the sets, by their true bases.
    pub(super) fn answers(
        &self,
        sets: Sets,
        kind: ForestKind,
        masks: Masks,
        progress: Progress,
    ) -> Result<&[AskedFrame], ExperimentError> {
        let asked = self.sets(sets, progress)?;
        let place = 4 * usize::from(sets == Sets::WorldCup)
            + 2 * usize::from(kind == ForestKind::Published)
            + usize::from(masks == Masks::Masked);
        Ok(self.answers[place].get_or_init(|| match masks {
            Masks::AsTheyAre => ask_all(asked, kind),
            Masks::Masked => ask_all(
                &asked.iter().map(FrameSet::masked).collect::<Vec<_>>(),
                kind,
            ),
        }))
    }

    /// A drawn set of so many frames for every seed.
    fn drawn(
        &self,
        frames: usize,
        progress: Progress,
        set: &Drawing<'_>,
    ) -> Result<Vec<FrameSet>, ExperimentError> {
        let seeds = self.options.seeds();
        let step = counted(seeds.len() * frames, progress);
        seeds.into_iter().map(|seed| set(seed, &step)).collect()
    }

    fn own_frames(
        &self,
        own: &OwnDocuments,
        progress: Progress,
    ) -> Result<FrameSet, ExperimentError> {
        let read = [&self.highlights, &self.distorted, &self.worldcup]
            .into_iter()
            .find_map(OnceLock::get);
        if let Some(set) = read.and_then(|sets| sets.first()) {
            return Ok(set.clone());
        }
        Ok(FrameSet {
            seed: self.options.seed,
            ..of_own(own, &counted(own.frame_count(), progress))?
        })
    }

    /// Whether the sets are drawn, so that masks and the paper's ranges are a choice.
    pub(super) fn are_drawn(
        &self,
        sets: Sets,
        progress: Progress,
    ) -> Result<bool, ExperimentError> {
        Ok(self
            .sets(sets, progress)?
            .iter()
            .all(|set| set.kind == SetKind::Drawn))
    }
}

/// What is in the cell; it is made first where there is nothing.
fn once(
    cell: &OnceLock<Vec<FrameSet>>,
    make: impl FnOnce() -> Result<Vec<FrameSet>, ExperimentError>,
) -> Result<&[FrameSet], ExperimentError> {
    if let Some(sets) = cell.get() {
        return Ok(sets);
    }
    let made = make()?;
    Ok(cell.get_or_init(|| made))
}
