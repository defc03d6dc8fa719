//! A camera that was found without clicks, and its frames.

use touchline_core::camera::{CameraBase, PanTilt, Ptz};
use touchline_core::field::FieldModel;
use touchline_core::solve::Uncertainty;
use touchline_core::solve::base::FittedSize;
use touchline_vision::paint::Snapped;

/// A camera that was found, and the frames that it was found from.
#[derive(Clone, Debug, PartialEq)]
pub struct AutocalibratedCamera {
    /// The base, in the pan gauge of the conventions.
    pub base: CameraBase,
    /// The field, with the crown and the size that were found.
    pub field: FieldModel,
    /// The lengths of the field that were fitted; none where its size is known, or where the one
    /// assumed explains the paint as well.
    pub sizes: Vec<FittedSize>,
    /// The frames that hang together and whose camera is certain.
    pub frames: Vec<AutocalibratedFrame>,
    /// Frames that were looked at and hang together with none of these, by their places in the
    /// document: another camera's.
    pub others: Vec<usize>,
    /// Where paint stays while the camera turns: pan and tilt, evenly thinned.
    pub paint: Vec<PanTilt>,
    /// What speaks for it.
    pub evidence: AutocalibrationEvidence,
}

impl AutocalibratedCamera {
    /// How many frames agree with the painted lines of their own picture.
    #[must_use]
    pub fn snapped_count(&self) -> usize {
        self.frames
            .iter()
            .filter(|frame| frame.snapped.is_some())
            .count()
    }
}

/// A frame of a camera that was found.
#[derive(Clone, Debug, PartialEq)]
pub struct AutocalibratedFrame {
    /// Its place in the document.
    pub index: usize,
    /// Pan, tilt and focal length by all frames together.
    pub ptz: Ptz,
    /// What all frames together leave open; none where that was not asked.
    pub uncertainty: Option<Uncertainty>,
    /// The camera pulled onto the painted lines of its own picture; none where these do not decide,
    /// or where the frames beside it contradict them.
    pub snapped: Option<Snapped>,
}

impl AutocalibratedFrame {
    /// Pan, tilt and focal length by its own picture where that decides, else by all frames
    /// together.
    pub(crate) fn best_ptz(&self) -> Ptz {
        self.snapped
            .as_ref()
            .map_or(self.ptz, |snapped| snapped.ptz)
    }
}

/// What speaks for a base.
#[derive(Clone, Debug, Default, PartialEq)]
#[non_exhaustive]
pub struct AutocalibrationEvidence {
    /// Frames that it was found from.
    pub frames: usize,
    /// The share of the paint that stays that lies on a line of the field.
    pub explained: f64,
    /// The share of the lines that should be seen on open ground and are.
    pub visible: f64,
    /// Explained times visible of the best other place.
    pub rival: f64,
    /// The lines of the field that were seen, by name.
    pub lines: Vec<String>,
    /// The lines of the field that should have been seen on open ground and were not, by label.
    /// Touchlines are not among them: the width of a field is assumed, and its rules fix all other
    /// lines.
    pub missing: Vec<String>,
    /// The median distance of paint from its line, px at 1920 px width.
    pub residual_px: f64,
    /// How far the bases of the two halves of the frames lie apart, m; of three frames twice the
    /// 1-σ that leaving one out at a time gives; infinite where some have none.
    pub parts_m: f64,
    /// Length and width of a field that would explain more, m, where the size is known and is not
    /// that.
    pub other_size_m: Option<[f64; 2]>,
}

impl AutocalibrationEvidence {
    /// How much of paint and lines belongs together, 0 to 1.
    #[must_use]
    pub fn score(&self) -> f64 {
        self.explained * self.visible
    }
}
