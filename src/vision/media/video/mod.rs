//! Videos: frames by their index among the frames that decode.
//!
//! The index counts decoded frames, from 0. The container's own count is not used: edit lists,
//! truncated files and estimates from the duration make it wrong. Every frame is identified by its
//! time stamp, so frame N is the same picture however it is reached; where times go back, as in
//! recordings that were joined, frames are counted from the first one. A damaged frame in the
//! middle of a long video of constant rate keeps its index, and reading it is an error.

mod backend;
mod clock;
mod comb;
mod container;
mod decode;
mod ffmpeg;
mod ffprobe;
mod frame_times;
mod known;
#[cfg(feature = "opencv-videoio")]
mod opencv_capture;
mod player;
mod process;
mod sample_table;
mod survey;
#[cfg(test)]
mod times_only;

pub use backend::VideoBackend;
pub use clock::FrameClock;
pub use decode::Video;

use super::{MediaError, Notice, Picture};
use std::path::Path;
use std::sync::Arc;
use touchline_core::geometry::ImageSize;

/// The result of the survey of a video.
#[derive(Clone, Debug, PartialEq)]
pub struct VideoInfo {
    /// The video's file.
    pub path: Arc<Path>,
    /// The size of its frames as returned, upright and with square pixels, px.
    pub size: ImageSize,
    /// Clockwise rotation that was applied to the stored frames to make them upright, degrees: 0,
    /// 90, 180 or 270.
    pub rotation_deg: u32,
    /// The rate that the container states, frames a second.
    pub fps: f64,
    /// The number of frames that the container states.
    pub stated_frames: usize,
    /// The number of frames that decode.
    pub decoded_frames: usize,
    /// Whether the frames are interlaced: two fields taken one after the other. The pictures
    /// returned are interpolated from the first field alone.
    pub interlaced: bool,
    /// When each frame is shown.
    pub clock: FrameClock,
    /// Remarks for the user about this video.
    pub notices: Vec<Notice>,
}

impl VideoInfo {
    /// When a frame is shown, seconds from the stream's start; none beyond the last frame.
    pub fn pts_s(&self, index: usize) -> Option<f64> {
        (index < self.decoded_frames)
            .then(|| self.clock.pts_s(index))
            .flatten()
    }
}

/// Progress of counting a video's frames, if every frame must be visited.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct CountProgress {
    /// The video.
    pub path: Arc<Path>,
    /// Number of frames visited.
    pub counted: usize,
    /// Number of frames that the container states; 0 if it states none.
    pub stated: usize,
}

// The interface of a video backend: frame after frame with their times, and seeking near a time.
//
// Each backend implements it in a file of its own ([`super::VideoBackend`]). Numbering, seeking by
// index and surveying build on it and do not depend on the backend.

/// Properties that a container states about its video. Only the frames show whether they are true.
#[derive(Clone, Copy, Debug)]
struct StatedProperties {
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
fn turned_aspect(stored_aspect: f64, rotation_deg: u32) -> f64 {
    if rotation_deg % 180 == 90 {
        stored_aspect.recip()
    } else {
        stored_aspect
    }
}

/// An open video; its position is the last frame grabbed.
trait Capture: Send {
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
