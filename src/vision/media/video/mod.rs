//! Videos: frames by their number among the decoded frames.
//!
//! A frame's number counts the frames that decode, from 0. The container's own count is not used:
//! edit lists, cut-off files and duration-based estimates make it wrong. Every frame is known by
//! its time stamp, so that frame N is the same picture however it is reached. A damaged frame in
//! the middle of a long video of even rate keeps its number and is an error when it is asked for.

mod backend;
mod capture;
mod clock;
mod comb;
mod decode;
mod ffmpeg;
mod known;
#[cfg(feature = "opencv-videoio")]
mod opencv_capture;
mod player;
mod sample_table;
mod survey;

pub use backend::VideoBackend;
pub use clock::FrameClock;
pub use decode::Video;

use super::Notice;
use std::path::Path;
use std::sync::Arc;
use touchline_core::geometry::ImageSize;

/// What is known about a video once it has been opened.
#[derive(Clone, Debug, PartialEq)]
pub struct VideoInfo {
    /// The video's file.
    pub path: Arc<Path>,
    /// The size of its frames as they are returned, turned upright, px.
    pub size: ImageSize,
    /// By how much the stored frames were turned clockwise to stand upright, degrees: 0, 90, 180 or
    /// 270.
    pub rotation_deg: u32,
    /// The rate that the container states, frames a second.
    pub fps: f64,
    /// The number of frames that the container states.
    pub stated_frames: usize,
    /// The number of frames that decode.
    pub decoded_frames: usize,
    /// The frames are interlaced: two fields taken one after the other. What is returned is made of
    /// the first field alone.
    pub interlaced: bool,
    /// When each frame is shown.
    pub clock: FrameClock,
    /// What the user should know about this video.
    pub notices: Vec<Notice>,
}

impl VideoInfo {
    /// When a frame is shown, seconds from the stream's start; none beyond the last frame.
    #[must_use]
    pub fn pts_s(&self, index: usize) -> Option<f64> {
        (index < self.decoded_frames)
            .then(|| self.clock.pts_s(index))
            .flatten()
    }
}

/// How far the numbering of a video's frames has come, where every one of them must be visited.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct CountProgress {
    /// The video.
    pub path: Arc<Path>,
    /// How many frames have been visited.
    pub counted: usize,
    /// How many frames the container states; 0 where it states none.
    pub stated: usize,
}
