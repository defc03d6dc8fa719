//! The base of a camera from the clicks and the painted lines of its frames. The frames that have
//! no clicks follow when a base has changed. The mathematics is in `touchline_core::solve`; here
//! documents become its problems, and its results are written back.

pub mod after_merge;
pub mod base_estimation;
pub mod base_on_paint;
pub mod follow_base;
pub mod known_frames;
pub mod on_paint;
pub mod own_cameras;
pub mod paint_observations;
pub mod refit;
pub mod size_on_paint;
