//! What fetches frames, keeping videos open between calls.

use super::{FrameRef, MediaError, Picture, Video, VideoInfo, load_image};
use std::path::Path;

/// Fetches frames of images and videos. Belongs to one thread: a video's decoder stands at one place at a time.
#[derive(Default)]
pub struct FrameReader {
    /// The videos used last, the latest at the end.
    videos: Vec<Video>,
}

/// How many videos stay open: each holds a decoder with some twenty reference frames.
const OPEN_VIDEOS: usize = 2;

impl FrameReader {
    /// A reader with nothing open.
    #[must_use]
    pub fn new() -> Self {
        Self::default()
    }

    /// The pixels of a frame.
    ///
    /// # Errors
    /// Those of [`load_image`], [`Video::open`] and [`Video::frame`].
    pub fn read(&mut self, frame: &FrameRef) -> Result<Picture, MediaError> {
        match frame {
            FrameRef::Image(path) => load_image(path),
            FrameRef::Video { path, index } => self.video(path)?.frame(*index),
        }
    }

    /// What is known about a video; it is opened if it is not open already.
    ///
    /// # Errors
    /// Those of [`Video::open`].
    pub fn video_info(&mut self, path: &Path) -> Result<&VideoInfo, MediaError> {
        Ok(self.video(path)?.info())
    }

    fn video(&mut self, path: &Path) -> Result<&mut Video, MediaError> {
        let video = match self.videos.iter().position(|video| *video.info().path == *path) {
            Some(at) => self.videos.remove(at),
            None => Video::open(path)?,
        };
        if self.videos.len() >= OPEN_VIDEOS {
            self.videos.remove(0);
        }
        Ok(self.videos.push_mut(video))
    }
}
