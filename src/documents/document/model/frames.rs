//! The frames of a document: ordered, each with a unique id, shared with the states kept for undo.

use super::frames_version::FramesVersion;
use crate::document::{Frame, FrameId, Shared};
use imbl::Vector;
use rayon::iter::{IndexedParallelIterator, IntoParallelRefIterator};
use std::collections::HashMap;
use std::fmt;
use std::ops::{Bound, Index, IndexMut, RangeBounds};
use std::sync::Arc;

/// Frames in the order in which the user steps through them.
///
/// A persistent vector: a clone takes constant time, and changing a frame of a clone copies the
/// chunk of handles that contains it. A frame without an id, or with an id that is taken, gets a
/// new one when it is added by [`Frames::push`], [`Frames::insert`] or `extend`. A frame that is
/// borrowed mutably must not get the id of another one: that is not checked.
#[derive(Clone, Default)]
pub struct Frames {
    ordered: Vector<Shared<Frame>>,
    /// The position of each id when the order last changed.
    positions: Arc<HashMap<FrameId, usize>>,
    version: FramesVersion,
}

/// Two frames of a document have the same id.
#[derive(Clone, Debug, PartialEq, Eq)]
pub(in crate::document) struct DuplicateId {
    pub id: FrameId,
    /// The later frame's position.
    pub second: usize,
    /// The earlier one's.
    pub first: usize,
}

impl Frames {
    /// No frames.
    pub fn new() -> Self {
        Self::default()
    }

    /// Frames in the order of a file. Those without an id get a reproducible one, derived from
    /// their picture, that no other frame has.
    pub(in crate::document) fn read(mut frames: Vec<Shared<Frame>>) -> Result<Self, DuplicateId> {
        // Stated ids come first, so that a derived one never is one that a later frame states.
        let mut positions = HashMap::with_capacity(frames.len());
        for (position, frame) in frames
            .iter()
            .enumerate()
            .filter(|(_, frame)| !frame.id.is_missing())
        {
            if let Some(first) = positions.insert(frame.id.clone(), position) {
                return Err(DuplicateId {
                    id: frame.id.clone(),
                    second: position,
                    first,
                });
            }
        }
        for (position, frame) in frames
            .iter_mut()
            .enumerate()
            .filter(|(_, frame)| frame.id.is_missing())
        {
            frame.id = frame.id_of_picture().free(|id| positions.contains_key(id));
            positions.insert(frame.id.clone(), position);
        }
        Ok(Self {
            ordered: frames.into_iter().collect(),
            positions: Arc::new(positions),
            version: FramesVersion::new(),
        })
    }

    /// How many there are.
    pub fn len(&self) -> usize {
        self.ordered.len()
    }

    /// Whether there are none.
    pub fn is_empty(&self) -> bool {
        self.ordered.is_empty()
    }

    /// The path of the first video that a frame is of.
    pub fn first_video(&self) -> Option<&str> {
        let video = self.iter().find_map(|frame| frame.video.as_ref());
        video.map(|video| video.path.as_str())
    }

    /// The frame at a position.
    pub fn get(&self, position: usize) -> Option<&Shared<Frame>> {
        self.ordered.get(position)
    }

    /// The frame at a position, mutable.
    pub fn get_mut(&mut self, position: usize) -> Option<&mut Shared<Frame>> {
        self.version.record_change(position);
        self.ordered.get_mut(position)
    }

    /// The position of the frame with an id.
    pub fn position_of(&self, id: &FrameId) -> Option<usize> {
        let known = self
            .positions
            .get(id)
            .copied()
            .filter(|position| self.get(*position).is_some_and(|frame| frame.id == *id));
        // A frame that was assigned over another one is not among the known positions. It is
        // searched for, unless all positions are known to be right: then no frame has the id.
        known.or_else(|| {
            if self.are_known() {
                None
            } else {
                self.iter().position(|frame| frame.id == *id)
            }
        })
    }

    /// Whether each frame is at the position that is known for its id.
    fn are_known(&self) -> bool {
        *self.version.are_known.get_or_init(|| {
            self.iter()
                .enumerate()
                .all(|(position, frame)| self.positions.get(&frame.id) == Some(&position))
        })
    }

    /// The frame of an id.
    pub fn by_id(&self, id: &FrameId) -> Option<&Shared<Frame>> {
        self.get(self.position_of(id)?)
    }

    /// The frame with an id, mutable.
    pub fn by_id_mut(&mut self, id: &FrameId) -> Option<&mut Shared<Frame>> {
        self.get_mut(self.position_of(id)?)
    }

    /// The first frame.
    pub fn first(&self) -> Option<&Shared<Frame>> {
        self.ordered.front()
    }

    /// The last frame.
    pub fn last(&self) -> Option<&Shared<Frame>> {
        self.ordered.back()
    }

    /// The frames in their order.
    pub fn iter(&self) -> Iter<'_> {
        self.ordered.iter()
    }

    /// The frames in their order, to change them.
    pub fn iter_mut(&mut self) -> IterMut<'_> {
        // Any frame may change, so there is nothing to remember.
        self.version = FramesVersion::new();
        self.ordered.iter_mut()
    }

    /// The frames in their order, on several threads.
    pub fn par_iter(&self) -> impl IndexedParallelIterator<Item = &Shared<Frame>> {
        self.ordered.par_iter()
    }

    /// The frames at these positions, as far as there are any.
    pub fn range(
        &self,
        range: impl RangeBounds<usize>,
    ) -> impl DoubleEndedIterator<Item = &Shared<Frame>> {
        let start = match range.start_bound() {
            Bound::Included(start) => *start,
            Bound::Excluded(before) => before.saturating_add(1),
            Bound::Unbounded => 0,
        };
        let end = match range.end_bound() {
            Bound::Included(last) => last.saturating_add(1),
            Bound::Excluded(end) => *end,
            Bound::Unbounded => self.len(),
        };
        (start..end.min(self.len())).filter_map(|position| self.get(position))
    }

    /// Appends a frame; it gets a new id if its own is missing or taken.
    pub fn push(&mut self, frame: Shared<Frame>) {
        let frame = self.with_own_id(frame);
        self.version = FramesVersion::new();
        Arc::make_mut(&mut self.positions).insert(frame.id.clone(), self.ordered.len());
        self.ordered.push_back(frame);
    }

    /// Inserts a frame before the one at a position, or at the end if there is none; ids as in
    /// [`Frames::push`].
    pub fn insert(&mut self, position: usize, frame: Shared<Frame>) {
        self.insert_all(position, vec![frame]);
    }

    /// Inserts frames before the one at a position, in their order; ids as in [`Frames::push`].
    pub fn insert_all(&mut self, position: usize, frames: Vec<Shared<Frame>>) {
        // A persistent vector is split and joined in logarithmic time, whatever its length.
        // Positions are entered at once, because `with_own_id` must see the ids of the frames
        // before; those behind are corrected by `order_changed`.
        let tail = self.ordered.split_off(position.min(self.ordered.len()));
        for frame in frames {
            let frame = self.with_own_id(frame);
            Arc::make_mut(&mut self.positions).insert(frame.id.clone(), self.ordered.len());
            self.ordered.push_back(frame);
        }
        self.ordered.append(tail);
        self.order_changed();
    }

    /// Removes and returns the frame at a position; none if there is none.
    pub fn remove(&mut self, position: usize) -> Option<Shared<Frame>> {
        let removed = (position < self.ordered.len()).then(|| self.ordered.remove(position));
        self.order_changed();
        removed
    }

    /// Removes and returns the last frame.
    pub fn pop(&mut self) -> Option<Shared<Frame>> {
        let last = self.ordered.pop_back()?;
        self.version = FramesVersion::new();
        Arc::make_mut(&mut self.positions).remove(&last.id);
        Some(last)
    }

    /// Keeps the frames for which `wanted` holds.
    pub fn retain(&mut self, mut wanted: impl FnMut(&Frame) -> bool) {
        self.ordered.retain(|frame| wanted(frame));
        self.order_changed();
    }

    /// Whether both share every frame, so that neither has changed since one was cloned from the
    /// other.
    pub fn is_same(&self, other: &Self) -> bool {
        self.ordered.ptr_eq(&other.ordered)
    }

    /// The positions at which frames differ from those of another, ascending, and those beyond its
    /// end. With a common remembered state only frames that were borrowed mutably since are
    /// compared, else all that are not shared.
    pub fn differences(&self, other: &Self) -> Vec<usize> {
        let mut differ = Vec::new();
        if self.is_same(other) {
            return differ;
        }
        // Changes of the order forget all predecessors, so states with a common one have the same
        // frames at the same positions.
        if let Some(changed) = self.version.possible_differences(&other.version) {
            differ.extend(
                changed
                    .into_iter()
                    .filter(|position| self.get(*position) != other.get(*position)),
            );
            return differ;
        }

        // Walk the chunks of both vectors in parallel; chunks that both share are skipped by their
        // address. Their bounds may differ, so each step compares as much as both chunks have left.
        let (mut left, mut right) = (self.ordered.leaves(), other.ordered.leaves());
        let (mut a, mut b): (&[Shared<Frame>], &[Shared<Frame>]) = (&[], &[]);
        let mut position = 0;
        loop {
            if a.is_empty() {
                let Some(next) = left.next() else {
                    return differ;
                };
                a = next;
            }
            if b.is_empty() {
                let Some(next) = right.next() else {
                    differ.extend(position..self.len());
                    return differ;
                };
                b = next;
            }
            let both = a.len().min(b.len());
            let ((here, rest_of_a), (there, rest_of_b)) = (a.split_at(both), b.split_at(both));
            if !std::ptr::eq(here, there) {
                let pairs = here.iter().zip(there).enumerate();
                differ.extend(
                    pairs
                        .filter(|(_, (here, there))| here != there)
                        .map(|(at, _)| position + at),
                );
            }
            (a, b) = (rest_of_a, rest_of_b);
            position += both;
        }
    }

    /// The frame with an id that no other has.
    fn with_own_id(&self, mut frame: Shared<Frame>) -> Shared<Frame> {
        if frame.id.is_missing() {
            frame.id = frame.id_of_picture();
        }
        if self.positions.contains_key(&frame.id) {
            frame.id = frame.id.clone().free(|id| self.positions.contains_key(id));
        }
        frame
    }

    fn order_changed(&mut self) {
        self.version = FramesVersion::new();
        let positions = self
            .ordered
            .iter()
            .enumerate()
            .map(|(position, frame)| (frame.id.clone(), position));
        self.positions = Arc::new(positions.collect());
    }
}

/// Over frames in their order.
pub type Iter<'a> = imbl::vector::Iter<'a, Shared<Frame>, imbl::shared_ptr::DefaultSharedPtr>;
/// Over frames in their order, to change them.
pub type IterMut<'a> = imbl::vector::IterMut<'a, Shared<Frame>, imbl::shared_ptr::DefaultSharedPtr>;

impl PartialEq for Frames {
    fn eq(&self, other: &Self) -> bool {
        self.len() == other.len() && self.differences(other).is_empty()
    }
}

impl fmt::Debug for Frames {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.debug_list().entries(self).finish()
    }
}

impl Index<usize> for Frames {
    type Output = Shared<Frame>;
    fn index(&self, position: usize) -> &Shared<Frame> {
        &self.ordered[position]
    }
}

impl IndexMut<usize> for Frames {
    fn index_mut(&mut self, position: usize) -> &mut Shared<Frame> {
        self.version.record_change(position);
        &mut self.ordered[position]
    }
}

impl Extend<Shared<Frame>> for Frames {
    fn extend<T: IntoIterator<Item = Shared<Frame>>>(&mut self, frames: T) {
        frames.into_iter().for_each(|frame| self.push(frame));
    }
}

impl FromIterator<Shared<Frame>> for Frames {
    fn from_iter<T: IntoIterator<Item = Shared<Frame>>>(frames: T) -> Self {
        let mut all = Self::default();
        all.extend(frames);
        all
    }
}

impl<'a> IntoIterator for &'a Frames {
    type Item = &'a Shared<Frame>;
    type IntoIter = Iter<'a>;
    fn into_iter(self) -> Iter<'a> {
        self.iter()
    }
}

impl<'a> IntoIterator for &'a mut Frames {
    type Item = &'a mut Shared<Frame>;
    type IntoIter = IterMut<'a>;
    fn into_iter(self) -> IterMut<'a> {
        self.iter_mut()
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::testing::new_frame;
    use proptest::prelude::*;
    use touchline_core::geometry::ImageSize;

    fn frame(image: &str) -> Shared<Frame> {
        new_frame(image, ImageSize::new(64, 36)).into()
    }

    fn frames(count: usize) -> Frames {
        (0..count).map(|index| frame(&index.to_string())).collect()
    }

    /// Each frame is found by its id.
    fn is_consistent(frames: &Frames) -> bool {
        frames
            .iter()
            .enumerate()
            .all(|(position, frame)| frames.position_of(&frame.id) == Some(position))
    }

    #[test]
    fn frames_of_one_picture_get_ids_of_their_own() {
        let twice: Frames = [frame("a"), frame("a"), frame("a")].into_iter().collect();
        let base = FrameId::from_picture(Some("a"), None);
        let ids: Vec<String> = twice.iter().map(|frame| frame.id.to_string()).collect();
        assert_eq!(
            ids,
            [format!("{base}"), format!("{base}-2"), format!("{base}-3")]
        );
        assert!(is_consistent(&twice));
    }

    #[test]
    fn what_is_read_keeps_its_ids_and_the_others_get_free_ones() {
        let without = |image: &str| {
            let mut frame = frame(image);
            frame.id = FrameId::default();
            frame
        };
        let mut stated = frame("b");
        stated.id = frame("a").id.clone();
        let read = Frames::read(vec![without("a"), stated.clone(), without("c")]).unwrap();
        assert_eq!(
            read[0].id,
            frame("a").id.clone().free(|id| *id == stated.id)
        );
        assert_eq!((&read[1].id, &read[2].id), (&stated.id, &frame("c").id));
        assert!(is_consistent(&read));
        let duplicate =
            Frames::read(vec![without("c"), stated.clone(), stated.clone()]).unwrap_err();
        assert_eq!(
            duplicate,
            DuplicateId {
                id: stated.id.clone(),
                second: 2,
                first: 1
            }
        );
    }

    #[test]
    fn a_frame_put_in_the_place_of_another_is_found() {
        let mut frames = frames(3);
        frames[1] = frame("other");
        assert_eq!(frames.position_of(&frame("other").id), Some(1));
        assert_eq!(frames.position_of(&frame("1").id), None);
        // Whatever was looked up in between.
        frames[1] = frame("1");
        frames[2] = frame("third");
        assert_eq!(frames.position_of(&frame("1").id), Some(1));
        assert_eq!(frames.position_of(&frame("third").id), Some(2));
        *frames.get_mut(0).unwrap() = frame("first");
        assert_eq!(frames.position_of(&frame("first").id), Some(0));
        frames.push(frame("last"));
        frames.pop();
        assert_eq!(frames.position_of(&frame("last").id), None);
        frames.iter_mut().for_each(|place| *place = frame("first"));
        assert_eq!(frames.position_of(&frame("third").id), None);
    }

    #[test]
    fn a_change_in_a_long_document_is_found_without_a_look_at_the_others() {
        let before = frames(10_000);
        let mut after = before.clone();
        assert!(after.is_same(&before) && after == before);
        for position in [0, 4_711, 9_999] {
            after[position].comment = Some("rain".to_owned());
        }
        assert_eq!(after.differences(&before), [0, 4_711, 9_999]);
        assert!(after[4_710].is_same(&before[4_710]) && after != before);
        after.pop();
        assert_eq!(after.differences(&before), [0, 4_711]);
        assert_eq!(
            before.differences(&after),
            [0, 4_711, 9_999],
            "what is beyond its end"
        );
    }

    proptest! {
        #[test]
        fn differences_are_those_of_the_frames_whatever_led_to_them(
            changes in prop::collection::vec((0usize..4, 0usize..4, 0usize..30, 0u8..40), 1..700),
        ) {
            let mut states = [frames(30), frames(30), frames(30), frames(30)];
            for (from, to, at, kind) in changes {
                let mut next = states[from].clone();
                match kind {
                    0 => next = next.iter().rev().cloned().collect(),
                    1 => drop(next.remove(at)),
                    2 => next.iter_mut().for_each(|frame| frame.gold = !frame.gold),
                    _ if at < next.len() => next[at].revision = u64::from(kind % 3),
                    _ => {}
                }
                for known in &states {
                    let differ = |at: &usize| next.get(*at) != known.get(*at);
                    let plain: Vec<usize> = (0..next.len()).filter(differ).collect();
                    prop_assert_eq!(next.differences(known), plain);
                }
                states[to] = next;
            }
        }

        #[test]
        fn every_change_of_the_order_keeps_the_ids_findable(
            changes in prop::collection::vec((0usize..200, 0u8..4), 1..60),
        ) {
            let mut all = frames(100);
            let mut plain: Vec<Shared<Frame>> = all.iter().cloned().collect();
            for (step, (at, kind)) in changes.into_iter().enumerate() {
                let new = frame(&format!("new {step}"));
                match kind {
                    0 => {
                        all.insert(at, new.clone());
                        plain.insert(at.min(plain.len()), new);
                    }
                    1 => {
                        all.push(new.clone());
                        plain.push(new);
                    }
                    2 if at < plain.len() => prop_assert_eq!(all.remove(at), Some(plain.remove(at))),
                    2 => prop_assert_eq!(all.remove(at), None),
                    _ => prop_assert_eq!(all.pop(), plain.pop()),
                }
            }
            prop_assert_eq!(all.iter().cloned().collect::<Vec<_>>(), plain.clone());
            prop_assert!(is_consistent(&all));
            prop_assert_eq!(all.differences(&plain.into_iter().collect()), Vec::<usize>::new());
        }
    }
}
