//! Linear light and its encoding: everything is drawn in linear light, as a sensor gathers it, and
//! encoded at the end.

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
