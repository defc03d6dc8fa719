//! The result of autocalibration: a camera and its frames.

use touchline_core::camera::{CameraBase, PanTilt, Ptz};
use touchline_core::field::FieldModel;
use touchline_core::solve::Uncertainty;
use touchline_core::solve::base::{FittedSize, PixelAspect};
use touchline_vision::paint::Snapped;

/// A camera found by autocalibration, and the frames that it was found from.
#[derive(Clone, Debug, PartialEq)]
pub struct AutocalibratedCamera {
    /// The base, with pan zero as the conventions fix it.
    pub base: CameraBase,
    /// The field, with the estimated crown and size.
    pub field: FieldModel,
    /// The fitted lengths of the field; empty if its size is known, or if the assumed size explains
    /// the paint equally well.
    pub sizes: Vec<FittedSize>,
    /// The frames that are linked by image matches and whose camera is certain.
    pub frames: Vec<AutocalibratedFrame>,
    /// Indices in the document of sampled frames that match none of these: they belong to another
    /// camera.
    pub others: Vec<usize>,
    /// Directions of persistent paint as pan and tilt, evenly subsampled.
    pub paint: Vec<PanTilt>,
    /// The evidence for the base.
    pub evidence: AutocalibrationEvidence,
}

impl AutocalibratedCamera {
    /// Number of frames that agree with the painted lines of their own picture.
    pub fn aligned_frame_count(&self) -> usize {
        self.frames
            .iter()
            .filter(|frame| frame.snapped.is_some())
            .count()
    }
}

/// A frame of a camera found by autocalibration.
#[derive(Clone, Debug, PartialEq)]
pub struct AutocalibratedFrame {
    /// Its index in the document.
    pub index: usize,
    /// Pan, tilt and focal length from all frames together.
    pub ptz: Ptz,
    /// Its uncertainty from all frames together; none if that was not computed.
    pub uncertainty: Option<Uncertainty>,
    /// The camera aligned to the painted lines of its own picture; none if these do not decide, or
    /// if neighbouring frames contradict them.
    pub snapped: Option<Snapped>,
    /// The score of the line check that says how likely the camera is by its own picture, where
    /// that could not be aligned; none without a picture, or if too few places of the lines are on
    /// open ground for a verdict.
    pub unaligned_score: Option<f64>,
}

impl AutocalibratedFrame {
    /// The probability, from the line check of its own picture, that its camera is right. None
    /// without a picture, if it shows too few places of the lines, or if neighbouring frames
    /// contradict the alignment.
    pub(crate) fn line_check_score(&self) -> Option<f64> {
        let aligned = self.snapped.as_ref().map(|alignment| alignment.check.score);
        aligned.or(self.unaligned_score)
    }

    /// Pan, tilt and focal length from its own picture if that decides, else from all frames
    /// together.
    pub(crate) fn best_ptz(&self) -> Ptz {
        self.snapped
            .as_ref()
            .map_or(self.ptz, |snapped| snapped.ptz)
    }
}

/// The evidence for a base.
#[derive(Clone, Debug, Default, PartialEq)]
#[non_exhaustive]
pub struct AutocalibrationEvidence {
    /// Number of frames that it was found from.
    pub frames: usize,
    /// How likely it is by the paint of its pictures, nats: a logarithm of likelihoods, against no
    /// line being where it has one. It rises with the number of lines that are seen.
    pub nats: f64,
    /// Share of the persistent paint that lies on a line of the field.
    pub explained: f64,
    /// Share of the lines expected on open ground that are visible.
    pub visible: f64,
    /// The evidence of the best other position of the camera, nats; none without another.
    pub runner_up_nats: Option<f64>,
    /// Names of the lines of the field that are visible.
    pub lines: Vec<String>,
    /// Labels of the lines that are expected on open ground and not visible, except touchlines: the
    /// width of a field is assumed, and its rules fix all other lines.
    pub missing: Vec<String>,
    /// Median distance of paint from its line, px at 1920 px width.
    pub residual_px: f64,
    /// Distance between the positions estimated from two halves of the frames, m. With three
    /// frames, twice the 1-σ of the leave-one-out estimates; infinite if some of these have no
    /// solution.
    pub parts_m: f64,
    /// Length and width of a field that would explain more, m, if the size is known and differs
    /// from that.
    pub other_size_m: Option<[f64; 2]>,
    /// The aspect of the pixels, if the paint shows that they are not square; the error that this
    /// gives the base is part of its sigma.
    pub pixel_aspect: Option<PixelAspect>,
}
