//! The stands' colours: rows of people and seats, stairs, tunnels, walls, roof. Every seat is a
//! draw of its own.

use super::bowl::{BowlHit, Part};
use super::coverage::inside;
use super::light::{Light, hex, mix, smooth_step};
use super::options::Moment;
use super::text::rasterise;
use super::texture::{Texture, hash, sub_seed, survives, unit, value_noise};

/// The rise from one row of seats to the next, m, and the width of a seat, m.
const ROW_RISE_M: f32 = 0.44;
const SEAT_WIDTH_M: f32 = 0.56;
/// From one flight of stairs to the next around the bowl, m, and their width, m.
const STAIRS_EVERY_M: f32 = 14.0;
const STAIRS_WIDTH_M: f32 = 1.3;

const COATS: [u32; 14] = [
    0x1B_2230, 0x2C_2C30, 0x52_555C, 0xC9_CBCE, 0xEC_ECE8, 0x27_3F6B, 0x6E_1F28, 0x3A_4A36,
    0x8A_6F4C, 0xD8_B13A, 0x7C_93A8, 0x49_3A5E, 0xA8_4B2A, 0x20_5A5A,
];
const SKINS: [u32; 6] = [
    0xE2_B493, 0xD0_9C78, 0xF0_CBB0, 0xA8_7350, 0x7A_4E34, 0x5A_3825,
];
const HAIR: [u32; 5] = [0x1C_1714, 0x3A_2A1D, 0x6B_4C2C, 0xA8_8A55, 0x8C_8680];

/// There is at most one banner per this length of wall, m; the banner's breadth and height, m.
const CLOTH_EVERY_M: f32 = 9.0;
const CLOTH_M: [f32; 2] = [5.2, 1.1];
const CLOTH_TEXELS_PER_M: f32 = 40.0;
/// What the cloths say.
const CLOTHS: [&str; 9] = [
    "NORTH BANK",
    "SINCE 1904",
    "EAST END",
    "ALWAYS HERE",
    "BLOCK 12",
    "OLD TOWN",
    "ON TOUR",
    "LAKESIDE",
    "NO PASSING",
];

/// The crowd and the materials of the stands.
#[derive(Clone, Debug)]
pub(super) struct Crowd {
    seed: u32,
    attendance: f32,
    home: Light,
    away: Light,
    seat: Light,
    ribbon: Texture,
    cloths: Vec<Texture>,
    coats: Vec<Light>,
    skins: Vec<Light>,
    hair: Vec<Light>,
    /// Who has been replaced, by occasion and share, one time after the other.
    replaced: Vec<(u32, f32)>,
    instant: u32,
    restlessness: f32,
}

/// The pixel's place on a tier: around and up, and what it covers of both, m.
struct TierFootprint {
    around: f32,
    up: f32,
    reach_around: f32,
    reach_up: f32,
}

impl TierFootprint {
    fn pixel(&self) -> f32 {
        self.reach_around.max(self.reach_up)
    }
}

/// A seat of the stands, counted around the field in its row, from the front.
struct Seat {
    tier: i32,
    row: i32,
    number: i32,
}

impl Crowd {
    /// `home` and `away` are the colours their supporters wear.
    pub fn new(seed: u64, attendance: f64, home: Light, away: Light) -> Self {
        let words = rasterise("TOUCHLINE ARENA", 22.0, 1.4);
        let (ink, ground) = (hex(0xF4_F1E6), home * 0.35);
        let width = 512;
        let left = (width as i64 - words.width as i64) / 2;
        let ribbon = Texture::paint(width, 48, |x, y| {
            mix(
                ground,
                ink,
                words.at(x as i64 - left, y as i64 - (48 - words.height as i64) / 2),
            )
        });
        let cloths = CLOTHS
            .iter()
            .zip(COATS)
            .map(|(words, dye)| cloth(words, hex(dye), home))
            .collect();
        let palette = |colours: &[u32]| colours.iter().copied().map(hex).collect();
        Self {
            seed: sub_seed(seed, 0xC20D),
            attendance: attendance as f32,
            home,
            away,
            seat: mix(home, hex(0x80_8488), 0.45),
            ribbon,
            cloths,
            coats: palette(&COATS),
            skins: palette(&SKINS),
            hair: palette(&HAIR),
            replaced: Vec::new(),
            instant: 0,
            restlessness: 0.0,
        }
    }

    /// Some people are others, chosen by `occasion`, and all hold themselves as they do at that
    /// moment.
    pub fn change(&mut self, occasion: u32, moment: &Moment) {
        if moment.people_changed > 0.0 {
            self.replaced.push((occasion, moment.people_changed as f32));
        }
        self.instant = sub_seed(moment.instant, 0x57A4);
        self.restlessness = moment.restlessness as f32;
    }

    /// The draw of whoever sits in a seat.
    fn draw_of(&self, seat: &Seat) -> u32 {
        // Each occasion replaces whoever sits there by then, so that occasions add up.
        let mut draw = hash(
            self.seed ^ (seat.tier as u32).wrapping_mul(0x51ED),
            seat.number,
            seat.row,
        );
        for (occasion, share) in &self.replaced {
            let another = hash(draw ^ occasion, 11, 3);
            if unit(another) < *share {
                draw = another.rotate_left(11);
            }
        }
        draw
    }

    /// How far a person leans aside and rises at this moment, m.
    fn posture(&self, draw: u32) -> [f32; 2] {
        // Different bits of one hash are different draws.
        let now = hash(draw ^ self.instant, 29, 7);
        let lean = 0.22 * (unit(now) - 0.5);
        let stands = unit(now.rotate_left(15)) < 0.12 * self.restlessness;
        let rise = 0.16 * (unit(now.rotate_left(7)) - 0.5);
        [
            self.restlessness * lean,
            self.restlessness * rise + if stands { 0.3 } else { 0.0 },
        ]
    }

    /// The light that a piece of the stands sends to the camera.
    pub fn colour(&self, hit: &BowlHit) -> Light {
        let place = TierFootprint {
            around: hit.around_m as f32,
            up: hit.above_foot_m as f32,
            reach_around: hit.at.reach(hit.around) as f32,
            reach_up: hit.at.by_x.z.hypot(hit.at.by_y.z) as f32,
        };
        match hit.part {
            // The roof's shade deepens towards the back rows.
            Part::LowerTier => self.tier(&place, 0, 8.8) * (0.95 - 0.022 * place.up),
            Part::UpperTier => self.tier(&place, 1, 13.9) * (0.86 - 0.026 * place.up),
            Part::FrontWall => self.front_wall(&place),
            Part::Fascia => self.fascia(&place),
            Part::BackWall => back_wall(&place),
            Part::RoofUnderside => roof_underside(&place),
            Part::RoofEdge => hex(0xC8_CDD2) * (0.75 + 0.2 * (place.up / 1.9)),
        }
    }

    fn tier(&self, place: &TierFootprint, tier: i32, height_m: f32) -> Light {
        // People are drawn one by one where a pixel is small enough to tell them apart (about half
        // a metre each), and fade into the mean of their colours beyond.
        let pixel = place.pixel();
        let near = survives(pixel, 0.5);
        let far_view = self.far_view(place, tier);
        let mut colour = if near > 0.0 {
            mix(far_view, self.people(place, tier), near)
        } else {
            far_view
        };
        // Stairs, step by step.
        let flight = (place.around / STAIRS_EVERY_M).floor();
        let from_stairs =
            (place.around - (flight + 0.5) * STAIRS_EVERY_M).abs() - 0.5 * STAIRS_WIDTH_M;
        let on_stairs = inside(from_stairs, place.reach_around);
        if on_stairs > 0.0 {
            let step = (place.up / (0.5 * ROW_RISE_M)).rem_euclid(1.0);
            let relief = 0.3 * survives(place.reach_up, 0.5 * ROW_RISE_M);
            let stair = hex(0xA6_A39C) * (0.62 + relief * if step > 0.55 { 0.6 } else { -0.4 });
            colour = mix(colour, stair, on_stairs);
        }
        if tier == 0 {
            colour = tunnel(place, flight as i32, self.seed, colour);
        }
        // A rail along the front and a dark gap under the tier above.
        let rail = inside((place.up - 0.12).abs() - 0.07, place.reach_up);
        colour = mix(colour, hex(0xD5_D8DA) * 0.8, rail);
        colour * (1.0 - 0.45 * smooth_step(height_m - 1.6, height_m, place.up))
    }

    /// What the tier looks like when its people are too small to tell apart.
    fn far_view(&self, place: &TierFootprint, tier: i32) -> Light {
        let (home, away) = self.loyalty(place.around, tier);
        let mixed = hex(0x56_534F);
        let colour =
            mixed * (1.0 - home - away) + self.home * (0.5 * home) + self.away * (0.5 * away);
        let grain = value_noise(self.seed ^ 0xFA2, place.around / 1.6, place.up / 0.8);
        colour * (1.0 + 0.25 * grain * survives(place.pixel(), 1.0))
    }

    /// The shares of people in the home and the away colours here.
    fn loyalty(&self, around: f32, tier: i32) -> (f32, f32) {
        let block = (around / STAIRS_EVERY_M + 0.5).floor() as i32;
        let draw = unit(hash(self.seed ^ 0xB10C, block, tier));
        // One corner of the lower tier belongs to the visitors.
        if tier == 0 && (4..=6).contains(&block) {
            return (0.0, 0.6);
        }
        (0.16 + 0.6 * draw * draw, 0.03)
    }

    /// The rows as seen from the pitch: whoever sits further down hides those behind.
    fn people(&self, place: &TierFootprint, tier: i32) -> Light {
        // A person who stands is up to 1.2 m above the row's foot and reaches into two rows above.
        // From the front row backwards, each covers what is left of the pixel.
        let row = (place.up / ROW_RISE_M).floor() as i32;
        let seat = (place.around / SEAT_WIDTH_M).floor() as i32;
        let across = place.around - (seat as f32 + 0.5) * SEAT_WIDTH_M;
        let (mut colour, mut left) = (Light::zeros(), 1.0);
        for seated_in in [row - 2, row - 1, row] {
            if seated_in < 0 {
                continue;
            }
            let up = place.up - seated_in as f32 * ROW_RISE_M;
            let (person, share) = self.person(
                place,
                &Seat {
                    tier,
                    row: seated_in,
                    number: seat,
                },
                [across, up],
            );
            colour += person * (left * share);
            left *= 1.0 - share;
            if left < 0.01 {
                return colour;
            }
        }
        colour + hex(0x3C_3B3A) * (0.5 * left)
    }

    /// The colour and the coverage of one seat and whoever sits in it, at a point across and up
    /// from the seat's foot, m.
    fn person(&self, place: &TierFootprint, seat: &Seat, [across, up]: [f32; 2]) -> (Light, f32) {
        // Shapes are signed distances in m, negative inside; the pixel's size softens their rims.
        // An empty seat shows its back.
        let draw = self.draw_of(seat);
        let again = hash(draw, 17, 4);
        let pixel = place.pixel();
        if unit(draw) > self.attendance {
            let back = (across.abs() - 0.21).max((up - 0.3).abs() - 0.2);
            return (
                self.seat * (0.5 + 0.8 * up.clamp(0.0, 0.5)),
                inside(back, pixel),
            );
        }
        let [leans, rises] = self.posture(draw);
        let lean = (unit(again) - 0.5) * 0.12 + leans;
        let stature = rises
            + 0.04 * unit(again.rotate_left(9))
            + if unit(again.rotate_left(3)) > 0.93 {
                0.3
            } else {
                0.0
            };
        let (x, y) = (across - lean, up - stature);
        // An oval head 0.76 m above the row's foot, before shoulders that narrow towards it.
        let head = x.hypot((y - 0.76) * 1.1) - 0.118;
        let on_head = inside(head, pixel);
        let shoulders =
            (x.abs() - 0.25 + 0.12 * smooth_step(0.48, 0.64, y)).max((y - 0.26).abs() - 0.38);
        let on_body = inside(shoulders, pixel) * (1.0 - on_head);
        let skin = self.skins[again as usize % self.skins.len()];
        let hair = self.hair[(again >> 5) as usize % self.hair.len()];
        let hat = unit(again.rotate_left(13));
        let loyal = self.loyalty(place.around, seat.tier);
        let coat = self.coat(draw, loyal);
        let top = if hat > 0.86 { coat } else { hair };
        let face = mix(
            skin,
            top,
            smooth_step(0.75, 0.80, y + 0.3 * (x.abs() - 0.04)),
        );
        // Light from above: shoulders are bright, laps are dark; arms make a fold at the sides.
        let shade =
            0.45 + 0.65 * smooth_step(0.1, 0.62, y) - 0.18 * smooth_step(0.11, 0.2, x.abs());
        let scarf = loyal.0 > 0.3 && hat < 0.2 && (0.56..0.66).contains(&y);
        let cloth = if scarf {
            mix(self.home, hex(0xFF_FFFF), if x > 0.0 { 0.7 } else { 0.0 })
        } else {
            coat
        };
        // The colour is that of the covered part alone, as `people` weighs it by the share.
        let share = on_head + on_body;
        if share <= 0.0 {
            return (Light::zeros(), 0.0);
        }
        (
            (face * (0.92 * on_head) + cloth * (shade * on_body)) / share,
            share,
        )
    }

    fn coat(&self, draw: u32, (home, away): (f32, f32)) -> Light {
        let choice = unit(hash(draw, 1, 2));
        let tone = 0.45 + 0.65 * unit(hash(draw, 3, 4));
        let base = if choice < home {
            self.home
        } else if choice < home + away {
            self.away
        } else {
            self.coats[hash(draw, 5, 6) as usize % self.coats.len()]
        };
        base * tone
    }

    fn front_wall(&self, place: &TierFootprint) -> Light {
        let panel = (place.around / 3.5).floor();
        let tone = 0.9 + 0.14 * unit(hash(self.seed ^ 0xF0, panel as i32, 0));
        let seam = inside(
            (place.around - panel * 3.5).min((panel + 1.0) * 3.5 - place.around) - 0.03,
            place.reach_around,
        );
        // Supporters hang their cloths over the wall.
        let cloth = hash(
            self.seed ^ 0xC107,
            (place.around / CLOTH_EVERY_M).floor() as i32,
            0,
        );
        let colour = mix(self.home * 0.42, hex(0x20_2226), 0.25) * tone * (1.0 - 0.5 * seam);
        if unit(cloth) > 0.6 {
            return colour;
        }
        // A cloth of 5.2 m is shifted by 0.5 to 3.5 m within its 9 m, so that it never crosses into
        // the next one's.
        let (across, up) = (
            place.around.rem_euclid(CLOTH_EVERY_M) - 0.5 - 3.0 * unit(cloth.rotate_left(9)),
            place.up - 0.2,
        );
        let texels_per_m = CLOTH_TEXELS_PER_M;
        let picture = &self.cloths[cloth as usize % self.cloths.len()];
        let light = picture.sample(
            across * texels_per_m,
            (CLOTH_M[1] - up) * texels_per_m,
            place.reach_around * texels_per_m,
            place.reach_up * texels_per_m,
        );
        let on = inside((-across).max(across - CLOTH_M[0]), place.reach_around)
            * inside((-up).max(up - CLOTH_M[1]), place.reach_up);
        mix(
            colour,
            light * (0.8 + 0.1 * value_noise(cloth, place.around / 0.8, 0.0)),
            on,
        )
    }

    /// The ribbon of the arena's name between the tiers, with a rail above.
    fn fascia(&self, place: &TierFootprint) -> Light {
        // The name repeats every 25.6 m: the 512 texels of the ribbon.
        let texels_per_m = 20.0;
        let x = (place.around.rem_euclid(25.6)) * texels_per_m;
        let lit = self.ribbon.sample(
            x,
            (2.4 - place.up) * texels_per_m,
            place.reach_around * texels_per_m,
            place.reach_up * texels_per_m,
        );
        let concrete = hex(0x9A_9B98) * 0.55;
        let on_ribbon = inside((place.up - 1.1).abs() - 0.85, place.reach_up);
        mix(concrete, lit * 0.8, on_ribbon)
    }
}

/// A supporters' banner: two colours and a word.
fn cloth(words: &str, dye: Light, home: Light) -> Texture {
    let (width, height) = (
        (CLOTH_M[0] * CLOTH_TEXELS_PER_M) as usize,
        (CLOTH_M[1] * CLOTH_TEXELS_PER_M) as usize,
    );
    let full = rasterise(words, 22.0, 1.8);
    let shrink = (0.88 * width as f32 / full.width as f32).min(1.0);
    let letters = rasterise(words, 22.0 * shrink, 1.8 * shrink);
    let (left, top) = (
        (width - letters.width.min(width)) / 2,
        (height - letters.height.min(height)) / 2,
    );
    let ink = if dye.sum() > 0.9 {
        hex(0x16_181E)
    } else {
        hex(0xF0_EEE6)
    };
    Texture::paint(width, height, |x, y| {
        let border = y < 5 || y + 5 >= height;
        let ground = if border { home } else { dye };
        mix(
            ground,
            ink,
            letters.at(x as i64 - left as i64, y as i64 - top as i64),
        )
    })
}

/// A tunnel below the seats: a dark opening with a pale frame, at every third block.
fn tunnel(place: &TierFootprint, flight: i32, seed: u32, colour: Light) -> Light {
    if (flight + (seed % 3) as i32).rem_euclid(3) != 0 {
        return colour;
    }
    let middle = (flight as f32 + 0.5) * STAIRS_EVERY_M;
    let (x, y) = ((place.around - middle).abs(), place.up - 3.1);
    let mouth = (x - 1.6).max((y - 1.0).abs() - 1.0);
    let frame = (x - 1.85).max((y - 1.05).abs() - 1.25);
    let pixel = place.pixel();
    let framed = mix(colour, hex(0xB9_BAB6) * 0.8, inside(frame, pixel));
    mix(
        framed,
        hex(0x16_1718) * (1.2 - 0.3 * y),
        inside(mouth, pixel),
    )
}

fn back_wall(place: &TierFootprint) -> Light {
    let panel = (place.around / 6.0).rem_euclid(1.0);
    let glass = (1.4..3.6).contains(&place.up) && (0.06..0.94).contains(&panel);
    if glass {
        hex(0x2A_3744) * (0.6 + 0.25 * panel)
    } else {
        hex(0x84_8688) * 0.4
    }
}

fn roof_underside(place: &TierFootprint) -> Light {
    let girder = inside(
        ((place.around / 7.0).rem_euclid(1.0) - 0.5).abs() * 7.0 - 0.35,
        place.reach_around,
    );
    let purlin = (place.up * 9.0).rem_euclid(2.0) < 0.35;
    let sheet = hex(0x8E_949A) * if purlin { 0.2 } else { 0.28 };
    mix(sheet, hex(0xD8_DCE0) * 0.5, girder)
}
