//! An open video as it is played: frame after frame with their times, and moved near a time.
//!
//! Each way of reading videos keeps this contract in a file of its own ([`super::VideoBackend`]).
//! Numbering frames, jumping and surveying stand above it and know none of them.

use crate::media::{MediaError, Picture};
use touchline_core::geometry::ImageSize;

/// What a container states about its video. Only its frames tell whether it is true.
#[derive(Clone, Copy, Debug)]
pub(super) struct StatedProperties {
    /// The size of the frames as they are returned, px.
    pub size: ImageSize,
    /// By how much the stored frames are turned clockwise, degrees: 0, 90, 180 or 270.
    pub rotation_deg: u32,
    /// The rate, frames a second; 25 where the container states none.
    pub fps: f64,
    /// The number of frames; 0 where the container states none.
    pub frames: usize,
    /// The width of a pixel over its height; 1 where the container states none.
    pub pixel_aspect: f64,
}

/// An open video, standing at the frame that was grabbed last.
pub(super) trait Capture: Send {
    /// What the container states.
    fn stated(&self) -> &StatedProperties;

    /// Goes to the next frame that decodes; false at the end.
    ///
    /// # Errors
    /// What reads the video broke down, so that this is not the end.
    fn grab(&mut self) -> Result<bool, MediaError>;

    /// The time stamp of the frame that was grabbed last, s from the stream's start; none where it
    /// is not known.
    fn time_s(&self) -> Option<f64>;

    /// Moves so that the next [`Capture::grab`] gives a frame near a time; which one, its time
    /// stamp tells.
    fn jump_near(&mut self, time_s: f64);

    /// The pixels of the frame that was grabbed last; `index` is its number, for the error.
    fn picture(&mut self, index: usize) -> Result<Picture, MediaError>;
}
