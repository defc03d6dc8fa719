//! The probability that the camera of a tracked frame is right.

use super::evidence::apart_px;
use touchline_core::camera::Ptz;
use touchline_core::geometry::{ImageSize, Mat3, Vec3};
use touchline_core::solve::{RIGHT_PX, probability_right};

/// 1-σ of the error that all frames of a clip have in common, which no further frame reduces: their
/// lines are half a pixel thick far away. Pan and tilt in px at 1920 px width, the focal length as
/// a fraction of it.
///
/// A clip is one draw of this error: in ten drawn clips constrained by exact cameras 90 % of the
/// frames lie within their stated 68 %, in one constrained by a person's clicks 60 %.
const COMMON_PX: f64 = 0.09;
const COMMON_OF_FOCAL: f64 = 2.5e-4;

/// The covariance of a frame's camera (pan rad, tilt rad, focal length px), with the error common
/// to all frames added. A focal length that is known beforehand has no such error.
pub(super) fn with_common(
    mut covariance: Mat3,
    ptz: Ptz,
    size: ImageSize,
    is_focal_known: bool,
) -> Mat3 {
    // A displacement in px divided by the focal length in px is a rotation in rad.
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

/// The covariance of a frame's camera (pan rad, tilt rad, focal length px) with the error of lines
/// that no known camera shows, `lines_px` (1-σ): in the picture they lie beside their paint as if
/// the camera had turned. In which direction is left open: each has half of the variance.
pub(super) fn with_unseen_lines(mut covariance: Mat3, lines_px: f64, ptz: Ptz) -> Mat3 {
    let variance = 0.5 * (lines_px / ptz.focal_px).powi(2);
    covariance[(0, 0)] += variance;
    covariance[(1, 1)] += variance;
    covariance
}

/// Cameras from the two directions of propagation that differ by more than this get a warning, px
/// at 1920 px width.
pub(super) const DIFFER_PX: f64 = 5.0;

/// Upper bound of the confidence in a camera that no person has checked.
const AT_MOST: f64 = 0.99;

/// Factor on the confidence where the paint contradicts the camera, where it does not confirm it
/// beside the end of a track, or where the two directions of propagation disagree.
const CONTRADICTED: f64 = 0.3;

/// The verdict of the painted lines on a frame's camera.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum PaintVerdict {
    /// They are where the camera projects them.
    Agrees,
    /// They do not decide, or were not searched.
    Silent,
    /// They are not where the camera projects them.
    Contradicts,
    /// They do not decide in a frame beside a place where tracking stopped.
    Unconfirmed,
}

/// Frames of a clip whose lines lie on their paint. They confirm the base in the direction in which
/// they look, however large its σ is. The base of one clicked frame with five points may be off by
/// metres and still fit that frame.
pub(super) struct BaseWitnesses {
    cameras: Vec<Ptz>,
    size: ImageSize,
}

impl BaseWitnesses {
    /// Selects the frames on whose cameras the paint agrees.
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

    /// Whether one of these frames shows at least half of what a camera shows. The error of the
    /// base then affects both nearly alike.
    pub fn show(&self, ptz: Ptz) -> bool {
        let half = 0.5 * f64::from(self.size.width);
        self.cameras
            .iter()
            .any(|other| apart_px(*other, ptz, self.size) <= half)
    }
}

/// What is known of a tracked camera's overlay.
pub(super) struct TrackedOverlay {
    /// The root mean square error at the worst corner of the picture, px. Without the base's part
    /// where the base is confirmed.
    pub corner_px: f64,
    /// Distance between the cameras propagated from both sides, px.
    pub apart_px: Option<f64>,
    pub paint: PaintVerdict,
}

/// The probability that a tracked camera's overlay is right within [`RIGHT_PX`].
pub(super) fn confidence(overlay: &TrackedOverlay, size: ImageSize) -> f64 {
    let TrackedOverlay {
        corner_px,
        apart_px,
        paint,
    } = *overlay;
    let px = size.scale_from_1920();
    let right = probability_right(corner_px / px);
    // Without paint, the two directions of propagation must not contradict each other.
    let both_sides = apart_px.is_none_or(|apart_px| apart_px <= RIGHT_PX * px);
    let is_contradicted = match paint {
        PaintVerdict::Agrees => false,
        PaintVerdict::Silent => !both_sides,
        PaintVerdict::Contradicts | PaintVerdict::Unconfirmed => true,
    };
    right.min(AT_MOST) * if is_contradicted { CONTRADICTED } else { 1.0 }
}

/// The confidence of the most certain of known cameras. One that the paint contradicts in its own
/// frame counts as such a frame does.
pub(super) fn most_certain(known: impl Iterator<Item = (f64, PaintVerdict)>) -> f64 {
    known
        .map(|(confidence, paint)| match paint {
            PaintVerdict::Contradicts => CONTRADICTED * confidence,
            PaintVerdict::Agrees | PaintVerdict::Silent | PaintVerdict::Unconfirmed => confidence,
        })
        .fold(0.0, f64::max)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn known_cameras_that_their_paint_contradicts_make_nothing_certain() {
        use PaintVerdict::{Agrees, Contradicts, Silent};
        let of = |verdicts: &[PaintVerdict]| most_certain(verdicts.iter().map(|it| (1.0, *it)));
        assert_eq!(of(&[Contradicts, Contradicts]), CONTRADICTED);
        assert_eq!(of(&[Contradicts, Silent]), 1.0);
        assert_eq!(of(&[Agrees]), 1.0);
        assert_eq!(of(&[]), 0.0);
    }
}
