//! The brightness or the colour along the normal of a line.

use crate::media::GreyPicture;
use std::ops::{AddAssign, Div, Sub};
use touchline_core::geometry::{ImagePoint, Vec2};

/// Each sample is the mean of points at these distances along the line, px, against noise.
const ALONG_PX: [f64; 3] = [-3.0, 0.0, 3.0];

/// A picture along whose normals a profile is read.
pub(super) trait ProfileSource {
    /// What the profile has of it.
    type Value;

    /// The mean of its values at some points.
    fn mean_at(&self, points: [ImagePoint; 3]) -> Self::Value;
}

impl ProfileSource for GreyPicture {
    type Value = f64;

    fn mean_at(&self, points: [ImagePoint; 3]) -> f64 {
        points.iter().map(|point| self.at(*point)).sum::<f64>() / points.len() as f64
    }
}

/// Grey levels or colours at equal distances along a normal. The buffers are reused from profile to
/// profile.
#[derive(Clone, Debug, Default)]
pub(super) struct Profile<T> {
    /// From one end of the normal to the other.
    values: Vec<T>,
    /// Prefix sums of the values, so that a mean over any range costs two look-ups.
    sums: Vec<T>,
    step_px: f64,
}

impl<T> Profile<T>
where
    T: Copy + Default + AddAssign + Sub<Output = T> + Div<f64, Output = T>,
{
    /// Reads the values every `step_px`, to at least `reach_px` on both sides of a point.
    pub fn read(
        &mut self,
        picture: &impl ProfileSource<Value = T>,
        middle: ImagePoint,
        normal: Vec2,
        reach_px: f64,
        step_px: f64,
    ) {
        // An odd number of samples, so that one lies on the middle.
        let half = (reach_px / step_px).ceil() as usize;
        self.step_px = step_px;
        let along = Vec2::new(-normal.y, normal.x);
        self.values.clear();
        self.sums.clear();
        let mut sum = T::default();
        self.sums.push(sum);
        for index in 0..=2 * half {
            let at = middle.translate(normal * ((index as f64 - half as f64) * step_px));
            let here = picture.mean_at(ALONG_PX.map(|by| at.translate(along * by)));
            sum += here;
            self.values.push(here);
            self.sums.push(sum);
        }
    }

    /// Number of samples.
    pub fn len(&self) -> usize {
        self.values.len()
    }

    /// Signed distance of a sample from the middle, px. The index may be fractional.
    pub fn offset_px(&self, index: f64) -> f64 {
        (index - (self.values.len() / 2) as f64) * self.step_px
    }

    /// Number of samples that a distance spans.
    pub fn places(&self, distance_px: f64) -> isize {
        (distance_px / self.step_px).round() as isize
    }

    /// The value of a sample.
    pub fn value(&self, index: usize) -> T {
        self.values[index]
    }

    /// Mean of the samples `index + from` to `index + to`, both included, clipped to the profile.
    pub fn mean(&self, index: usize, from: isize, to: isize) -> T {
        let last = self.values.len() - 1;
        let from = index.saturating_add_signed(from).min(last);
        let to = index.saturating_add_signed(to).min(last);
        (self.sums[to + 1] - self.sums[from]) / (to + 1 - from) as f64
    }
}

impl Profile<f64> {
    /// The fractional index at which the brightness first falls below a level, going from a sample
    /// in one direction; linear between samples. None within `within_px`.
    pub fn falls_below(
        &self,
        from: usize,
        direction: isize,
        level: f64,
        within_px: f64,
    ) -> Option<f64> {
        let mut last = self.values[from];
        let mut index = from;
        for _ in 0..(within_px / self.step_px).ceil() as usize {
            index = index.checked_add_signed(direction)?;
            let here = *self.values.get(index)?;
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

/// Whether no value within `reach` of one is larger; of equal values the first is the maximum.
pub(super) fn is_local_maximum(values: &[f64], index: usize, reach: usize) -> bool {
    let value = values[index];
    let around = index.saturating_sub(reach)..=(index + reach).min(values.len() - 1);
    let mut others = around.map(|other| (other, values[other]));
    !others.any(|(other, beside)| beside > value || (beside == value && other < index))
}
