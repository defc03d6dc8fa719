//! What is known of a frame's camera before its clicks are used: the plausible ranges of pan, tilt
//! and focal length, a prior around a proposal, and the motion between neighbouring frames.
//! [`prior::SolveContext`] collects these for one solve. Observations are not priors and are kept
//! apart.

pub mod motion_prior;
pub mod prior;
