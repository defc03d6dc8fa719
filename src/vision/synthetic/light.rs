//! Where the light comes from, and who stands in whose shadow.

use super::options::Daylight;
use touchline_core::field::FieldModel;
use touchline_core::geometry::Vec3;

/// The sun or one floodlight mast.
#[derive(Clone, Copy, Debug)]
pub(super) struct Lamp {
    /// The unit direction from the field to the lamp.
    pub towards: Vec3,
    pub light: Light,
}

/// The light over a stadium. A sheet of white paper on the open ground is about 1.
#[derive(Clone, Debug)]
pub(super) struct Lighting {
    pub lamps: Vec<Lamp>,
    sky: Light,
    /// What the grass throws back at those who stand on it.
    bounce: Light,
    /// How bright the stands are.
    pub stands: f32,
    /// The roof's height and its place beyond the field's edges, if it throws a shadow on the
    /// pitch.
    roof: Option<[f64; 2]>,
    half_length: f64,
    half_width: f64,
    pub daylight: Daylight,
}

impl Lighting {
    pub fn new(daylight: Daylight, field: &FieldModel) -> Self {
        let lamp = |x: f64, y: f64, z: f64, strength: f32, colour: u32| Lamp {
            towards: Vec3::new(x, y, z).normalize(),
            light: hex(colour) * strength,
        };
        let (lamps, sky, stands, roof) = match daylight {
            Daylight::Hazy => (
                vec![lamp(-0.55, -0.5, 0.72, 0.95, 0xFF_F3DF)],
                hex(0xE2_EDFF) * 0.42,
                0.8,
                None,
            ),
            Daylight::LowSun => {
                // A court smaller than a pitch has lower stands, nearer to it.
                let scale = (field.length_m / 90.0).min(1.0);
                let roof = Some([35.4 * scale, 19.0 * scale]);
                (
                    vec![lamp(-0.8, -0.36, 0.42, 2.1, 0xFF_E9C8)],
                    hex(0xD5_E4FF) * 0.34,
                    0.55,
                    roof,
                )
            }
            Daylight::Floodlit => {
                let masts = [(-1.0, -0.8), (1.0, -0.8), (-1.0, 0.8), (1.0, 0.8)];
                let lamps = masts
                    .map(|(x, y)| lamp(x, y, 0.85, 0.42, 0xF2_F6FF))
                    .to_vec();
                (lamps, hex(0xE8_F0FF) * 0.16, 0.42, None)
            }
        };
        Self {
            lamps,
            sky,
            bounce: hex(0x6B_8F4A) * 0.35,
            stands,
            roof,
            half_length: 0.5 * field.length_m,
            half_width: 0.5 * field.width_m,
            daylight,
        }
    }

    /// The light on open ground.
    pub fn on_ground(&self, point: Vec3) -> Light {
        self.lamps
            .iter()
            .map(|lamp| self.lamp_on_ground(lamp, point))
            .sum::<Light>()
            + self.sky
    }

    /// What one lamp gives to the ground at a place.
    pub fn lamp_on_ground(&self, lamp: &Lamp, point: Vec3) -> Light {
        lamp.light * (lamp.towards.z as f32 * self.open_to(lamp, point))
    }

    /// The light of the sky on the ground.
    pub const fn sky(&self) -> Light {
        self.sky
    }

    /// The light that a surface with this unit normal throws back, standing at `point`.
    pub fn shade(&self, albedo: Light, normal: Vec3, point: Vec3) -> Light {
        // Sky from above and grass from below, in the shares of a hemisphere that the surface sees
        // of both; then the lamps.
        let up = normal.z as f32;
        let mut light = self.sky * (0.5 + 0.5 * up) + self.bounce * (0.5 - 0.5 * up);
        for lamp in &self.lamps {
            let facing = normal.dot(&lamp.towards) as f32;
            // Cloth and skin are softer than a stone ball: the terminator is wrapped a little.
            let wrapped = ((facing + 0.15) / 1.15).max(0.0);
            light += lamp.light * (wrapped * self.open_to(lamp, point));
        }
        albedo.component_mul(&light)
    }

    /// How much of a lamp is seen from a place beside the roof's edge: 0 to 1.
    fn open_to(&self, lamp: &Lamp, point: Vec3) -> f32 {
        let Some([height, beyond]) = self.roof else {
            return 1.0;
        };
        // By how much the way to the lamp passes over the roof's edge at the left or near side, m.
        // The way rises by z / |slope| for each metre that it goes towards that side; to a lamp on
        // the other side it is free. The roof's shadow is soft over half a metre.
        let clearance = |from_edge: f64, slope: f64| {
            if slope >= 0.0 {
                return f64::INFINITY;
            }
            point.z + lamp.towards.z / -slope * (from_edge + beyond) - height
        };
        let over_left = clearance(point.x + self.half_length, lamp.towards.x);
        let over_near = clearance(point.y + self.half_width, lamp.towards.y);
        smooth_step(-0.25, 0.25, over_left.min(over_near) as f32)
    }

    /// The sky in a direction.
    pub fn sky_in(&self, direction: Vec3) -> Light {
        let height = (direction.z / direction.norm()).clamp(0.0, 1.0) as f32;
        let (low, high) = match self.daylight {
            Daylight::Hazy => (hex(0xDF_E8F0), hex(0x8F_B6DE)),
            Daylight::LowSun => (hex(0xF6_E3C2), hex(0x7F_AEDD)),
            Daylight::Floodlit => (hex(0x1A_2233), hex(0x06_0A14)),
        };
        mix(low, high, smooth_step(0.0, 0.5, height))
    }
}

/// Linear light: red, green, blue; 1 is the white of a sheet of paper in full light.
pub(super) type Light = nalgebra::Vector3<f32>;

/// The linear light of an sRGB colour written as `0xRRGGBB`.
pub(super) fn hex(rgb: u32) -> Light {
    let channel = |shift: u32| decode(((rgb >> shift) & 0xff) as f32 / 255.0);
    Light::new(channel(16), channel(8), channel(0))
}

/// sRGB (0 to 1) to linear light.
pub(super) fn decode(encoded: f32) -> f32 {
    if encoded <= 0.040_45 {
        encoded / 12.92
    } else {
        ((encoded + 0.055) / 1.055).powf(2.4)
    }
}

/// Linear light to sRGB (0 to 1), clipped.
pub(super) fn encode(linear: f32) -> f32 {
    let x = linear.clamp(0.0, 1.0);
    if x <= 0.003_130_8 {
        x * 12.92
    } else {
        1.055 * x.powf(1.0 / 2.4) - 0.055
    }
}

/// The straight mix of two lights: `a` at 0, `b` at 1.
pub(super) fn mix(a: Light, b: Light, share: f32) -> Light {
    a + (b - a) * share
}

/// 0 below `from`, 1 above `to`, smooth between them.
pub(super) fn smooth_step(from: f32, to: f32, x: f32) -> f32 {
    let t = ((x - from) / (to - from)).clamp(0.0, 1.0);
    t * t * (3.0 - 2.0 * t)
}

#[cfg(test)]
mod tests {
    use super::*;
    use touchline_core::testing::soccer;

    #[test]
    fn a_low_sun_leaves_a_part_of_the_pitch_in_shadow_and_haze_does_not() {
        let field = soccer();
        let spread = |daylight| {
            let lighting = Lighting::new(daylight, &field);
            let at = |x: f64, y: f64| lighting.on_ground(Vec3::new(x, y, 0.0)).y;
            (at(40.0, 25.0), at(-40.0, -25.0))
        };
        let (sun, shadow) = spread(Daylight::LowSun);
        assert!(sun > 2.0 * shadow && shadow > 0.1, "{sun} {shadow}");
        for even in [Daylight::Hazy, Daylight::Floodlit] {
            let (one, other) = spread(even);
            assert!(one == other && (0.6..1.3).contains(&one), "{one} {other}");
        }
    }

    #[test]
    fn every_byte_survives_decoding_and_encoding() {
        for byte in 0..=255u8 {
            let again = encode(decode(f32::from(byte) / 255.0)) * 255.0;
            assert!(
                (again - f32::from(byte)).abs() < 0.01,
                "{byte} came back as {again}"
            );
        }
    }
}
