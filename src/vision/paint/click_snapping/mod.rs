//! Click snapping: a placed point moves to the painted corner, crossing or point marking that it
//! means. The place is found by least squares over the ridges nearby, with its sigma. Whole cameras
//! are aligned in `camera_alignment`.

mod crossing;
mod drawn_spot;
pub mod placed_point;
pub mod point;
mod spot;
