//! What a search without clicks answers.

use super::Abstention;
use crate::calibrate::AutocalibratedCamera;
use touchline_core::field::LandmarkId;
use touchline_core::geometry::ImagePoint;

/// The answer of a search that came to its end.
#[derive(Clone, Debug, PartialEq)]
pub enum AutocalibrationAnswer {
    /// The camera.
    Found(Box<AutocalibratedCamera>),
    /// Two places for the camera pass every question, and neither is much better than the other.
    Two {
        /// The one that explains more.
        best: Box<AutocalibratedCamera>,
        /// The other.
        other: Box<AutocalibratedCamera>,
        /// A landmark that tells them apart by one click.
        deciding: Option<DecidingLandmark>,
    },
    /// No answer is certain enough.
    Abstained(Abstention),
}

/// A landmark that two answers see in places far apart: one click on it in one frame decides
/// between them.
#[derive(Clone, Debug, PartialEq)]
pub struct DecidingLandmark {
    /// The frame's place in the document.
    pub frame: usize,
    /// The landmark to click.
    pub landmark: LandmarkId,
    /// Where the better answer and the other have it, px of the frame.
    pub image: [ImagePoint; 2],
}
