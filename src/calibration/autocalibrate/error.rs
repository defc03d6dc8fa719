//! Errors of autocalibration, and reasons to give no answer.

use crate::autocalibrate::Doubt;
use crate::calibrate::AutocalibratedCamera;
use thiserror::Error;
use touchline_core::field::FieldError;
use touchline_vision::features::FeatureError;
use touchline_vision::track::TrackError;

/// Why the search could not run to its end.
#[derive(Debug, Error)]
#[non_exhaustive]
pub enum AutocalibrationError {
    /// The document's field is not usable.
    #[error(transparent)]
    Field(#[from] FieldError),
    /// The program was built without OpenCV, or OpenCV failed.
    #[error(transparent)]
    Features(#[from] FeatureError),
    /// Frames could not be matched.
    #[error(transparent)]
    Track(TrackError),
    /// The search was cancelled.
    #[error("the search was stopped")]
    Stopped,
}

/// Why the search ended without an answer.
#[derive(Clone, Debug, PartialEq, Error)]
#[non_exhaustive]
pub enum Abstention {
    /// Too few frames match each other.
    #[error("{}", why_not_connected(*.frames, *.connected))]
    NotConnected {
        /// Number of sampled frames with a picture that could be read.
        frames: usize,
        /// Size of the largest connected group; 1 if no two frames match.
        connected: usize,
    },
    /// The matches do not fit a camera that only rotates and zooms.
    #[error(transparent)]
    NotTurning(TrackError),
    /// There is hardly any persistent paint.
    #[error(
        "only {places} places of paint agree between the frames: use frames that show more of the lines"
    )]
    LittlePaint {
        /// Number of directions with persistent paint.
        places: usize,
    },
    /// No position of the camera explains the paint.
    #[error("no position of the camera explains the painted lines: check the sport")]
    NothingFits,
    /// No picture of a court shows enough of its lines.
    #[error("no picture shows enough of the court's lines")]
    NoCourt,
    /// The lines across the field repeat, so that its pictures fit in several places of it.
    #[error(
        "the lines of this field repeat every few metres, so its pictures alone do not say where they are"
    )]
    LinesRepeat,
    /// The best answer is not certain.
    #[error("the best answer is not certain, so none is given: {}", join_doubts(.doubts))]
    Uncertain {
        /// The reasons to reject the best answer.
        doubts: Vec<Doubt>,
        /// The best answer, as far as it was refined.
        best: Option<Box<AutocalibratedCamera>>,
    },
}

impl Abstention {
    /// The best answer, although it is not certain.
    pub fn best(&self) -> Option<&AutocalibratedCamera> {
        match self {
            Self::Uncertain { best, .. } => best.as_deref(),
            _ => None,
        }
    }
}

/// Why the frames are no group of one camera.
fn why_not_connected(frames: usize, connected: usize) -> String {
    let matching = match (frames, connected) {
        (0, _) => return "no picture of its frames can be read".to_owned(),
        (1, _) => "there is only 1 frame".to_owned(),
        (_, 0 | 1) => format!("no two of the {frames} frames match each other"),
        _ => format!("at most {connected} of {frames} frames match each other"),
    };
    format!("{matching}: use three or more overlapping frames of one camera that does not move")
}

fn join_doubts(doubts: &[Doubt]) -> String {
    doubts
        .iter()
        .map(Doubt::to_string)
        .collect::<Vec<_>>()
        .join("; ")
}

/// Why a stage ended the search.
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

#[cfg(test)]
mod tests {
    use super::Abstention;

    #[test]
    fn frames_that_do_not_match_are_counted_and_pictures_that_cannot_be_read_are_named() {
        for (frames, connected, begins) in [
            (0, 0, "no picture of its frames can be read"),
            (1, 1, "there is only 1 frame: "),
            (5, 1, "no two of the 5 frames match each other: "),
            (5, 2, "at most 2 of 5 frames match each other: "),
        ] {
            let says = Abstention::NotConnected { frames, connected }.to_string();
            assert!(says.starts_with(begins), "{says}");
        }
    }
}
