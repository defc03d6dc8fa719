//! Video backends, and opening a video with one: the user's `ffmpeg` program, and OpenCV if it is
//! built in with its video module.

use super::Capture;
use super::container::Container;
use super::ffmpeg::{FfmpegCapture, Output, ffmpeg};
use super::ffprobe::{self, Stream};
#[cfg(feature = "opencv-videoio")]
use super::opencv_capture::OpenCvCapture;
use crate::media::MediaError;
use std::fmt;
use std::path::Path;

/// A video backend. All give the same frames under the same indices.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub enum VideoBackend {
    /// The program `ffmpeg` of this machine.
    Ffmpeg,
    /// OpenCV's video module, where this program was built with it.
    OpenCv,
}

impl VideoBackend {
    /// The backends that this machine and this build have, the preferred one first.
    pub fn available() -> impl Iterator<Item = Self> {
        let ffmpeg = ffmpeg().map(|_| Self::Ffmpeg);
        ffmpeg
            .into_iter()
            .chain(cfg!(feature = "opencv-videoio").then_some(Self::OpenCv))
    }
}

impl fmt::Display for VideoBackend {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Ffmpeg => write!(
                f,
                "ffmpeg {}",
                ffmpeg().map_or("", |program| &program.version)
            ),
            Self::OpenCv => f.write_str("OpenCV"),
        }
    }
}

/// A video as its backend describes it. It can be opened any number of times without being described
/// again.
#[derive(Clone, Copy, Debug)]
pub(super) enum DescribedVideo {
    /// By `ffprobe`.
    Ffmpeg(Stream),
    /// OpenCV describes a video as it opens it.
    #[cfg(feature = "opencv-videoio")]
    OpenCv,
}

impl DescribedVideo {
    /// Describes a video with a backend.
    ///
    /// # Errors
    /// The file is no video, or the backend is not available.
    pub fn new(
        path: &Path,
        container: Container,
        backend: VideoBackend,
    ) -> Result<Self, MediaError> {
        match backend {
            VideoBackend::Ffmpeg => {
                ffmpeg().ok_or_else(|| MediaError::no_video_support(path))?;
                Ok(Self::Ffmpeg(Stream::probe(path, container.demuxer)?))
            }
            #[cfg(feature = "opencv-videoio")]
            VideoBackend::OpenCv => Ok(Self::OpenCv),
            #[cfg(not(feature = "opencv-videoio"))]
            VideoBackend::OpenCv => Err(MediaError::no_video_support(path)),
        }
    }

    /// Opens the video, before its first frame.
    ///
    /// # Errors
    /// The file cannot be read, or the backend is gone.
    pub fn open(self, path: &Path) -> Result<Box<dyn Capture>, MediaError> {
        self.open_for(path, Output::Pictures)
    }

    /// Opens the video for the times of its frames. It may have no pictures.
    ///
    /// # Errors
    /// As [`Self::open`].
    pub fn open_times(self, path: &Path) -> Result<Box<dyn Capture>, MediaError> {
        self.open_for(path, Output::Times)
    }

    fn open_for(self, path: &Path, output: Output) -> Result<Box<dyn Capture>, MediaError> {
        match self {
            Self::Ffmpeg(stream) => Ok(Box::new(FfmpegCapture::open(path, stream, output)?)),
            #[cfg(feature = "opencv-videoio")]
            Self::OpenCv => Ok(Box::new(OpenCvCapture::open(path)?)),
        }
    }

    /// The number of stored frames, decodable or not, read without decoding; `None` if the backend
    /// cannot count them. `count` is called with the number so far and may stop it.
    ///
    /// # Errors
    /// Those of `count`.
    pub fn count_packets(
        self,
        path: &Path,
        count: &mut dyn FnMut(usize) -> Result<(), MediaError>,
    ) -> Result<Option<usize>, MediaError> {
        match self {
            Self::Ffmpeg(stream) => ffprobe::count_packets(path, stream.demuxer, count),
            #[cfg(feature = "opencv-videoio")]
            Self::OpenCv => {
                let Ok(mut capture) = OpenCvCapture::open_packets(path) else {
                    return Ok(None);
                };
                let mut packets = 0;
                while capture.grab()? {
                    packets += 1;
                    count(packets)?;
                }
                Ok(Some(packets))
            }
        }
    }
}
