//! The brightness or the colour along the normal of a line.

use crate::media::GreyPicture;
use crate::paint::GroundPicture;
use std::ops::{AddAssign, Div, Range, Sub};
use touchline_core::geometry::{ImagePoint, Vec2};
use touchline_core::markings::LineSample;

/// Each sample is the mean of points at these distances along the line, px, against noise.
const ALONG_PX: [f64; 3] = [-3.0, 0.0, 3.0];

/// A picture from which a profile is read.
pub(in crate::paint) trait ProfileSource {
    /// What a sample of the profile is: a grey level, or a colour.
    type Value;

    /// The mean of its values at some points, px.
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
pub(in crate::paint) struct Profile<T> {
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
    /// Reads the values every `step_px`, to at least `reach_px` on both sides of a point. Outside
    /// the picture its border is repeated.
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

    /// Number of steps from a sample that reach a distance: rounded up.
    pub fn steps_within(&self, distance_px: f64) -> usize {
        (distance_px / self.step_px).ceil() as usize
    }

    /// The samples that are at least `margin_px` away from both ends.
    pub fn without_margins(&self, margin_px: f64) -> Range<usize> {
        let skipped = self.places(margin_px).max(0) as usize;
        skipped..self.len().saturating_sub(skipped)
    }

    /// The value of a sample.
    pub fn value(&self, index: usize) -> T {
        self.values[index]
    }

    /// Mean of the samples `index + from` to `index + to`, both included, clipped to the profile.
    pub fn mean(&self, index: usize, from: isize, to: isize) -> T {
        // A profile that was read has at least one sample.
        let last = self.values.len() - 1;
        let from = index.saturating_add_signed(from).min(last);
        let to = index.saturating_add_signed(to).min(last);
        (self.sums[to + 1] - self.sums[from]) / (to + 1 - from) as f64
    }

    /// The means of the bands from `near` to `far` samples before and behind a sample.
    pub fn beside(&self, index: usize, near: isize, far: isize) -> [T; 2] {
        [self.mean(index, -far, -near), self.mean(index, near, far)]
    }

    /// The fractional index at which the level of the values first falls below a limit, going from
    /// a sample in one direction (1 or −1); linear between samples. None within that many steps.
    pub fn falls_below(
        &self,
        level_of: impl Fn(T) -> f64,
        from: usize,
        direction: isize,
        limit: f64,
        steps: usize,
    ) -> Option<f64> {
        let mut last = level_of(self.values[from]);
        let mut index = from;
        for _ in 0..steps {
            index = index.checked_add_signed(direction)?;
            let here = level_of(*self.values.get(index)?);
            if here < limit {
                // Share of the last step that lies beyond the crossing of the limit; at most 1,
                // because the search may begin below the limit.
                let beyond = if last > here {
                    ((limit - here) / (last - here)).min(1.0)
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

/// Full width at half maximum that optics and compression give to an infinitely thin line, px.
const BLUR_PX: f64 = 1.8;

/// Gap between the edge of the paint and the ground that it is compared with, px.
const GAP_PX: f64 = 1.3;

/// Distances from the paint's edge at which the ground's colour is tested, px.
const COLOUR_PX: [f64; 3] = [2.0, 3.5, 5.0];

/// A ridge of paint across a line.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(in crate::paint) struct Ridge {
    /// Offset of its centre from the predicted line, px along the normal.
    pub offset_px: f64,
    /// Full width at half the contrast, px.
    pub width_px: f64,
}

/// The position, direction and expected width of a search for paint.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(in crate::paint) struct Across {
    /// Centre of the search, px.
    pub at: ImagePoint,
    /// Unit vector across the line, in the picture.
    pub normal: Vec2,
    /// Predicted width of the paint, px.
    pub width_px: f64,
    /// Direction out of the playing area, where the ground may end: 1 along the normal, −1 against
    /// it, 0 if both sides are inside.
    pub outward: f64,
}

impl From<&LineSample> for Across {
    fn from(sample: &LineSample) -> Self {
        let LineSample {
            image,
            normal,
            width_px,
            outward,
            ..
        } = *sample;
        Self {
            at: image,
            normal,
            width_px,
            outward,
        }
    }
}

impl Across {
    /// Width of the band of ground beside the paint that it is compared with, px.
    fn band_px(&self) -> f64 {
        (0.6 * self.width_px).max(2.5)
    }

    /// Distances from the centre of the paint at which that band begins and ends, px.
    pub fn beside_px(&self) -> (f64, f64) {
        let near_px = 0.5 * self.width_px + GAP_PX;
        (near_px, near_px + self.band_px())
    }

    /// How far the profile extends beyond the reach of the search, px.
    pub fn margin_px(&self) -> f64 {
        self.beside_px().1 + 1.0
    }

    /// Predicted width of the ridge, px. Widths of convolved profiles add in quadrature (exactly so
    /// for Gaussians).
    pub fn expected_width_px(&self) -> f64 {
        self.width_px.hypot(BLUR_PX)
    }

    /// The point of the picture at an offset along the normal, px.
    pub fn point(&self, offset_px: f64) -> ImagePoint {
        self.at.translate(self.normal * offset_px)
    }
}

/// Whether a ridge looks like the paint of the line: within reach, as wide as the camera predicts
/// it, within generous limits, and with ground on the inner sides.
pub(super) fn is_like_paint(
    ground: &GroundPicture,
    across: &Across,
    ridge: &Ridge,
    reach_px: f64,
) -> bool {
    // The limits are generous: the width comes from a camera that may be rough, and the blur is
    // that of a typical picture.
    let expected_px = across.expected_width_px();
    (0.4 * expected_px..=1.6 * expected_px + 0.5).contains(&ridge.width_px)
        && ridge.offset_px.abs() <= reach_px
        && is_on_ground(ground, across, ridge)
}

/// Whether most of the points beside a ridge have the ground's colours, on every side within the
/// playing area.
fn is_on_ground(ground: &GroundPicture, across: &Across, ridge: &Ridge) -> bool {
    // `outward` is the sign of the side where the ground may end, behind a touchline for example.
    // That side is not tested.
    let mut sides = [-1.0, 1.0]
        .into_iter()
        .filter(|sign| sign * across.outward <= 0.0);
    sides.all(|sign| {
        let on_ground = COLOUR_PX.into_iter().filter(|beyond_px| {
            ground.is_ground(
                across.point(ridge.offset_px + sign * (0.5 * ridge.width_px + beyond_px)),
            )
        });
        2 * on_ground.count() > COLOUR_PX.len()
    })
}
