//! A picture in the world, prefiltered so that it neither aliases nor blurs when seen from far or
//! askew.

use super::colour::{Light, mix};

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
}
