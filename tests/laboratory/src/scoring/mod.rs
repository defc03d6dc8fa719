//! The answers of a method to test frames and how they are scored: errors, overlays in px, coverage
//! by the references, and a sheet of pictures that shows right and wrong answers. The two kinds of
//! forests that answer are trained here. Which frames are asked is decided by each study.

pub mod answers;
pub mod coverage;
pub mod forests;
pub mod overlays;
pub mod sheet;
