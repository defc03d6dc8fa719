//! Advertising boards with readable words along the far touchline and behind both goals.

use super::light::{Light, hex, mix};
use super::ray::{PlaneHit, Ray};
use super::text::rasterise;
use super::texture::{Texture, hash, sub_seed, unit};
use touchline_core::field::FieldModel;
use touchline_core::geometry::Vec3;

/// The height of the boards, m.
pub(super) const HEIGHT_M: f64 = 0.95;

const TEXELS_PER_M: f64 = 56.0;
const AD_WIDTH_M: f64 = 7.6;

/// What stands on the boards, in what colours (ground, words), in which design. All names are
/// invented.
const ADS: [(&str, u32, u32, Design); 15] = [
    ("TOUCHLINE", 0x0B_2E6B, 0xFF_FFFF, Design::Ball),
    ("TWO POINTS", 0xE8_E4D8, 0xC0_1F2E, Design::Plain),
    ("NORDWIND", 0x06_6A73, 0xF4_F7F7, Design::Chevrons),
    ("ALPENTAL", 0xF2_F2F0, 0x17_5A2B, Design::Peaks),
    ("KICK OFF COLA", 0xB8_1420, 0xFF_FFFF, Design::Wave),
    ("PAN TILT ZOOM", 0x15_1518, 0xF2_B705, Design::Plain),
    ("HALF TIME TEA", 0xF3_C613, 0x1C_2A1A, Design::Twice),
    ("SWEEPER & SONS", 0x3A_1D5E, 0xE9_E2F5, Design::Plain),
    ("LINESMAN", 0xFF_FFFF, 0x0A_51A1, Design::Chevrons),
    ("CORNER BANK", 0x0E_4D3A, 0xE9_D9A0, Design::Ball),
    ("OFFSIDE AIR", 0x2B_8FD6, 0xFF_FFFF, Design::Wave),
    ("EXTRA TIME", 0x22_2228, 0x4F_E0C2, Design::Plain),
    ("VOLLEY", 0xE4_5A0C, 0xFF_FFFF, Design::Twice),
    ("FAIR PLAY", 0x1B_74BC, 0xFF_F3B0, Design::Ball),
    ("MARATHON BREAD", 0xD9_C7A3, 0x55_2B12, Design::Peaks),
];

#[derive(Clone, Copy)]
enum Design {
    Plain,
    Ball,
    Chevrons,
    Peaks,
    Wave,
    Twice,
}

/// The boards of a stadium.
#[derive(Clone, Debug)]
pub(super) struct Boards {
    rows: Vec<BoardRow>,
    ads: Vec<Texture>,
}

#[derive(Clone, Debug)]
struct BoardRow {
    start: Vec3,
    along: Vec3,
    /// Towards the pitch.
    normal: Vec3,
    length_m: f64,
    /// Indices into the textures, in reading order.
    ads: Vec<usize>,
}

/// Where a ray meets a board.
pub(super) struct BoardHit {
    pub at: PlaneHit,
    row: usize,
    /// Along the row, m.
    along_m: f64,
}

impl Boards {
    pub fn new(seed: u64, field: &FieldModel, [behind, beside]: [f64; 2]) -> Self {
        // Each row goes from left to right as it is read from the pitch.
        let seed = sub_seed(seed, 0xB0A2);
        let (x, y) = (0.5 * field.length_m + behind, 0.5 * field.width_m + beside);
        let row = |start: Vec3, end: Vec3, salt: i32| {
            let length_m = (end - start).norm();
            let along = (end - start) / length_m;
            let count = (length_m / AD_WIDTH_M).round().max(1.0) as i32;
            // Sponsors pay for runs of boards: a new one begins with probability 0.7, else the last
            // is repeated.
            let mut ads: Vec<usize> = Vec::new();
            for place in 0..count {
                let drawn = hash(seed, place, salt) as usize % ADS.len();
                let repeats = unit(hash(seed, place, salt + 50)) < 0.3;
                ads.push(ads.last().copied().filter(|_| repeats).unwrap_or(drawn));
            }
            BoardRow {
                start,
                along,
                normal: Vec3::new(along.y, -along.x, 0.0),
                length_m,
                ads,
            }
        };
        let rows = vec![
            row(Vec3::new(-x, y, 0.0), Vec3::new(x, y, 0.0), 1),
            row(Vec3::new(x, y, 0.0), Vec3::new(x, -y, 0.0), 2),
            row(Vec3::new(-x, -y, 0.0), Vec3::new(-x, y, 0.0), 3),
        ];
        let ads = ADS
            .iter()
            .map(|(words, ground, ink, design)| paint(words, hex(*ground), hex(*ink), *design))
            .collect();
        Self { rows, ads }
    }

    /// Draws this share of the boards again.
    pub fn change(&mut self, seed: u32, share: f32) {
        for (salt, row) in self.rows.iter_mut().enumerate() {
            for (place, ad) in row.ads.iter_mut().enumerate() {
                let draw = hash(seed, place as i32, salt as i32);
                if unit(draw) < share {
                    *ad = hash(draw, 5, 9) as usize % ADS.len();
                }
            }
        }
    }

    /// The nearest board that a ray meets from the pitch's side.
    pub fn meets(&self, ray: &Ray) -> Option<BoardHit> {
        // A board is seen only from its front: the normal points towards the pitch.
        self.rows
            .iter()
            .enumerate()
            .filter(|(_, row)| ray.direction.dot(&row.normal) < 0.0)
            .filter_map(|(index, row)| {
                let at = ray.meets(row.start, row.normal)?;
                let along_m = (at.point - row.start).dot(&row.along);
                let on =
                    (0.0..HEIGHT_M).contains(&at.point.z) && (0.0..row.length_m).contains(&along_m);
                on.then_some(BoardHit {
                    at,
                    row: index,
                    along_m,
                })
            })
            .min_by(|a, b| a.at.depth.total_cmp(&b.at.depth))
    }

    /// Which board of all it is, to tell neighbours apart.
    pub fn number(&self, hit: &BoardHit) -> u8 {
        (hit.row * 40 + self.place(hit)) as u8
    }

    /// The colour of the board under a pixel (self-luminous: the same in sun and shade).
    pub fn colour(&self, hit: &BoardHit) -> Light {
        // All boards of a row have one width, near `AD_WIDTH_M`, to which the texture is stretched.
        // Texture rows count downwards from the board's upper edge.
        let row = &self.rows[hit.row];
        let place = self.place(hit);
        let width_m = row.length_m / row.ads.len() as f64;
        let texels_per_m = (AD_WIDTH_M * TEXELS_PER_M) / width_m;
        let x = (hit.along_m - place as f64 * width_m) * texels_per_m;
        let y = (HEIGHT_M - hit.at.point.z) * TEXELS_PER_M;
        let picture = self.ads[row.ads[place]].sample(
            x as f32,
            y as f32,
            (hit.at.reach(row.along) * texels_per_m) as f32,
            (hit.at.reach(Vec3::z()) * TEXELS_PER_M) as f32,
        );
        picture * 0.86
    }

    fn place(&self, hit: &BoardHit) -> usize {
        let row = &self.rows[hit.row];
        ((hit.along_m / row.length_m * row.ads.len() as f64) as usize).min(row.ads.len() - 1)
    }
}

/// The picture of one board: its design, the words over it, and a dark frame.
fn paint(words: &str, ground: Light, ink: Light, design: Design) -> Texture {
    let (width, height) = (
        (AD_WIDTH_M * TEXELS_PER_M) as usize,
        (HEIGHT_M * TEXELS_PER_M) as usize,
    );
    let (w, h) = (width as f32, height as f32);
    let margin = match design {
        Design::Ball | Design::Peaks => 1.15 * h,
        Design::Chevrons => 1.3 * h,
        Design::Plain | Design::Wave | Design::Twice => 0.35 * h,
    };
    let copies = if matches!(design, Design::Twice) {
        2.0
    } else {
        1.0
    };
    let room = (w - margin - 0.3 * h) / copies;
    // Words that are too long for their room are rasterised again, smaller: letters of a scaled
    // picture would be soft.
    let full = rasterise(words, 0.56 * h, 2.4);
    let shrink = (room * 0.92 / full.width as f32).min(1.0);
    let word = if shrink < 1.0 {
        rasterise(words, 0.56 * h * shrink, 2.4 * shrink)
    } else {
        full
    };
    let origins: Vec<(i64, i64)> = (0..copies as usize)
        .map(|copy| {
            let left = margin + room * copy as f32 + 0.5 * (room - word.width as f32);
            (left as i64, ((h - word.height as f32) * 0.5) as i64)
        })
        .collect();
    Texture::paint(width, height, |column, row| {
        let (x, y) = (column as f32 + 0.5, row as f32 + 0.5);
        let mut colour = design_colour(design, ground, ink, x / h, y / h, w / h);
        for (left, top) in &origins {
            colour = mix(colour, ink, word.at(column as i64 - left, row as i64 - top));
        }
        // The frame of each panel.
        let rim = x.min(w - x).min(y).min(h - y);
        colour * if rim < 1.5 { 0.35 } else { 1.0 }
    })
}

/// The design behind the words; x and y in board heights.
fn design_colour(design: Design, ground: Light, ink: Light, x: f32, y: f32, width: f32) -> Light {
    // Shapes are signed distances, negative inside, with rims a fortieth of the height wide. Where
    // two shapes meet, the product is their intersection and the maximum their union.
    let soft = |signed: f32| (0.5 - signed * 40.0).clamp(0.0, 1.0);
    match design {
        Design::Plain | Design::Twice => mix(ground, ground * 0.72, y),
        Design::Ball => {
            let distance = (x - 0.62).hypot(y - 0.5);
            let ring = (distance - 0.3).abs() - 0.055;
            let cut = (x - 0.62 + 0.5 * (y - 0.5)).abs() - 0.04;
            mix(
                ground,
                ink,
                soft(ring).max(soft(cut) * soft(distance - 0.3)),
            )
        }
        Design::Chevrons => {
            let slant = x - 0.9 * (y - 0.5).abs();
            let bars = (slant / 0.34).rem_euclid(1.0);
            let on = soft((bars - 0.5).abs() - 0.24) * soft(x - 1.15);
            mix(ground, ink, on * 0.9)
        }
        Design::Peaks => {
            let peak = |at: f32, top: f32| top + 1.5 * (x - at).abs() - y;
            let snow = soft(peak(0.5, 0.2)).max(soft(peak(0.85, 0.4)));
            mix(ground, ink, snow * soft(y - 0.82) * soft(x - 1.1))
        }
        Design::Wave => {
            let crest = 0.74 + 0.09 * (x * 2.1).sin() - y;
            let other = mix(ground, ink, 0.22);
            mix(ground, other, soft(crest) * (0.6 + 0.4 * x / width))
        }
    }
}
