//! Errors of experiments.

use super::Experiment;
use std::path::{Path, PathBuf};
use thiserror::Error;
use touchline::evaluate::EvaluationError;
use touchline::exchange::AuthorsError;
use touchline::features::FeatureError;
use touchline::field::FieldError;
use touchline::media::MediaError;
use touchline::proposals::PictureError;
use touchline::report::figure::FigureError;

/// Why an experiment failed.
#[derive(Debug, Error)]
pub enum ExperimentError {
    /// A figure cannot be drawn.
    #[error(transparent)]
    Figure(#[from] FigureError),
    /// The field of a frame is not valid.
    #[error(transparent)]
    Field(#[from] FieldError),
    /// Features cannot be extracted.
    #[error(transparent)]
    Features(#[from] FeatureError),
    /// A picture cannot be drawn or read.
    #[error(transparent)]
    Media(#[from] MediaError),
    /// A drawn picture cannot be encoded.
    #[error("a drawn picture cannot be encoded")]
    Image(#[from] image::ImageError),
    /// A picture of the user's own frames cannot be read.
    #[error("{frame}")]
    Picture {
        /// The frame.
        frame: String,
        /// What is wrong.
        source: PictureError,
    },
    /// The two documents have no camera in common that has solved frames in both.
    #[error(
        "no camera has solved frames in both documents; both must hold frames with `ptz`, of a camera of the same name"
    )]
    NothingInCommon,
    /// No camera has two clips in a document, and there is no second document to test on.
    #[error(
        "no camera has solved frames in two clips (`clip` of a frame): give a second \
         document to test on"
    )]
    OneClip,
    /// The authors' files cannot be read.
    #[error(transparent)]
    Published(#[from] AuthorsError),
    /// Published frames of which none can be tested against others.
    #[error(
        "{}: no frame can be tested against another; there must be two sequences of a camera, or \
         two frames in a sequence",
        folder.display()
    )]
    NothingToTest {
        /// The folder with the annotations.
        folder: PathBuf,
    },
    /// A file of the given data cannot be read.
    #[error("{}: {reason}", path.display())]
    Given {
        /// The file or folder.
        path: PathBuf,
        /// What is wrong.
        reason: String,
    },
    /// The data of the experiment was not given, or is not in the folder.
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

/// The message for missing data: what an experiment needs.
fn not_given(experiment: Experiment, folder: Option<&Path>) -> String {
    if !experiment.takes_data() {
        return format!("{experiment} needs no data; omit --data");
    }
    let wanted = match experiment {
        Experiment::Homographies => "train_val.json, or a file N.homographyMatrix for each frame",
        Experiment::Motion | Experiment::Annotator => "soccer_ground_truth.json",
        Experiment::Worldcup => {
            "MATLAB files such as game1_anno.mat, in it or in a folder named after the World Cup"
        }
        _ => "MATLAB files such as seq1_anno.mat, in it or in a folder named highlights",
    };
    match folder {
        Some(folder) => format!("{experiment} needs {wanted}; {} has none", folder.display()),
        None => format!("{experiment} needs data: give --data DIR, a folder with {wanted}"),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn an_experiment_that_draws_its_frames_needs_no_data() {
        for experiment in [
            Experiment::Synthetic,
            Experiment::Ransac,
            Experiment::Assumptions,
            Experiment::Pose,
        ] {
            assert_eq!(
                not_given(experiment, Some(Path::new("data"))),
                format!("{experiment} needs no data; omit --data")
            );
        }
    }
}
