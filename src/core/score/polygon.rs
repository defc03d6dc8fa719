//! Areas and intersections of polygons.
//!
//! Clipping uses `i_overlay`, on a grid of 64-bit integers that spans both inputs. It is exact up
//! to the rounding to that grid, about 10⁻¹⁶ of their size.

use crate::geometry::Vec2;
use i_overlay::core::fill_rule::FillRule;
use i_overlay::core::overlay_rule::OverlayRule;
use i_overlay::float::single::SingleFloatOverlay as _;
use nalgebra::SVector;

/// A closed polygon of either orientation. The last point is joined to the first.
pub(super) type Ring = Vec<Vec2>;

/// Twice the signed area: positive where the points run from +x towards +y.
fn doubled_area(ring: &[Vec2]) -> f64 {
    // Relative to a vertex, so that nothing cancels for a polygon far from the origin. The closing
    // edge ends at that vertex and adds nothing.
    let Some(origin) = ring.first() else {
        return 0.0;
    };
    ring.windows(2)
        .map(|pair| (pair[0] - origin).perp(&(pair[1] - origin)))
        .sum()
}

/// The area of polygons that do not overlap each other.
pub(super) fn area(rings: &[Ring]) -> f64 {
    rings
        .iter()
        .map(|ring| doubled_area(ring).abs() / 2.0)
        .sum()
}

/// The intersection of two sets of polygons, as polygons that do not overlap. Inputs without holes
/// give no holes.
pub(super) fn intersect(one: &[Ring], other: &[Ring]) -> Vec<Ring> {
    let (one, other) = (contours(one), contours(other));
    if one.is_empty() || other.is_empty() {
        return Vec::new();
    }
    let shapes = one.overlay_as::<i64>(&other, OverlayRule::Intersect, FillRule::NonZero);
    // A shape is its outer ring and then its holes, of which there are none.
    let outer = shapes
        .into_iter()
        .filter_map(|shape| shape.into_iter().next());
    outer
        .map(|ring| ring.into_iter().map(|[x, y]| Vec2::new(x, y)).collect())
        .collect()
}

/// The polygons that enclose an area, in the form that `i_overlay` takes.
fn contours(rings: &[Ring]) -> Vec<Vec<[f64; 2]>> {
    rings
        .iter()
        .filter(|ring| ring.len() >= 3)
        .map(|ring| ring.iter().map(|point| [point.x, point.y]).collect())
        .collect()
}

/// The part of a convex polygon where `side` is not negative (Sutherland and Hodgman 1974).
pub(super) fn cut<const D: usize>(
    polygon: &[SVector<f64, D>],
    side: &dyn Fn(&SVector<f64, D>) -> f64,
) -> Vec<SVector<f64, D>> {
    let mut kept = Vec::with_capacity(polygon.len() + 1);
    for (i, here) in polygon.iter().enumerate() {
        let next = &polygon[(i + 1) % polygon.len()];
        let (at_here, at_next) = (side(here), side(next));
        if at_here >= 0.0 {
            kept.push(*here);
        }
        // Where the sign changes, the difference of the two values is not zero.
        if (at_here >= 0.0) != (at_next >= 0.0) {
            kept.push(here + (next - here) * (at_here / (at_here - at_next)));
        }
    }
    kept
}

#[cfg(test)]
mod tests {
    use super::*;

    fn ring(points: &[[f64; 2]]) -> Ring {
        points.iter().map(|[x, y]| Vec2::new(*x, *y)).collect()
    }

    fn square(x: f64, y: f64, side: f64) -> Ring {
        ring(&[[x, y], [x + side, y], [x + side, y + side], [x, y + side]])
    }

    #[test]
    fn areas_of_known_polygons() {
        assert!((area(&[square(-3.0, 7.0, 2.0)]) - 4.0).abs() < 1e-15);
        assert!((area(&[ring(&[[0.0, 0.0], [0.0, 3.0], [4.0, 0.0]])]) - 6.0).abs() < 1e-15);
        assert!(area(&[ring(&[[0.0, 0.0], [1.0, 1.0]]), Ring::new()]) == 0.0);
        // At a distance of a million metres no precision is lost.
        assert!((area(&[square(1e6, 1e6, 0.5)]) - 0.25).abs() < 1e-12);
    }

    #[test]
    fn intersections_of_known_polygons() {
        let both =
            |a: &Ring, b: &Ring| area(&intersect(std::slice::from_ref(a), std::slice::from_ref(b)));
        let unit = square(0.0, 0.0, 1.0);
        assert!((both(&unit, &square(0.5, 0.25, 1.0)) - 0.375).abs() < 1e-14);
        assert!(
            both(&unit, &square(1.0, 0.0, 1.0)) == 0.0,
            "they only touch"
        );
        assert!((both(&unit, &unit) - 1.0).abs() < 1e-15);
        // Either orientation works.
        let clockwise: Ring = unit.iter().rev().copied().collect();
        assert!((both(&clockwise, &square(-0.5, -0.5, 1.0)) - 0.25).abs() < 1e-14);
    }

    #[test]
    fn a_notched_polygon_may_share_two_parts() {
        // A U: two arms of width 1 and height 2 on a foot of height 1.
        let u = ring(&[
            [0.0, 0.0],
            [3.0, 0.0],
            [3.0, 3.0],
            [2.0, 3.0],
            [2.0, 1.0],
            [1.0, 1.0],
            [1.0, 3.0],
            [0.0, 3.0],
        ]);
        let bar = ring(&[[-1.0, 2.0], [4.0, 2.0], [4.0, 2.5], [-1.0, 2.5]]);
        let parts = intersect(&[u], &[bar]);
        assert_eq!(parts.len(), 2);
        assert!((area(&parts) - 1.0).abs() < 1e-14);
    }
}
