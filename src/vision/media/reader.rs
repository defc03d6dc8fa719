//! Reading frames, with videos kept open between calls.

use super::{CountProgress, FrameRef, MediaError, Notice, Picture, Video, VideoInfo, load_image};
use std::collections::BTreeSet;
use std::ops::ControlFlow;
use std::path::Path;
use std::sync::Arc;

/// Whatever fetches frames: a [`FrameReader`], or a test's stand-in for one.
pub trait ReadFrames {
    /// The pixels of a frame.
    ///
    /// # Errors
    /// The frame cannot be had.
    fn read(&mut self, frame: &FrameRef) -> Result<Picture, MediaError>;

    /// What the user should know about the videos opened since the last call.
    fn take_notices(&mut self) -> Vec<Notice> {
        Vec::new()
    }
}

/// Asked now and then while the frames of a video are counted.
type CountWatch = Box<dyn FnMut(CountProgress) -> ControlFlow<()>>;

/// Fetches frames of images and videos. Belongs to one thread: a video's decoder stands at one place at a time.
pub struct FrameReader {
    /// The videos used last, the latest at the end.
    videos: Vec<Video>,
    /// The videos whose notices have been given.
    noticed: BTreeSet<Arc<Path>>,
    notices: Vec<Notice>,
    watch: CountWatch,
}

/// How many videos stay open: each holds a decoder with some twenty reference frames.
const OPEN_VIDEOS: usize = 2;

impl Default for FrameReader {
    fn default() -> Self {
        Self::watched(Box::new(|_| ControlFlow::Continue(())))
    }
}

impl FrameReader {
    /// A reader with nothing open.
    #[must_use]
    pub fn new() -> Self {
        Self::default()
    }

    /// A reader that reports the progress of counting a video's frames to `watch`, which may stop it: see
    /// [`Video::open_watched`].
    #[must_use]
    pub fn watched(watch: CountWatch) -> Self {
        Self { videos: Vec::new(), noticed: BTreeSet::new(), notices: Vec::new(), watch }
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

    /// What the user should know about the videos opened since the last call, once for each video.
    pub fn take_notices(&mut self) -> Vec<Notice> {
        std::mem::take(&mut self.notices)
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
            None => Video::open_watched(path, &mut self.watch)?,
        };
        if self.noticed.insert(Arc::clone(&video.info().path)) {
            self.notices.extend(video.info().notices.iter().cloned());
        }
        if self.videos.len() >= OPEN_VIDEOS {
            self.videos.remove(0);
        }
        Ok(self.videos.push_mut(video))
    }
}

impl ReadFrames for FrameReader {
    fn read(&mut self, frame: &FrameRef) -> Result<Picture, MediaError> {
        Self::read(self, frame)
    }

    fn take_notices(&mut self) -> Vec<Notice> {
        Self::take_notices(self)
    }
}
