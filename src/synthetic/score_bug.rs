//! The broadcaster's score graphic: laid over the picture, always in the same place.

use super::body::Kits;
use super::colour::{Light, decode, encode, hex, mix};
use super::coverage::inside;
use super::noise::{smooth_walk, sub_seed};
use super::options::scale_from_1280;
use super::text::{GlyphCoverage, rasterise};
use crate::geometry::{ImageSize, PixelBox};
use image::RgbImage;

/// Where the graphic lies in a picture 1280 px wide, px.
const AT_1280: PixelBox = PixelBox { x: 56.0, y: 36.0, width: 292.0, height: 34.0 };

/// The box that the graphic covers, px: what a camera's mask must hold.
#[must_use]
pub fn score_bug_box(image_size: ImageSize) -> PixelBox {
    let scale = scale_from_1280(image_size);
    PixelBox {
        x: AT_1280.x * scale,
        y: AT_1280.y * scale,
        width: AT_1280.width * scale,
        height: AT_1280.height * scale,
    }
}

/// Draws the score and the clock of a match.
pub(super) fn draw(picture: &mut RgbImage, seed: u64, kits: &Kits, time_s: f64) {
    let scale = scale_from_1280(ImageSize::new(picture.width(), picture.height())) as f32;
    let minute = 11 + i64::from(sub_seed(seed, 0x71) % 20);
    let clock_s = 60 * minute + time_s.max(0.0) as i64;
    let goals = |salt: u32| (1.4 + 1.4 * smooth_walk(sub_seed(seed, salt), 0.5)) as i64;
    let mut canvas = Canvas { picture, scale };
    let (navy, white, grey) = (hex(0x0D_1730), hex(0xF6_F7F9), hex(0xDD_E2E8));
    let (left, y, height) = (AT_1280.x as f32, AT_1280.y as f32, AT_1280.height as f32);
    let part = |x: f32, width: f32| Area { x: left + x, y, width, height };
    canvas.panel(part(0.0, 86.0), navy);
    canvas.text(&clock(clock_s), part(0.0, 86.0), white);
    canvas.panel(part(86.0, 206.0), white);
    canvas.panel(part(86.0, 6.0), kits.home.shirt);
    canvas.panel(part(286.0, 6.0), kits.away.shirt);
    canvas.text(kits.names[0], part(92.0, 58.0), navy);
    canvas.text(kits.names[1], part(228.0, 58.0), navy);
    canvas.panel(part(152.0, 74.0), grey);
    canvas.text(&format!("{} – {}", goals(0x72), goals(0x73)), part(152.0, 74.0), navy);
}

fn clock(seconds: i64) -> String {
    format!("{:02}:{:02}", seconds / 60, seconds % 60)
}

/// A box with sides of its own length, px.
#[derive(Clone, Copy)]
struct Area {
    x: f32,
    y: f32,
    width: f32,
    height: f32,
}

impl Area {
    fn scaled(self, scale: f32) -> Self {
        Self { x: self.x * scale, y: self.y * scale, width: self.width * scale, height: self.height * scale }
    }
}

struct Canvas<'a> {
    picture: &'a mut RgbImage,
    scale: f32,
}

impl Canvas<'_> {
    /// A filled box with smooth rims; lengths in px at 1280 px width.
    fn panel(&mut self, at: Area, colour: Light) {
        let Area { x, y, width, height } = at.scaled(self.scale);
        self.cover(at.scaled(self.scale), colour, |px, py| {
            let beyond = (x - px).max(px - x - width).max(y - py).max(py - y - height);
            inside(beyond, 1.0)
        });
    }

    /// A text in the middle of a box; lengths in px at 1280 px width.
    fn text(&mut self, text: &str, within: Area, ink: Light) {
        let within = within.scaled(self.scale);
        let letters: GlyphCoverage = rasterise(text, 0.44 * within.height, 1.15 * self.scale);
        let (width, height) = (letters.width as f32, letters.height as f32);
        let x = (within.x + 0.5 * within.width - 0.5 * width).round();
        let y = (within.y + 0.5 * within.height - 0.5 * height).round();
        self.cover(Area { x, y, width, height }, ink, |px, py| {
            letters.at((px - x).floor() as i64, (py - y).floor() as i64)
        });
    }

    fn cover(&mut self, Area { x, y, width, height }: Area, ink: Light, share: impl Fn(f32, f32) -> f32) {
        let columns = (x.floor().max(0.0) as u32)..((x + width).ceil().max(0.0) as u32).min(self.picture.width());
        let rows = (y.floor().max(0.0) as u32)..((y + height).ceil().max(0.0) as u32).min(self.picture.height());
        for row in rows {
            for column in columns.clone() {
                let share = share(column as f32 + 0.5, row as f32 + 0.5);
                let pixel = &mut self.picture.get_pixel_mut(column, row).0;
                let under = Light::from_iterator(pixel.iter().map(|byte| decode(f32::from(*byte) / 255.0)));
                let light = mix(under, ink, share);
                for (byte, channel) in pixel.iter_mut().zip(light.iter()) {
                    *byte = (255.0 * encode(*channel)).round() as u8;
                }
            }
        }
    }
}
