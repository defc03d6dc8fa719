//! The sampled frames, matched with each other: stages 1 to 3.

pub mod by_shot;
pub mod matched_frames;
pub mod panorama;
pub mod rotations_by_focal_scale;
pub mod sampled_frames;
