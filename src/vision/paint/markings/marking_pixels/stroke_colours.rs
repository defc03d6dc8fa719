//! The colours of a marking and of the ground beside it, which tell paint from lighter turf.
//!
//! A mowing stripe that is seen from far away is as thin as paint, and brighter than the turf
//! beside it. Its colour differs: a stripe adds the turf's own green to the ground, while paint
//! adds white or yellow.

use crate::media::Picture;
use touchline_core::geometry::{ImagePoint, Vec2};

/// Sums of red, green and blue over marking pixels: on the marking, and on the ground beside it.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct Colours {
    stroke: [f64; 3],
    ground: [f64; 3],
    /// Number of pixels.
    pixels: f64,
}

impl Colours {
    /// The colours at the centre of a marking and, averaged, `side_px` to both sides of it.
    pub fn at(picture: &Picture, at: ImagePoint, normal: Vec2, side_px: f64) -> Self {
        // Whole pixels without interpolation: the sums over a component average their noise.
        // Outside of the picture the border pixel counts, as for the brightness.
        let size = picture.size();
        let (right, bottom) = (size.width.saturating_sub(1), size.height.saturating_sub(1));
        let [stroke, one, other] = [0.0, side_px, -side_px].map(|beside_px| {
            let at = at.translate(normal * beside_px);
            let (column, row) = (at.x.max(0.0) as u32, at.y.max(0.0) as u32);
            let pixel = picture.pixel(column.min(right), row.min(bottom));
            let [red, green, blue, _] = pixel.unwrap_or_default();
            [red, green, blue].map(f64::from)
        });
        Self {
            stroke,
            ground: [0, 1, 2].map(|channel| f64::midpoint(one[channel], other[channel])),
            pixels: 1.0,
        }
    }

    pub fn add(&mut self, other: &Self) {
        for channel in 0..3 {
            self.stroke[channel] += other.stroke[channel];
            self.ground[channel] += other.ground[channel];
        }
        self.pixels += other.pixels;
    }

    /// Whether the marking is whiter than the ground, and not only brighter: it is less green.
    ///
    /// Paint mixes with the turf of a pixel, so that brightness and greenness change in proportion,
    /// however thin the paint is. Strong compression keeps the brightness and loses the greenness.
    pub fn are_whiter(&self) -> bool {
        /// Minimum change of greenness, as a share of that by white paint.
        const SHARE: f64 = 0.33;
        const WHITE: f64 = 255.0;
        let mean = |colour: [f64; 3]| colour.iter().sum::<f64>() / 3.0;
        // The sums are over many pixels, so they are compared as shares of the ground's brightness.
        // A pixel of the share p of white paint is brighter by p (255 − ground) and less green by p
        // times the ground's greenness: `white` is the ratio of the two. On black ground all is NaN
        // or infinite, and the answer is no.
        let ground = mean(self.ground);
        let brighter = (mean(self.stroke) - ground) / ground;
        let less_green = (greenness(self.ground) - greenness(self.stroke)) / ground;
        let pixels = self.pixels.max(1.0);
        let white = greenness(self.ground) / pixels / (WHITE - ground / pixels);
        less_green > SHARE * white * brighter
    }

    /// Whether the marking is turf that is lighter than the turf beside it, such as a mowing stripe
    /// seen from far away.
    ///
    /// Compares the colour that the marking adds to the ground. Lighter turf adds the ground's own
    /// green. White paint adds less green than red and blue, and yellow paint adds hardly any blue.
    pub fn are_of_brighter_turf(&self) -> bool {
        /// Minimum ratio of greenness, added colour by ground, for lighter turf. Painted lines of a
        /// drawn match have at most 0.1, mowing stripes at least 0.44.
        const GREEN: f64 = 0.35;
        /// Yellow paint has at least this much more red than blue, as a share of the colour that it
        /// adds.
        const YELLOW: f64 = 0.35;
        // Greenness is taken as a share of the brightness, so that the ratio of the two does not
        // depend on how much is added.
        let added = [0, 1, 2].map(|channel| self.stroke[channel] - self.ground[channel]);
        let green = |colour: [f64; 3]| greenness(colour) / colour.iter().sum::<f64>();
        let [red, _, blue] = added;
        let all: f64 = added.iter().sum();
        all > 0.0
            && green(self.ground) > 0.0
            && green(added) > GREEN * green(self.ground)
            && (red - blue) / all < YELLOW
    }
}

/// Green less the mean of red and blue.
fn greenness([red, green, blue]: [f64; 3]) -> f64 {
    green - f64::midpoint(red, blue)
}

#[cfg(test)]
mod tests {
    use super::*;
    use touchline_core::geometry::ImageSize;

    #[test]
    fn the_ground_beside_a_marking_at_the_border_is_that_of_the_border() {
        let turf = [60, 120, 60, 255];
        let picture = Picture::with_colour(ImageSize::new(20, 20), turf);
        for at in [ImagePoint::new(2.5, 2.5), ImagePoint::new(17.5, 17.5)] {
            for normal in [Vec2::new(1.0, 0.0), Vec2::new(0.0, 1.0)] {
                let colours = Colours::at(&picture, at, normal, 8.0);
                assert_eq!(colours.ground, [60.0, 120.0, 60.0], "{at:?} {normal:?}");
            }
        }
    }
}
