//! Where a picture is even: where the ground is seen, and neither players nor a crowd hide it.
//!
//! That a line is not shown says something only there.

use touchline_core::geometry::{ImagePoint, ImageSize};
use touchline_vision::paint::GroundPicture;

/// Side of a block, px at 1920 px width.
const BLOCK_PX: f64 = 24.0;

/// Maximum mean slope of the brightness in an even block, grey levels / px: planks of a floor have
/// 1 to 3, a crowd 8 and more.
const MAX_SLOPE: f64 = 5.0;

/// Places between two points that are looked at.
const PLACES: u32 = 12;

/// The even blocks of a picture.
pub struct EvenAreas {
    block_px: f64,
    columns: usize,
    is_even: Vec<bool>,
}

impl EvenAreas {
    pub fn detect(ground: &GroundPicture) -> Self {
        let size: ImageSize = ground.size();
        let block_px = (BLOCK_PX * size.scale_from_1920()).max(4.0);
        let blocks = |side: u32| (f64::from(side) / block_px).ceil() as usize;
        let (columns, rows) = (blocks(size.width), blocks(size.height));
        let mut sums = vec![(0.0, 0.0); columns * rows];
        for y in (1..size.height.saturating_sub(1)).step_by(2) {
            for x in (1..size.width.saturating_sub(1)).step_by(2) {
                let grey = |dx: f64, dy: f64| {
                    ground.grey().at(ImagePoint::new(
                        f64::from(x) + 0.5 + dx,
                        f64::from(y) + 0.5 + dy,
                    ))
                };
                let slope = 0.5
                    * (grey(1.0, 0.0) - grey(-1.0, 0.0)).hypot(grey(0.0, 1.0) - grey(0.0, -1.0));
                let block = |at: u32| (f64::from(at) / block_px) as usize;
                let (sum, count) = &mut sums[block(y) * columns + block(x)];
                *sum += slope;
                *count += 1.0;
            }
        }
        Self {
            block_px,
            columns,
            is_even: sums
                .iter()
                .map(|(sum, count)| *sum <= MAX_SLOPE * *count)
                .collect(),
        }
    }

    /// The share of the way between two points that is even.
    pub fn share_between(&self, from: ImagePoint, to: ImagePoint) -> f64 {
        let way = to.offset_from(from);
        let even = (0..PLACES).filter(|place| {
            let share = (f64::from(*place) + 0.5) / f64::from(PLACES);
            self.is_even_at(from.translate(way * share))
        });
        even.count() as f64 / f64::from(PLACES)
    }

    fn is_even_at(&self, at: ImagePoint) -> bool {
        let [column, row] = [at.x, at.y].map(|at| (at / self.block_px) as usize);
        column < self.columns
            && self
                .is_even
                .get(row * self.columns + column)
                .copied()
                .unwrap_or(false)
    }
}
