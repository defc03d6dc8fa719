//! The contrast of a line with the turf beside it, averaged over many places and pictures.
//!
//! Paint that is thinner than a pixel, or that an encoder has blurred, may stand out from the turf
//! by less than the noise of any single picture, so that no detector of ridges finds it. A clip
//! shows such a line at thousands of places, and the noise of a mean falls with the square root of
//! their number: a line that is one grey level brighter than the turf is then plain to see.

use crate::paint::GroundPicture;
use std::ops::AddAssign;
use touchline_core::geometry::{ImagePoint, Vec2};
use touchline_core::markings::LineSample;

/// The mean contrast of a line.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct LineContrast {
    /// Sum over the places, grey levels.
    sum: f64,
    num_places: usize,
}

/// Distance of the turf that is compared from the edges of the paint, px: outside the blur of lens
/// and encoder.
const BESIDE_PX: f64 = 1.6;

/// Each level is the mean of points at these distances along the line, px.
const ALONG_PX: [f64; 3] = [-2.0, 0.0, 2.0];

/// Contrasts are limited to this range on either side of zero, grey levels, so that no player on a
/// line outweighs the line.
const MAX_CONTRAST: f64 = 6.0;

impl LineContrast {
    /// Adds a place: a sample of a line, moved by `offset_px` along its normal. `scale` multiplies
    /// the distance of the turf from the paint; it is above 1 in pictures in which the blur is
    /// wider. Places with anything but ground on either side do not count.
    pub fn add(&mut self, ground: &GroundPicture, sample: &LineSample, offset_px: f64, scale: f64) {
        let along = Vec2::new(-sample.normal.y, sample.normal.x);
        let middle = sample.image.translate(sample.normal * offset_px);
        let beside = sample.normal * (0.5 * sample.width_px + BESIDE_PX * scale);
        let sides = [middle.translate(beside), middle.translate(-beside)];
        let is_covered = |at: &ImagePoint| !ground.is_ground(*at) || ground.is_masked(*at);
        if sides.iter().any(is_covered) {
            return;
        }
        let [on_line, one, other] = [middle, sides[0], sides[1]].map(|at| {
            let levels = ALONG_PX.map(|by_px| ground.grey().at(at.translate(along * by_px)));
            levels.iter().sum::<f64>() / levels.len() as f64
        });
        // Against the mean of both sides, where `ridge.rs` takes the brighter one: the brighter of
        // two noisy sides is biased, and a mean over many places would keep that bias.
        let contrast = on_line - 0.5 * (one + other);
        self.sum += contrast.clamp(-MAX_CONTRAST, MAX_CONTRAST);
        self.num_places += 1;
    }

    /// The number of places.
    #[must_use]
    pub const fn num_places(&self) -> usize {
        self.num_places
    }

    /// The mean over all places, grey levels; positive for paint. None without places.
    #[must_use]
    pub fn mean(&self) -> Option<f64> {
        (self.num_places > 0).then(|| self.sum / self.num_places as f64)
    }
}

impl AddAssign for LineContrast {
    fn add_assign(&mut self, other: Self) {
        self.sum += other.sum;
        self.num_places += other.num_places;
    }
}
