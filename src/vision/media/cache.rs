//! A least-recently-used cache of decoded frames with a byte budget.

use super::{FrameRef, Picture};
use lru::LruCache;

/// Keeps decoded frames; evicts those not used for longest when they exceed the budget.
///
/// The frame inserted last always stays, even if it is larger than the whole budget: the user is
/// looking at it.
#[derive(Debug)]
pub struct FrameCache {
    budget_bytes: usize,
    bytes: usize,
    frames: LruCache<FrameRef, Picture>,
}

impl FrameCache {
    /// An empty cache that keeps up to `budget_bytes` of pixels.
    pub fn new(budget_bytes: usize) -> Self {
        Self {
            budget_bytes,
            bytes: 0,
            frames: LruCache::unbounded(),
        }
    }

    /// A frame, if it is kept; this counts as a use.
    pub fn get(&mut self, frame: &FrameRef) -> Option<Picture> {
        self.frames.get(frame).cloned()
    }

    /// Whether a frame is kept; this does not count as a use.
    pub fn contains(&self, frame: &FrameRef) -> bool {
        self.frames.contains(frame)
    }

    /// Inserts or replaces a frame, and evicts others until the budget is met.
    pub fn insert(&mut self, frame: FrameRef, picture: Picture) {
        // The new bytes are added before the old ones are subtracted, so that the count stays above
        // zero.
        self.bytes += picture.bytes();
        if let Some(before) = self.frames.put(frame, picture) {
            self.bytes -= before.bytes();
        }
        self.keep_budget();
    }

    /// Changes the budget, and evicts frames until it is met.
    pub fn set_budget(&mut self, budget_bytes: usize) {
        self.budget_bytes = budget_bytes;
        self.keep_budget();
    }

    /// Evicts the frames not used for longest; the last one stays, whatever its size.
    fn keep_budget(&mut self) {
        while self.bytes > self.budget_bytes && self.frames.len() > 1 {
            let Some((_, oldest)) = self.frames.pop_lru() else {
                break;
            };
            self.bytes -= oldest.bytes();
        }
    }

    /// Inserts a frame only if it fits into the remaining budget, as the first to be evicted.
    pub fn offer(&mut self, frame: &FrameRef, picture: &Picture) {
        // It fits, so that `insert` evicts nothing; demoted, it never displaces a frame that the
        // user has viewed.
        if self.bytes + picture.bytes() <= self.budget_bytes && !self.contains(frame) {
            self.insert(frame.clone(), picture.clone());
            self.frames.demote(frame);
        }
    }

    /// The budget, bytes.
    pub const fn budget_bytes(&self) -> usize {
        self.budget_bytes
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::path::Path;
    use touchline_core::geometry::ImageSize;

    fn frame(index: usize) -> FrameRef {
        FrameRef::video(Path::new("match.mp4"), index)
    }

    /// 100 px, 400 bytes.
    fn picture(shade: u8) -> Picture {
        Picture::with_colour(ImageSize::new(10, 10), [shade, shade, shade, 255])
    }

    #[test]
    fn a_smaller_budget_holds_at_once() {
        let mut cache = FrameCache::new(1200);
        for index in 0..3 {
            cache.insert(frame(index), picture(index as u8));
        }
        cache.set_budget(800);
        assert_eq!(
            [0, 1, 2].map(|index| cache.contains(&frame(index))),
            [false, true, true]
        );
        assert_eq!(cache.budget_bytes(), 800);
    }

    #[test]
    fn the_frame_not_used_for_longest_goes_first() {
        let mut cache = FrameCache::new(1200);
        for index in 0..3 {
            cache.insert(frame(index), picture(index as u8));
        }
        assert_eq!((cache.frames.len(), cache.bytes), (3, 1200));
        assert_eq!(cache.get(&frame(0)), Some(picture(0)));
        assert!(cache.contains(&frame(1)), "asking is no use");
        cache.insert(frame(3), picture(3));
        assert!(cache.get(&frame(1)).is_none());
        assert!([0, 2, 3].iter().all(|&index| cache.contains(&frame(index))));
        assert_eq!(cache.bytes, 1200);
    }

    #[test]
    fn a_frame_beyond_the_budget_stays_alone() {
        let mut cache = FrameCache::new(500);
        cache.insert(frame(0), picture(0));
        cache.insert(
            frame(1),
            Picture::with_colour(ImageSize::new(20, 20), [0; 4]),
        );
        assert_eq!((cache.frames.len(), cache.bytes), (1, 1600));
        cache.insert(frame(2), picture(2));
        assert_eq!((cache.frames.len(), cache.bytes), (1, 400));
    }

    #[test]
    fn a_frame_put_in_twice_counts_once() {
        let mut cache = FrameCache::new(1000);
        cache.insert(frame(0), picture(0));
        cache.insert(frame(0), picture(9));
        assert_eq!((cache.frames.len(), cache.bytes), (1, 400));
        assert_eq!(cache.get(&frame(0)), Some(picture(9)));
    }

    proptest::proptest! {
        #[test]
        fn the_budget_holds_whatever_happens(steps in proptest::collection::vec((0_usize..12, 0_u8..2, 1_u32..12), 0..80)) {
            let mut cache = FrameCache::new(1500);
            for (index, what, side) in steps {
                match what {
                    0 => cache.insert(frame(index), Picture::with_colour(ImageSize::new(side, side), [0; 4])),
                    _ => drop(cache.get(&frame(index))),
                }
                let kept: usize = cache.frames.iter().map(|(_, picture)| picture.bytes()).sum();
                assert_eq!(kept, cache.bytes);
                assert!(kept <= 1500 || cache.frames.len() == 1);
            }
        }
    }
}
