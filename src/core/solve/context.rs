//! What a solve is given beside the clicks.

use super::{Loss, MotionPrior, PtzPrior, PtzRanges};
use crate::camera::Ptz;
use crate::geometry::ImageSize;

/// Two candidates whose χ² differ by less than this (times its expectation) cannot be told apart by
/// the clicks: five sigmas, since a base is never quite right.
pub(super) const SAME_FIT: f64 = 25.0;

/// What is known of a frame beside its clicks and its camera's base.
#[derive(Clone, Debug, PartialEq)]
pub struct SolveContext {
    /// The size of the frame.
    pub image_size: ImageSize,
    /// What this camera can do; candidates outside are taken only if there is no other.
    pub ranges: PtzRanges,
    /// Solved frames just before and after, nearest first: they choose between candidates, and
    /// start the search where the clicks alone have no closed form. They do not pull on the result.
    pub neighbours: Vec<Ptz>,
    /// What this camera usually does: it decides where the clicks cannot, and what is out of the
    /// usual is warned of. It does not pull on the result.
    pub motion: MotionPrior,
    /// Where to start, for example the solution before a click moved; as `neighbours`, it does not
    /// pull on the result.
    pub start: Option<Ptz>,
    /// How strongly clicks that disagree with the others still pull (see [`Loss`]).
    pub loss: Loss,
    /// What is known of pan, tilt and focal length before the clicks, such as a neighbour's
    /// solution and its motion; this does pull: three more equations.
    pub prior: Option<PtzPrior>,
}

impl SolveContext {
    /// Nothing is known but the frame's size.
    #[must_use]
    pub fn new(image_size: ImageSize) -> Self {
        Self {
            image_size,
            ranges: PtzRanges::for_width(image_size.width),
            neighbours: Vec::new(),
            motion: MotionPrior::default(),
            start: None,
            loss: Loss::default(),
            prior: None,
        }
    }

    /// The camera that a tie is decided by: the start, else the nearest neighbour, else the prior.
    pub(super) fn expected(&self) -> Option<Ptz> {
        self.start
            .or(self.neighbours.first().copied())
            .or(self.prior.map(|prior| prior.ptz))
    }
}
