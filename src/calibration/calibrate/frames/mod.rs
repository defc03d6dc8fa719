//! Single frames of a document solved with a known base: what a document contributes to a solve,
//! which camera took a frame, and how many frames are solved at once. A proposed camera can be a
//! prior. The base itself is estimated in `base`.

pub mod better_camera;
pub mod calibration;
pub mod frame_lookup;
mod from_proposal;
pub mod own_covariance;
pub mod solve_all;
pub mod solve_frames;
pub mod which_camera;
