//! Colours in a space in which Euclidean distances measure visible difference: brightness, and the
//! scaled differences of red and of blue from it, as in Y′CbCr.

use crate::media::Picture;
use touchline_core::geometry::{ImagePoint, Vec2, Vec3};

/// Brightness, and [`HUE`] times red − brightness and blue − brightness, grey levels.
pub(super) type Colour = Vec3;

/// Weight of a difference in hue against one in brightness: compression blurs hues more.
const HUE: f64 = 0.6;

/// Weights of red, green and blue in the brightness (ITU-R BT.601).
const BRIGHTNESS: Vec3 = Vec3::new(0.299, 0.587, 0.114);

/// Each sample is the mean of points at these distances along the line, px, against noise.
const ALONG_PX: [f64; 3] = [-3.0, 0.0, 3.0];

/// Colours at equal distances along a normal. The buffers are reused from profile to profile.
#[derive(Clone, Debug, Default)]
pub(super) struct ColourProfile {
    colours: Vec<Colour>,
    /// Prefix sums of the colours, so that a mean over any range costs two look-ups.
    sums: Vec<Colour>,
    step_px: f64,
}

impl ColourProfile {
    /// Reads the colours every `step_px`, to at least `reach_px` on both sides of a point.
    pub fn read(
        &mut self,
        picture: &Picture,
        middle: ImagePoint,
        normal: Vec2,
        reach_px: f64,
        step_px: f64,
    ) {
        // An odd number of samples, so that one lies on the middle.
        let half = (reach_px / step_px).ceil() as usize;
        self.step_px = step_px;
        let along = Vec2::new(-normal.y, normal.x);
        self.colours.clear();
        self.sums.clear();
        self.sums.push(Colour::zeros());
        let mut sum = Colour::zeros();
        for index in 0..=2 * half {
            let at = middle.moved(normal * ((index as f64 - half as f64) * step_px));
            let here: Vec3 = ALONG_PX
                .iter()
                .map(|by| rgb_at(picture, at.moved(along * *by)))
                .sum();
            let here = colour_of(here / ALONG_PX.len() as f64);
            sum += here;
            self.colours.push(here);
            self.sums.push(sum);
        }
    }

    /// Number of samples.
    pub fn len(&self) -> usize {
        self.colours.len()
    }

    /// Signed distance of a sample from the middle, px. The index may be fractional.
    pub fn offset_px(&self, index: f64) -> f64 {
        (index - (self.colours.len() / 2) as f64) * self.step_px
    }

    /// Number of samples that a distance spans.
    pub fn places(&self, distance_px: f64) -> isize {
        (distance_px / self.step_px).round() as isize
    }

    /// The colour of a sample.
    pub fn colour(&self, index: usize) -> Colour {
        self.colours[index]
    }

    /// Mean colour of the samples `index + from` to `index + to`, both included, clipped to the
    /// profile.
    pub fn mean(&self, index: usize, from: isize, to: isize) -> Colour {
        let last = self.colours.len() - 1;
        let from = index.saturating_add_signed(from).min(last);
        let to = index.saturating_add_signed(to).min(last);
        (self.sums[to + 1] - self.sums[from]) / (to + 1 - from) as f64
    }
}

/// Red, green and blue at a point, bilinear between the centres of the four pixels around it. The
/// border is repeated outside.
fn rgb_at(picture: &Picture, point: ImagePoint) -> Vec3 {
    let size = picture.size();
    let (Some(right), Some(bottom)) = (size.width.checked_sub(1), size.height.checked_sub(1))
    else {
        return Vec3::zeros();
    };
    // Corner convention: the first pixel's centre is at (0.5, 0.5).
    let x = (point.x - 0.5).clamp(0.0, f64::from(right));
    let y = (point.y - 0.5).clamp(0.0, f64::from(bottom));
    let (column, row) = (x as u32, y as u32);
    let (share_x, share_y) = (x - f64::from(column), y - f64::from(row));
    let rgb = |column: u32, row: u32| {
        let [red, green, blue, _] = picture
            .pixel(column.min(right), row.min(bottom))
            .unwrap_or_default();
        Vec3::new(f64::from(red), f64::from(green), f64::from(blue))
    };
    let above = rgb(column, row) * (1.0 - share_x) + rgb(column + 1, row) * share_x;
    let below = rgb(column, row + 1) * (1.0 - share_x) + rgb(column + 1, row + 1) * share_x;
    above * (1.0 - share_y) + below * share_y
}

/// Converts red, green and blue.
fn colour_of(rgb: Vec3) -> Colour {
    let brightness = BRIGHTNESS.dot(&rgb);
    Colour::new(
        brightness,
        HUE * (rgb.x - brightness),
        HUE * (rgb.z - brightness),
    )
}
