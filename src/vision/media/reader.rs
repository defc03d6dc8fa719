//! Reading frames, with videos kept open between calls.

use super::{CountProgress, FrameRef, MediaError, Notice, Picture, Video, VideoInfo, load_image};
use std::collections::BTreeMap;
use std::path::Path;
use std::sync::Arc;
use touchline_core::progress::Progress;

/// A reader of frames: a [`FrameReader`], or a fake in tests.
pub trait ReadFrames {
    /// The pixels of a frame.
    ///
    /// # Errors
    /// The frame cannot be read.
    fn read(&mut self, frame: &FrameRef) -> Result<Picture, MediaError>;

    /// The pixels of a frame that will hardly be read again: a reader that keeps pictures does not
    /// keep this one.
    ///
    /// # Errors
    /// The frame cannot be read.
    fn read_in_passing(&mut self, frame: &FrameRef) -> Result<Picture, MediaError> {
        self.read(frame)
    }

    /// Remarks for the user about the videos opened since the last call.
    fn take_notices(&mut self) -> Vec<Notice> {
        Vec::new()
    }
}

impl<R: ReadFrames + ?Sized> ReadFrames for &mut R {
    fn read(&mut self, frame: &FrameRef) -> Result<Picture, MediaError> {
        (**self).read(frame)
    }

    fn read_in_passing(&mut self, frame: &FrameRef) -> Result<Picture, MediaError> {
        (**self).read_in_passing(frame)
    }

    fn take_notices(&mut self) -> Vec<Notice> {
        (**self).take_notices()
    }
}

/// Reads frames of images and videos. Use one per thread, because the decoder of a video has one
/// read position.
pub struct FrameReader {
    /// The videos used last, the latest at the end.
    videos: Vec<Video>,
    /// The remarks about each video when it was opened last.
    noticed: BTreeMap<Arc<Path>, Vec<Notice>>,
    notices: Vec<Notice>,
    /// Receives the progress of counting a video's frames, from 0 for each video.
    counting: Progress<'static, CountProgress>,
}

/// Number of videos kept open: each has a decoder with about twenty reference frames.
const OPEN_VIDEOS: usize = 2;

impl Default for FrameReader {
    fn default() -> Self {
        Self::with_progress(Progress::default())
    }
}

impl FrameReader {
    /// A reader with nothing open.
    pub fn new() -> Self {
        Self::default()
    }

    /// A reader that reports to `counting` while it counts the frames of a video: see
    /// [`Video::open_with_progress`]. If that cancels, the video is not opened; the next read tries
    /// again.
    pub fn with_progress(counting: Progress<'static, CountProgress>) -> Self {
        Self {
            videos: Vec::new(),
            noticed: BTreeMap::new(),
            notices: Vec::new(),
            counting,
        }
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

    /// Remarks for the user about the videos opened since the last call; those about a video come
    /// once, and again if it was replaced by one that needs others.
    pub fn take_notices(&mut self) -> Vec<Notice> {
        std::mem::take(&mut self.notices)
    }

    /// The survey of a video, which is opened if necessary.
    ///
    /// # Errors
    /// Those of [`Video::open`].
    pub fn video_info(&mut self, path: &Path) -> Result<&VideoInfo, MediaError> {
        Ok(self.video(path)?.info())
    }

    /// A video, opened if it is not open or its file has been replaced. It becomes the latest one;
    /// beyond [`OPEN_VIDEOS`] the one not used for longest is closed.
    fn video(&mut self, path: &Path) -> Result<&mut Video, MediaError> {
        // It is taken out of the list even if it is open, so that it returns to the end. The
        // progress is renewed because a cancelled one stays cancelled, and the next read tries
        // again.
        let at = self
            .videos
            .iter()
            .position(|video| *video.info().path == *path);
        let open = at.map(|at| self.videos.remove(at));
        let video = match open.filter(|video| !video.is_replaced()) {
            Some(video) => video,
            None => Video::open_with_progress(path, &self.counting.renew())?,
        };
        self.note_remarks(video.info());
        if self.videos.len() >= OPEN_VIDEOS {
            self.videos.remove(0);
        }
        Ok(self.videos.push_mut(video))
    }

    /// Notes the remarks about a video unless they are those of the last time.
    fn note_remarks(&mut self, info: &VideoInfo) {
        if self.noticed.get(&info.path) != Some(&info.notices) {
            self.notices.extend(info.notices.iter().cloned());
            self.noticed
                .insert(Arc::clone(&info.path), info.notices.clone());
        }
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

#[cfg(test)]
mod tests {
    use super::*;
    use crate::media::FrameClock;
    use touchline_core::geometry::ImageSize;

    #[test]
    fn remarks_come_once_and_again_where_a_video_was_replaced() {
        let path: Arc<Path> = Arc::from(Path::new("match.mp4"));
        let mut info = VideoInfo {
            path: Arc::clone(&path),
            size: ImageSize::new(64, 36),
            rotation_deg: 0,
            fps: 25.0,
            stated_frames: 9,
            decoded_frames: 9,
            interlaced: true,
            clock: FrameClock::Even {
                first_s: 0.0,
                fps: 25.0,
            },
            notices: vec![Notice::Interlaced {
                path: path.to_path_buf(),
            }],
        };
        let mut reader = FrameReader::new();
        reader.note_remarks(&info);
        reader.note_remarks(&info);
        assert_eq!(reader.take_notices(), info.notices);
        info.notices = vec![Notice::NoJumping {
            path: path.to_path_buf(),
        }];
        reader.note_remarks(&info);
        assert_eq!(reader.take_notices(), info.notices);
        reader.note_remarks(&info);
        assert_eq!(reader.take_notices(), []);
    }
}
