//! The plausible range of pan, tilt and focal length.

use crate::camera::Ptz;
use crate::geometry::{Angle, AngleRange};
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
    /// Any pan, tilt from straight down to 20° up, fields of view from 1.5° to 90° of a frame this
    /// wide.
    #[must_use]
    pub fn for_width(width_px: u32) -> Self {
        let width_px = f64::from(width_px);
        Self {
            pan: AngleRange::FULL,
            tilt: Angle::from_degrees(-90.0)..=Angle::from_degrees(20.0),
            focal_px: 0.5 * width_px..=40.0 * width_px,
        }
    }

    /// Whether pan, tilt and focal length are all within.
    #[must_use]
    pub fn contains(&self, ptz: &Ptz) -> bool {
        self.pan.contains(ptz.pan)
            && self.tilt.contains(&ptz.tilt)
            && self.focal_px.contains(&ptz.focal_px)
    }
}
