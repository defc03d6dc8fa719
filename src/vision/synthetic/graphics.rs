//! The broadcaster's graphics: laid over the picture, always in the same place.

use super::body::Kits;
use super::coverage::inside;
use super::light::{Light, decode, encode, hex, mix};
use super::options::{Graphics, scale_from_1280};
use super::text::{GlyphCoverage, rasterise};
use super::texture::{smooth_walk, sub_seed};
use image::RgbImage;
use touchline_core::geometry::{ImageSize, PixelBox};

/// The score and the clock, in a picture 1280 px wide, px.
const SCORE_BUG_AT_1280: PixelBox = PixelBox::new(56.0, 36.0, 292.0, 34.0);

/// A band with a player's name and some numbers, in a picture 1280 px wide, px.
const LOWER_THIRD_AT_1280: PixelBox = PixelBox::new(150.0, 590.0, 640.0, 76.0);

/// A channel's logo, in a picture 1280 px wide, px.
const WATERMARK_AT_1280: PixelBox = PixelBox::new(1064.0, 44.0, 160.0, 52.0);

/// A band through which words run, in a picture 1280 px wide, px.
const TICKER_AT_1280: PixelBox = PixelBox::new(90.0, 622.0, 860.0, 46.0);

/// How long it slides in and out, s, and how fast its words run, px in a picture 1280 px wide.
const TICKER_SLIDES_S: f64 = 0.5;
const TICKER_PX_PER_S: f64 = 110.0;

/// The words of the band, and the room for each, px in a picture 1280 px wide.
const TICKER_WORDS: [&str; 5] = [
    "ROVERS 2 ATHLETIC 1",
    "RESULTS",
    "UNITED 0 CITY 0",
    "TONIGHT 20:45",
    "TABLE",
];
const TICKER_WORD_AT_1280: f64 = 190.0;

impl Graphics {
    /// The boxes that these cover at a time since kick-off, px; a band that slides is where it
    /// comes to rest.
    pub fn boxes(self, image_size: ImageSize, time_s: f64) -> Vec<PixelBox> {
        let all = [
            (self.score_bug, SCORE_BUG_AT_1280),
            (self.lower_third, LOWER_THIRD_AT_1280),
            (self.watermark, WATERMARK_AT_1280),
            (self.ticker_in(time_s) > 0.0, TICKER_AT_1280),
        ];
        let scale = scale_from_1280(image_size);
        all.iter()
            .filter(|(shown, _)| *shown)
            .map(|(_, area)| area.scale_by(scale))
            .collect()
    }

    /// Draws them over a picture of a match.
    pub(super) fn draw(self, picture: &mut RgbImage, seed: u64, kits: &Kits, time_s: f64) {
        // The watermark comes last, because it changes the opacity of the canvas.
        let scale = scale_from_1280(ImageSize::new(picture.width(), picture.height())) as f32;
        let mut canvas = Canvas {
            picture,
            scale,
            opacity: 1.0,
        };
        if self.score_bug {
            score_bug(&mut canvas, seed, kits, time_s);
        }
        if self.lower_third {
            lower_third(&mut canvas, kits);
        }
        let share_in = self.ticker_in(time_s);
        if share_in > 0.0 {
            ticker(&mut canvas, kits, time_s, share_in);
        }
        if self.watermark {
            canvas.opacity = self.watermark_share;
            watermark(&mut canvas);
        }
    }

    /// How far the ticker has come in, 0 to 1.
    fn ticker_in(self, time_s: f64) -> f64 {
        let Some([from_s, to_s]) = self.ticker_s else {
            return 0.0;
        };
        ((time_s - from_s).min(to_s - time_s) / TICKER_SLIDES_S).clamp(0.0, 1.0)
    }
}

/// The name of a player and the numbers of a match.
fn lower_third(canvas: &mut Canvas<'_>, kits: &Kits) {
    let (navy, white, grey) = (hex(0x0D_1730), hex(0xF6_F7F9), hex(0xB9_C4D2));
    let whole = Area::from_pixel_box(&LOWER_THIRD_AT_1280);
    let half = 0.5 * whole.height;
    let part = |x: f32, row: f32, width: f32| Area {
        x: whole.x + x,
        y: whole.y + row * half,
        width,
        height: half,
    };
    canvas.panel(whole, navy);
    canvas.panel(
        Area {
            width: 12.0,
            ..whole
        },
        kits.home.shirt,
    );
    canvas.text("10  MARTINEZ", part(20.0, 0.0, 320.0), white);
    canvas.text(kits.names[0], part(400.0, 0.0, 160.0), grey);
    canvas.text(
        "PASSES 41 / 47   DISTANCE 8.3 KM   SHOTS 3",
        part(0.0, 1.0, whole.width),
        white,
    );
}

/// A band through which words run.
fn ticker(canvas: &mut Canvas<'_>, kits: &Kits, time_s: f64, share_in: f64) {
    // Out of the picture it lies with its right end at the left border.
    let whole = Area::from_pixel_box(&TICKER_AT_1280);
    let slid = Area {
        x: whole.x - (1.0 - share_in) as f32 * (whole.x + whole.width),
        ..whole
    };
    canvas.panel(slid, hex(0x10_2A5C));
    canvas.panel(
        Area {
            width: 10.0,
            ..slid
        },
        kits.away.shirt,
    );
    // The words run only while the band is at rest. They go round: one that has left at the left
    // comes again from the right. A word that would cross an end of the band is left out whole.
    if share_in < 1.0 {
        return;
    }
    let round_px = TICKER_WORD_AT_1280 * TICKER_WORDS.len() as f64;
    for (place, words) in TICKER_WORDS.iter().enumerate() {
        let run_px = TICKER_WORD_AT_1280 * place as f64 - TICKER_PX_PER_S * time_s;
        let x = run_px.rem_euclid(round_px) as f32;
        let width = TICKER_WORD_AT_1280 as f32;
        if x > 20.0 && x + width < whole.width {
            canvas.text(
                words,
                Area {
                    x: whole.x + x,
                    width,
                    ..whole
                },
                hex(0xF6_F7F9),
            );
        }
    }
}

/// A channel's logo.
fn watermark(canvas: &mut Canvas<'_>) {
    let (white, whole) = (hex(0xFF_FFFF), Area::from_pixel_box(&WATERMARK_AT_1280));
    let part = |from: f32, to: f32| Area {
        y: whole.y + from * whole.height,
        height: (to - from) * whole.height,
        ..whole
    };
    canvas.text("ARENA", part(0.0, 0.8), white);
    canvas.panel(
        Area {
            height: 3.0,
            ..part(0.78, 1.0)
        },
        white,
    );
    canvas.text("LIVE SPORT", part(0.78, 1.06), white);
}

/// Draws the score and the clock of a match.
fn score_bug(canvas: &mut Canvas<'_>, seed: u64, kits: &Kits, time_s: f64) {
    // The clock runs with the frames, so that its digits change from picture to picture as real
    // ones do; the start and the goals are draws of the seed.
    let minute = 11 + i64::from(sub_seed(seed, 0x71) % 20);
    let clock_s = 60 * minute + time_s.max(0.0) as i64;
    let goals = |salt: u32| (1.4 + 1.4 * smooth_walk(sub_seed(seed, salt), 0.5)) as i64;
    let (navy, white, grey) = (hex(0x0D_1730), hex(0xF6_F7F9), hex(0xDD_E2E8));
    let (left, y, height) = (
        SCORE_BUG_AT_1280.x as f32,
        SCORE_BUG_AT_1280.y as f32,
        SCORE_BUG_AT_1280.height as f32,
    );
    let part = |x: f32, width: f32| Area {
        x: left + x,
        y,
        width,
        height,
    };
    canvas.panel(part(0.0, 86.0), navy);
    canvas.text(&clock(clock_s), part(0.0, 86.0), white);
    canvas.panel(part(86.0, 206.0), white);
    canvas.panel(part(86.0, 6.0), kits.home.shirt);
    canvas.panel(part(286.0, 6.0), kits.away.shirt);
    canvas.text(kits.names[0], part(92.0, 58.0), navy);
    canvas.text(kits.names[1], part(228.0, 58.0), navy);
    canvas.panel(part(152.0, 74.0), grey);
    canvas.text(
        &format!("{} – {}", goals(0x72), goals(0x73)),
        part(152.0, 74.0),
        navy,
    );
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
    fn from_pixel_box(area: &PixelBox) -> Self {
        Self {
            x: area.x as f32,
            y: area.y as f32,
            width: area.width as f32,
            height: area.height as f32,
        }
    }

    fn scale_by(self, scale: f32) -> Self {
        Self {
            x: self.x * scale,
            y: self.y * scale,
            width: self.width * scale,
            height: self.height * scale,
        }
    }
}

struct Canvas<'a> {
    picture: &'a mut RgbImage,
    scale: f32,
    /// How much of the ink covers the picture.
    opacity: f32,
}

impl Canvas<'_> {
    /// A filled box with smooth rims; lengths in px at 1280 px width.
    fn panel(&mut self, at: Area, colour: Light) {
        let Area {
            x,
            y,
            width,
            height,
        } = at.scale_by(self.scale);
        self.cover(at.scale_by(self.scale), colour, |px, py| {
            // The signed distance to the nearest side, negative inside.
            let beyond = (x - px)
                .max(px - x - width)
                .max(y - py)
                .max(py - y - height);
            inside(beyond, 1.0)
        });
    }

    /// A text in the middle of a box; lengths in px at 1280 px width.
    fn text(&mut self, text: &str, within: Area, ink: Light) {
        let within = within.scale_by(self.scale);
        // Glyphs are rasterised at the size of the picture and placed on whole pixels, where they
        // are sharpest.
        let letters: GlyphCoverage = rasterise(text, 0.44 * within.height, 1.15 * self.scale);
        let (width, height) = (letters.width as f32, letters.height as f32);
        let x = (within.x + 0.5 * within.width - 0.5 * width).round();
        let y = (within.y + 0.5 * within.height - 0.5 * height).round();
        self.cover(
            Area {
                x,
                y,
                width,
                height,
            },
            ink,
            |px, py| letters.at((px - x).floor() as i64, (py - y).floor() as i64),
        );
    }

    /// Covers the pixels of a box with ink, each by its `share` at the pixel's centre times the
    /// opacity.
    fn cover(
        &mut self,
        Area {
            x,
            y,
            width,
            height,
        }: Area,
        ink: Light,
        share: impl Fn(f32, f32) -> f32,
    ) {
        // Mixed in linear light, as everything else is, though the picture is encoded already. The
        // box is clipped to the picture.
        let columns = (x.floor().max(0.0) as u32)
            ..((x + width).ceil().max(0.0) as u32).min(self.picture.width());
        let rows = (y.floor().max(0.0) as u32)
            ..((y + height).ceil().max(0.0) as u32).min(self.picture.height());
        for row in rows {
            for column in columns.clone() {
                let share = self.opacity * share(column as f32 + 0.5, row as f32 + 0.5);
                let pixel = &mut self.picture.get_pixel_mut(column, row).0;
                let under =
                    Light::from_iterator(pixel.iter().map(|byte| decode(f32::from(*byte) / 255.0)));
                let light = mix(under, ink, share);
                for (byte, channel) in pixel.iter_mut().zip(light.iter()) {
                    *byte = (255.0 * encode(*channel)).round() as u8;
                }
            }
        }
    }
}
