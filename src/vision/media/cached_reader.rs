//! Reading frames several times and decoding them once, within a memory budget.
//!
//! Work on a clip reads its frames again and again, mostly in order: to track points, to search
//! paint, to adjust, and to search paint again. The pictures of a long clip do not fit into memory,
//! and a least-recently-used cache would drop each one just before it is read again. So a full
//! cache keeps what it has and drops only pictures that the work no longer reads.

use super::{FrameRef, MediaError, Notice, Picture, ReadFrames};
use lru::LruCache;
use std::collections::BTreeMap;

/// A memory budget for work without a window, bytes: 145 frames of 720p, 64 of 1080p.
pub const KEPT_BYTES: usize = 512 << 20;

/// Reads frames and keeps their pictures, as long as these fit into a budget.
///
/// Reads of ascending frames are one *pass*; a step back begins the next. A full cache drops a
/// frame that the pass has skipped, or that neither this pass nor the one before it has read. If
/// there is none, a newly read picture is not kept. So passes over more frames than fit find the
/// same first ones again, and when other frames are wanted the old ones are dropped at once.
#[derive(Debug)]
pub struct CachedReader<R> {
    reader: R,
    budget_bytes: usize,
    kept: BTreeMap<FrameRef, KeptPicture>,
    kept_bytes: usize,
    last: Option<FrameRef>,
    /// Number of the present pass, from 0.
    pass: usize,
}

/// A picture in memory.
#[derive(Debug)]
struct KeptPicture {
    picture: Picture,
    /// The last pass that read it.
    pass: usize,
}

impl<R: ReadFrames> CachedReader<R> {
    /// A reader that reads with `reader` what it does not keep. It keeps up to `budget_bytes` of
    /// pixels.
    pub const fn new(reader: R, budget_bytes: usize) -> Self {
        Self {
            reader,
            budget_bytes,
            kept: BTreeMap::new(),
            kept_bytes: 0,
            last: None,
            pass: 0,
        }
    }

    /// Whether the picture of a frame is kept.
    #[cfg(test)]
    pub(super) fn is_kept(&self, frame: &FrameRef) -> bool {
        self.kept.contains_key(frame)
    }

    /// The picture of a frame, if it is kept; it counts as read in this pass.
    fn find(&mut self, frame: &FrameRef) -> Option<Picture> {
        // Frames are ordered by file and then by index, so a step back is a smaller frame.
        if self.last.as_ref().is_some_and(|last| frame < last) {
            self.pass += 1;
        }
        self.last = Some(frame.clone());
        let kept = self.kept.get_mut(frame)?;
        kept.pass = self.pass;
        Some(kept.picture.clone())
    }

    /// Keeps a picture that has just been read, if there is room for it.
    fn keep(&mut self, frame: &FrameRef, picture: &Picture) {
        // Called only for frames that `find` has not found, so nothing is replaced below and the
        // count of bytes is exact.
        while self.kept_bytes + picture.bytes() > self.budget_bytes {
            let Some(unused) = self.find_unused(frame) else {
                return;
            };
            if let Some(dropped) = self.kept.remove(&unused) {
                self.kept_bytes -= dropped.picture.bytes();
            }
        }
        self.kept_bytes += picture.bytes();
        let (picture, pass) = (picture.clone(), self.pass);
        self.kept
            .insert(frame.clone(), KeptPicture { picture, pass });
    }

    /// A kept frame that the present pass, now at `frame`, will not read.
    fn find_unused(&self, frame: &FrameRef) -> Option<FrameRef> {
        // Frames before this one that the pass has not read will not come in it any more. One ahead
        // may still come; it is given up only if the whole pass before went without it.
        let mut skipped = self.kept.range(..frame);
        let mut ahead = self.kept.range(frame..);
        skipped
            .find(|(_, kept)| kept.pass < self.pass)
            .or_else(|| ahead.find(|(_, kept)| kept.pass + 1 < self.pass))
            .map(|(unused, _)| unused.clone())
    }
}

impl<R: ReadFrames> ReadFrames for CachedReader<R> {
    fn read(&mut self, frame: &FrameRef) -> Result<Picture, MediaError> {
        if let Some(picture) = self.find(frame) {
            return Ok(picture);
        }
        let picture = self.reader.read(frame)?;
        self.keep(frame, &picture);
        Ok(picture)
    }

    fn read_in_passing(&mut self, frame: &FrameRef) -> Result<Picture, MediaError> {
        match self.find(frame) {
            Some(picture) => Ok(picture),
            None => self.reader.read_in_passing(frame),
        }
    }

    fn take_notices(&mut self) -> Vec<Notice> {
        self.reader.take_notices()
    }
}

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

    const SIZE: ImageSize = ImageSize::new(10, 10);
    const BYTES: usize = 400;

    /// Gives each frame a picture of its number, and remembers which ones were requested. Frame 99
    /// cannot be read.
    #[derive(Default)]
    struct Numbered(Vec<usize>);

    impl ReadFrames for Numbered {
        fn read(&mut self, frame: &FrameRef) -> Result<Picture, MediaError> {
            let FrameRef::Video { path, index } = frame else {
                panic!("{frame}")
            };
            self.0.push(*index);
            if *index == 99 {
                return Err(MediaError::Missing {
                    path: path.to_path_buf(),
                });
            }
            Ok(Picture::with_colour(SIZE, [*index as u8, 0, 0, 255]))
        }
    }

    fn frame(index: usize) -> FrameRef {
        FrameRef::video(Path::new("match.mp4"), index)
    }

    /// Reads frames, checks what they show, and returns which of them were decoded for it.
    fn frames_decoded(reader: &mut CachedReader<Numbered>, frames: &[usize]) -> Vec<usize> {
        for &index in frames {
            let picture = reader.read(&frame(index)).unwrap();
            assert_eq!(usize::from(picture.rgba()[0]), index);
        }
        std::mem::take(&mut reader.reader.0)
    }

    #[test]
    fn what_fits_is_decoded_once() {
        let mut reader = CachedReader::new(Numbered::default(), 4 * BYTES);
        assert_eq!(frames_decoded(&mut reader, &[3, 7, 11]), [3, 7, 11]);
        assert_eq!(frames_decoded(&mut reader, &[3, 7, 11]), [0; 0]);
        assert_eq!(frames_decoded(&mut reader, &[11, 7, 5]), [5]);
    }

    #[test]
    fn passes_over_more_than_fits_find_the_first_frames_again() {
        let mut reader = CachedReader::new(Numbered::default(), 4 * BYTES);
        let pass: Vec<usize> = (0..10).collect();
        assert_eq!(frames_decoded(&mut reader, &pass), pass);
        for _ in 0..3 {
            assert_eq!(frames_decoded(&mut reader, &pass), [4, 5, 6, 7, 8, 9]);
        }
    }

    #[test]
    fn frames_that_are_no_longer_read_make_room() {
        let mut reader = CachedReader::new(Numbered::default(), 4 * BYTES);
        frames_decoded(&mut reader, &[0, 10, 20, 30]);
        // 5 drops 0, which was skipped. For 15 there is no room, because 20 and 30 may yet come.
        // 25 drops 20.
        assert_eq!(frames_decoded(&mut reader, &[5, 10, 15, 25]), [5, 15, 25]);
        // 15 drops 30, which was not read in two passes, and 30 drops 25.
        assert_eq!(frames_decoded(&mut reader, &[5, 10, 15, 30]), [15, 30]);
        assert_eq!(frames_decoded(&mut reader, &[5, 10, 15, 30]), [0; 0]);
    }

    #[test]
    fn frames_read_in_passing_and_those_that_failed_are_not_kept() {
        let mut reader = CachedReader::new(Numbered::default(), 4 * BYTES);
        frames_decoded(&mut reader, &[2]);
        for index in 0..4 {
            let picture = reader.read_in_passing(&frame(index)).unwrap();
            assert_eq!(usize::from(picture.rgba()[0]), index);
        }
        assert!(reader.read(&frame(99)).is_err() && reader.read(&frame(99)).is_err());
        assert_eq!(reader.reader.0, [0, 1, 3, 99, 99]);
        assert_eq!(reader.kept_bytes, BYTES);
    }

    proptest::proptest! {
        #[test]
        fn the_budget_holds_and_every_picture_is_its_frames(
            frames in proptest::collection::vec(0_usize..12, 0..80), budget in 0_usize..3000,
        ) {
            let mut reader = CachedReader::new(Numbered::default(), budget);
            for index in frames {
                frames_decoded(&mut reader, &[index]);
                let kept: usize = reader.kept.values().map(|kept| kept.picture.bytes()).sum();
                assert_eq!(kept, reader.kept_bytes);
                assert!(kept <= budget);
            }
        }
    }

    fn numbered(index: usize) -> FrameRef {
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
            cache.insert(numbered(index), picture(index as u8));
        }
        cache.set_budget(800);
        assert_eq!(
            [0, 1, 2].map(|index| cache.contains(&numbered(index))),
            [false, true, true]
        );
        assert_eq!(cache.budget_bytes(), 800);
    }

    #[test]
    fn the_frame_not_used_for_longest_goes_first() {
        let mut cache = FrameCache::new(1200);
        for index in 0..3 {
            cache.insert(numbered(index), picture(index as u8));
        }
        assert_eq!((cache.frames.len(), cache.bytes), (3, 1200));
        assert_eq!(cache.get(&numbered(0)), Some(picture(0)));
        assert!(cache.contains(&numbered(1)), "asking is no use");
        cache.insert(numbered(3), picture(3));
        assert!(cache.get(&numbered(1)).is_none());
        assert!(
            [0, 2, 3]
                .iter()
                .all(|&index| cache.contains(&numbered(index)))
        );
        assert_eq!(cache.bytes, 1200);
    }

    #[test]
    fn a_frame_beyond_the_budget_stays_alone() {
        let mut cache = FrameCache::new(500);
        cache.insert(numbered(0), picture(0));
        cache.insert(
            numbered(1),
            Picture::with_colour(ImageSize::new(20, 20), [0; 4]),
        );
        assert_eq!((cache.frames.len(), cache.bytes), (1, 1600));
        cache.insert(numbered(2), picture(2));
        assert_eq!((cache.frames.len(), cache.bytes), (1, 400));
    }

    #[test]
    fn a_frame_put_in_twice_counts_once() {
        let mut cache = FrameCache::new(1000);
        cache.insert(numbered(0), picture(0));
        cache.insert(numbered(0), picture(9));
        assert_eq!((cache.frames.len(), cache.bytes), (1, 400));
        assert_eq!(cache.get(&numbered(0)), Some(picture(9)));
    }

    proptest::proptest! {
        #[test]
        fn the_budget_holds_whatever_happens(
            steps in proptest::collection::vec((0_usize..12, 0_u8..2, 1_u32..12), 0..80),
        ) {
            let mut cache = FrameCache::new(1500);
            for (index, what, side) in steps {
                match what {
                    0 => cache.insert(
                        numbered(index),
                        Picture::with_colour(ImageSize::new(side, side), [0; 4]),
                    ),
                    _ => drop(cache.get(&numbered(index))),
                }
                let kept: usize = cache.frames.iter().map(|(_, picture)| picture.bytes()).sum();
                assert_eq!(kept, cache.bytes);
                assert!(kept <= 1500 || cache.frames.len() == 1);
            }
        }
    }
}
