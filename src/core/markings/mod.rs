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
mod landmarks;
mod lines;
mod samples;
mod verdict;
mod window;

pub use verdict::LineVerdict;
// For the crates above alone: no promise to other programs.
#[doc(hidden)]
pub use {
    ground::visible_ground,
    landmarks::{ProjectedLandmark, project_landmarks},
    lines::{MarkingOptions, MarkingPolyline, project_lines},
    samples::{LineSample, ProjectedLine, SampleOptions, detectability, sample_lines},
    verdict::FEWEST_OPEN,
};
