//! Homographies: those of the World Cup 2014 set, those of the TS-WorldCup set, JSON lines that
//! state their conventions, and tables that do not.
//!
//! H denotes a map from picture to ground in the sets and elsewhere the opposite one, so each file
//! here says which it reads and writes. A homography has neither distortion nor points off the
//! ground: unless the user asks for `undistorted`, the one that fits best over the visible pitch is
//! written, and its error is reported.

mod ground_homography;
mod ground_plan;
mod homography_lines;
mod homography_tables;
mod world_cup_sets;

pub use homography_lines::HomographyLines;
pub use homography_tables::HomographyTables;
pub use world_cup_sets::{TsWorldCup, Wc14, template_from_ground};
