//! The brightness of the turf around a point: what distinguishes paint from a mowing stripe where
//! a video has lost the colours.
//!
//! Mowing makes light and dark stripes. Seen along the field they are as thin as lines far away.
//! Their colour is that of turf, but strong compression removes the faint colour differences, and
//! a light stripe then differs from the dark one beside it as paint does, by grey alone. Paint is
//! also brighter than the *light* stripes around it.

use super::ground_area::GroundArea;
use crate::paint::GroundPicture;

/// Side of a block of the picture, px. The levels at a point are those of its block and the eight
/// around it: wide enough for several of the stripes that are as thin as lines.
const BLOCK_PX: usize = 32;

/// Blocks with fewer pixels of turf around them have no levels.
const MIN_PIXELS: u32 = 256;

/// Paint is brighter than the upper quartile of the turf by at least this share of the distance
/// between the quartiles. The middle of a stripe is 0.2 above it for a sinusoidal profile (its
/// quartiles are at ±1/√2 of the amplitude), and less for a rectangular one.
const MIN_EXCESS: f64 = 0.5;

/// Brightness of turf around a point, grey levels.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
struct Quartiles {
    lower: f64,
    upper: f64,
}

/// The turf's brightness all over a picture.
pub(in crate::paint) struct TurfLevels {
    columns: usize,
    /// By block, row by row; none where little turf is seen.
    quartiles: Vec<Option<Quartiles>>,
}

/// Sums over the pixels of a marking.
#[derive(Clone, Copy, Debug, Default)]
pub(in crate::paint) struct TurfExcess {
    above_turf: f64,
    spread_of_turf: f64,
}

impl TurfLevels {
    pub fn measure(ground: &GroundPicture, area: &GroundArea) -> Self {
        let (width, height) = (ground.size().width as usize, ground.size().height as usize);
        let (columns, rows) = (width.div_ceil(BLOCK_PX), height.div_ceil(BLOCK_PX));
        // Brightness is counted once by block; the nine blocks around a point add their counts, so
        // that the levels of neighbouring points are alike. The paint is counted, too: it covers
        // few of the pixels and hardly moves a quartile.
        let mut counts = vec![[0_u32; 256]; columns * rows];
        for y in 0..height {
            for x in 0..width {
                if area.holds(x, y) {
                    let level = ground.grey().values[y * width + x];
                    counts[y / BLOCK_PX * columns + x / BLOCK_PX][usize::from(level)] += 1;
                }
            }
        }
        let quartiles = (0..columns * rows)
            .map(|block| quartiles(&counts_around(&counts, block, [columns, rows])))
            .collect();
        Self { columns, quartiles }
    }

    /// How much brighter a pixel is than the turf around it, and how widely that turf scatters.
    /// Both are zero where the turf has no levels; a marking there is not light turf.
    pub fn excess(&self, x: usize, y: usize, level: f64) -> TurfExcess {
        let block = y / BLOCK_PX * self.columns + x / BLOCK_PX;
        let around = self.quartiles.get(block).copied().flatten();
        around.map_or_else(TurfExcess::default, |turf| TurfExcess {
            above_turf: level - turf.upper,
            spread_of_turf: turf.upper - turf.lower,
        })
    }
}

impl TurfExcess {
    pub fn add(&mut self, other: &Self) {
        self.above_turf += other.above_turf;
        self.spread_of_turf += other.spread_of_turf;
    }

    /// Whether a marking is no brighter than the light stripes of the turf around it.
    pub fn is_light_turf(&self) -> bool {
        self.above_turf < MIN_EXCESS * self.spread_of_turf
    }
}

/// The counts of a block and of the blocks around it, by grey level.
fn counts_around(counts: &[[u32; 256]], block: usize, [columns, rows]: [usize; 2]) -> [u32; 256] {
    let (column, row) = (block % columns, block / columns);
    let mut sum = [0_u32; 256];
    for row in row.saturating_sub(1)..(row + 2).min(rows) {
        for column in column.saturating_sub(1)..(column + 2).min(columns) {
            for (sum, count) in sum.iter_mut().zip(&counts[row * columns + column]) {
                *sum += count;
            }
        }
    }
    sum
}

/// The quartiles of brightness; none of too few pixels.
fn quartiles(counts: &[u32; 256]) -> Option<Quartiles> {
    let all: u32 = counts.iter().sum();
    if all < MIN_PIXELS {
        return None;
    }
    Some(Quartiles {
        lower: level_at(counts, 0.25 * f64::from(all))?,
        upper: level_at(counts, 0.75 * f64::from(all))?,
    })
}

/// The lowest grey level up to which at least `wanted` pixels are counted.
fn level_at(counts: &[u32; 256], wanted: f64) -> Option<f64> {
    let mut below = 0.0;
    let level = counts.iter().position(|count| {
        below += f64::from(*count);
        below >= wanted
    })?;
    Some(level as f64)
}

#[cfg(test)]
mod tests {
    use crate::media::Picture;
    use crate::paint::{GroundPicture, MarkingPixels};
    use touchline_core::geometry::ImageSize;

    /// Rows of light and dark turf that differ by grey alone, as after strong compression, with a
    /// painted line down the middle.
    fn stripes(line_levels: f64) -> Picture {
        let size = ImageSize::new(320, 180);
        let level = |x: u32, y: u32| {
            let stripe = 12.0 * (std::f64::consts::TAU * f64::from(y) / 20.0).sin();
            let off_px = f64::from(x) - 160.0;
            stripe + line_levels * (-0.5 * off_px * off_px).exp()
        };
        let pixels = (0..size.height)
            .flat_map(|y| (0..size.width).map(move |x| (x, y)))
            .flat_map(|(x, y)| {
                let [red, green, blue] =
                    [71.0, 109.0, 48.0].map(|turf| (turf + 12.0 + level(x, y)) as u8);
                [red, green, blue, 255]
            });
        Picture::new(size, pixels.collect()).unwrap()
    }

    #[test]
    fn stripes_of_mowing_without_their_colour_are_no_paint() {
        let seen =
            |picture: &Picture| MarkingPixels::detect(&GroundPicture::new(picture, &[])).points;
        assert_eq!(seen(&stripes(0.0)), []);
        let line = seen(&stripes(60.0));
        let off_line = line
            .iter()
            .filter(|point| (point.at.x - 160.5).abs() > 4.0)
            .count();
        assert!(line.len() > 120, "{} points of the line", line.len());
        assert!(off_line * 10 < line.len(), "{off_line} of {}", line.len());
    }
}
