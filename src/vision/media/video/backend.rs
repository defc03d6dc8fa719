//! Video backends, and opening a video with one: the user's `ffmpeg` program, and OpenCV if it is
//! built in with its video module.

use super::capture::Capture;
use super::ffmpeg::{self, FfmpegCapture, Output, ffmpeg};
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

/// Opens a video, before its first frame.
pub(super) fn open_capture(
    path: &Path,
    backend: VideoBackend,
) -> Result<Box<dyn Capture>, MediaError> {
    match backend {
        VideoBackend::Ffmpeg => Ok(Box::new(FfmpegCapture::open(path, Output::Pictures)?)),
        #[cfg(feature = "opencv-videoio")]
        VideoBackend::OpenCv => Ok(Box::new(OpenCvCapture::open(path)?)),
        #[cfg(not(feature = "opencv-videoio"))]
        VideoBackend::OpenCv => Err(MediaError::NoVideoSupport {
            path: path.to_path_buf(),
        }),
    }
}

/// Opens a video for the times of its frames. It may have no pictures.
pub(super) fn open_times(
    path: &Path,
    backend: VideoBackend,
) -> Result<Box<dyn Capture>, MediaError> {
    match backend {
        VideoBackend::Ffmpeg => Ok(Box::new(FfmpegCapture::open(path, Output::Times)?)),
        VideoBackend::OpenCv => open_capture(path, backend),
    }
}

/// The number of stored frames, decodable or not, read without decoding; `None` if the backend
/// cannot count them. `count` is called with the number so far and may stop it.
pub(super) fn count_packets(
    path: &Path,
    backend: VideoBackend,
    count: &mut dyn FnMut(usize) -> Result<(), MediaError>,
) -> Result<Option<usize>, MediaError> {
    match backend {
        VideoBackend::Ffmpeg => ffmpeg::count_packets(path, count),
        #[cfg(feature = "opencv-videoio")]
        VideoBackend::OpenCv => {
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
        #[cfg(not(feature = "opencv-videoio"))]
        VideoBackend::OpenCv => Ok(None),
    }
}
