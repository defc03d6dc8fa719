//! Seeded spatial noise: the same value at the same place for every camera, frame and thread.

/// A well-mixed hash of two integers and a seed (the finaliser of `MurmurHash3` after a Weyl-like
/// combination).
pub(super) const fn hash(seed: u32, x: i32, y: i32) -> u32 {
    let mut h = seed
        ^ (x as u32).wrapping_mul(0x9E37_79B1)
        ^ (y as u32).wrapping_mul(0x85EB_CA77).rotate_left(13);
    h ^= h >> 16;
    h = h.wrapping_mul(0x85EB_CA6B);
    h ^= h >> 13;
    h = h.wrapping_mul(0xC2B2_AE35);
    h ^ (h >> 16)
}

/// A seed for one purpose out of a scene's seed.
pub(super) const fn sub_seed(seed: u64, purpose: u32) -> u32 {
    hash(purpose, seed as i32, (seed >> 32) as i32)
}

/// A number in [0, 1) from a hash.
pub(super) const fn unit(hash: u32) -> f32 {
    (hash >> 8) as f32 / 16_777_216.0
}

/// Smooth noise in [−1, 1] with features of size one (value noise with a quintic fade).
pub(super) fn value_noise(seed: u32, x: f32, y: f32) -> f32 {
    let (column, row) = (x.floor(), y.floor());
    let (u, v) = (fade(x - column), fade(y - row));
    let at = |dx: i32, dy: i32| unit(hash(seed, column as i32 + dx, row as i32 + dy));
    let top = at(0, 0) + (at(1, 0) - at(0, 0)) * u;
    let bottom = at(0, 1) + (at(1, 1) - at(0, 1)) * u;
    2.0 * (top + (bottom - top) * v) - 1.0
}

/// Smooth noise in [−1, 1] of one variable: twice differentiable, so that what it moves moves
/// smoothly.
pub(super) fn smooth_walk(seed: u32, t: f64) -> f64 {
    let cell = t.floor();
    let u = t - cell;
    let u = u * u * u * (u * (u * 6.0 - 15.0) + 10.0);
    let at = |step: i32| f64::from(unit(hash(seed, cell as i32 + step, 0)));
    2.0 * (at(0) + (at(1) - at(0)) * u) - 1.0
}

/// How much of a pattern with features of `size` survives a pixel that covers `footprint` of it: 1
/// while a feature spans four pixels, 0 below one and a half. This is what a lens and a sensor do
/// to detail too fine for them.
pub(super) fn survives(footprint: f32, size: f32) -> f32 {
    let ratio = footprint / size;
    ((0.66 - ratio) / (0.66 - 0.25)).clamp(0.0, 1.0)
}

fn fade(t: f32) -> f32 {
    t * t * t * (t * (t * 6.0 - 15.0) + 10.0)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn noise_is_bounded_centred_and_continuous() {
        let mut sum = 0.0;
        for step in 0..40_000_u16 {
            let (x, y) = (
                f32::from(step % 200) * 0.37 - 30.0,
                f32::from(step / 200) * 0.41 - 30.0,
            );
            let here = value_noise(7, x, y);
            assert!(here.abs() <= 1.0);
            assert!((value_noise(7, x + 1e-3, y) - here).abs() < 0.01);
            sum += here;
        }
        assert!((sum / 40_000.0).abs() < 0.05, "mean {}", sum / 40_000.0);
    }

    #[test]
    fn detail_below_the_pixel_vanishes() {
        assert_eq!(survives(1.0, 1.0), 0.0);
        assert_eq!(survives(0.1, 1.0), 1.0);
    }
}
