//! How a clip is tracked, and how far that has come.

use touchline_vision::track::{AdjustOptions, CarryOptions, FollowOptions};

/// How a clip is tracked.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct TrackClipOptions {
    /// How points are followed.
    pub follow: FollowOptions,
    /// When a frame is not carried on to.
    pub carry: CarryOptions,
    /// How all is adjusted.
    pub adjust: AdjustOptions,
    /// Every n-th frame is aligned to its painted lines; 0 turns this off. Default: 5.
    pub paint_every: usize,
    /// Whether the motion is smoothed. False by default.
    pub smooth: bool,
    /// Whether the focal length of frames that state their lens is sought as in all others, and
    /// their statement but a start. False by default: it is kept, and pan and tilt alone are
    /// sought.
    pub seek_focal: bool,
}

impl Default for TrackClipOptions {
    fn default() -> Self {
        Self {
            follow: FollowOptions::default(),
            carry: CarryOptions::default(),
            adjust: AdjustOptions::default(),
            paint_every: 5,
            smooth: false,
            seek_focal: false,
        }
    }
}

/// How far it has come.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum ClipProgress {
    /// Points are followed: frames done, of all.
    Following(usize, usize),
    /// Frames are held to their painted lines: done, of all.
    Painting(usize, usize),
    /// All frames are adjusted.
    Adjusting,
}
