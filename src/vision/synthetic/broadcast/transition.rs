//! How a broadcast goes from one shot to the next: the pictures of both, mixed.

use crate::synthetic::body::Kits;
use crate::synthetic::coverage::inside;
use crate::synthetic::light::{Light, encode, hex};
use crate::synthetic::text::{GlyphCoverage, rasterise};
use image::{Rgb, RgbImage};

/// How a shot begins.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum TransitionStyle {
    /// At once.
    Cut,
    /// The picture before becomes the one after as a whole.
    Dissolve,
    /// The picture before darkens to black, and the one after comes out of it.
    Fade,
    /// An edge moves over the picture.
    Wipe,
    /// A band with the broadcaster's logo moves over the picture, and covers all of it half way.
    LogoWipe,
}

/// Width of the band of a wipe with a logo, in widths of the picture; its edges lean.
const BAND_WIDTH: f32 = 1.35;
const LEAN: f32 = 0.3;
/// Share of a fade in which the picture is black.
const BLACK_SHARE: f64 = 0.15;

impl TransitionStyle {
    /// The name in documents.
    pub const fn as_str(self) -> &'static str {
        match self {
            Self::Cut => "cut",
            Self::Dissolve => "dissolve",
            Self::Fade => "fade",
            Self::Wipe => "wipe",
            Self::LogoWipe => "logo_wipe",
        }
    }

    /// The fewest and the most frames that it takes, at 25 a second.
    pub(super) const fn frames(self) -> [usize; 2] {
        match self {
            Self::Cut => [0, 0],
            Self::Dissolve => [8, 26],
            Self::Fade => [16, 34],
            Self::Wipe => [8, 20],
            Self::LogoWipe => [14, 28],
        }
    }

    /// The picture at a share of the way, above 0 and below 1, from one to another of equal size.
    pub(super) fn mix(
        self,
        before: &RgbImage,
        after: &RgbImage,
        share: f64,
        kits: &Kits,
    ) -> RgbImage {
        match self {
            Self::Cut => after.clone(),
            // A vision mixer adds encoded levels, not light.
            Self::Dissolve => blend(before, after, |_, _| share as f32),
            Self::Fade => {
                // Both halves are linear; the picture is black for a while in between.
                let black = RgbImage::new(before.width(), before.height());
                let left = 1.0 - share / (0.5 - 0.5 * BLACK_SHARE);
                let come = 1.0 - (1.0 - share) / (0.5 - 0.5 * BLACK_SHARE);
                let shown = if share < 0.5 { before } else { after };
                blend(&black, shown, |_, _| left.max(come).max(0.0) as f32)
            }
            Self::Wipe => {
                // A straight edge from left to right, two pixels soft.
                let edge = share as f32 * before.width() as f32;
                blend(before, after, |x, _| inside(x - edge, 2.0))
            }
            Self::LogoWipe => LogoBand::new(before, share as f32, kits).sweep(before, after),
        }
    }
}

/// A picture whose pixels have this share of `after`, by their centres, px.
fn blend(before: &RgbImage, after: &RgbImage, share: impl Fn(f32, f32) -> f32) -> RgbImage {
    RgbImage::from_fn(before.width(), before.height(), |x, y| {
        let share = share(x as f32 + 0.5, y as f32 + 0.5);
        let (a, b) = (before.get_pixel(x, y), after.get_pixel(x, y));
        Rgb([0, 1, 2].map(|channel| mix_levels(a.0[channel], b.0[channel], share)))
    })
}

fn mix_levels(a: u8, b: u8, share: f32) -> u8 {
    (f32::from(a) + share * (f32::from(b) - f32::from(a))).round() as u8
}

/// A leaning band with stripes and a logo, at one moment of its way from left to right.
struct LogoBand {
    /// Where its leading edge meets the picture's upper border, and its width, px.
    head: f32,
    width: f32,
    size: [f32; 2],
    logo: GlyphCoverage,
    colours: [Light; 3],
}

impl LogoBand {
    fn new(picture: &RgbImage, share: f32, kits: &Kits) -> Self {
        let size = [picture.width() as f32, picture.height() as f32];
        let width = BAND_WIDTH * size[0];
        // From wholly left of the picture to wholly right of it, lower corners included.
        let way = width + size[0] + LEAN * size[1];
        Self {
            head: share * way,
            width,
            size,
            logo: rasterise("ARENA LIVE", 0.16 * size[1], 0.004 * size[0]),
            colours: [hex(0x0D_1730), kits.home.shirt, hex(0xF6_F7F9)],
        }
    }

    fn sweep(&self, before: &RgbImage, after: &RgbImage) -> RgbImage {
        RgbImage::from_fn(before.width(), before.height(), |x, y| {
            let [px, py] = [x as f32 + 0.5, y as f32 + 0.5];
            // Behind the leading edge, px.
            let behind = self.head - px - LEAN * py;
            if behind < 0.0 {
                *before.get_pixel(x, y)
            } else if behind > self.width {
                *after.get_pixel(x, y)
            } else {
                self.colour(behind, py)
            }
        })
    }

    fn colour(&self, behind: f32, y: f32) -> Rgb<u8> {
        // The logo stands in the middle of the band, upright.
        let across = self.width - behind - 0.5 * (self.width - self.logo.width as f32);
        let down = y - 0.5 * (self.size[1] - self.logo.height as f32);
        let ink = self.logo.at(across.floor() as i64, down.floor() as i64);
        // Broad stripes at both edges, one colour between.
        let rim = behind.min(self.width - behind) / self.size[0];
        let ground = if rim < 0.12 {
            self.colours[1]
        } else {
            self.colours[0]
        };
        let light = ground + (self.colours[2] - ground) * ink;
        Rgb([light.x, light.y, light.z].map(|channel| (255.0 * encode(channel)).round() as u8))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_transition_goes_from_the_first_picture_to_the_second() {
        let [before, after] = [40, 200].map(|level| RgbImage::from_pixel(64, 36, Rgb([level; 3])));
        let kits = Kits::from_seed(3);
        for style in [
            TransitionStyle::Dissolve,
            TransitionStyle::Fade,
            TransitionStyle::Wipe,
            TransitionStyle::LogoWipe,
        ] {
            let off = |share: f64, from: &RgbImage| {
                let mixed = style.mix(&before, &after, share, &kits);
                let pairs = mixed.iter().zip(from.iter());
                let differ = pairs.filter(|(a, b)| a.abs_diff(**b) > 2).count();
                differ as f64 / mixed.len() as f64
            };
            assert!(off(0.005, &before) < 0.06, "{style:?}");
            assert!(off(0.995, &after) < 0.06, "{style:?}");
            assert!(
                off(0.5, &before) > 0.4 && off(0.5, &after) > 0.4,
                "{style:?}"
            );
        }
    }

    #[test]
    fn a_fade_is_black_and_a_logo_covers_all_in_the_middle() {
        let [before, after] = [40, 200].map(|level| RgbImage::from_pixel(64, 36, Rgb([level; 3])));
        let kits = Kits::from_seed(3);
        let faded = TransitionStyle::Fade.mix(&before, &after, 0.5, &kits);
        assert!(faded.iter().all(|level| *level == 0));
        let covered = TransitionStyle::LogoWipe.mix(&before, &after, 0.5, &kits);
        let shown = [[40; 3], [200; 3]];
        assert!(covered.pixels().all(|pixel| !shown.contains(&pixel.0)));
    }
}
