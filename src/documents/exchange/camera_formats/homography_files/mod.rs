//! Homographies: those of the World Cup 2014 set, those of the TS-WorldCup set, and JSON lines that
//! state their conventions.
//!
//! H denotes a map from picture to ground in the sets and elsewhere the opposite one, so each file
//! here says which it reads and writes. A homography has neither distortion nor points off the
//! ground: unless the user asks for `undistorted`, the one that fits best over the visible pitch is
//! written, and its error is reported.

mod ground_homography;
mod homography_lines;
mod world_cup_sets;

pub use homography_lines::HomographyLines;
pub use world_cup_sets::{TsWorldCup, Wc14, template_from_ground};
