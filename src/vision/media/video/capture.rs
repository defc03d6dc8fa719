//! An open video as it is played: frame after frame with their times, and moved near a time.
//!
//! Two ways of reading a video keep this contract, each in a file of its own: the user's `ffmpeg` program, and OpenCV where it
//! is built in with its video module. Numbering frames, jumping and surveying stand above it and know neither.

use super::ffmpeg::{FfmpegCapture, Output, ffmpeg};
#[cfg(feature = "opencv-videoio")]
use super::opencv_capture::OpenCvCapture;
use crate::media::{MediaError, Picture};
use std::fmt;
use std::path::Path;
use touchline_core::geometry::ImageSize;

/// A way of reading videos. All give the same frames under the same numbers.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub enum VideoBackend {
    /// The program `ffmpeg` of this machine.
    Ffmpeg,
    /// OpenCV's video module, where this program was built with it.
    OpenCv,
}

impl VideoBackend {
    /// Those that this machine and this program have, the preferred one first.
    pub fn available() -> impl Iterator<Item = Self> {
        let ffmpeg = ffmpeg().map(|_| Self::Ffmpeg);
        ffmpeg.into_iter().chain(cfg!(feature = "opencv-videoio").then_some(Self::OpenCv))
    }
}

impl fmt::Display for VideoBackend {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Ffmpeg => write!(f, "ffmpeg {}", ffmpeg().map_or("", |program| &program.version)),
            Self::OpenCv => f.write_str("OpenCV"),
        }
    }
}

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

    /// The time stamp of the frame that was grabbed last, s from the stream's start; none where it is not known.
    fn time_s(&self) -> Option<f64>;

    /// Moves so that the next [`Capture::grab`] gives a frame near a time; which one, its time stamp tells.
    fn jump_near(&mut self, time_s: f64);

    /// The pixels of the frame that was grabbed last; `index` is its number, for the error.
    fn picture(&mut self, index: usize) -> Result<Picture, MediaError>;
}

/// Opens a video, before its first frame.
pub(super) fn open_capture(path: &Path, backend: VideoBackend) -> Result<Box<dyn Capture>, MediaError> {
    match backend {
        VideoBackend::Ffmpeg => Ok(Box::new(FfmpegCapture::open(path, Output::Pictures)?)),
        #[cfg(feature = "opencv-videoio")]
        VideoBackend::OpenCv => Ok(Box::new(OpenCvCapture::open(path)?)),
        #[cfg(not(feature = "opencv-videoio"))]
        VideoBackend::OpenCv => Err(MediaError::NoVideoSupport { path: path.to_path_buf() }),
    }
}

/// Opens a video for the times of its frames. It may have no pictures.
pub(super) fn open_times(path: &Path, backend: VideoBackend) -> Result<Box<dyn Capture>, MediaError> {
    match backend {
        VideoBackend::Ffmpeg => Ok(Box::new(FfmpegCapture::open(path, Output::Times)?)),
        VideoBackend::OpenCv => open_capture(path, backend),
    }
}

/// The number of stored frames, decodable or not, read without decoding; none where they cannot be read so. `count` is called
/// with the number so far and may end it.
pub(super) fn count_packets(
    path: &Path,
    backend: VideoBackend,
    count: &mut dyn FnMut(usize) -> Result<(), MediaError>,
) -> Result<Option<usize>, MediaError> {
    match backend {
        VideoBackend::Ffmpeg => super::ffmpeg::count_packets(path, count),
        #[cfg(feature = "opencv-videoio")]
        VideoBackend::OpenCv => {
            let Ok(mut capture) = OpenCvCapture::open_packets(path) else { return Ok(None) };
            let mut packets = 0;
            while capture.grab()? {
                packets += 1;
                count(packets)?;
            }
            Ok(Some(packets))
        }
        #[cfg(not(feature = "opencv-videoio"))]
        VideoBackend::OpenCv => Ok(None),
    }
}
