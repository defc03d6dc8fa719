//! Which experiments there are, and how they are run.

use std::fmt;
use std::str::FromStr;
use thiserror::Error;

/// An experiment.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Experiment {
    /// Pan, tilt and focal length from noisy rays: figure (b), (c), (d) of the paper, with the
    /// Cramér–Rao bound.
    Synthetic,
    /// Rounds of RANSAC for four, two and one points: table 1, and what they cost as outliers grow.
    Ransac,
    /// Sequences of one match, each asked of the others: the paper's highlights.
    Highlights,
    /// Two games, half of each for training: the paper's World Cup.
    Worldcup,
    /// Distributions of rotation and focal length errors.
    Errors,
    /// The gate on descriptors' distances: table 4.
    Threshold,
    /// One to ten trees.
    Trees,
    /// `IoU` over the field of view.
    Fov,
    /// Matching to references, nearest neighbours and the forest over the number of references.
    Baselines,
    /// SIFT against ORB and AKAZE.
    Descriptors,
    /// With and without distortion in the optimisation.
    Pose,
    /// What each step of the program is worth to a simulated annotator.
    Annotator,
    /// Published homographies: our camera fitted to them, and how many frames share a base. Needs
    /// data.
    Homographies,
    /// The motion of a real broadcast camera, drawn. Needs data.
    Motion,
}

impl Experiment {
    /// All of them, in the order of the report.
    pub const ALL: [Self; 14] = [
        Self::Synthetic,
        Self::Ransac,
        Self::Highlights,
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

    /// Whether it looks at frames that may be a user's own.
    #[must_use]
    pub const fn takes_frames(self) -> bool {
        !matches!(
            self,
            Self::Synthetic | Self::Ransac | Self::Annotator | Self::Homographies | Self::Motion
        )
    }

    /// Whether its drawn frames are drawn with several seeds.
    #[must_use]
    pub const fn takes_seeds(self) -> bool {
        self.takes_frames() && !matches!(self, Self::Pose)
    }

    /// Whether it is about data that the program does not have.
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

/// An experiment's name was not known.
#[derive(Clone, Debug, PartialEq, Eq, Error)]
#[error("there is no experiment {name:?}; there are {}", Experiment::ALL.map(Experiment::name).join(", "))]
pub struct UnknownExperiment {
    /// The name.
    pub name: String,
}

/// How an experiment is run.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct ExperimentOptions {
    /// A tenth or less of everything: for trying out and for tests.
    pub quick: bool,
    /// Where chance starts; the same seed gives the same bytes.
    pub seed: u64,
    /// How many seeds, from that one on, the drawn sets are made with; none: 5, or 2 where quick.
    pub seeds: Option<u32>,
}

impl ExperimentOptions {
    /// The first number, or the second where quick.
    #[must_use]
    pub const fn sized(&self, full: usize, quick: usize) -> usize {
        if self.quick { quick } else { full }
    }

    /// The seeds of the drawn sets.
    #[must_use]
    pub fn seeds(&self) -> Vec<u64> {
        let count = self.seeds.map_or(self.sized(5, 2) as u64, u64::from);
        (0..count)
            .map(|number| self.seed.wrapping_add(number))
            .collect()
    }
}
