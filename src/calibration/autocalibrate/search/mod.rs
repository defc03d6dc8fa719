//! The pose of the panorama on the field: stages 4 and 5.

pub mod bright_markings;
pub mod clicked;
pub mod exhaustive;
pub mod focal_scales;
pub mod painted_curves;
pub mod panorama_fit;
pub mod pitch_map;
pub mod places;
pub mod pose;
pub mod pose_score;
