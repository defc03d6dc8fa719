//! Why there is no base without clicks.

use super::Doubt;
use crate::calibrate::AutocalibratedCamera;
use thiserror::Error;
use touchline_core::field::FieldError;
use touchline_vision::features::FeatureError;
use touchline_vision::track::TrackError;

/// Why a camera was not looked for to the end.
#[derive(Debug, Error)]
#[non_exhaustive]
pub enum AutocalibrationError {
    /// The camera's field cannot be had.
    #[error(transparent)]
    Field(#[from] FieldError),
    /// The program was built without OpenCV, or OpenCV refused.
    #[error(transparent)]
    Features(#[from] FeatureError),
    /// Frames could not be compared.
    #[error(transparent)]
    Track(TrackError),
    /// It was given up.
    #[error("the search was stopped")]
    Stopped,
}

/// Why no camera is given although the search came to its end.
#[derive(Clone, Debug, PartialEq, Error)]
#[non_exhaustive]
pub enum Abstention {
    /// The frames do not show the same.
    #[error(
        "at most {tied} of {frames} frames match each other: use three or more overlapping frames of one camera that does not move"
    )]
    NotTied {
        /// Frames looked at.
        frames: usize,
        /// Frames of the largest group.
        tied: usize,
    },
    /// The frames are not of a camera that turns and zooms.
    #[error(transparent)]
    NotTurning(TrackError),
    /// Hardly any paint.
    #[error(
        "only {places} places of paint agree between the frames: use frames that show more of the lines"
    )]
    LittlePaint {
        /// Directions in which paint stays.
        places: usize,
    },
    /// No place for the camera explains anything.
    #[error("no position of the camera explains the painted lines: check the sport")]
    NothingFits,
    /// The best answer is not certain.
    #[error("the best answer is not certain, so none is given: {}. Click 4 landmarks on 2 frames instead", listed(.doubts))]
    Uncertain {
        /// What speaks against it.
        doubts: Vec<Doubt>,
        /// It, as far as it was looked at.
        best: Option<Box<AutocalibratedCamera>>,
    },
}

fn listed(doubts: &[Doubt]) -> String {
    doubts
        .iter()
        .map(Doubt::to_string)
        .collect::<Vec<_>>()
        .join("; ")
}

/// Why the search ended before its answer.
pub(super) enum Stop {
    Failed(AutocalibrationError),
    Abstained(Abstention),
}

impl From<AutocalibrationError> for Stop {
    fn from(error: AutocalibrationError) -> Self {
        Self::Failed(error)
    }
}

impl From<Abstention> for Stop {
    fn from(why: Abstention) -> Self {
        Self::Abstained(why)
    }
}
