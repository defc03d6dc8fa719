//! The field's markings as a camera sees them: projected, clipped, ready to draw.
//!
//! [`project_lines`] projects every line, circle, arc and post of a field to polylines in px, exact
//! to a stated tolerance, crown and distortion included. They are clipped at the near plane, at the
//! fold of the distortion and at the picture's border, so that a point behind the camera never
//! causes a stray line. [`sample_lines`] gives points along the painted lines with their normals
//! and the paint's width, for detecting the paint in the picture.
//!
//! Frames, signs and units: [`crate::conventions`].

mod clip;
mod flatten;
mod ground;
mod lines;
mod samples;

// For the crates above alone: no promise to other programs.
#[doc(hidden)]
pub use {
    ground::visible_ground,
    lines::{MarkingOptions, MarkingPolyline, ProjectedLandmark, project_landmarks, project_lines},
    samples::{LineSample, ProjectedLine, SampleOptions, detectability, sample_lines},
};

/// The minimum number of unoccluded line samples for a verdict.
#[doc(hidden)]
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
