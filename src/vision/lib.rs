//! What a computer sees in the pictures of a pan-tilt-zoom camera. OpenCV, where it is compiled in,
//! is called only here.
//!
//! | floor | rooms |
//! |---|---|
//! | 4 | [`relocalize`] (the pan-tilt forest, pose from its rays), [`paint`] (painted lines in pixels: the line check, snapping), [`track`] (frames of one camera matched to each other under rotation and zoom), [`synthetic`] (drawn matches with exact truth) |
//! | 3 | [`features`] (SIFT of a picture) |
//! | 1 | [`media`] (frames of folders and videos) |

pub mod features;
pub mod media;
pub mod paint;
pub mod relocalize;
pub mod synthetic;
#[cfg(any(test, feature = "testing"))]
#[doc(hidden)]
pub mod testing;
pub mod track;
