//! Distances from straight segments.

use super::ImagePoint;
use nalgebra::SVector;

/// The distance of a point from the segment between two ends, in any number of dimensions; a
/// segment of zero length is a point.
pub fn distance_from_segment<const D: usize>(
    point: SVector<f64, D>,
    [from, to]: [SVector<f64, D>; 2],
) -> f64 {
    let (along, offset) = (to - from, point - from);
    (offset - along * share_along(offset, along)).norm()
}

/// Where the foot of a point lies on a segment, as a share of its length from 0 to 1; both are
/// vectors from the segment's beginning.
fn share_along<const D: usize>(offset: SVector<f64, D>, along: SVector<f64, D>) -> f64 {
    // The foot of the perpendicular is clamped to the segment: beyond an end, the end is nearest.
    let length_squared = along.norm_squared();
    if length_squared > 0.0 {
        (offset.dot(&along) / length_squared).clamp(0.0, 1.0)
    } else {
        0.0
    }
}

impl ImagePoint {
    /// The distance from the segment between two points, px.
    pub fn distance_from_segment_px(self, from: Self, to: Self) -> f64 {
        distance_from_segment(
            self.offset_from(from),
            [super::Vec2::zeros(), to.offset_from(from)],
        )
    }

    /// The distance from a polyline, px; infinite if that has fewer than two points.
    pub fn distance_from_polyline_px(self, polyline: &[Self]) -> f64 {
        polyline
            .windows(2)
            .map(|ends| self.distance_from_segment_px(ends[0], ends[1]))
            .fold(f64::INFINITY, f64::min)
    }

    /// The point of the segment between two points that is nearest to this one.
    #[must_use]
    pub fn nearest_on_segment(self, from: Self, to: Self) -> Self {
        let along = to.offset_from(from);
        from.translate(along * share_along(self.offset_from(from), along))
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::geometry::Vec3;

    #[test]
    fn the_nearest_point_is_the_foot_or_an_end() {
        let ends = [ImagePoint::new(10.0, 5.0), ImagePoint::new(30.0, 5.0)];
        for (at, nearest) in [
            ((20.0, 9.0), (20.0, 5.0)),
            ((7.0, 1.0), (10.0, 5.0)),
            ((34.0, 8.0), (30.0, 5.0)),
        ] {
            let found = ImagePoint::new(at.0, at.1).nearest_on_segment(ends[0], ends[1]);
            assert_eq!((found.x, found.y), nearest);
        }
        let point = ImagePoint::new(13.0, 9.0).nearest_on_segment(ends[0], ends[0]);
        assert_eq!(point, ends[0], "a segment without length");
    }

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
