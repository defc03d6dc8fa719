//! Colours in a space in which Euclidean distances measure visible difference: brightness, and the
//! scaled differences of red and of blue from it, as in Y′CbCr.

use super::profile::{Profile, ProfileSource};
use crate::media::Picture;
use touchline_core::geometry::{ImagePoint, Vec3};

/// Brightness, and [`HUE`] times red − brightness and blue − brightness, grey levels.
pub(super) type Colour = Vec3;

/// Weight of a difference in hue against one in brightness: compression blurs hues more.
const HUE: f64 = 0.6;

/// Weights of red, green and blue in the brightness (ITU-R BT.601).
const BRIGHTNESS: Vec3 = Vec3::new(0.299, 0.587, 0.114);

/// Colours at equal distances along a normal.
pub(super) type ColourProfile = Profile<Colour>;

impl ProfileSource for Picture {
    type Value = Colour;

    fn mean_at(&self, points: [ImagePoint; 3]) -> Colour {
        let sum: Vec3 = points.iter().map(|point| rgb_at(self, *point)).sum();
        colour_of(sum / points.len() as f64)
    }
}

/// Red, green and blue at a point, bilinear between the centres of the four pixels around it, as
/// `GreyPicture::at` does for grey. The border is repeated outside; a picture without pixels is
/// black.
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

/// Converts red, green and blue. The green difference is left out: it follows from the other two
/// and the brightness.
fn colour_of(rgb: Vec3) -> Colour {
    let brightness = BRIGHTNESS.dot(&rgb);
    Colour::new(
        brightness,
        HUE * (rgb.x - brightness),
        HUE * (rgb.z - brightness),
    )
}
