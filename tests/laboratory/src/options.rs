//! The experiments and their options.

use std::fmt;
use std::str::FromStr;
use thiserror::Error;

/// An experiment.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Experiment {
    /// Pan, tilt and focal length from noisy rays: figures (b), (c) and (d) of the paper, with the
    /// Cramér–Rao bound.
    Synthetic,
    /// Iterations of RANSAC with samples of four, two and one points (table 1), and their number as
    /// the share of outliers grows.
    Ransac,
    /// Sequences of one match, each relocalized with the others as references: the highlights
    /// (table 2).
    Highlights,
    /// How the highlights' results move with what their drawn scenes assume.
    Assumptions,
    /// Two games, half of each for training: the World Cup (table 3).
    Worldcup,
    /// The distributions of the errors of rotation and focal length.
    Errors,
    /// The threshold on distances of descriptors (table 4).
    Threshold,
    /// The number of trees, from one to ten.
    Trees,
    /// `IoU` as a function of the field of view.
    Fov,
    /// Matching to references, nearest neighbours and the forest, as a function of the number of
    /// references.
    Baselines,
    /// SIFT compared with SURF, ORB and AKAZE.
    Descriptors,
    /// Refinement of the camera with and without lens distortion.
    Pose,
    /// The clicks that each feature of the program saves a simulated annotator.
    Annotator,
    /// Published homographies: how well our camera model fits them, and how many frames share a
    /// base. Needs data.
    Homographies,
    /// The motion of a real broadcast camera, in diagrams. Needs data.
    Motion,
}

impl Experiment {
    /// All experiments, in the order of the report.
    pub const ALL: [Self; 15] = [
        Self::Synthetic,
        Self::Ransac,
        Self::Highlights,
        Self::Assumptions,
        Self::Worldcup,
        Self::Errors,
        Self::Threshold,
        Self::Trees,
        Self::Fov,
        Self::Baselines,
        Self::Descriptors,
        Self::Pose,
        Self::Annotator,
        Self::Homographies,
        Self::Motion,
    ];

    /// Its name on the command line and in files.
    #[must_use]
    pub const fn name(self) -> &'static str {
        match self {
            Self::Synthetic => "synthetic",
            Self::Ransac => "ransac",
            Self::Highlights => "highlights",
            Self::Assumptions => "assumptions",
            Self::Worldcup => "worldcup",
            Self::Errors => "errors",
            Self::Threshold => "threshold",
            Self::Trees => "trees",
            Self::Fov => "fov",
            Self::Baselines => "baselines",
            Self::Descriptors => "descriptors",
            Self::Pose => "pose",
            Self::Annotator => "annotator",
            Self::Homographies => "homographies",
            Self::Motion => "motion",
        }
    }

    /// Whether it can use a user's own frames.
    #[must_use]
    pub const fn takes_frames(self) -> bool {
        !matches!(
            self,
            Self::Synthetic
                | Self::Ransac
                | Self::Assumptions
                | Self::Annotator
                | Self::Homographies
                | Self::Motion
        )
    }

    /// Whether its synthetic frames are drawn with several seeds.
    #[must_use]
    pub const fn takes_seeds(self) -> bool {
        self.takes_frames() && !matches!(self, Self::Pose)
    }

    /// Whether it belongs to the comparison with the paper.
    #[must_use]
    pub const fn is_of_paper(self) -> bool {
        !matches!(self, Self::Pose | Self::Annotator)
    }

    /// Whether it can use published data.
    #[must_use]
    pub const fn takes_data(self) -> bool {
        // The lens of the pose experiment bends strongly, as that of no published data does.
        !matches!(
            self,
            Self::Synthetic | Self::Ransac | Self::Assumptions | Self::Pose
        )
    }

    /// Whether it needs data that does not come with the program.
    #[must_use]
    pub const fn needs_data(self) -> bool {
        matches!(self, Self::Homographies | Self::Motion)
    }
}

impl fmt::Display for Experiment {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(self.name())
    }
}

impl FromStr for Experiment {
    type Err = UnknownExperiment;

    fn from_str(name: &str) -> Result<Self, Self::Err> {
        let found = Self::ALL
            .into_iter()
            .find(|experiment| experiment.name() == name);
        found.ok_or_else(|| UnknownExperiment {
            name: name.to_owned(),
        })
    }
}

/// The name of an experiment that does not exist.
#[derive(Clone, Debug, PartialEq, Eq, Error)]
#[error("there is no experiment {name:?}; there are {}", Experiment::ALL.map(Experiment::name).join(", "))]
pub struct UnknownExperiment {
    /// The name.
    pub name: String,
}

/// Options of all experiments.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct ExperimentOptions {
    /// A quick run, with a tenth or less of all sample sizes: for trying out and for tests.
    pub quick: bool,
    /// The first seed. The same seed gives the same bytes.
    pub seed: u64,
    /// Number of seeds for synthetic sets, from `seed` on. Default: 5, or 2 in a quick run.
    pub seeds: Option<u32>,
}

impl ExperimentOptions {
    /// The first number, or the second in a quick run.
    #[must_use]
    pub const fn full_or_quick(&self, full: usize, quick: usize) -> usize {
        if self.quick { quick } else { full }
    }

    /// The seeds of the synthetic sets.
    #[must_use]
    pub fn seeds(&self) -> Vec<u64> {
        let count = self
            .seeds
            .map_or(self.full_or_quick(5, 2) as u64, u64::from);
        (0..count)
            .map(|number| self.seed.wrapping_add(number))
            .collect()
    }
}
