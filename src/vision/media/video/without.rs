//! The same interface without OpenCV: opening a video is an error.

use super::{CountProgress, VideoInfo};
use crate::media::error::open_file;
use crate::media::{MediaError, Picture};
use std::convert::Infallible;
use std::path::Path;
use touchline_core::progress::Progress;

/// A video; without the feature `opencv` there is none.
#[derive(Debug)]
pub struct Video {
    none: Infallible,
}

impl Video {
    /// Says that this program reads no videos.
    ///
    /// # Errors
    /// Always: [`MediaError::NoVideoSupport`], or why the file cannot be read at all.
    pub fn open(path: &Path) -> Result<Self, MediaError> {
        open_file(path)?;
        Err(MediaError::NoVideoSupport { path: path.to_path_buf() })
    }

    /// Says that this program reads no videos.
    ///
    /// # Errors
    /// As [`Video::open`].
    pub fn open_with_progress(path: &Path, _progress: &Progress<'_, CountProgress>) -> Result<Self, MediaError> {
        Self::open(path)
    }

    /// What is known about the video.
    #[must_use]
    pub const fn info(&self) -> &VideoInfo {
        match self.none {}
    }

    /// The pixels of a frame.
    ///
    /// # Errors
    /// None, for there is no video.
    pub const fn frame(&mut self, _index: usize) -> Result<Picture, MediaError> {
        match self.none {}
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_message_says_what_to_do() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("match.mp4");
        assert_eq!(Video::open(&path).unwrap_err(), MediaError::Missing { path: path.clone() });
        std::fs::write(&path, "x").unwrap();
        let line = Video::open(&path).unwrap_err().to_string();
        let expected = "match.mp4: a video, but this program was built without video support; \
                        build it with the feature `opencv`, or extract the frames to a folder";
        assert!(line.ends_with(expected), "{line}");
    }
}
