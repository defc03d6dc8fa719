//! The ground: mown stripes, worn places and grain that differs from place to place, and what lies
//! beyond the grass.

use super::courts::boards_m;
use super::floor::{Floor, LineLayer, grain_tone, line_layers};
use super::light::{Light, hex, mix, smooth_step};
use super::options::StadiumOptions;
use super::paint::Paint;
use super::ray::PlaneHit;
use super::texture::{hash, sub_seed, survives, unit, value_noise};
use touchline_core::geometry::Vec3;

/// Grain of the turf: size along x and y (m) and strength. Blades lie along y, the way the mower
/// goes, which is also the way a main camera foreshortens them.
const GRAIN: [(f32, f32, f32); 6] = [
    (13.0, 17.0, 0.05),
    (3.1, 4.3, 0.05),
    (0.85, 2.2, 0.06),
    (0.24, 0.9, 0.10),
    (0.10, 0.45, 0.14),
    (0.035, 0.16, 0.16),
];

/// The ground of a stadium.
#[derive(Clone, Debug)]
pub(super) struct Ground {
    seed: u32,
    /// The floor of a court; none: grass alone.
    floor: Option<Floor>,
    /// What is painted on it, one layer over the other.
    lines: Vec<LineLayer>,
    paint_left: f32,
    /// From goal lines and touchlines to the boards, m.
    boards_m: [f64; 2],
    half_length: f64,
    half_width: f64,
    stripe_m: f64,
    /// Places where boots have worn the turf: x, y, radius along x and y, how much.
    worn: Vec<[f32; 5]>,
    dark: Light,
    bright: Light,
}

impl Ground {
    pub fn new(options: &StadiumOptions) -> Self {
        let (field, court) = (&options.field, options.scene.court());
        let floor = court.map(|court| Floor::new(options.seed, court, field));
        let all = || vec![LineLayer::new(Paint::new(field, |_| true), hex(0xF3_F5EE))];
        // Boots wear the paint of grass, skates and shoes that of a floor.
        let finish_left = floor.as_ref().map_or(1.0, |floor| floor.finish.paint_left);
        let seed = sub_seed(options.seed, 0x62A5);
        let (half_length, half_width) = (0.5 * field.length_m, 0.5 * field.width_m);
        // Boots wear the centre spot, the goal mouths, the penalty spots, and the near touchline
        // where an assistant runs.
        let l = half_length as f32;
        let mut worn = vec![[0.0, 0.0, 2.2, 1.8, 0.25]];
        for side in [-1.0, 1.0] {
            worn.push([side * (l - 1.6), 0.0, 2.4, 3.4, 0.6]);
            worn.push([side * (l - 11.0), 0.0, 1.5, 1.2, 0.45]);
            worn.push([side * 0.45 * l, -(half_width as f32) - 0.8, 18.0, 0.7, 0.35]);
        }
        let hue = unit(hash(seed, 1, 1));
        Self {
            seed,
            floor,
            lines: court.map_or_else(all, |court| line_layers(court, field)),
            paint_left: finish_left * options.paint_left.clamp(0.0, 1.0) as f32,
            boards_m: boards_m(options.scene),
            half_length,
            half_width,
            stripe_m: field.length_m / (field.length_m / 5.5).round().max(1.0),
            worn,
            dark: mix(hex(0x4C_7038), hex(0x45_713A), hue),
            bright: mix(hex(0x63_8A47), hex(0x5C_8B4B), hue),
        }
    }

    /// The boards stand around the grass: whether a place is inside them.
    pub fn is_inside_boards(&self, point: Vec3) -> bool {
        let [behind, beside] = self.boards_m;
        point.x.abs() < self.half_length + behind && point.y < self.half_width + beside
    }

    /// The floor of a court at a place; none on grass, and beyond the boards of a rink.
    pub fn floor_at(&self, point: Vec3) -> Option<&Floor> {
        self.floor
            .as_ref()
            .filter(|floor| !floor.is_beyond_rink(point))
    }

    /// The reflectance of the ground under a pixel.
    pub fn albedo(&self, hit: &PlaneHit) -> Light {
        // Outside the boards, and in the corners of a rink, the ground is the hall's.
        let floor = self.floor_at(hit.point);
        if !self.is_inside_boards(hit.point) || floor.is_none() && self.floor.is_some() {
            return self.apron(hit);
        }
        let ground = match floor {
            Some(floor) => floor.albedo(hit, || self.turf(hit)),
            None => self.turf(hit),
        };
        // Other sports' lines lie below those of the court.
        let layers = self.lines.iter();
        layers.fold(ground, |below, layer| self.paint_over(below, layer, hit))
    }

    /// The ground with one layer of lines over it.
    fn paint_over(&self, below: Light, layer: &LineLayer, hit: &PlaneHit) -> Light {
        let share = layer.share(hit);
        if share == 0.0 {
            return below;
        }
        // Paint that is partly gone goes in patches of a metre or two; fresh paint has a fine
        // unevenness through which a little grass shows.
        let (x, y) = (hit.point.x as f32, hit.point.y as f32);
        let patches =
            1.0 + (1.0 - self.paint_left) * 0.8 * value_noise(self.seed ^ 0x2C, x / 1.6, y / 1.6);
        let painted = share * (self.paint_left * patches).clamp(0.0, 1.0);
        let thin = 0.5 + 0.5 * value_noise(self.seed ^ 0x1A1, x / 0.5, y / 0.5);
        let chalk = layer.colour * (0.9 - 0.05 * thin);
        mix(below, mix(chalk, below, 0.05 * thin), painted)
    }

    fn turf(&self, hit: &PlaneHit) -> Light {
        let (x, y) = (hit.point.x as f32, hit.point.y as f32);
        let (reach_x, reach_y) = (hit.reach(Vec3::x()) as f32, hit.reach(Vec3::y()) as f32);
        let tone = grain_tone(self.seed, &GRAIN, [x, y], [reach_x, reach_y]);
        let stripe = self.stripe(x, y, reach_x);
        let mut turf = mix(self.dark, self.bright, stripe) * tone;
        // Patches lean to yellow or to blue-green.
        let patch = value_noise(self.seed ^ 0x77, x / 7.0, y / 9.0);
        turf.x *= 1.0 + 0.07 * patch;
        turf.z *= 1.0 - 0.07 * patch;
        mix(turf, hex(0x8D_8450) * tone, self.wear(x, y))
    }

    /// 1 on stripes mown away from the main camera, 0 on those towards it; soft at their borders.
    fn stripe(&self, x: f32, y: f32, reach_x: f32) -> f32 {
        // A mower does not drive exactly straight. Stripes begin at the goal line, and a place is
        // measured by its distance to the nearest border of a stripe, positive on the bright ones.
        let wobble = 0.12 * value_noise(self.seed ^ 0x99, x / 3.0, y / 1.5);
        let period = 2.0 * self.stripe_m as f32;
        let place = ((x + wobble - self.half_length as f32) / period + 0.25).rem_euclid(1.0);
        let distance_m = (0.25 - (place - 0.5).abs()) * period;
        let soft = (0.15 + reach_x).max(0.1);
        let inside_field = smooth_step(2.2, 1.6, y.abs() - self.half_width as f32);
        let on = smooth_step(-soft, soft, distance_m);
        0.5 + (on - 0.5) * inside_field
    }

    fn wear(&self, x: f32, y: f32) -> f32 {
        let mut worn: f32 = 0.0;
        for [centre_x, centre_y, radius_x, radius_y, strength] in &self.worn {
            let squared = ((x - centre_x) / radius_x).powi(2) + ((y - centre_y) / radius_y).powi(2);
            if squared < 4.0 {
                let ragged = 0.75 + 0.5 * value_noise(self.seed ^ 0x3E, x / 0.6, y / 0.8);
                worn = worn.max(strength * (-squared).exp() * ragged);
            }
        }
        worn.min(0.7)
    }

    /// Behind the boards: dark rubber paving.
    fn apron(&self, hit: &PlaneHit) -> Light {
        let (x, y) = (hit.point.x as f32, hit.point.y as f32);
        let grain = value_noise(self.seed ^ 0xA9, x / 0.7, y / 0.7)
            * survives(hit.reach(Vec3::y()) as f32, 0.7);
        hex(0x5C_6062) * (0.8 + 0.1 * grain)
    }
}
