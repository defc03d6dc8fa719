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
    /// Sums over the places, against the turf on either side, grey levels.
    sums: [f64; 2],
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
        // Each side by itself, where `ridge.rs` takes the brighter one at once: the brighter of two
        // noisy sides is biased, and a mean over many places would keep that bias.
        for (sum, side) in self.sums.iter_mut().zip([one, other]) {
            *sum += (on_line - side).clamp(-MAX_CONTRAST, MAX_CONTRAST);
        }
        self.num_places += 1;
    }

    /// The number of places.
    pub const fn num_places(&self) -> usize {
        self.num_places
    }

    /// The mean over all places, against the side that is brighter in the mean, grey levels. It is
    /// positive for paint alone: an edge, or a slope of the light, is darker than one of its sides
    /// wherever it is measured. None without places.
    pub fn mean(&self) -> Option<f64> {
        let [one, other] = self.sums;
        (self.num_places > 0).then(|| one.min(other) / self.num_places as f64)
    }
}

impl AddAssign for LineContrast {
    fn add_assign(&mut self, other: Self) {
        for (sum, other) in self.sums.iter_mut().zip(other.sums) {
            *sum += other;
        }
        self.num_places += other.num_places;
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::media::Picture;
    use touchline_core::geometry::{ImageSize, Vec3};

    const SIZE: ImageSize = ImageSize {
        width: 81,
        height: 41,
    };
    const MIDDLE: u32 = SIZE.width / 2;

    /// The highest contrast within 1.5 px of the middle column of turf whose columns have some
    /// brightness.
    fn highest_contrast(brightness: impl Fn(u32) -> u8) -> f64 {
        let columns = (0..SIZE.width).map(|column| {
            let green = brightness(column);
            [green / 2, green, green / 2, 255]
        });
        let row: Vec<u8> = columns.flatten().collect();
        let picture = Picture::new(SIZE, row.repeat(SIZE.height as usize)).unwrap();
        let ground = GroundPicture::new(&picture, &[]);
        let sample = LineSample {
            line: 0,
            at: Vec3::zeros(),
            image: ImagePoint::new(40.5, 20.5),
            normal: Vec2::x(),
            width_px: 0.5,
            painted_share: 1.0,
            outward: 0.0,
        };
        let contrast_at = |offset_px: f64| {
            let mut contrast = LineContrast::default();
            contrast.add(&ground, &sample, offset_px, 1.0);
            contrast.mean().expect("all of it is turf")
        };
        let offsets_px = (-3..=3).map(|step| 0.5 * f64::from(step));
        offsets_px.map(contrast_at).fold(f64::MIN, f64::max)
    }

    #[test]
    fn an_edge_or_a_slope_of_the_light_is_no_line() {
        let edge = highest_contrast(|column| if column < MIDDLE { 110 } else { 122 });
        assert!(edge <= 0.0, "{edge}");
        let slope = highest_contrast(|column| 80 + column as u8);
        assert!(slope < 0.0, "{slope}");
        assert!(highest_contrast(|_| 120) <= 0.0);
    }

    #[test]
    fn a_line_along_an_edge_is_a_line() {
        let contrast = highest_contrast(|column| match column.cmp(&MIDDLE) {
            std::cmp::Ordering::Less => 110,
            std::cmp::Ordering::Equal => 126,
            std::cmp::Ordering::Greater => 122,
        });
        assert!(contrast > 1.0, "{contrast}");
    }

    #[test]
    fn without_places_there_is_no_contrast() {
        assert_eq!(LineContrast::default().mean(), None);
    }
}
