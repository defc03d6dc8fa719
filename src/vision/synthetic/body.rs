//! A person as a stick figure: a runner's pose from speed and stride.

use super::light::{Light, hex};
use super::play::{Person, Side};
use super::solid::Stick;
use super::texture::{hash, unit};
use touchline_core::geometry::Vec3;

/// What a person wears.
#[derive(Clone, Copy, Debug)]
pub(super) struct Kit {
    pub shirt: Light,
    pub shorts: Light,
    pub socks: Light,
}

/// The colours of a match.
#[derive(Clone, Copy, Debug)]
pub(super) struct Kits {
    pub home: Kit,
    pub away: Kit,
    home_keeper: Kit,
    away_keeper: Kit,
    official: Kit,
    /// Names of the teams on the score graphic.
    pub names: [&'static str; 2],
}

const SKINS: [u32; 6] = [
    0xD9_A98A, 0xC6_9270, 0xE7_C0A4, 0x99_6746, 0x6E_4630, 0x4F_3122,
];
const HAIR: [u32; 5] = [0x14_1110, 0x30_2218, 0x5E_4226, 0x9A_7C48, 0x1E_1A18];
const BOOTS: [u32; 4] = [0x15_1515, 0xE8_E8E8, 0xD6_E62A, 0xE0_4A2A];

impl Kits {
    /// The colours of a seed.
    pub fn from_seed(seed: u32) -> Self {
        let kit = |shirt: u32, shorts: u32, socks: u32| Kit {
            shirt: hex(shirt),
            shorts: hex(shorts),
            socks: hex(socks),
        };
        let (home, away, names) = match seed % 5 {
            0 => (
                kit(0xC4_1E2E, 0xF0_F0F0, 0xC4_1E2E),
                kit(0xF2_F3F4, 0x16_2350, 0xF2_F3F4),
                ["NOR", "ALP"],
            ),
            1 => (
                kit(0x1E_57B8, 0x1E_57B8, 0xF2_F2F2),
                kit(0xF2_C41A, 0x1B_1B20, 0xF2_C41A),
                ["HAV", "SOL"],
            ),
            2 => (
                kit(0xF4_F4F2, 0x12_1316, 0xF4_F4F2),
                kit(0xB0_1530, 0x8A_1026, 0xB0_1530),
                ["EIS", "RUB"],
            ),
            3 => (
                kit(0x6C_1F3B, 0x8B_C1E8, 0x6C_1F3B),
                kit(0xF0_EFE9, 0xF0_EFE9, 0x21_2D5C),
                ["CLA", "LIL"],
            ),
            _ => (
                kit(0xF0_7A16, 0x17_1717, 0xF0_7A16),
                kit(0x2A_9ED8, 0xF2_F2F2, 0x2A_9ED8),
                ["TAN", "AZU"],
            ),
        };
        Self {
            home,
            away,
            home_keeper: kit(0x2E_B872, 0x1C_6B45, 0x2E_B872),
            away_keeper: kit(0xE8_5AA0, 0x8A_2D5B, 0xE8_5AA0),
            official: kit(0x17_181B, 0x17_181B, 0x17_181B),
            names,
        }
    }

    fn kit(&self, side: Side) -> Kit {
        match side {
            Side::Home => self.home,
            Side::Away => self.away,
            Side::HomeKeeper => self.home_keeper,
            Side::AwayKeeper => self.away_keeper,
            Side::Official => self.official,
        }
    }
}

/// The sticks of a person on ground of height `ground_z`.
pub(super) fn body(person: &Person, kits: &Kits, ground_z: f64) -> Vec<Stick> {
    let kit = kits.kit(person.side);
    build(person, kit, ground_z)
}

/// A steward or photographer who sits behind the boards.
pub(super) fn bystander(place: [f64; 2], facing: f64, look: u32) -> Vec<Stick> {
    let vests = [0xD9_E021, 0xE8_7420, 0x2A_4B8C, 0x30_3236];
    let vest = hex(vests[(look >> 4) as usize % vests.len()]);
    let dark = hex(0x22_242A);
    let kit = Kit {
        shirt: vest,
        shorts: dark,
        socks: dark,
    };
    let person = Person {
        side: Side::Official,
        place,
        velocity: [0.0; 2],
        facing,
        stride: f64::from(unit(look)) * 6.0,
        height_m: 1.68 + 0.2 * f64::from(unit(hash(look, 1, 1))),
        look,
    };
    build(&person, kit, 0.0)
}

fn build(person: &Person, kit: Kit, ground_z: f64) -> Vec<Stick> {
    // Lengths below are those of a person 1.8 m tall, in m, and scaled. Swing and lean grow with
    // the speed up to 6.5 and 7 m/s; a person who stands swings a little, too.
    let scale = person.height_m / 1.8;
    let speed = person.velocity[0].hypot(person.velocity[1]);
    let forward = Vec3::new(person.facing.cos(), person.facing.sin(), 0.0);
    let left = Vec3::new(-forward.y, forward.x, 0.0);
    let swing = (speed / 6.5).clamp(0.12, 1.0) * 0.8;
    let lean = 0.03 + 0.16 * (speed / 7.0).min(1.0);
    let skin = hex(SKINS[person.look as usize % SKINS.len()]);
    let hair = hex(HAIR[(person.look >> 3) as usize % HAIR.len()]);
    let boot = hex(BOOTS[(person.look >> 6) as usize % BOOTS.len()]);
    // A joint `reach` further in the plane of running, at an angle from straight down, forwards
    // positive.
    let limb = |from: Vec3, reach: f64, angle: f64| {
        from + (forward * angle.sin() - Vec3::z() * angle.cos()) * (reach * scale)
    };

    let hips = Vec3::new(person.place[0], person.place[1], 0.93 * scale);
    let neck = limb(hips, -0.56, -lean);
    let mut sticks = Vec::with_capacity(24);
    let mut lowest = f64::INFINITY;
    for side in [-1.0, 1.0] {
        // Left and right leg are half a stride apart, and each arm swings against its leg. The knee
        // bends while the thigh comes forward. `lowest` is the sole that touches the ground.
        let phase = person.stride
            + if side > 0.0 {
                0.0
            } else {
                std::f64::consts::PI
            };
        let hip = hips + left * (0.095 * side * scale);
        let thigh = swing * phase.sin() + 0.12;
        let bend = 0.18 + 1.25 * swing * phase.cos().max(0.0);
        let knee = limb(hip, 0.44, thigh);
        let ankle = limb(knee, 0.42, thigh - bend);
        let toe = limb(ankle, 0.17, thigh - bend + 1.35);
        let hem = limb(hip, 0.30, thigh);
        lowest = lowest.min(ankle.z - 0.06).min(toe.z - 0.04);
        sticks.push(Stick::with_radii(hip, hem, 0.105, 0.115, kit.shorts));
        sticks.push(Stick::with_radii(hem, knee, 0.075, 0.06, skin));
        sticks.push(Stick::with_radii(
            limb(knee, 0.05, thigh - bend),
            ankle,
            0.062,
            0.045,
            kit.socks,
        ));
        sticks.push(Stick::with_radii(ankle, toe, 0.05, 0.04, boot));

        let shoulder = limb(neck, 0.06, 0.0) + left * (0.19 * side * scale);
        let arm = -0.85 * swing * phase.sin() + 0.05;
        let out = left * (0.05 * side * scale);
        let elbow = limb(shoulder, 0.29, arm) + out;
        let hand = limb(elbow, 0.27, arm + 0.35 + 1.1 * swing) + out * 0.3;
        let cuff = shoulder + (elbow - shoulder) * 0.7;
        sticks.push(Stick::with_radii(shoulder, cuff, 0.068, 0.062, kit.shirt));
        sticks.push(Stick::with_radii(cuff, elbow, 0.045, 0.042, skin));
        sticks.push(Stick::with_radii(elbow, hand, 0.042, 0.036, skin));

        let waist = hips + left * (0.085 * side * scale);
        let chest = limb(neck, 0.07, 0.0) + left * (0.115 * side * scale);
        sticks.push(Stick::with_radii(
            limb(waist, -0.04, 0.0),
            chest,
            0.115,
            0.125,
            kit.shirt,
        ));
    }
    let spine = hips + (neck - hips) * 0.12;
    sticks.push(Stick::with_radii(
        spine,
        limb(neck, 0.05, 0.0),
        0.12,
        0.13,
        kit.shirt,
    ));
    let girdle = left * (0.07 * scale);
    sticks.push(Stick::new(hips - girdle, hips + girdle, 0.125, kit.shorts));
    let head = limb(neck, -0.20, -0.3 * lean);
    sticks.push(Stick::new(neck, head, 0.06, skin));
    sticks.push(Stick::with_radii(
        head,
        head + Vec3::z() * (0.03 * scale),
        0.096,
        0.1,
        skin,
    ));
    sticks.push(Stick::ball(
        head + (Vec3::z() * 0.045 - forward * 0.03) * scale,
        0.104,
        hair,
    ));
    // Joints were placed down from the hips; the lower foot is put on the ground.
    let lift = Vec3::z() * (ground_z - lowest);
    for stick in &mut sticks {
        stick.from += lift;
        stick.to += lift;
    }
    sticks
}
