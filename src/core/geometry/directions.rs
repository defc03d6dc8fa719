//! A set of directions, with the smallest arc of all of them and of all but one.

use super::Angle;
use std::cmp::Reverse;
use std::f64::consts::TAU;

/// A set of directions; the same one may be in it more than once.
///
/// The smallest arc is the complement of the widest gap between neighbours. Leaving one direction
/// out joins the two gaps beside it, so only the widest three gaps have to be known.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Directions {
    /// rad within (−π, π], ascending.
    sorted: Vec<f64>,
    /// The widest gaps, the widest first.
    widest: Vec<Gap>,
}

/// The number of known gaps: enough that the widest gap not beside a given direction is among them.
const KNOWN: usize = 3;

/// A gap between one direction and the next, by their indices; the gap that contains ±180° leads
/// from the last to the first.
#[derive(Clone, Copy, Debug, PartialEq)]
struct Gap {
    width: f64,
    from: usize,
    to: usize,
    holds_seam: bool,
}

impl Gap {
    /// Whether the smallest arc leaves out this gap rather than another: the wider one; of equal
    /// ones the one at ±180°, or else the first.
    fn precedes(&self, other: &Self) -> bool {
        self.width
            .total_cmp(&other.width)
            .then_with(|| self.rank_of_equal().cmp(&other.rank_of_equal()))
            .is_gt()
    }

    /// The order of equally wide gaps; the largest is left out.
    const fn rank_of_equal(&self) -> (bool, Reverse<usize>) {
        (self.holds_seam, Reverse(self.from))
    }
}

impl FromIterator<Angle> for Directions {
    fn from_iter<I: IntoIterator<Item = Angle>>(angles: I) -> Self {
        let mut sorted: Vec<f64> = angles
            .into_iter()
            .map(|angle| angle.wrap().radians())
            .collect();
        sorted.sort_unstable_by(f64::total_cmp);
        let mut directions = Self {
            sorted,
            widest: Vec::new(),
        };
        directions.find_widest();
        directions
    }
}

impl Directions {
    /// How many there are.
    pub const fn len(&self) -> usize {
        self.sorted.len()
    }

    /// Whether there are none.
    pub const fn is_empty(&self) -> bool {
        self.sorted.is_empty()
    }

    /// Adds some directions and removes others; removing one that is not in the set has no effect.
    pub fn change(
        &mut self,
        added: impl IntoIterator<Item = Angle>,
        removed: impl IntoIterator<Item = Angle>,
    ) {
        for angle in removed {
            if let Ok(place) = self.place_of(angle) {
                self.sorted.remove(place);
            }
        }
        for angle in added {
            let (Ok(place) | Err(place)) = self.place_of(angle);
            self.sorted.insert(place, angle.wrap().radians());
        }
        self.find_widest();
    }

    /// The ends of the smallest arc that contains all of them, the second not below the first; none
    /// without any. Of equally wide gaps the one that contains ±180° is left out, or else the first
    /// above it.
    pub fn smallest_arc(&self) -> Option<[Angle; 2]> {
        self.widest.first().map(|gap| self.arc_without(gap))
    }

    /// The ends of the smallest arc that contains all but one of them; all of them if that one is
    /// not in the set.
    pub fn smallest_arc_without(&self, angle: Angle) -> Option<[Angle; 2]> {
        let Ok(left_out) = self.place_of(angle) else {
            return self.smallest_arc();
        };
        let count = self.sorted.len();
        if count < 2 {
            return None;
        }
        // Without the direction, its two gaps become one. The smallest arc leaves out this joined
        // gap or the widest of the others.
        let joined = self.gap((left_out + count - 1) % count, (left_out + 1) % count);
        let other = self
            .widest
            .iter()
            .find(|gap| gap.from != left_out && gap.to != left_out)
            .filter(|other| other.precedes(&joined));
        Some(self.arc_without(other.unwrap_or(&joined)))
    }

    fn place_of(&self, angle: Angle) -> Result<usize, usize> {
        self.sorted
            .binary_search_by(|known| known.total_cmp(&angle.wrap().radians()))
    }

    /// The gap from one direction to a later one, or across ±180° to one that is not later.
    fn gap(&self, from: usize, to: usize) -> Gap {
        let holds_seam = to <= from;
        let (start, end) = (self.sorted[from], self.sorted[to]);
        Gap {
            width: if holds_seam {
                end + TAU - start
            } else {
                end - start
            },
            from,
            to,
            holds_seam,
        }
    }

    fn arc_without(&self, gap: &Gap) -> [Angle; 2] {
        // The arc is the gap's complement: it starts where the gap ends. Unless the gap contains
        // ±180°, the arc does, and its end lies one turn higher.
        let (start, end) = (self.sorted[gap.to], self.sorted[gap.from]);
        [start, if gap.holds_seam { end } else { end + TAU }].map(Angle::from_radians)
    }

    fn find_widest(&mut self) {
        self.widest.clear();
        let count = self.sorted.len();
        for from in 0..count {
            // Insertion into a short sorted list: one pass over all gaps finds the widest three.
            let gap = self.gap(from, (from + 1) % count);
            let place = self
                .widest
                .iter()
                .position(|known| gap.precedes(known))
                .unwrap_or(self.widest.len());
            if place < KNOWN {
                self.widest.truncate(KNOWN - 1);
                self.widest.insert(place, gap);
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    fn directions(degrees: &[f64]) -> Directions {
        degrees.iter().copied().map(Angle::from_degrees).collect()
    }

    #[test]
    fn what_is_left_out_does_not_hold_the_arc_open() {
        let of = directions(&[170.0, -175.0, -178.0, 20.0]);
        let rounded =
            |arc: Option<[Angle; 2]>| arc.map(|ends| ends.map(|end| end.degrees().round()));
        let all = of.smallest_arc();
        assert_eq!(rounded(all), Some([20.0, 185.0]));
        assert_eq!(
            rounded(of.smallest_arc_without(Angle::from_degrees(20.0))),
            Some([170.0, 185.0])
        );
        assert_eq!(
            of.smallest_arc_without(Angle::from_degrees(21.0)),
            all,
            "it is not there"
        );
        assert_eq!(
            directions(&[5.0]).smallest_arc_without(Angle::from_degrees(5.0)),
            None
        );
        assert_eq!(directions(&[]).smallest_arc(), None);
    }

    proptest! {
        /// Whole multiples of 15° make equal gaps and equal directions common.
        #[test]
        fn changes_and_omissions_give_what_a_new_set_gives(
            steps in proptest::collection::vec(-12..12_i32, 1..14),
            removed in 0..4_usize,
            left_out in 0..14_usize,
        ) {
            let angles: Vec<Angle> = steps.iter().map(|step| Angle::from_degrees(15.0 * f64::from(*step))).collect();
            let (gone, kept) = angles.split_at(removed.min(angles.len() - 1));
            let mut changed: Directions = angles.iter().copied().collect();
            changed.change([], gone.iter().copied());
            let anew: Directions = kept.iter().copied().collect();
            prop_assert_eq!(&changed, &anew);
            changed.change(gone.iter().copied(), []);
            prop_assert_eq!(&changed, &angles.iter().copied().collect::<Directions>());
            let left_out = left_out % kept.len();
            let others = kept.iter().enumerate().filter(|(place, _)| *place != left_out).map(|(_, angle)| *angle);
            prop_assert_eq!(anew.smallest_arc_without(kept[left_out]), others.collect::<Directions>().smallest_arc());
        }
    }
}
