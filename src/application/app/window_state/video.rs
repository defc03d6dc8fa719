//! The playback state of a video.

/// The playback state of the shown frame's video; neither saved nor undone.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct VideoState {
    /// Whether the video is playing.
    pub playing: bool,
    pub speed: PlaySpeed,
    /// The first and the last of the frames that were played without a jump between them, up to
    /// now or to the last pause.
    pub played: Option<(usize, usize)>,
    /// Whether the picture of the shown frame is still being decoded; the screen then shows another
    /// frame's.
    pub picture_awaited: bool,
}

/// The speed of playback, as a multiple of the video's own.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct PlaySpeed(pub f64);

impl Default for PlaySpeed {
    fn default() -> Self {
        Self(1.0)
    }
}
