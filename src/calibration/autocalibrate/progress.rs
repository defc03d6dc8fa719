//! Progress of autocalibration, in steps that a user understands.

use crate::autocalibrate::AutocalibrationError;
use std::fmt;
use std::sync::Arc;
use touchline_core::camera::{CameraBase, PanTilt, Ptz};
use touchline_core::field::FieldModel;
use touchline_core::geometry::{ImageSize, thousands};
use touchline_core::progress::Progress;

/// Progress of the search. `Display` shows it as text: "matching pairs of frames, 212 of 480".
#[derive(Clone, Debug, PartialEq)]
pub enum AutocalibrationProgress {
    /// Frames are sampled.
    Looking {
        /// Frames done.
        done: usize,
        /// Total number.
        of: usize,
    },
    /// Frames are matched pairwise.
    Tying {
        /// Pairs done.
        done: usize,
        /// Total number.
        of: usize,
    },
    /// The frames of one camera are known. What follows is searched from these alone.
    Matched {
        /// Indices in the document of the frames that match each other.
        frames: Vec<usize>,
        /// Indices in the document of the other sampled frames: taken to be another camera's.
        others: Vec<usize>,
        /// Which of `frames` match each other, by their places in it, and how many of their points
        /// do.
        links: Vec<([usize; 2], usize)>,
    },
    /// Persistent paint is collected, once for each kind of places that is searched.
    Gathering,
    /// Positions of the camera are searched.
    Trying {
        /// Poses that one round scores.
        places: usize,
        /// Rounds done, one per focal scale.
        done: usize,
        /// Total number.
        of: usize,
        /// What is known so far; none while no scale gathers paint enough.
        panorama: Option<Arc<SearchedPanorama>>,
    },
    /// The best positions are adjusted with all frames.
    Adjusting {
        /// Positions done.
        done: usize,
        /// Total number, at most.
        of: usize,
    },
    /// Neighbouring sizes of the field are tried.
    Sizing {
        /// Positions done.
        done: usize,
        /// Total number.
        of: usize,
    },
    /// Frames are aligned to the paint of their own pictures.
    Snapping {
        /// Frames done.
        done: usize,
        /// Total number.
        of: usize,
    },
    /// The base is refined with what the frames' own pictures show.
    Refining,
}

/// The panorama of the frames during the search, to be shown. Pan and tilt refer to `base`.
#[derive(Clone, Debug, PartialEq)]
pub struct SearchedPanorama {
    /// The base of the best pose so far; before there is one, at the origin of `world`.
    pub base: CameraBase,
    /// The field of the best pose so far; none before there is one.
    pub field: Option<FieldModel>,
    /// Pan, tilt and focal length of each frame, and the size of its picture.
    pub frames: Vec<(Ptz, ImageSize)>,
    /// Directions of persistent paint.
    pub paint: Vec<PanTilt>,
}

/// Reports progress.
///
/// # Errors
/// [`AutocalibrationError::Stopped`] if the receiver ends the search.
pub(super) fn report(
    progress: &Progress<'_, AutocalibrationProgress>,
    step: AutocalibrationProgress,
) -> Result<(), AutocalibrationError> {
    if progress.report(step).is_break() {
        Err(AutocalibrationError::Stopped)
    } else {
        Ok(())
    }
}

impl AutocalibrationProgress {
    /// The share of the present step that is done, 0 to 1.
    pub fn share_of_step(&self) -> f64 {
        match *self {
            Self::Looking { done, of }
            | Self::Tying { done, of }
            | Self::Trying { done, of, .. }
            | Self::Adjusting { done, of }
            | Self::Sizing { done, of }
            | Self::Snapping { done, of } => done as f64 / of.max(1) as f64,
            // These steps are short, or their length is not known.
            Self::Matched { .. } | Self::Gathering | Self::Refining => 0.0,
        }
    }
}

impl fmt::Display for AutocalibrationProgress {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match *self {
            Self::Looking { done, of } => {
                write!(
                    f,
                    "looking at frame {} of {}",
                    thousands(done),
                    thousands(of)
                )
            }
            Self::Tying { done, of } => write!(
                f,
                "matching pairs of frames, {} of {}",
                thousands(done),
                thousands(of)
            ),
            Self::Matched { ref frames, .. } => {
                let count = thousands(frames.len());
                write!(f, "{count} frames match each other")
            }
            Self::Gathering => f.write_str("collecting the painted lines"),
            Self::Refining => f.write_str("adjusting the base to the paint of every frame"),
            Self::Trying {
                places, done, of, ..
            } => {
                write!(
                    f,
                    "trying {} positions, round {} of {of}",
                    thousands(places),
                    (done + 1).min(of)
                )
            }
            Self::Adjusting { done, of } => {
                write!(
                    f,
                    "adjusting, {} of {} positions",
                    thousands(done),
                    thousands(of)
                )
            }
            Self::Sizing { done, of } => {
                write!(
                    f,
                    "trying other field sizes, {} of {} positions",
                    thousands(done),
                    thousands(of)
                )
            }
            Self::Snapping { done, of } => {
                write!(
                    f,
                    "aligning {} of {} frames",
                    thousands(done),
                    thousands(of)
                )
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::AutocalibrationProgress;

    #[test]
    fn progress_is_words_and_a_share() {
        let tying = AutocalibrationProgress::Tying {
            done: 1212,
            of: 4848,
        };
        assert_eq!(
            tying.to_string(),
            "matching pairs of frames, 1,212 of 4,848"
        );
        assert!((tying.share_of_step() - 0.25).abs() < 1e-12);
        let trying = AutocalibrationProgress::Trying {
            places: 304_425,
            done: 0,
            of: 5,
            panorama: None,
        };
        assert_eq!(trying.to_string(), "trying 304,425 positions, round 1 of 5");
        assert!(
            AutocalibrationProgress::Looking { done: 0, of: 0 }
                .share_of_step()
                .abs()
                < 1e-12
        );
    }
}
