//! The camera of a clip: one base, and the lens of each frame where it is known beforehand.

use touchline_core::camera::{CameraBase, FocalCurve, Ptz, PtzCamera};
use touchline_core::geometry::ImagePoint;

/// The camera of a clip.
///
/// All frames share position and rotation of the base. They also share its lens, except frames with
/// a known lens of their own, as a zoom encoder or the provider of a recording states it frame by
/// frame.
#[derive(Clone, Debug, PartialEq)]
pub struct ClipCamera {
    base: CameraBase,
    lenses: Vec<Option<ClipLens>>,
}

/// The lens of one frame, known beforehand.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ClipLens {
    /// Principal point, px.
    pub principal_point: ImagePoint,
    /// Radial distortion as a function of the focal length.
    pub distortion: FocalCurve,
    /// The focal length, px; `None` where it is estimated with pan and tilt.
    pub focal_px: Option<f64>,
}

impl ClipCamera {
    /// A camera with one lens for all frames.
    pub const fn new(base: CameraBase) -> Self {
        Self {
            base,
            lenses: Vec::new(),
        }
    }

    /// A camera with a lens per frame, by the frame's index in the clip. Frames without one, and
    /// those beyond the list, have the lens of the base.
    pub const fn with_lenses(base: CameraBase, lenses: Vec<Option<ClipLens>>) -> Self {
        Self { base, lenses }
    }

    fn lens_at(&self, frame: usize) -> Option<&ClipLens> {
        self.lenses.get(frame)?.as_ref()
    }

    /// The base with the lens of a frame.
    pub fn base_at(&self, frame: usize) -> CameraBase {
        let Some(lens) = self.lens_at(frame) else {
            return self.base;
        };
        CameraBase {
            principal_point: lens.principal_point,
            distortion: lens.distortion,
            ..self.base
        }
    }

    /// The focal length of a frame, where it is known, px.
    pub fn focal_px_at(&self, frame: usize) -> Option<f64> {
        self.lens_at(frame)?.focal_px
    }

    /// `ptz` with the frame's focal length where that is known.
    pub fn with_known_focal(&self, frame: usize, ptz: Ptz) -> Ptz {
        Ptz {
            focal_px: self.focal_px_at(frame).unwrap_or(ptz.focal_px),
            ..ptz
        }
    }

    /// The camera of a frame, positioned at the origin, so that it projects directions of `base`.
    pub(super) fn at_origin(&self, frame: usize, ptz: Ptz) -> PtzCamera {
        PtzCamera::new(self.base_at(frame).at_origin(), ptz)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use touchline_core::testing::base_at;

    #[test]
    fn a_frame_has_its_own_lens_or_that_of_the_base() {
        let middle = ImagePoint::new(960.0, 540.0);
        let base = base_at([0.0, -70.0, 15.0], middle);
        let lens = ClipLens {
            principal_point: ImagePoint::new(970.0, 530.0),
            distortion: FocalCurve::constant(0.3),
            focal_px: Some(3000.0),
        };
        let sought = ClipLens {
            focal_px: None,
            ..lens
        };
        let camera = ClipCamera::with_lenses(base, vec![None, Some(lens), Some(sought)]);
        assert_eq!((camera.base_at(0), camera.base_at(7)), (base, base));
        assert_eq!(camera.base_at(1).principal_point, lens.principal_point);
        assert_eq!(camera.base_at(2), camera.base_at(1));
        let ptz = Ptz::from_degrees(3.0, -10.0, 2000.0);
        let focal_px = |frame| camera.with_known_focal(frame, ptz).focal_px;
        assert_eq!(
            [focal_px(0), focal_px(1), focal_px(2)],
            [2000.0, 3000.0, 2000.0]
        );
    }
}
