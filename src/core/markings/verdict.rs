//! What the paint of a picture says about a camera, in a word.

/// With fewer open places of the lines the paint says nothing.
pub const FEWEST_OPEN: usize = 30;

/// A verdict is given where it is right with this probability.
const SUPPORTS: f64 = 0.9;

/// What the paint says about a camera.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum LineVerdict {
    /// The paint lies where the camera predicts it.
    Supports,
    /// The paint lies elsewhere.
    Contradicts,
    /// Too little paint is predicted or can be seen.
    CannotSay,
}

impl LineVerdict {
    /// What a score, the probability that the camera is right by the paint alone, says with this
    /// many open places.
    #[must_use]
    pub fn of(score: f64, open: usize) -> Self {
        match score {
            _ if open < FEWEST_OPEN => Self::CannotSay,
            score if score >= SUPPORTS => Self::Supports,
            score if score <= 1.0 - SUPPORTS => Self::Contradicts,
            _ => Self::CannotSay,
        }
    }
}
