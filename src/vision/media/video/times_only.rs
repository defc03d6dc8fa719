//! A video of which only the times matter, for tests of what reads and counts frames.

use super::player::Player;
use super::{Capture, FrameClock, StatedProperties, VideoInfo};
use crate::media::{MediaError, Picture};
use std::path::Path;
use std::sync::Arc;
use touchline_core::geometry::ImageSize;

const SIZE: ImageSize = ImageSize::new(64, 36);

/// A video of which only the times matter; a picture shows how many frames were grabbed.
pub(super) struct TimesOnly {
    pub(super) times_s: Vec<f64>,
    grabbed: usize,
    stated: StatedProperties,
    /// The frame before which the reader breaks down, once.
    pub(super) breaks_at: Option<usize>,
}

impl TimesOnly {
    pub(super) fn new(indices: impl Iterator<Item = i32>) -> Self {
        Self {
            times_s: indices.map(|index| f64::from(index) / 25.0).collect(),
            grabbed: 0,
            stated: StatedProperties {
                size: SIZE,
                rotation_deg: 0,
                fps: 25.0,
                frames: 100,
                pixel_aspect: 1.0,
            },
            breaks_at: None,
        }
    }
}

/// A player of such a video that has grabbed nothing yet.
pub(super) fn player(capture: TimesOnly, preroll: usize) -> Player {
    Player {
        capture: Box::new(capture),
        position: None,
        preroll,
    }
}

/// A video of 25 frames a second, of which 32 have been played.
pub(super) fn info() -> VideoInfo {
    VideoInfo {
        path: Arc::from(Path::new("match.ts")),
        size: SIZE,
        rotation_deg: 0,
        fps: 25.0,
        stated_frames: 100,
        decoded_frames: 32,
        interlaced: false,
        clock: FrameClock::Even {
            first_s: 0.0,
            fps: 25.0,
        },
        notices: Vec::new(),
    }
}

impl Capture for TimesOnly {
    fn stated_properties(&self) -> &StatedProperties {
        &self.stated
    }

    fn grab(&mut self) -> Result<bool, MediaError> {
        if self.breaks_at == Some(self.grabbed) {
            self.breaks_at = None;
            return Err(MediaError::ReaderFailed {
                path: "match.ts".into(),
                reader: "ffmpeg".to_owned(),
                reason: "it was ended".to_owned(),
            });
        }
        let is_there = self.grabbed < self.times_s.len();
        self.grabbed += usize::from(is_there);
        Ok(is_there)
    }

    fn time_s(&self) -> Option<f64> {
        self.times_s.get(self.grabbed.checked_sub(1)?).copied()
    }

    fn restart(&mut self) -> Result<(), MediaError> {
        self.grabbed = 0;
        Ok(())
    }

    fn jump_near(&mut self, time_s: f64) {
        let at = self.times_s.iter().position(|at| *at > time_s - 1e-6);
        self.grabbed = at.unwrap_or(self.times_s.len());
    }

    fn picture(&mut self, _: usize) -> Result<Picture, MediaError> {
        Ok(Picture::with_colour(SIZE, [self.grabbed as u8; 4]))
    }
}
