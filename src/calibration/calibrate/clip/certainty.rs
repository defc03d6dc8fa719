//! How certain the camera of a carried frame is.

use super::evidence::apart_px;
use touchline_core::camera::{Ptz, PtzCamera};
use touchline_core::geometry::{ImageSize, Mat3, Vec3};
use touchline_core::solve::Uncertainty;

/// What the frames of a clip err by alike, 1-σ, as no further frame mends it: their lines are half
/// a pixel thick far away. Pan and tilt in px at 1920 px width, the focal length as a share of it.
/// A clip is one draw of it: of ten drawn clips held by exact cameras 90 % of the frames lie within
/// their stated 68 %, of one held by a person's clicks 60 %.
const COMMON_PX: f64 = 0.09;
const COMMON_OF_FOCAL: f64 = 2.5e-4;

/// The covariance (pan rad, tilt rad, focal length px) of a frame's camera with what all frames
/// have in common; a focal length that is known beforehand has no part of it.
pub(super) fn with_common(
    mut covariance: Mat3,
    ptz: Ptz,
    size: ImageSize,
    is_focal_known: bool,
) -> Mat3 {
    let turn = COMMON_PX * size.scale_from_1920() / ptz.focal_px;
    let of_focal = if is_focal_known {
        0.0
    } else {
        COMMON_OF_FOCAL * ptz.focal_px
    };
    let common = Vec3::new(turn, turn, of_focal);
    covariance += Mat3::from_diagonal(&common.component_mul(&common));
    covariance
}

/// An overlay that is off by no more is right, px at 1920 px width.
const RIGHT_PX: f64 = 10.0;

/// Cameras that differ by more than this are warned of, px at 1920 px width.
pub(super) const DIFFER_PX: f64 = 5.0;

/// No camera that nobody has looked at is more certain.
const AT_MOST: f64 = 0.99;

/// What is left of the certainty where the paint contradicts, or where both sides do.
const CONTRADICTED: f64 = 0.3;

/// What the painted lines say about the camera that a frame is given.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum PaintVerdict {
    /// They are where it projects them.
    Agrees,
    /// They do not decide, or the frame was not asked.
    Silent,
    /// They are elsewhere.
    Contradicts,
}

/// Frames of a clip whose lines lie on their paint: they show that the base is right where they
/// look, however far its σ reaches. The base of one clicked frame with five points may be off by
/// meters, and yet agree with that frame.
pub(super) struct BaseWitnesses {
    cameras: Vec<Ptz>,
    size: ImageSize,
}

impl BaseWitnesses {
    /// Of frames with their cameras, and what paint says about each.
    pub fn new<'a>(
        frames: impl Iterator<Item = (Option<Ptz>, &'a PaintVerdict)>,
        size: ImageSize,
    ) -> Self {
        let agreeing = frames.filter(|(_, verdict)| **verdict == PaintVerdict::Agrees);
        Self {
            cameras: agreeing.filter_map(|(ptz, _)| ptz).collect(),
            size,
        }
    }

    /// Whether one of them shows at least half of what a camera shows: what the base leaves open is
    /// then nearly the same for both.
    pub fn show(&self, ptz: Ptz) -> bool {
        let half = 0.5 * f64::from(self.size.width);
        self.cameras
            .iter()
            .any(|other| apart_px(*other, ptz, self.size) <= half)
    }
}

/// How probable it is that a tracked camera's overlay is right: its error has a Rayleigh
/// distribution. `uncertainty` is without the base where the base is shown to be right.
pub(super) fn confidence(
    camera: &PtzCamera,
    uncertainty: &Uncertainty,
    size: ImageSize,
    apart_px: Option<f64>,
    paint: PaintVerdict,
) -> f64 {
    let px = size.scale_from_1920();
    // The root of the covariance's trace is √2 times the 1-σ of each coordinate.
    let sigma_px = uncertainty.worst_corner_sigma_px(camera, size) / 2f64.sqrt();
    let right = right_within(RIGHT_PX * px, sigma_px);
    let both_sides = apart_px.is_none_or(|apart_px| apart_px <= RIGHT_PX * px);
    let is_contradicted = match paint {
        PaintVerdict::Agrees => false,
        PaintVerdict::Silent => !both_sides,
        PaintVerdict::Contradicts => true,
    };
    right.min(AT_MOST) * if is_contradicted { CONTRADICTED } else { 1.0 }
}

/// How much of its certainty a camera keeps where the lines of the field's middle may lie off by
/// this much, 1-σ, px: the rest of its picture stays right.
pub(super) fn certainty_under_length(sigma_px: f64, size: ImageSize) -> f64 {
    let right = right_within(RIGHT_PX * size.scale_from_1920(), sigma_px);
    right + CONTRADICTED * (1.0 - right)
}

/// The probability that an error is no larger, where it has a Rayleigh distribution; 1 where
/// nothing is left open.
fn right_within(px: f64, sigma_px: f64) -> f64 {
    1.0 - (-0.5 * (px / sigma_px).powi(2)).exp()
}
