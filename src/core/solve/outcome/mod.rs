//! The result of solving a frame, and how far it is to be trusted: covariance, residuals, warnings
//! that the user should check, and the verdict with its reason. Nothing here moves the camera.
//! Errors, where there is no result at all, are in `error.rs`.

pub mod checks;
pub mod covariance;
pub mod solution;
pub mod verdict;
