//! What the window knows about the video it shows, and what changes that.

use super::place::Place;
use super::shot_search::{FoundShots, ShotFailure, ShotProgress};

/// What is done with the video of the shown frame; not saved, not undone.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct VideoState {
    /// The search for cuts that is under way.
    pub search: Option<RunningSearch>,
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

/// A search for cuts.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct RunningSearch {
    /// Which one.
    pub ticket: u64,
    /// The video as the document names it.
    pub video: String,
    /// How far it has come.
    pub progress: ShotProgress,
    /// How many steps could be undone when it began: what it finds goes beneath those that come later.
    pub(super) num_below: usize,
    /// What it found, while it waits for the end of what the person is doing.
    pub(super) found: Option<FoundShots>,
}

/// What changes state in the matter of a video.
#[derive(Clone, Debug, PartialEq)]
pub enum VideoAction {
    /// How far a search for cuts has come.
    ShotProgress {
        /// Which search.
        ticket: u64,
        /// How far.
        progress: ShotProgress,
    },
    /// A search for cuts has ended.
    ShotsFound {
        /// Which search.
        ticket: u64,
        /// The cuts, or why they were not found.
        found: Result<FoundShots, ShotFailure>,
    },
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
