//! What the window knows about the video it shows, and what changes that.

use super::place::Place;

/// What is done with the video of the shown frame; not saved, not undone.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct VideoState {
    /// The video is playing.
    pub playing: bool,
    /// At this multiple of its own speed.
    pub speed: PlaySpeed,
    /// The picture of the shown frame is on its way: what is on the screen belongs to another frame.
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

/// What changes state in the matter of a video.
#[derive(Clone, Debug, PartialEq)]
pub enum VideoAction {
    /// A cut of the shown frame's video is moved.
    MoveCut {
        /// The first frame of the shot that begins there, as the video counts.
        cut: u64,
        /// The first frame of that shot from now on.
        to: u64,
    },
    /// The video is played at this speed.
    SetSpeed(PlaySpeed),
    /// The end is reached, or something else is done: the video stands.
    Pause,
    /// The frame or the time that was typed is shown.
    GoToPlace(Place),
    /// The shown frame's picture is on its way, or is there.
    PictureAwaited(bool),
}
