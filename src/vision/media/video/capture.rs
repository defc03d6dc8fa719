//! The interface of a video backend: frame after frame with their times, and seeking near a time.
//!
//! Each backend implements it in a file of its own ([`VideoBackend`](super::VideoBackend)).
//! Numbering, seeking by index and surveying build on it and do not depend on the backend.

use crate::media::{MediaError, Picture};
use touchline_core::geometry::ImageSize;

/// Properties that a container states about its video. Only the frames show whether they are true.
#[derive(Clone, Copy, Debug)]
pub(super) struct StatedProperties {
    /// The size of the frames as they are returned, px.
    pub size: ImageSize,
    /// Clockwise rotation of the stored frames, degrees: 0, 90, 180 or 270.
    pub rotation_deg: u32,
    /// The rate, frames a second; 25 where the container states none.
    pub fps: f64,
    /// The number of frames; 0 where the container states none.
    pub frames: usize,
    /// The width of a pixel over its height; 1 where the container states none.
    pub pixel_aspect: f64,
}

/// The width of a pixel over its height in the frames as they are returned: pixels of frames that a
/// quarter turn sets upright lie on their side.
pub(super) fn turned_aspect(stored_aspect: f64, rotation_deg: u32) -> f64 {
    if rotation_deg % 180 == 90 {
        stored_aspect.recip()
    } else {
        stored_aspect
    }
}

/// An open video; its position is the last frame grabbed.
pub(super) trait Capture: Send {
    /// Properties that the container states.
    fn stated_properties(&self) -> &StatedProperties;

    /// Goes to the next frame that decodes; false at the end.
    ///
    /// # Errors
    /// The reader failed, so this is not the end.
    fn grab(&mut self) -> Result<bool, MediaError>;

    /// The time stamp of the frame that was grabbed last, s from the stream's start; none where it
    /// is not known.
    fn time_s(&self) -> Option<f64>;

    /// Goes back to before the first frame.
    ///
    /// # Errors
    /// The file cannot be opened again.
    fn restart(&mut self) -> Result<(), MediaError>;

    /// Seeks so that the next [`Capture::grab`] gives a frame near a time; its time stamp tells
    /// which.
    fn jump_near(&mut self, time_s: f64);

    /// The pixels of the frame that was grabbed last; `index` is its number, for the error.
    fn picture(&mut self, index: usize) -> Result<Picture, MediaError>;
}
