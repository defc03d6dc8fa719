//! Ridges of paint along the normal of a predicted line, in one picture. A profile of brightness or
//! colour is read across the line, and a ridge is found where it rises and falls as paint does.
//! Floors of wood, plastic or ice have a search of their own. What the ridges say about a camera is
//! decided in `camera_alignment`.

mod colours;
pub mod contrast;
mod floor_ridge;
pub mod profile;
pub mod ridge;
