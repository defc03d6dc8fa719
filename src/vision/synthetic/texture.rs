//! A picture in the world, prefiltered so that it neither aliases nor blurs when seen from far or
//! askew.

use super::light::{Light, mix};

/// A picture and its halvings.
#[derive(Clone, Debug)]
pub(super) struct Texture {
    levels: Vec<Level>,
}

#[derive(Clone, Debug)]
struct Level {
    width: usize,
    height: usize,
    texels: Vec<Light>,
}

/// The most samples along the longer axis of a pixel's footprint.
const MAX_TAPS: f32 = 12.0;

impl Texture {
    /// A texture of `width` × `height` texels given by their centres.
    pub fn paint(width: usize, height: usize, texel: impl Fn(usize, usize) -> Light) -> Self {
        let texels = (0..width * height)
            .map(|index| texel(index % width, index / width))
            .collect();
        let mut levels = vec![Level {
            width,
            height,
            texels,
        }];
        while let Some(last) = levels
            .last()
            .filter(|level| level.width > 1 || level.height > 1)
        {
            let half = last.halve();
            levels.push(half);
        }
        Self { levels }
    }

    /// The mean over a pixel's footprint: centre (x, y) and extents along both axes in texels.
    pub fn sample(&self, x: f32, y: f32, reach_x: f32, reach_y: f32) -> Light {
        // Anisotropic filtering: one level alone would blur a board that is seen askew along both
        // axes. The level fits the shorter extent, and several samples in a row cover the longer
        // one; beyond `MAX_TAPS` they would leave gaps, so the level rises instead.
        let (reach_x, reach_y) = (reach_x.max(1e-3), reach_y.max(1e-3));
        let (short, long) = if reach_x < reach_y {
            (reach_x, reach_y)
        } else {
            (reach_y, reach_x)
        };
        let taps = (long / short).min(MAX_TAPS).ceil();
        let step = long / taps;
        let level = short.max(step).log2().max(0.0);
        let mut sum = Light::zeros();
        for tap in 0..taps as usize {
            let along = (tap as f32 + 0.5) * step - 0.5 * long;
            sum += if reach_x < reach_y {
                self.at_level(x, y + along, level)
            } else {
                self.at_level(x + along, y, level)
            };
        }
        sum / taps
    }

    /// The colour at a level between two halvings, mixed from both so that no seam shows where the
    /// level changes.
    fn at_level(&self, x: f32, y: f32, level: f32) -> Light {
        let last = self.levels.len() - 1;
        let lower = (level as usize).min(last);
        let fine = self.levels[lower].bilinear(x, y, lower);
        if lower == last || level == lower as f32 {
            return fine;
        }
        mix(
            fine,
            self.levels[lower + 1].bilinear(x, y, lower + 1),
            level - lower as f32,
        )
    }
}

impl Level {
    /// A texel; beyond the border that of the border.
    fn at(&self, x: i64, y: i64) -> Light {
        let x = x.clamp(0, self.width as i64 - 1) as usize;
        let y = y.clamp(0, self.height as i64 - 1) as usize;
        self.texels[y * self.width + x]
    }

    fn halve(&self) -> Self {
        // An odd side is rounded up, and its last column or row counts twice.
        let (width, height) = (self.width.div_ceil(2), self.height.div_ceil(2));
        let texels = (0..width * height)
            .map(|index| {
                let (x, y) = (2 * (index % width) as i64, 2 * (index / width) as i64);
                (self.at(x, y) + self.at(x + 1, y) + self.at(x, y + 1) + self.at(x + 1, y + 1))
                    * 0.25
            })
            .collect();
        Self {
            width,
            height,
            texels,
        }
    }

    /// Bilinear at a place given in texels of the full picture.
    fn bilinear(&self, x: f32, y: f32, level: usize) -> Light {
        // Texel centres are at half-integers at every level.
        let scale = 1.0 / (1_u32 << level) as f32;
        let (x, y) = (x * scale - 0.5, y * scale - 0.5);
        let (column, row) = (x.floor(), y.floor());
        let (u, v) = (x - column, y - row);
        let (column, row) = (column as i64, row as i64);
        let top = mix(self.at(column, row), self.at(column + 1, row), u);
        let bottom = mix(self.at(column, row + 1), self.at(column + 1, row + 1), u);
        mix(top, bottom, v)
    }
}

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
    fn a_checkerboard_is_itself_from_near_and_grey_from_far() {
        let board = Texture::paint(64, 16, |x, y| {
            Light::repeat(if (x + y) % 2 == 0 { 1.0 } else { 0.0 })
        });
        assert!((board.sample(0.5, 0.5, 0.1, 0.1).x - 1.0).abs() < 1e-6);
        assert!((board.sample(30.0, 8.0, 8.0, 8.0).x - 0.5).abs() < 1e-3);
        let stripes = Texture::paint(64, 16, |x, _| {
            Light::repeat(if x % 2 == 0 { 1.0 } else { 0.0 })
        });
        // Long along x only: the stripes average out; long along y only: they stay.
        assert!((stripes.sample(30.0, 8.0, 8.0, 0.5).x - 0.5).abs() < 0.07);
        assert!(stripes.sample(30.5, 8.0, 0.5, 8.0).x > 0.95);
    }

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
