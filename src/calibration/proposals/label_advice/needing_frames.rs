//! The frames of a camera that need a label, by view direction, updated frame by frame.

use std::collections::BTreeMap;
use touchline_core::geometry::Angle;
use touchline_documents::document::{Frame, FrameStatus};

/// Width of a direction in pan, degrees.
pub(super) const DIRECTION_DEG: f64 = 1.0;

/// The horizontal view of a frame: pan of its centre and half of its field of view.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct HorizontalView {
    pub(in crate::proposals) pan: Angle,
    pub(super) half_view: Angle,
}

/// A frame that needs a label in about its direction.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct LabelCandidate {
    pub(in crate::proposals) frame: usize,
    pub(in crate::proposals) look: HorizontalView,
    /// The probability that its answer is wrong, 0 to 1; 1 without an answer.
    pub(in crate::proposals) need: f64,
}

/// The frames of a camera that need a label and have a known view.
#[derive(Clone, Debug, Default)]
pub(super) struct NeedingFrames {
    /// The direction of each frame, by its index in the document: see
    /// [`HorizontalView::direction`].
    frames: BTreeMap<usize, i64>,
    directions: BTreeMap<i64, Direction>,
}

/// The frames of one direction.
#[derive(Clone, Debug, Default, PartialEq)]
pub(super) struct Direction {
    /// The frames, by index in the document.
    frames: BTreeMap<usize, LabelCandidate>,
    /// The sum of their needs, in units of 1/[`PARTS`]. Integer sums do not depend on the order in
    /// which frames were added and removed.
    need: u64,
    /// The sum of half their fields of view, weighted by their needs, degrees in units of
    /// 1/[`PARTS`].
    half_view_deg: u64,
}

/// Parts per unit in integer sums: exact to 10⁻⁹, without overflow for a hundred million frames.
const PARTS: f64 = (1 << 30) as f64;

impl NeedingFrames {
    /// Sets or removes the need of a frame. Returns whether that changed anything.
    pub(in crate::proposals) fn put(
        &mut self,
        index: usize,
        needing: Option<LabelCandidate>,
    ) -> bool {
        // The direction in which the frame is listed, which may differ from that of the new view.
        let to = self.frames.get(&index).copied();
        let known = to.and_then(|to| Some((to, *self.directions.get(&to)?.frames.get(&index)?)));
        if known.map(|(_, known)| known) == needing {
            return false;
        }
        // Subtract exactly what was added, then add the new value.
        if let Some((to, known)) = known {
            self.frames.remove(&index);
            if let Some(direction) = self.directions.get_mut(&to) {
                direction.frames.remove(&index);
                direction.need -= known.need_parts();
                direction.half_view_deg -= known.half_view_parts();
                if direction.frames.is_empty() {
                    self.directions.remove(&to);
                }
            }
        }
        if let Some(needing) = needing {
            let to = needing.look.direction();
            self.frames.insert(index, to);
            let direction = self.directions.entry(to).or_default();
            direction.frames.insert(index, needing);
            direction.need += needing.need_parts();
            direction.half_view_deg += needing.half_view_parts();
        }
        true
    }

    /// The directions that have frames, ascending.
    pub(in crate::proposals) fn directions(&self) -> impl Iterator<Item = (i64, &Direction)> {
        self.directions
            .iter()
            .map(|(&to, direction)| (to, direction))
    }

    /// Of the frames of a direction with the greatest need, the middle one in the document's order.
    pub(super) fn neediest(&self, to: i64) -> Option<&LabelCandidate> {
        let here = &self.directions.get(&to)?.frames;
        let most = here
            .values()
            .map(|needing| needing.need)
            .max_by(f64::total_cmp)?;
        let neediest: Vec<&LabelCandidate> = here
            .values()
            .filter(|needing| needing.need == most)
            .collect();
        neediest.get(neediest.len() / 2).copied()
    }

    /// Number of frames with a pan within `reach` of this one.
    pub(in crate::proposals) fn within(&self, pan: Angle, reach: Angle) -> usize {
        let half = Angle::from_degrees(DIRECTION_DEG / 2.0);
        // Directions entirely within or beyond the reach are counted as a whole, those at the limit
        // frame by frame.
        let counts = self.directions.iter().map(|(&to, direction)| {
            let apart = HorizontalView::towards(to).turn_from(pan).abs();
            if apart + half <= reach {
                direction.frames.len()
            } else if apart - half > reach {
                0
            } else {
                let pans = direction.frames.values().map(|needing| needing.look.pan);
                pans.filter(|other| other.turn_from(pan).abs() <= reach)
                    .count()
            }
        });
        counts.sum()
    }
}

impl Direction {
    /// The sum of the needs of its frames.
    pub(in crate::proposals) fn need(&self) -> f64 {
        self.need as f64 / PARTS
    }

    /// Mean of half the field of view of its frames, weighted by their needs.
    pub(super) fn half_view(&self) -> Angle {
        Angle::from_degrees(self.half_view_deg as f64 / self.need.max(1) as f64)
    }
}

impl LabelCandidate {
    /// The need as an integer, in units of 1/[`PARTS`].
    fn need_parts(&self) -> u64 {
        (self.need * PARTS).round() as u64
    }

    fn half_view_parts(&self) -> u64 {
        (self.need * self.look.half_view.degrees() * PARTS).round() as u64
    }
}

impl HorizontalView {
    /// The view of a solved frame that is not rejected; the half view is atan(width / 2f).
    pub fn from_frame(frame: &Frame) -> Option<Self> {
        let ptz = frame
            .ptz
            .as_ref()
            .filter(|_| frame.status != FrameStatus::Rejected)?;
        let half_view =
            Angle::from_radians((f64::from(frame.image_size.width) / 2.0).atan2(ptz.focal_px));
        Some(Self {
            pan: ptz.ptz().pan.wrap(),
            half_view,
        })
    }

    /// Its direction: the pan, rounded to multiples of [`DIRECTION_DEG`].
    fn direction(&self) -> i64 {
        (self.pan.degrees() / DIRECTION_DEG).round() as i64
    }

    /// The pan of the middle of a direction.
    pub(super) fn towards(direction: i64) -> Angle {
        Angle::from_degrees(direction as f64 * DIRECTION_DEG)
    }
}
