//! Options and progress of tracking a clip.

use touchline_vision::track::{AdjustOptions, FollowOptions, PropagateOptions};

/// Options of tracking a clip.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct TrackClipOptions {
    /// How points are tracked.
    pub follow: FollowOptions,
    /// Where propagation stops.
    pub propagate: PropagateOptions,
    /// Options of the joint adjustment.
    pub adjust: AdjustOptions,
    /// Every n-th frame is aligned to its painted lines; 0 disables this. Default: 5.
    pub paint_every: usize,
    /// Whether the motion is smoothed. Default: false.
    pub smooth: bool,
    /// Whether the focal length of frames that state their lens is estimated as in all others,
    /// beginning at the stated one. Default: false, the stated focal length is fixed and only pan
    /// and tilt are estimated.
    pub seek_focal: bool,
}

impl Default for TrackClipOptions {
    fn default() -> Self {
        Self {
            follow: FollowOptions::default(),
            propagate: PropagateOptions::default(),
            adjust: AdjustOptions::default(),
            paint_every: 5,
            smooth: false,
            seek_focal: false,
        }
    }
}

/// Progress of tracking a clip.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum ClipProgress {
    /// Points are being tracked: frames done, of all.
    Following(usize, usize),
    /// Frames are being compared with their painted lines: done, of all.
    Painting(usize, usize),
    /// All frames are being adjusted.
    Adjusting,
}
