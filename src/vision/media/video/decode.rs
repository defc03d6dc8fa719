//! An open video and its frames by number.

use super::backend::VideoBackend;
use super::comb::first_field;
use super::known::known_or;
use super::player::Player;
use super::survey::{Survey, survey};
use super::{CountProgress, VideoInfo};
use crate::media::{MediaError, Picture};
use std::path::Path;
use touchline_core::progress::Progress;

/// An open video. It stands at one place at a time: one for each thread.
pub struct Video {
    info: VideoInfo,
    player: Player,
}

impl Video {
    /// Opens a video and finds out how many of its frames decode.
    ///
    /// Takes a second or two where the frames have one rate or an MP4's table of samples has their
    /// times, and one pass over all frames where neither holds; hardly any time for a file that was
    /// opened before and has not changed.
    ///
    /// # Errors
    /// The file cannot be read, is no video, none of its frames decodes, or they are too large.
    pub fn open(path: &Path) -> Result<Self, MediaError> {
        Self::open_with_progress(path, &Progress::default())
    }

    /// Opens a video as [`Video::open`] does; where all frames are visited, `progress` hears now
    /// and then how far that has come, and may cancel it.
    ///
    /// # Errors
    /// As [`Video::open`]; [`MediaError::Stopped`] when `progress` cancelled it.
    pub fn open_with_progress(
        path: &Path,
        progress: &Progress<'_, CountProgress>,
    ) -> Result<Self, MediaError> {
        let backend = VideoBackend::available().next();
        let backend = backend.ok_or_else(|| MediaError::NoVideoSupport {
            path: path.to_path_buf(),
        })?;
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
        let survey = |progress: &Progress<'_, CountProgress>| survey(path, backend, progress);
        let Survey {
            info,
            preroll,
            capture,
        } = known_or(path, backend, progress, survey)?;
        Ok(Self {
            player: Player {
                capture,
                backend,
                position: None,
                preroll,
            },
            info,
        })
    }

    /// What is known about the video.
    #[must_use]
    pub const fn info(&self) -> &VideoInfo {
        &self.info
    }

    /// The pixels of a frame by its number among the decoded frames, from 0, turned upright; of an
    /// interlaced one those of its first field.
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
        self.player.go_to(&self.info, index)?;
        let picture = self.player.capture.picture(index)?;
        Ok(if self.info.interlaced {
            first_field(&picture)
        } else {
            picture
        })
    }
}
