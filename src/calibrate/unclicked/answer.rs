//! What a search without clicks answers.

use super::{Abstention, UnclickedEvidence};
use crate::camera::{CameraBase, Ptz};
use crate::field::LandmarkId;
use crate::geometry::ImagePoint;
use crate::paint::Snapped;
use crate::solve::base::FittedSize;

/// The answer of a search that came to its end.
#[derive(Clone, Debug, PartialEq)]
pub enum UnclickedAnswer {
    /// The camera.
    Found(Box<UnclickedCamera>),
    /// Two places for the camera pass every question, and neither is much better than the other.
    Two {
        /// The one that explains more.
        best: Box<UnclickedCamera>,
        /// The other.
        other: Box<UnclickedCamera>,
        /// A landmark that tells them apart by one click.
        deciding: Option<DecidingLandmark>,
    },
    /// No answer is certain enough.
    Abstained(Abstention),
}

/// A camera that was found, and the frames that it was found from.
#[derive(Clone, Debug, PartialEq)]
pub struct UnclickedCamera {
    /// The base, in the pan gauge of the conventions.
    pub base: CameraBase,
    /// The height of the pitch's crown, m.
    pub crown_m: f64,
    /// The lengths of the field that were fitted; none where its size is known, or where the one assumed explains the paint as well.
    pub sizes: Vec<FittedSize>,
    /// The frames that hang together and show enough paint.
    pub frames: Vec<UnclickedFrame>,
    /// What speaks for it.
    pub evidence: UnclickedEvidence,
}

impl UnclickedCamera {
    /// How many frames agree with the painted lines of their own picture.
    #[must_use]
    pub fn snapped_count(&self) -> usize {
        self.frames.iter().filter(|frame| frame.snapped.is_some()).count()
    }
}

/// A frame of a camera that was found.
#[derive(Clone, Debug, PartialEq)]
pub struct UnclickedFrame {
    /// Its place in the document.
    pub index: usize,
    /// Pan, tilt and focal length by all frames together.
    pub ptz: Ptz,
    /// The same pulled onto the painted lines of its own picture; none where these do not decide.
    pub snapped: Option<Snapped>,
}

/// A landmark that two answers see in places far apart: one click on it in one frame decides between them.
#[derive(Clone, Debug, PartialEq)]
pub struct DecidingLandmark {
    /// The frame's place in the document.
    pub frame: usize,
    /// The landmark to click.
    pub landmark: LandmarkId,
    /// Where the better answer and the other have it, px of the frame.
    pub image: [ImagePoint; 2],
}
