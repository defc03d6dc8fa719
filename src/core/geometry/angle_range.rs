//! Arcs of directions. Pan wraps at ±180°; only this file handles that.
//!
//! The minimum and maximum of wrapped angles do not give a range: 179° and −179° are two degrees
//! apart, as a camera on the far side shows.

use super::{Angle, Directions};
use std::f64::consts::{PI, TAU};
use std::fmt;

/// An arc of the circle: from its start in the positive sense (for a pan: to the right) to its end,
/// both included; at most the whole circle.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct AngleRange {
    /// Within (−π, π], or −π for the whole circle.
    start: Angle,
    /// Not below `start`, and at most 2π above.
    end: Angle,
}

impl AngleRange {
    /// Every direction, from −180° to 180°.
    pub const FULL: Self = Self {
        start: Angle::from_radians(-PI),
        end: Angle::from_radians(PI),
    };

    /// The arc from `start` in the positive sense to `end`; an end below the start lies beyond
    /// ±180°. If they differ by 360° or more, the full circle.
    pub fn new(start: Angle, end: Angle) -> Self {
        let width = end - start;
        // Negated, so that NaN, too, gives the full circle, which excludes nothing.
        if !(width.abs().radians() < TAU) {
            return Self::FULL;
        }
        let wrapped = start.wrap();
        // An angle that needs no wrapping must stay bit-identical; adding the width would round it.
        let end = if wrapped == start {
            end
        } else {
            wrapped + width
        };
        Self {
            start: wrapped,
            end: if end < wrapped {
                end + Angle::TURN
            } else {
                end
            },
        }
    }

    /// The arc around a direction, to either side.
    pub fn around(centre: Angle, half_width: Angle) -> Self {
        if half_width.radians() < PI {
            Self::new(centre - half_width, centre + half_width)
        } else {
            Self::FULL
        }
    }

    /// The smallest arc that contains all of some directions: the complement of the largest gap
    /// between them. None without any. If several gaps are equally large, the arc leaves out the
    /// one that contains ±180°, or else the first above it.
    pub fn smallest(angles: impl IntoIterator<Item = Angle>) -> Option<Self> {
        Self::smallest_of(&angles.into_iter().collect())
    }

    /// The smallest arc that contains all of a set of directions; none without any.
    pub fn smallest_of(directions: &Directions) -> Option<Self> {
        directions
            .smallest_arc()
            .map(|[start, end]| Self { start, end })
    }

    /// The same with one of the directions left out.
    pub fn smallest_without(directions: &Directions, left_out: Angle) -> Option<Self> {
        directions
            .smallest_arc_without(left_out)
            .map(|[start, end]| Self { start, end })
    }

    /// The indices of directions in their order along the smallest arc; equal ones keep their
    /// order.
    pub fn along_smallest(angles: &[Angle]) -> Vec<usize> {
        let Some(arc) = Self::smallest(angles.iter().copied()) else {
            return Vec::new();
        };
        // Unwrapped along the arc the directions are plain numbers without a jump. The sort is
        // stable, which leaves equal directions in their order.
        let from_start = |place: &usize| arc.unwrap_angle(angles[*place]).radians();
        let mut order: Vec<usize> = (0..angles.len()).collect();
        order.sort_by(|a, b| from_start(a).total_cmp(&from_start(b)));
        order
    }

    /// The start, within (−π, π]; −π for the full circle.
    pub const fn start(&self) -> Angle {
        self.start
    }

    /// The end: not below the start, so above π where the arc contains ±180°. [`Angle::wrap`]
    /// makes it a direction.
    pub const fn end(&self) -> Angle {
        self.end
    }

    /// The angle from the start to the end, at most 2π.
    pub fn width(&self) -> Angle {
        self.end - self.start
    }

    /// The direction in its middle, within (−π, π].
    pub fn centre(&self) -> Angle {
        self.middle().wrap()
    }

    /// Whether it is the whole circle.
    pub fn is_full(&self) -> bool {
        self.width().radians() >= TAU
    }

    /// Whether a direction lies within, the ends included.
    pub fn contains(&self, angle: Angle) -> bool {
        // The representative of the direction in [start, start + 2π), where `end` lies as well.
        let wrapped = angle.wrap();
        let above_start = if wrapped < self.start {
            wrapped + Angle::TURN
        } else {
            wrapped
        };
        self.is_full() || above_start <= self.end
    }

    /// The angle from a direction to the nearer end; zero within.
    pub fn distance(&self, angle: Angle) -> Angle {
        if self.contains(angle) {
            return Angle::ZERO;
        }
        let [from_start, from_end] =
            [self.start, self.end].map(|border| angle.turn_from(border).abs());
        if from_start < from_end {
            from_start
        } else {
            from_end
        }
    }

    /// The arc extended by a margin on either side.
    #[must_use]
    pub fn expand(&self, margin: Angle) -> Self {
        if (self.width() + margin * 2.0).radians() < TAU {
            Self::new(self.start - margin, self.end + margin)
        } else {
            Self::FULL
        }
    }

    /// A direction as the angle within π of the arc's middle, so that angles in the arc increase
    /// from its start to its end without a jump.
    pub fn unwrap_angle(&self, angle: Angle) -> Angle {
        // An angle that needs no revolution is returned as it is, to the bit.
        let revolutions = ((self.middle() - angle).radians() / TAU).round();
        if revolutions == 0.0 {
            angle
        } else {
            angle + Angle::TURN * revolutions
        }
    }

    /// The angle at a fraction of the way from the start (0) to the end (1), without a jump.
    pub fn at(&self, share: f64) -> Angle {
        self.start + self.width() * share
    }

    /// The position of a direction from the start (0) to the end (1); outside of these if it is not
    /// in the arc, not finite if the arc is a single direction.
    pub fn share(&self, angle: Angle) -> f64 {
        (self.unwrap_angle(angle) - self.start).radians() / self.width().radians()
    }

    /// The middle, without a jump between start and end.
    fn middle(&self) -> Angle {
        self.at(0.5)
    }
}

impl fmt::Display for AngleRange {
    /// Both ends as directions: "170.00° to -175.00°".
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let digits = f.precision().unwrap_or(2);
        let end = if self.is_full() {
            self.end
        } else {
            self.end.wrap()
        };
        write!(f, "{:.digits$} to {end:.digits$}", self.start)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    fn degrees(degrees: f64) -> Angle {
        Angle::from_degrees(degrees)
    }

    fn arc(start: f64, end: f64) -> AngleRange {
        AngleRange::new(degrees(start), degrees(end))
    }

    fn smallest(of: &[f64]) -> AngleRange {
        AngleRange::smallest(of.iter().copied().map(degrees)).unwrap()
    }

    #[test]
    fn the_smallest_arc_leaves_the_largest_gap_out() {
        for (of, start, end) in [
            (&[10.0, -20.0, 5.0][..], -20.0, 10.0),
            (&[179.0, -178.0, 176.0], 176.0, 182.0),
            (&[-90.0, 180.0], 180.0, 270.0),
            (&[-100.0, 100.0], 100.0, 260.0),
            (&[33.0], 33.0, 33.0),
            (&[-180.0], 180.0, 180.0),
            // Half a turn either way: the gap at ±180° is taken.
            (&[-90.0, 90.0], -90.0, 90.0),
            (&[0.0, 120.0, -120.0], -120.0, 120.0),
        ] {
            let found = smallest(of);
            assert!(
                (found.start().degrees() - start).abs() < 1e-12,
                "{of:?}: {found:?}"
            );
            assert!(
                (found.end().degrees() - end).abs() < 1e-12,
                "{of:?}: {found:?}"
            );
        }
        assert_eq!(AngleRange::smallest([]), None);
    }

    #[test]
    fn directions_are_ordered_along_the_smallest_arc() {
        let along = |of: &[f64]| {
            AngleRange::along_smallest(&of.iter().copied().map(degrees).collect::<Vec<_>>())
        };
        assert_eq!(along(&[10.0, -20.0, 5.0, -20.0]), [1, 3, 2, 0]);
        assert_eq!(along(&[-178.0, 176.0, 179.0]), [1, 2, 0], "over the seam");
        assert_eq!(along(&[]), [0_usize; 0]);
    }

    #[test]
    fn an_arc_over_the_seam_holds_what_lies_within() {
        let far_side = arc(170.0, -160.0);
        assert_eq!(far_side.width().degrees().round(), 30.0);
        assert!((far_side.centre().degrees() + 175.0).abs() < 1e-12);
        for within in [170.0, 180.0, -180.0, -160.0, 530.0] {
            assert!(far_side.contains(degrees(within)), "{within}");
            assert_eq!(far_side.distance(degrees(within)), Angle::ZERO);
        }
        for (outside, distance) in [
            (169.0, 1.0),
            (-159.0, 1.0),
            (0.0, 160.0),
            (5.0, 165.0),
            (-10.0, 150.0),
        ] {
            assert!(!far_side.contains(degrees(outside)), "{outside}");
            assert!(
                (far_side.distance(degrees(outside)).degrees() - distance).abs() < 1e-9,
                "{outside}"
            );
        }
        assert_eq!(format!("{far_side:.1}"), "170.0° to -160.0°");
    }

    #[test]
    fn a_margin_widens_an_arc_up_to_the_full_circle() {
        let wide = arc(175.0, 178.0).expand(degrees(10.0));
        assert!(
            (wide.start().degrees() - 165.0).abs() < 1e-9
                && (wide.end().degrees() - 188.0).abs() < 1e-9
        );
        assert!(wide.contains(degrees(-172.5)) && !wide.contains(degrees(-171.5)));
        assert!(arc(-100.0, 100.0).expand(degrees(79.0)).width().degrees() < 360.0);
        assert_eq!(arc(-100.0, 100.0).expand(degrees(80.0)), AngleRange::FULL);
        assert_eq!(
            (arc(-180.0, 180.0), arc(0.0, 400.0)),
            (AngleRange::FULL, AngleRange::FULL)
        );
        assert_eq!(
            AngleRange::around(degrees(90.0), degrees(180.0)),
            AngleRange::FULL
        );
        assert!(AngleRange::FULL.is_full() && AngleRange::FULL.contains(degrees(-180.0)));
        assert_eq!(format!("{:.0}", AngleRange::FULL), "-180° to 180°");
    }

    #[test]
    fn directions_run_through_an_arc_without_a_jump() {
        let far_side = arc(150.0, -150.0);
        for (direction, along) in [
            (150.0, 150.0),
            (179.0, 179.0),
            (-179.0, 181.0),
            (-150.0, 210.0),
            (-100.0, 260.0),
        ] {
            assert!(
                (far_side.unwrap_angle(degrees(direction)).degrees() - along).abs() < 1e-9,
                "{direction}"
            );
        }
        assert!((far_side.share(degrees(-165.0)) - 0.75).abs() < 1e-12);
        assert!((far_side.at(0.75).wrap().degrees() + 165.0).abs() < 1e-9);
        let near_side = degrees(12.3);
        assert_eq!(
            arc(-40.0, 40.0).unwrap_angle(near_side),
            near_side,
            "what needs no turn keeps its bits"
        );
    }

    proptest! {
        #[test]
        fn the_smallest_arc_holds_all_and_no_smaller_one_does(
            of in proptest::collection::vec(-720.0..720.0_f64, 1..12),
            turned in -400.0..400.0_f64,
        ) {
            let found = smallest(&of);
            for direction in &of {
                prop_assert!(found.contains(degrees(*direction)), "{found:?} {direction}");
                let along = found.unwrap_angle(degrees(*direction));
                prop_assert!(along.radians() >= found.start().radians() - 1e-9);
                prop_assert!(along.radians() <= found.end().radians() + 1e-9);
            }
            // The width does not depend on the zero of the pan.
            let again: Vec<f64> = of.iter().map(|direction| direction + turned).collect();
            prop_assert!((smallest(&again).width() - found.width()).abs().radians() < 1e-9);
            prop_assert!(found.width().degrees() <= 360.0 * (1.0 - 1.0 / of.len() as f64) + 1e-9);
        }

        #[test]
        fn distance_is_how_much_an_arc_must_be_extended(
            start in -180.0..180.0_f64, width in 0.0..300.0_f64, direction in -180.0..180.0_f64,
        ) {
            let range = arc(start, start + width);
            let distance = range.distance(degrees(direction));
            prop_assert!(range.expand(distance + degrees(1e-6)).contains(degrees(direction)));
            if distance.degrees() > 1e-5 {
                prop_assert!(!range.expand(distance - degrees(1e-6)).contains(degrees(direction)));
            }
        }
    }
}
