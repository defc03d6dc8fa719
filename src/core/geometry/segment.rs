//! Distances from straight segments.

use super::ImagePoint;
use nalgebra::SVector;

/// The distance of a point from the segment between two ends, in any number of dimensions; a
/// segment of zero length is a point.
#[must_use]
pub fn distance_from_segment<const D: usize>(
    point: SVector<f64, D>,
    [from, to]: [SVector<f64, D>; 2],
) -> f64 {
    let (along, offset) = (to - from, point - from);
    let length_squared = along.norm_squared();
    let share = if length_squared > 0.0 {
        (offset.dot(&along) / length_squared).clamp(0.0, 1.0)
    } else {
        0.0
    };
    (offset - along * share).norm()
}

impl ImagePoint {
    /// The distance from the segment between two points, px.
    #[must_use]
    pub fn distance_from_segment_px(self, from: Self, to: Self) -> f64 {
        distance_from_segment(
            self.offset_from(from),
            [super::Vec2::zeros(), to.offset_from(from)],
        )
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::geometry::Vec3;

    #[test]
    fn beside_beyond_and_a_segment_without_length() {
        let ends = [ImagePoint::new(10.0, 5.0), ImagePoint::new(30.0, 5.0)];
        let distance = |x, y| ImagePoint::new(x, y).distance_from_segment_px(ends[0], ends[1]);
        assert_eq!(
            (distance(20.0, 9.0), distance(7.0, 1.0), distance(34.0, 8.0)),
            (4.0, 5.0, 5.0)
        );
        assert_eq!(
            ImagePoint::new(13.0, 9.0).distance_from_segment_px(ends[0], ends[0]),
            5.0
        );
        assert_eq!(
            distance_from_segment(Vec3::z(), [Vec3::zeros(), Vec3::x()]),
            1.0
        );
    }
}
