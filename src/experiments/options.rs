//! Which experiments there are, and how they are run.

use super::workshop::{Progress, Workshop};
use super::{baselines, descriptors, homographies, motion, pose, ransac, relocalization, synthetic};
use crate::evaluate::EvaluationError;
use crate::exchange::AuthorsError;
use crate::features::FeatureError;
use crate::field::FieldError;
use crate::media::MediaError;
use crate::proposals::PictureError;
use crate::report::Report;
use crate::report::figure::FigureError;
use std::fmt;
use std::path::{Path, PathBuf};
use std::str::FromStr;
use thiserror::Error;

/// An experiment.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Experiment {
    /// Pan, tilt and focal length from noisy rays: figure (b), (c), (d) of the paper, with the Cramér–Rao bound.
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
    /// Published homographies: our camera fitted to them, and how many frames share a base. Needs data.
    Homographies,
    /// The motion of a real broadcast camera, drawn. Needs data.
    Motion,
}

impl Experiment {
    /// All of them, in the order of the report.
    pub const ALL: [Self; 13] = [
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
            Self::Homographies => "homographies",
            Self::Motion => "motion",
        }
    }

    /// Whether it looks at frames that may be a user's own.
    #[must_use]
    pub const fn takes_frames(self) -> bool {
        !matches!(self, Self::Synthetic | Self::Ransac | Self::Homographies | Self::Motion)
    }

    /// Whether it is about data that the program does not have.
    #[must_use]
    pub const fn needs_data(self) -> bool {
        matches!(self, Self::Homographies | Self::Motion)
    }

    /// Runs it.
    ///
    /// # Errors
    /// What it needs is missing or cannot be read.
    pub fn run(self, workshop: &Workshop, progress: Progress) -> Result<Report, ExperimentError> {
        match self {
            Self::Synthetic => Ok(synthetic::run(&workshop.options, progress)),
            Self::Ransac => Ok(ransac::run(&workshop.options, progress)),
            Self::Highlights => relocalization::highlights(workshop, progress),
            Self::Worldcup => relocalization::worldcup(workshop, progress),
            Self::Errors => relocalization::errors(workshop, progress),
            Self::Threshold => relocalization::threshold(workshop, progress),
            Self::Trees => relocalization::trees(workshop, progress),
            Self::Fov => relocalization::fov(workshop, progress),
            Self::Baselines => baselines::run(workshop, progress),
            Self::Descriptors => descriptors::run(workshop, progress),
            Self::Pose => pose::run(workshop, progress),
            Self::Homographies => homographies::run(workshop, &workshop.given_for(self)?, progress),
            Self::Motion => motion::run(workshop, &workshop.given_for(self)?, progress),
        }
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
        let found = Self::ALL.into_iter().find(|experiment| experiment.name() == name);
        found.ok_or_else(|| UnknownExperiment { name: name.to_owned() })
    }
}

/// An experiment's name was not known.
#[derive(Clone, Debug, PartialEq, Eq, Error)]
#[error("no experiment is called {name:?}; there are {}", Experiment::ALL.map(Experiment::name).join(", "))]
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
}

impl ExperimentOptions {
    /// The first number, or the second where quick.
    #[must_use]
    pub const fn sized(&self, full: usize, quick: usize) -> usize {
        if self.quick { quick } else { full }
    }
}

/// Why an experiment has no report.
#[derive(Debug, Error)]
pub enum ExperimentError {
    /// A figure cannot be drawn.
    #[error(transparent)]
    Figure(#[from] FigureError),
    /// The field of a frame is not valid.
    #[error(transparent)]
    Field(#[from] FieldError),
    /// Features cannot be found.
    #[error(transparent)]
    Features(#[from] FeatureError),
    /// A picture cannot be made or read.
    #[error(transparent)]
    Media(#[from] MediaError),
    /// A drawn picture cannot be encoded.
    #[error("a drawn picture cannot be encoded")]
    Image(#[from] image::ImageError),
    /// A picture of the user's own cannot be had.
    #[error("{frame}")]
    Picture {
        /// The frame.
        frame: String,
        /// What is wrong.
        source: PictureError,
    },
    /// The two documents share no camera with solved frames.
    #[error(
        "no camera has solved frames in both documents; both must hold frames with `ptz`, of a camera of the same name"
    )]
    NothingInCommon,
    /// No document has two clips of a camera, and there is no second document.
    #[error(
        "no camera has solved frames in two clips (`clip` of a frame): give a second document whose frames are to be asked"
    )]
    OneClip,
    /// The authors' files cannot be read.
    #[error(transparent)]
    Published(#[from] AuthorsError),
    /// A file of the given data cannot be read.
    #[error("{}: {reason}", path.display())]
    Given {
        /// The file or folder.
        path: PathBuf,
        /// What is wrong.
        reason: String,
    },
    /// The given data is not there, or not what the experiment is about.
    #[error("{}", not_given(*experiment, folder.as_deref()))]
    NotGiven {
        /// The experiment.
        experiment: Experiment,
        /// The folder that was given.
        folder: Option<PathBuf>,
    },
    /// The answers cannot be evaluated.
    #[error(transparent)]
    Evaluation(#[from] EvaluationError),
}

/// What an experiment wants of a folder of data.
fn not_given(experiment: Experiment, folder: Option<&Path>) -> String {
    let wanted = match experiment {
        Experiment::Homographies => "train_val.json, or a file N.homographyMatrix for each frame",
        Experiment::Motion => "soccer_ground_truth.json",
        Experiment::Worldcup => "MATLAB files such as game1_anno.mat, in it or in a folder named after the World Cup",
        Experiment::Synthetic | Experiment::Ransac => return format!("{experiment} needs no data; leave --data away"),
        _ => "MATLAB files such as seq1_anno.mat, in it or in a folder named highlights",
    };
    match folder {
        Some(folder) => format!("{experiment} wants {wanted}; {} has none", folder.display()),
        None => format!("{experiment} is about given data: --data DIR, a folder with {wanted}"),
    }
}
