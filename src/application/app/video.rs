//! What the window knows about the video it shows.

/// What is done with the video of the shown frame; not saved, not undone.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct VideoState {
    /// The video is playing.
    pub playing: bool,
    /// At this multiple of its own speed.
    pub speed: PlaySpeed,
    /// The picture of the shown frame is on its way: what is on the screen belongs to another
    /// frame.
    pub picture_awaited: bool,
}

/// How fast a video is played, as a multiple of its own speed.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct PlaySpeed(pub f64);

impl Default for PlaySpeed {
    fn default() -> Self {
        Self(1.0)
    }
}
