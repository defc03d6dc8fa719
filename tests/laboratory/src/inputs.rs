//! Inputs that several experiments share, each computed once.

use super::calibme::{self, Chosen};
use super::given::folder_with;
use super::progress::{Progress, step_counter};
use super::sets::{
    FrameSet, MOTION_FILE, OwnDocuments, PublishedKind, SetKind, frames_a_game, frames_a_sequence,
    highlights, published_folder, read_own_documents, read_published, worldcup,
};
use super::{Experiment, ExperimentError, ExperimentOptions};
use crate::scoring::answers::FrameAnswer;
use crate::scoring::forests::{ForestKind, ask_all};
use crate::studies::homographies::holds_homographies;
use std::path::{Path, PathBuf};
use std::sync::OnceLock;
use touchline::synthetic::Preset;

/// The options of the experiments and their shared inputs. Sets of frames with their features, and
/// the answers of forests to them, are computed at the first use and kept.
#[derive(Debug, Default)]
pub struct SharedInputs {
    /// The options.
    pub options: ExperimentOptions,
    /// A user's own frames, used in place of synthetic ones.
    own: Option<OwnDocuments>,
    /// A folder of published data, used in place of synthetic frames.
    data: Option<PathBuf>,
    highlights: OnceLock<Vec<FrameSet>>,
    distorted: OnceLock<Vec<FrameSet>>,
    worldcup: OnceLock<Vec<FrameSet>>,
    answers: [OnceLock<Vec<FrameAnswer>>; 8],
    calibme: [OnceLock<Vec<Chosen>>; 2],
}

/// Number of sequences in a synthetic set like the highlights.
const SEQUENCES: usize = crate::report::paper::TABLE_2.len();

/// Draws a set with a seed. Calls the callback after each frame.
type Drawing<'a> = dyn Fn(u64, &(dyn Fn() + Sync)) -> Result<FrameSet, ExperimentError> + 'a;

/// The kind of sets.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Sets {
    Highlights,
    WorldCup,
}

/// Whether features on players and graphics are used.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Masks {
    /// All features of the set; in synthetic sets, including those on players.
    AsTheyAre,
    /// Without the features on players and graphics.
    Masked,
}

impl SharedInputs {
    /// Inputs with these options. The user's own frames have precedence over published data, and
    /// that over synthetic frames.
    #[must_use]
    pub fn new(options: ExperimentOptions, own: Option<OwnDocuments>, data: Option<&Path>) -> Self {
        Self {
            options,
            own,
            data: data.map(Path::to_path_buf),
            ..Self::default()
        }
    }

    /// The folder with an experiment's data, within the given data.
    ///
    /// # Errors
    /// No data was given, or it contains nothing for this experiment.
    pub fn data_folder(&self, experiment: Experiment) -> Result<PathBuf, ExperimentError> {
        let data = self.data.as_deref().filter(|_| experiment.takes_data());
        let found = data.and_then(|data| match experiment {
            Experiment::Homographies => folder_with(data, holds_homographies),
            Experiment::Motion | Experiment::Annotator => {
                folder_with(data, |folder| folder.join(MOTION_FILE).is_file())
            }
            Experiment::Worldcup => published_folder(data, PublishedKind::WorldCup),
            _ => published_folder(data, PublishedKind::Highlights),
        });
        found.ok_or_else(|| ExperimentError::NotGiven {
            experiment,
            folder: self.data.clone(),
        })
    }

    /// The highlights: the user's own frames, the published sequences, or synthetic ones like them.
    /// Synthetic sets are one for each seed.
    pub(super) fn highlights(&self, progress: Progress) -> Result<&[FrameSet], ExperimentError> {
        // The user's own frames have precedence. That there are no published ones is no error here,
        // for drawn frames then take their place, and every heading says which kind they are.
        once(&self.highlights, || {
            match (&self.own, self.data_folder(Experiment::Highlights)) {
                (Some(own), _) => Ok(vec![self.own_frames(own, progress)?]),
                (None, Ok(folder)) => Ok(vec![self.published_set(
                    &folder,
                    PublishedKind::Highlights,
                    progress,
                )?]),
                (None, Err(_)) => self.draw_sets(
                    SEQUENCES * frames_a_sequence(&self.options),
                    progress,
                    &|seed, step| highlights(&self.options, Preset::Paper, seed, step),
                ),
            }
        })
    }

    /// The user's own frames, or a synthetic set like the highlights, seen through a lens with
    /// strong distortion.
    pub(super) fn distorted_set(&self, progress: Progress) -> Result<&FrameSet, ExperimentError> {
        let sets = once(&self.distorted, || {
            if let Some(own) = &self.own {
                return Ok(vec![self.own_frames(own, progress)?]);
            }
            // One seed, because this experiment has no claim that needs an interval.
            let step = step_counter(SEQUENCES * frames_a_sequence(&self.options), progress);
            Ok(vec![highlights(
                &self.options,
                Preset::Hard,
                self.options.seed,
                &step,
            )?])
        })?;
        Ok(&sets[0])
    }

    /// The World Cup games: the user's own frames, the published games, or synthetic ones like
    /// them.
    pub(super) fn worldcup(&self, progress: Progress) -> Result<&[FrameSet], ExperimentError> {
        once(&self.worldcup, || {
            match (&self.own, self.data_folder(Experiment::Worldcup)) {
                (Some(own), _) => Ok(vec![self.own_frames(own, progress)?]),
                (None, Ok(folder)) => Ok(vec![self.published_set(
                    &folder,
                    PublishedKind::WorldCup,
                    progress,
                )?]),
                (None, Err(_)) => self.draw_sets(
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

    /// The answers of a forest to all test frames of the sets. Each frame's true base is known to
    /// the solver.
    pub(super) fn answers(
        &self,
        sets: Sets,
        kind: ForestKind,
        masks: Masks,
        progress: Progress,
    ) -> Result<&[FrameAnswer], ExperimentError> {
        let sets_of_frames = self.sets(sets, progress)?;
        // The index of this combination among the eight.
        let place = 4 * usize::from(sets == Sets::WorldCup)
            + 2 * usize::from(kind == ForestKind::Published)
            + usize::from(masks == Masks::Masked);
        Ok(self.answers[place].get_or_init(|| match masks {
            Masks::AsTheyAre => ask_all(sets_of_frames, kind),
            Masks::Masked => ask_all(
                &sets_of_frames
                    .iter()
                    .map(FrameSet::without_masked_features)
                    .collect::<Vec<_>>(),
                kind,
            ),
        }))
    }

    /// The answers of few references, chosen to cover the views, to all test frames of the sets.
    pub(super) fn calibme(
        &self,
        sets: Sets,
        progress: Progress,
    ) -> Result<&[Chosen], ExperimentError> {
        let frames = self.sets(sets, progress)?;
        let place = usize::from(sets == Sets::WorldCup);
        Ok(self.calibme[place].get_or_init(|| calibme::measure(frames, progress)))
    }

    /// The seeds of the sets of frames that an experiment uses: one for given frames, which are not
    /// drawn again with other seeds; it is that of the forests.
    #[must_use]
    pub fn seeds(&self, experiment: Experiment) -> Vec<u64> {
        let is_given = self.own.is_some() || self.data_folder(experiment).is_ok();
        if experiment.takes_seeds() && !is_given {
            self.options.seeds()
        } else {
            vec![self.options.seed]
        }
    }

    /// The published frames in a folder.
    fn published_set(
        &self,
        folder: &Path,
        kind: PublishedKind,
        progress: Progress,
    ) -> Result<FrameSet, ExperimentError> {
        Ok(FrameSet {
            seed: self.options.seed,
            ..read_published(folder, kind, progress)?
        })
    }

    /// Draws a set of this number of frames for each seed.
    fn draw_sets(
        &self,
        frames: usize,
        progress: Progress,
        set: &Drawing<'_>,
    ) -> Result<Vec<FrameSet>, ExperimentError> {
        let seeds = self.options.seeds();
        let step = step_counter(seeds.len() * frames, progress);
        seeds.into_iter().map(|seed| set(seed, &step)).collect()
    }

    /// The user's own frames, read once for all kinds of sets.
    fn own_frames(
        &self,
        own: &OwnDocuments,
        progress: Progress,
    ) -> Result<FrameSet, ExperimentError> {
        // Own frames are the same in all three places. Finding their features again would take far
        // longer than a copy.
        let read = [&self.highlights, &self.distorted, &self.worldcup]
            .into_iter()
            .find_map(OnceLock::get);
        if let Some(set) = read.and_then(|sets| sets.first()) {
            return Ok(set.clone());
        }
        Ok(FrameSet {
            seed: self.options.seed,
            ..read_own_documents(own, &step_counter(own.frame_count(), progress))?
        })
    }

    /// Whether the sets are synthetic. Only then are masks and the paper's ranges available.
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

/// The content of the cell, computed if it is empty. An error leaves it empty.
fn once(
    cell: &OnceLock<Vec<FrameSet>>,
    make: impl FnOnce() -> Result<Vec<FrameSet>, ExperimentError>,
) -> Result<&[FrameSet], ExperimentError> {
    if let Some(sets) = cell.get() {
        return Ok(sets);
    }
    // `get_or_init` takes no function that may fail. Experiments run one after the other, so that
    // nothing is made twice.
    let made = make()?;
    Ok(cell.get_or_init(|| made))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn given_frames_have_one_seed_and_drawn_ones_several() {
        let data = tempfile::tempdir().unwrap();
        let highlights = data.path().join("highlights");
        std::fs::create_dir(&highlights).unwrap();
        std::fs::write(highlights.join("seq1_anno.mat"), "").unwrap();
        let options = ExperimentOptions {
            seed: 7,
            ..ExperimentOptions::default()
        };
        let drawn = SharedInputs::new(options, None, None);
        let given = SharedInputs::new(options, None, Some(data.path()));
        let several = vec![7, 8, 9, 10, 11];
        assert_eq!(drawn.seeds(Experiment::Highlights), several);
        assert_eq!(given.seeds(Experiment::Highlights), [7]);
        assert_eq!(given.seeds(Experiment::Trees), [7]);
        // The games are not among the data, so that they are drawn.
        assert_eq!(given.seeds(Experiment::Worldcup), several);
        assert_eq!(drawn.seeds(Experiment::Ransac), [7]);
    }

    #[test]
    fn the_pose_experiment_takes_no_published_data_instead_of_drawing_beside_them() {
        let data = tempfile::tempdir().unwrap();
        std::fs::write(data.path().join("seq1_anno.mat"), "").unwrap();
        let inputs = SharedInputs::new(ExperimentOptions::default(), None, Some(data.path()));
        assert!(inputs.data_folder(Experiment::Highlights).is_ok());
        let refused = inputs.data_folder(Experiment::Pose).unwrap_err();
        assert_eq!(refused.to_string(), "pose needs no data; omit --data");
    }
}
