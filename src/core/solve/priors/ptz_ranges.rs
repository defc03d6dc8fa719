//! The plausible range of pan, tilt and focal length.

use crate::camera::Ptz;
use crate::geometry::{Angle, AngleRange, ImageSize};
use std::ops::RangeInclusive;

/// The plausible range of pan, tilt and focal length of a camera.
#[derive(Clone, Debug, PartialEq)]
pub struct PtzRanges {
    /// Pan.
    pub pan: AngleRange,
    /// Tilt.
    pub tilt: RangeInclusive<Angle>,
    /// Focal length, px of the frame.
    pub focal_px: RangeInclusive<f64>,
}

impl PtzRanges {
    /// Any pan, tilt from straight down to 20° up, fields of view from 1.5° of the 16:9 picture that
    /// a frame is cut from to 90° along its own longer side.
    pub fn for_size(size: ImageSize) -> Self {
        let longer_px = f64::from(size.width.max(size.height));
        Self {
            pan: AngleRange::FULL,
            tilt: Angle::from_degrees(-90.0)..=Angle::from_degrees(20.0),
            focal_px: 0.5 * longer_px..=40.0 * size.reference_width_px(),
        }
    }

    /// Whether pan, tilt and focal length are all within.
    pub fn contains(&self, ptz: &Ptz) -> bool {
        self.pan.contains(ptz.pan)
            && self.tilt.contains(&ptz.tilt)
            && self.focal_px.contains(&ptz.focal_px)
    }
}
