//! Colours as three numbers whose differences say how far apart they look: brightness, and how much
//! redder and bluer they are.

use crate::media::Picture;
use touchline_core::geometry::{ImagePoint, Vec2, Vec3};

/// A colour, grey levels.
pub(super) type Colour = Vec3;

/// A grey level of hue counts this much of one of brightness: pictures are compressed so that hues
/// are blurred more.
const HUE: f64 = 0.6;

/// The weights of red, green and blue in brightness (BT.601).
const BRIGHTNESS: Vec3 = Vec3::new(0.299, 0.587, 0.114);

/// Colours are averaged over points this far apart along a line, px.
const ALONG_PX: [f64; 3] = [-3.0, 0.0, 3.0];

/// The colours at even distances along a normal. The buffers are used again by the next profile.
#[derive(Clone, Debug, Default)]
pub(super) struct ColourProfile {
    colours: Vec<Colour>,
    /// Sums of the colours before each place, and of all.
    sums: Vec<Colour>,
    step_px: f64,
}

impl ColourProfile {
    /// Reads the colours every `step_px` up to `reach_px` or a little farther on both sides of a
    /// point.
    pub fn read(
        &mut self,
        picture: &Picture,
        middle: ImagePoint,
        normal: Vec2,
        reach_px: f64,
        step_px: f64,
    ) {
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

    /// How many places there are.
    pub fn len(&self) -> usize {
        self.colours.len()
    }

    /// How far a place lies from the middle, px.
    pub fn offset_px(&self, index: f64) -> f64 {
        (index - (self.colours.len() / 2) as f64) * self.step_px
    }

    /// How many places a distance spans.
    pub fn places(&self, distance_px: f64) -> isize {
        (distance_px / self.step_px).round() as isize
    }

    /// The colour at a place.
    pub fn colour(&self, index: usize) -> Colour {
        self.colours[index]
    }

    /// The mean colour of the places from the first offset after a place to the last, both
    /// included, as far as there are any.
    pub fn mean(&self, index: usize, from: isize, to: isize) -> Colour {
        let last = self.colours.len() - 1;
        let from = index.saturating_add_signed(from).min(last);
        let to = index.saturating_add_signed(to).min(last);
        (self.sums[to + 1] - self.sums[from]) / (to + 1 - from) as f64
    }
}

/// Red, green and blue at a point, linear between the centres of the four pixels around it; points
/// outside take the nearest pixel's.
fn rgb_at(picture: &Picture, point: ImagePoint) -> Vec3 {
    let size = picture.size();
    let (Some(right), Some(bottom)) = (size.width.checked_sub(1), size.height.checked_sub(1))
    else {
        return Vec3::zeros();
    };
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

/// A colour from red, green and blue.
fn colour_of(rgb: Vec3) -> Colour {
    let brightness = BRIGHTNESS.dot(&rgb);
    Colour::new(
        brightness,
        HUE * (rgb.x - brightness),
        HUE * (rgb.z - brightness),
    )
}
