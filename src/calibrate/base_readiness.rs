//! What the frames of a camera give for estimating its base.

use crate::document::Frame;
use std::ops::{AddAssign, SubAssign};

/// This many landmarks on the ground determine a camera of which nothing else is known.
pub const LANDMARKS_ALONE: usize = 4;

/// This many wide frames, left, centre and right, determine where a camera stands.
pub const WIDE_FRAMES: usize = 3;

/// How much the frames of a camera say about its base.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct BaseReadiness {
    /// Frames that take part: at least one named click.
    pub frames: usize,
    /// Their clicks.
    pub clicks: usize,
    /// Those that determine a camera by themselves: four or more landmarks.
    pub wide: usize,
    /// Frames that somebody left out.
    pub left_out: usize,
}

impl BaseReadiness {
    /// What one frame gives.
    #[must_use]
    pub fn of_frame(frame: &Frame) -> Self {
        let clicks = frame.clicks.iter().filter(|click| !click.check && click.target.is_some()).count();
        if !frame.use_for_base {
            Self { left_out: 1, ..Self::default() }
        } else if frame.is_used_for_base() && clicks > 0 {
            let wide = usize::from(frame.landmark_clicks() >= LANDMARKS_ALONE);
            Self { frames: 1, clicks, wide, left_out: 0 }
        } else {
            Self::default()
        }
    }

    fn each(self, other: Self, of: fn(usize, usize) -> usize) -> Self {
        Self {
            frames: of(self.frames, other.frames),
            clicks: of(self.clicks, other.clicks),
            wide: of(self.wide, other.wide),
            left_out: of(self.left_out, other.left_out),
        }
    }

    /// Enough for a good base.
    #[must_use]
    pub const fn is_enough(&self) -> bool {
        self.wide >= WIDE_FRAMES
    }

    /// What is to be done, and how far it is done.
    #[must_use]
    pub fn describe(&self) -> String {
        format!(
            "On {WIDE_FRAMES} wide frames (left, centre, right) click {LANDMARKS_ALONE} or more landmarks. Done: {} of \
             {WIDE_FRAMES}.",
            self.wide.min(WIDE_FRAMES)
        )
    }
}

impl AddAssign for BaseReadiness {
    fn add_assign(&mut self, other: Self) {
        *self = self.each(other, |a, b| a + b);
    }
}

impl SubAssign for BaseReadiness {
    fn sub_assign(&mut self, other: Self) {
        *self = self.each(other, |a, b| a - b);
    }
}
