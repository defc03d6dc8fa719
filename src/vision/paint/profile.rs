//! The brightness along the normal of a line.

use crate::media::GreyPicture;
use touchline_core::geometry::{ImagePoint, Vec2};

/// Each sample is the mean of points at these distances along the line, px, against noise.
const ALONG_PX: [f64; 3] = [-3.0, 0.0, 3.0];

/// Grey levels at equal distances along a normal. The buffers are reused from profile to profile.
#[derive(Clone, Debug, Default)]
pub(super) struct Profile {
    /// Grey levels from one end of the normal to the other.
    grey: Vec<f64>,
    /// Prefix sums of the grey levels, so that a mean over any range costs two look-ups.
    sums: Vec<f64>,
    step_px: f64,
}

impl Profile {
    /// Reads the brightness every `step_px`, to at least `reach_px` on both sides of a point.
    pub fn read(
        &mut self,
        grey: &GreyPicture,
        middle: ImagePoint,
        normal: Vec2,
        reach_px: f64,
        step_px: f64,
    ) {
        // An odd number of samples, so that one lies on the middle.
        let half = (reach_px / step_px).ceil() as usize;
        self.step_px = step_px;
        let along = Vec2::new(-normal.y, normal.x);
        self.grey.clear();
        self.sums.clear();
        self.sums.push(0.0);
        let mut sum = 0.0;
        for index in 0..=2 * half {
            let at = middle.moved(normal * ((index as f64 - half as f64) * step_px));
            let here = ALONG_PX
                .iter()
                .map(|by| grey.at(at.moved(along * *by)))
                .sum::<f64>()
                / ALONG_PX.len() as f64;
            sum += here;
            self.grey.push(here);
            self.sums.push(sum);
        }
    }

    /// Number of samples.
    pub fn len(&self) -> usize {
        self.grey.len()
    }

    /// Signed distance of a sample from the middle, px. The index may be fractional.
    pub fn offset_px(&self, index: f64) -> f64 {
        (index - (self.grey.len() / 2) as f64) * self.step_px
    }

    /// Number of samples that a distance spans.
    pub fn places(&self, distance_px: f64) -> isize {
        (distance_px / self.step_px).round() as isize
    }

    /// The brightness of a sample.
    pub fn grey(&self, index: usize) -> f64 {
        self.grey[index]
    }

    /// Mean brightness of the samples `index + from` to `index + to`, both included, clipped to the
    /// profile.
    pub fn mean(&self, index: usize, from: isize, to: isize) -> f64 {
        let last = self.grey.len() - 1;
        let from = index.saturating_add_signed(from).min(last);
        let to = index.saturating_add_signed(to).min(last);
        (self.sums[to + 1] - self.sums[from]) / (to + 1 - from) as f64
    }

    /// The fractional index at which the brightness first falls below a level, going from a sample
    /// in one direction; linear between samples. None within `within_px`.
    pub fn falls_below(
        &self,
        from: usize,
        direction: isize,
        level: f64,
        within_px: f64,
    ) -> Option<f64> {
        let mut last = self.grey[from];
        let mut index = from;
        for _ in 0..(within_px / self.step_px).ceil() as usize {
            index = index.checked_add_signed(direction)?;
            let here = *self.grey.get(index)?;
            if here < level {
                // Share of the last step that lies beyond the crossing of the level.
                let beyond = if last > here {
                    ((level - here) / (last - here)).min(1.0)
                } else {
                    0.0
                };
                return Some(index as f64 - direction as f64 * beyond);
            }
            last = here;
        }
        None
    }
}
