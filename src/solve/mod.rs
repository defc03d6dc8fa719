//! From observations to parameters: one problem a file.
//!
//! [`Observation`] says what a click shows: a landmark, or a line on which it lies. [`FrameSolution`] is what a frame's
//! clicks and a known base say about pan, tilt and focal length, with everything a person must know to trust it.

mod covariance;
mod error;
mod line;
mod observation;
mod solution;
mod verdict;
mod warning;

pub use covariance::Uncertainty;
pub use error::{ObservationError, SolveError};
pub use observation::{Observation, Target, WorldCurve};
pub use solution::{Candidate, CheckResult, ClickResidual, FrameSolution, Loss, PtzRanges, SolveContext};
pub use verdict::{Judgement, Verdict, judge};
pub use warning::{UnknownWarningCode, Warning, WarningCode};
