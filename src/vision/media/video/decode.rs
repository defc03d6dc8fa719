//! An open video and its frames by index.

use super::backend::VideoBackend;
use super::comb::first_field;
use super::known::{FileState, find_or_survey};
use super::player::Player;
use super::survey::{Survey, survey};
use super::{CountProgress, VideoInfo};
use crate::media::{MediaError, Picture};
use std::path::Path;
use touchline_core::geometry::ImageSize;
use touchline_core::progress::Progress;

/// An open video. It has one read position; use one per thread.
pub struct Video {
    info: VideoInfo,
    /// The size of the frames before their pixels are made square.
    stored_size: ImageSize,
    player: Player,
    /// The file when it was opened; none where the system does not tell.
    file: Option<FileState>,
}

impl Video {
    /// Opens a video and surveys it.
    ///
    /// Takes a second or two if the frame rate is constant or the sample table of an MP4 has the
    /// times, and one pass over all frames otherwise; hardly any time for a file that was opened
    /// before and has not changed.
    ///
    /// # Errors
    /// The file cannot be read, is no video, none of its frames decodes, or they are too large.
    pub fn open(path: &Path) -> Result<Self, MediaError> {
        Self::open_with_progress(path, &Progress::default())
    }

    /// Opens a video as [`Video::open`] does. If all frames have to be visited, `progress` receives
    /// reports and may cancel.
    ///
    /// # Errors
    /// As [`Video::open`]; [`MediaError::Stopped`] when `progress` cancelled it.
    pub fn open_with_progress(
        path: &Path,
        progress: &Progress<'_, CountProgress>,
    ) -> Result<Self, MediaError> {
        let backend = VideoBackend::available().next();
        let backend = backend.ok_or_else(|| MediaError::no_video_support(path))?;
        Self::open_with(path, backend, progress)
    }

    /// Opens a video as [`Video::open_with_progress`] does, by a backend of the caller's choice.
    ///
    /// # Errors
    /// As [`Video::open_with_progress`]; [`MediaError::NoVideoSupport`] where the backend is not
    /// available.
    pub fn open_with(
        path: &Path,
        backend: VideoBackend,
        progress: &Progress<'_, CountProgress>,
    ) -> Result<Self, MediaError> {
        // Before the survey: a file that changes meanwhile is another one afterwards.
        let file = FileState::read(path, backend);
        let Survey { video, capture } = find_or_survey(path, file.clone(), progress, |progress| {
            survey(path, backend, progress)
        })?;
        // After a survey the capture is somewhere in the video, after an earlier one before its
        // first frame. With an unknown position the first access seeks in both cases.
        Ok(Self {
            player: Player {
                capture,
                position: None,
                preroll: video.preroll,
            },
            info: video.info,
            stored_size: video.stored_size,
            file,
        })
    }

    /// Whether its file has been replaced since it was opened.
    pub(in crate::media) fn is_replaced(&self) -> bool {
        self.file.as_ref().is_some_and(FileState::is_replaced)
    }

    /// The result of the survey of the video.
    pub const fn info(&self) -> &VideoInfo {
        &self.info
    }

    /// The pixels of a frame by its index among the decoded frames, from 0, upright and square; of
    /// an interlaced video those of the first field.
    ///
    /// # Errors
    /// There is no such frame, or its data are damaged.
    pub fn frame(&mut self, index: usize) -> Result<Picture, MediaError> {
        if index >= self.info.decoded_frames {
            return Err(MediaError::NoSuchFrame {
                path: self.info.path.to_path_buf(),
                index,
                frames: self.info.decoded_frames,
            });
        }
        // The survey compared and examined the pictures as they are stored, so fields are separated
        // here, above the player.
        self.player.go_to(&self.info, index)?;
        let picture = self.player.capture.picture(index)?;
        let picture = if self.info.interlaced {
            first_field(&picture)
        } else {
            picture
        };
        // A picture of yet another size, as after a change in the middle of a stream, stays as it
        // is.
        if self.info.size == self.stored_size || picture.size() != self.stored_size {
            return Ok(picture);
        }
        picture.resize(self.info.size)
    }
}
