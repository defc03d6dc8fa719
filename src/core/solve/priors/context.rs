//! The inputs of a solve beside the clicks.

use crate::camera::Ptz;
use crate::geometry::ImageSize;
use crate::solve::{Loss, MotionPrior, PtzPrior, PtzRanges};

/// Clicks cannot decide between two candidates whose χ² differ by less than this (times its
/// expectation): five sigmas, since a base is never exact.
pub(in crate::solve) const SAME_FIT: f64 = 25.0;

/// Knowledge about a frame beside its clicks and its camera's base.
#[derive(Clone, Debug, PartialEq)]
pub struct SolveContext {
    /// The size of the frame.
    pub image_size: ImageSize,
    /// The plausible range of this camera; candidates outside are chosen only if there is no other.
    pub ranges: PtzRanges,
    /// Cameras of solved frames before and after, nearest first. They decide between candidates,
    /// and are starts where the clicks alone have no closed form. They are not part of the cost.
    pub neighbours: Vec<Ptz>,
    /// The usual motion of this camera. It decides where the clicks cannot, and an unusual result
    /// gives a warning. It is not part of the cost.
    pub motion: MotionPrior,
    /// A start, for example the solution before a click was moved. Like `neighbours`, it is not
    /// part of the cost.
    pub start: Option<Ptz>,
    /// The robust loss of the clicks.
    pub loss: Loss,
    /// A prior of pan, tilt and focal length, such as a neighbour's solution and its motion. It is
    /// part of the cost: three more equations.
    pub prior: Option<PtzPrior>,
}

impl SolveContext {
    /// A context with the frame's size alone.
    pub fn new(image_size: ImageSize) -> Self {
        Self {
            image_size,
            ranges: PtzRanges::for_size(image_size),
            neighbours: Vec::new(),
            motion: MotionPrior::default(),
            start: None,
            loss: Loss::default(),
            prior: None,
        }
    }

    /// The camera that decides between equally good candidates: the start, else the nearest
    /// neighbour, else the prior.
    pub(in crate::solve) fn expected_ptz(&self) -> Option<Ptz> {
        self.start
            .or(self.neighbours.first().copied())
            .or(self.prior.map(|prior| prior.ptz))
    }
}
