//! Where paint is looked for across a line, and what is found there.

use super::GroundPicture;
use touchline_core::geometry::{ImagePoint, Vec2};
use touchline_core::markings::LineSample;

/// The width that optics and compression give to a line without any, px (full width at half
/// height).
const BLUR_PX: f64 = 1.8;

/// The ground beside the paint is looked at from this far beyond its edge, px.
const GAP_PX: f64 = 1.3;

/// Where the ground beside the paint is asked for its colour, px beyond the paint's edge.
const COLOUR_PX: [f64; 3] = [2.0, 3.5, 5.0];

/// A ridge of paint.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Ridge {
    /// How far its middle lies from where the line was predicted, px along the normal.
    pub offset_px: f64,
    /// Its width between the places where half the contrast is reached, px.
    pub width_px: f64,
    /// How much brighter it is than the brighter of its sides, grey levels; on a floor, how far its
    /// colour is from all that its sides mix.
    pub contrast: f64,
}

/// Where to look for paint.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Across {
    /// The middle of the search, px.
    pub at: ImagePoint,
    /// The unit vector across the line.
    pub normal: Vec2,
    /// How wide the paint should be, px.
    pub width_px: f64,
    /// Which way leads out of the playing area, where the ground may end: 1 along the normal, −1
    /// against it, else 0.
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
    /// How wide the band of ground beside the paint is that it is compared with, px.
    fn band_px(&self) -> f64 {
        (0.6 * self.width_px).max(2.5)
    }

    /// From where to where beside the middle of the paint the ground is that it is compared with,
    /// px.
    pub fn beside_px(&self) -> (f64, f64) {
        let near_px = 0.5 * self.width_px + GAP_PX;
        (near_px, near_px + self.band_px())
    }

    /// How far beyond the reach of a search the picture is read, px.
    pub fn margin_px(&self) -> f64 {
        self.beside_px().1 + 1.0
    }

    /// The width of the ridge that the paint makes in the picture, px.
    pub fn expected_px(&self) -> f64 {
        self.width_px.hypot(BLUR_PX)
    }

    /// A point across the line.
    pub fn point(&self, offset_px: f64) -> ImagePoint {
        self.at.moved(self.normal * offset_px)
    }
}

/// Whether most of what lies beside a ridge has the ground's colours, on every side that belongs to
/// the playing area.
pub(super) fn is_on_ground(ground: &GroundPicture, across: &Across, ridge: &Ridge) -> bool {
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
