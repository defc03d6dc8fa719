//! Suggestions and the user's decisions about them, one at a time and several together, by actions
//! as the window sends them. How suggestions are made is tested in `touchline-calibration`.

mod batches_in_app;
mod gallery_in_app;
pub mod proposals_in_app;
mod quality_in_app;
pub mod review_in_app;
mod stretch_in_app;
mod suggestions_in_app;
