//! Videos: frames by their index among the frames that decode.
//!
//! The index counts decoded frames, from 0. The container's own count is not used: edit lists,
//! truncated files and estimates from the duration make it wrong. Every frame is identified by its
//! time stamp, so frame N is the same picture however it is reached; where times go back, as in
//! recordings that were joined, frames are counted from the first one. A damaged frame in the
//! middle of a long video of constant rate keeps its index, and reading it is an error.

mod backend;
mod capture;
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
mod write;

pub use backend::VideoBackend;
pub use clock::FrameClock;
pub use decode::Video;
pub use write::VideoWriter;

use super::Notice;
use capture::{Capture, StatedProperties, turned_aspect};
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
