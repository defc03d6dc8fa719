//! The verdict of a picture's paint on a camera.

/// The minimum number of unoccluded line samples for a verdict.
pub const FEWEST_OPEN: usize = 30;

/// Minimum probability for a verdict, on either side.
const SUPPORTS: f64 = 0.9;

/// The verdict of the paint on a camera; a less favourable one is less.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub enum LineVerdict {
    /// The paint lies elsewhere.
    Contradicts,
    /// Too little paint is predicted or visible.
    CannotSay,
    /// The paint lies where the camera predicts it.
    Supports,
}

impl LineVerdict {
    /// The verdict from a score (the probability, by the paint alone, that the camera is right) and
    /// the number of unoccluded line samples.
    pub fn from_score(score: f64, open: usize) -> Self {
        // A score of NaN reaches the last arm: it says nothing.
        match score {
            _ if open < FEWEST_OPEN => Self::CannotSay,
            score if score >= SUPPORTS => Self::Supports,
            score if score <= 1.0 - SUPPORTS => Self::Contradicts,
            _ => Self::CannotSay,
        }
    }
}
