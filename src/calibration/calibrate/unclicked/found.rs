//! A camera that was found without clicks, and its frames.

use super::UnclickedEvidence;
use touchline_core::camera::{CameraBase, PanTilt, Ptz};
use touchline_core::field::FieldModel;
use touchline_core::solve::Uncertainty;
use touchline_core::solve::base::FittedSize;
use touchline_vision::paint::Snapped;

/// A camera that was found, and the frames that it was found from.
#[derive(Clone, Debug, PartialEq)]
pub struct UnclickedCamera {
    /// The base, in the pan gauge of the conventions.
    pub base: CameraBase,
    /// The field, with the crown and the size that were found.
    pub field: FieldModel,
    /// The lengths of the field that were fitted; none where its size is known, or where the one assumed explains the paint as well.
    pub sizes: Vec<FittedSize>,
    /// The frames that hang together and whose camera is certain.
    pub frames: Vec<UnclickedFrame>,
    /// Frames that were looked at and hang together with none of these, by their places in the document: another camera's.
    pub others: Vec<usize>,
    /// Where paint stays while the camera turns: pan and tilt, evenly thinned.
    pub paint: Vec<PanTilt>,
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
    /// What all frames together leave open; none where that was not asked.
    pub uncertainty: Option<Uncertainty>,
    /// The camera pulled onto the painted lines of its own picture; none where these do not decide, or where the frames beside it
    /// contradict them.
    pub snapped: Option<Snapped>,
}
