//! Where the refinement of a frame starts: cameras that a few observations determine in closed
//! form, or for each focal length of a sweep. One and two points, pairs on drawn lines, and four
//! landmarks on a plane are minimal problems of this kind. The best start is chosen by refining all
//! of them, which happens elsewhere.

pub mod focal_sweep;
pub mod line_pairs;
pub mod one_point;
pub mod plane_pose;
pub mod starts;
pub mod two_point;
