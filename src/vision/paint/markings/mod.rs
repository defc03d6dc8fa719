//! Marking pixels: pixels that look like paint, whatever the camera is. They are found in one
//! picture, or in many frames of a rotating camera, where paint keeps its direction. Scores compare
//! them with the lines that a camera predicts. Aligning that camera is not done here.

pub mod agreement;
pub mod evidence;
pub mod marking_pixels;
pub mod persistent;
pub mod straight_lines;
