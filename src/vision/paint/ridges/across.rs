//! The search for paint along the normal of a line: its geometry and its result.

use crate::paint::GroundPicture;
use touchline_core::geometry::{ImagePoint, Vec2};
use touchline_core::markings::LineSample;

/// Full width at half maximum that optics and compression give to an infinitely thin line, px.
const BLUR_PX: f64 = 1.8;

/// Gap between the edge of the paint and the ground that it is compared with, px.
const GAP_PX: f64 = 1.3;

/// Distances from the paint's edge at which the ground's colour is tested, px.
const COLOUR_PX: [f64; 3] = [2.0, 3.5, 5.0];

/// A ridge of paint across a line.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(in crate::paint) struct Ridge {
    /// Offset of its centre from the predicted line, px along the normal.
    pub offset_px: f64,
    /// Full width at half the contrast, px.
    pub width_px: f64,
}

/// The position, direction and expected width of a search for paint.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(in crate::paint) struct Across {
    /// Centre of the search, px.
    pub at: ImagePoint,
    /// Unit vector across the line, in the picture.
    pub normal: Vec2,
    /// Predicted width of the paint, px.
    pub width_px: f64,
    /// Direction out of the playing area, where the ground may end: 1 along the normal, −1 against
    /// it, 0 if both sides are inside.
    pub outward: f64,
}

impl From<&LineSample> for Across {
    fn from(sample: &LineSample) -> Self {
        let LineSample {
            image,
            normal,
            width_px,
            outward,
            ..
        } = *sample;
        Self {
            at: image,
            normal,
            width_px,
            outward,
        }
    }
}

impl Across {
    /// Width of the band of ground beside the paint that it is compared with, px.
    fn band_px(&self) -> f64 {
        (0.6 * self.width_px).max(2.5)
    }

    /// Distances from the centre of the paint at which that band begins and ends, px.
    pub fn beside_px(&self) -> (f64, f64) {
        let near_px = 0.5 * self.width_px + GAP_PX;
        (near_px, near_px + self.band_px())
    }

    /// How far the profile extends beyond the reach of the search, px.
    pub fn margin_px(&self) -> f64 {
        self.beside_px().1 + 1.0
    }

    /// Predicted width of the ridge, px. Widths of convolved profiles add in quadrature (exactly so
    /// for Gaussians).
    pub fn expected_width_px(&self) -> f64 {
        self.width_px.hypot(BLUR_PX)
    }

    /// The point of the picture at an offset along the normal, px.
    pub fn point(&self, offset_px: f64) -> ImagePoint {
        self.at.translate(self.normal * offset_px)
    }
}

/// Whether a ridge looks like the paint of the line: within reach, as wide as the camera predicts
/// it, within generous limits, and with ground on the inner sides.
pub(super) fn is_like_paint(
    ground: &GroundPicture,
    across: &Across,
    ridge: &Ridge,
    reach_px: f64,
) -> bool {
    // The limits are generous: the width comes from a camera that may be rough, and the blur is
    // that of a typical picture.
    let expected_px = across.expected_width_px();
    (0.4 * expected_px..=1.6 * expected_px + 0.5).contains(&ridge.width_px)
        && ridge.offset_px.abs() <= reach_px
        && is_on_ground(ground, across, ridge)
}

/// Whether most of the points beside a ridge have the ground's colours, on every side within the
/// playing area.
fn is_on_ground(ground: &GroundPicture, across: &Across, ridge: &Ridge) -> bool {
    // `outward` is the sign of the side where the ground may end, behind a touchline for example.
    // That side is not tested.
    let mut sides = [-1.0, 1.0]
        .into_iter()
        .filter(|sign| sign * across.outward <= 0.0);
    sides.all(|sign| {
        let on_ground = COLOUR_PX.into_iter().filter(|beyond_px| {
            ground.is_ground(
                across.point(ridge.offset_px + sign * (0.5 * ridge.width_px + beyond_px)),
            )
        });
        2 * on_ground.count() > COLOUR_PX.len()
    })
}
