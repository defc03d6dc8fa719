//! Which neighbours of the current frame to decode next, and in which order.

/// The direction in which the user steps through frames.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum StepDirection {
    /// Unknown, as after a jump.
    #[default]
    Unknown,
    /// To later frames.
    Forward,
    /// To earlier frames.
    Backward,
}

impl StepDirection {
    /// The direction of a step from one frame to another: unknown when it is no step to a near
    /// neighbour.
    pub fn from_step(from: usize, to: usize) -> Self {
        const MAX_STEP: usize = 12;
        match (to.checked_sub(from), from.checked_sub(to)) {
            (Some(1..=MAX_STEP), _) => Self::Forward,
            (_, Some(1..=MAX_STEP)) => Self::Backward,
            _ => Self::Unknown,
        }
    }
}

/// Numbers of frames to decode in advance.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct PrefetchOptions {
    /// Number of frames in the direction of stepping. Default: 12.
    pub ahead: usize,
    /// Number of frames in the other direction. Default: 2.
    pub behind: usize,
    /// Whether frames are cheap only in ascending order, as in a video. Stepping back then decodes
    /// whole blocks of `ahead` frames from their first frame on, instead of one seek per frame.
    /// Default: false (image files).
    pub in_blocks: bool,
}

impl Default for PrefetchOptions {
    fn default() -> Self {
        Self {
            ahead: 12,
            behind: 2,
            in_blocks: false,
        }
    }
}

impl PrefetchOptions {
    /// Limits the numbers to half of the frames that fit a cache: 1,080p frames take 8 MB each, 4K
    /// frames 33 MB.
    #[must_use]
    pub fn within(self, budget_bytes: usize, picture_bytes: usize) -> Self {
        // The other half is for frames that the user has viewed and may return to. Stepping back in
        // blocks keeps two blocks at a time.
        let room = budget_bytes / 2 / picture_bytes.max(1);
        let ahead = if self.in_blocks {
            room / 2
        } else {
            room.saturating_sub(self.behind.min(room / 2))
        };
        Self {
            ahead: self.ahead.min(ahead.max(1)),
            behind: self.behind.min(room / 2),
            ..self
        }
    }
}

/// The neighbours of frame `current` to decode, of `count` frames: the most urgent first, without
/// duplicates and without `current`.
///
/// Empty if `current` is not among the frames.
pub fn prefetch_plan(
    current: usize,
    count: usize,
    direction: StepDirection,
    options: PrefetchOptions,
) -> Vec<usize> {
    if current >= count {
        return Vec::new();
    }
    match direction {
        StepDirection::Forward => later(current, count, options.ahead)
            .chain(earlier(current, options.behind))
            .collect(),
        StepDirection::Backward if options.in_blocks => {
            // The rest of the current block in ascending order, then the block before it. Blocks
            // begin at multiples of their length, so that a step within one requests nothing new.
            let block = options.ahead.max(1);
            let own = current / block * block;
            let before = own.saturating_sub(block)..own;
            (own..current)
                .chain(before)
                .chain(later(current, count, options.behind))
                .collect()
        }
        StepDirection::Backward => earlier(current, options.ahead)
            .chain(later(current, count, options.behind))
            .collect(),
        StepDirection::Unknown => later(current, count, options.ahead.div_ceil(2))
            .chain(earlier(current, options.behind))
            .collect(),
    }
}

/// The frames after `current`, of `count` frames, the nearest first.
fn later(current: usize, count: usize, frames: usize) -> impl Iterator<Item = usize> {
    let next = current.saturating_add(1);
    next..next.saturating_add(frames).min(count)
}

/// The frames before `current`, the nearest first.
fn earlier(current: usize, frames: usize) -> impl Iterator<Item = usize> {
    (current.saturating_sub(frames)..current).rev()
}

#[cfg(test)]
mod tests {
    use super::*;
    use StepDirection::{Backward, Forward, Unknown};

    const SINGLE: PrefetchOptions = PrefetchOptions {
        ahead: 4,
        behind: 2,
        in_blocks: false,
    };
    const BLOCKS: PrefetchOptions = PrefetchOptions {
        ahead: 4,
        behind: 1,
        in_blocks: true,
    };

    #[test]
    fn the_nearest_in_the_direction_come_first() {
        assert_eq!(
            prefetch_plan(10, 100, Forward, SINGLE),
            [11, 12, 13, 14, 9, 8]
        );
        assert_eq!(
            prefetch_plan(10, 100, Backward, SINGLE),
            [9, 8, 7, 6, 11, 12]
        );
        assert_eq!(prefetch_plan(10, 100, Unknown, SINGLE), [11, 12, 9, 8]);
    }

    #[test]
    fn back_through_a_video_in_blocks_of_rising_frames() {
        assert_eq!(
            prefetch_plan(10, 100, Backward, BLOCKS),
            [8, 9, 4, 5, 6, 7, 11]
        );
        // A step within a block asks for nothing new.
        assert_eq!(prefetch_plan(9, 100, Backward, BLOCKS), [8, 4, 5, 6, 7, 10]);
        assert_eq!(prefetch_plan(8, 100, Backward, BLOCKS), [4, 5, 6, 7, 9]);
        assert_eq!(
            prefetch_plan(7, 100, Backward, BLOCKS),
            [4, 5, 6, 0, 1, 2, 3, 8]
        );
    }

    #[test]
    fn the_ends_cut_the_plan() {
        assert_eq!(prefetch_plan(0, 3, Forward, SINGLE), [1, 2]);
        assert_eq!(prefetch_plan(2, 3, Forward, SINGLE), [1, 0]);
        assert_eq!(prefetch_plan(1, 3, Backward, BLOCKS), [0, 2]);
        assert_eq!(prefetch_plan(0, 1, Backward, BLOCKS), [0; 0]);
        assert_eq!(prefetch_plan(5, 5, Forward, SINGLE), [0; 0]);
        assert_eq!(prefetch_plan(0, 0, Unknown, SINGLE), [0; 0]);
    }

    #[test]
    fn a_jump_has_no_direction() {
        assert_eq!(StepDirection::from_step(3, 4), Forward);
        assert_eq!(StepDirection::from_step(13, 3), Backward);
        assert_eq!(StepDirection::from_step(3, 3), Unknown);
        assert_eq!(StepDirection::from_step(3, 300), Unknown);
        assert_eq!(StepDirection::from_step(300, 3), Unknown);
    }

    proptest::proptest! {
        #[test]
        fn no_frame_twice_and_never_the_current(
            current in 0_usize..60, count in 0_usize..60, ahead in 0_usize..20, behind in 0_usize..20,
            in_blocks: bool, which in 0_usize..3,
        ) {
            let options = PrefetchOptions { ahead, behind, in_blocks };
            let plan = prefetch_plan(current, count, [Forward, Backward, Unknown][which], options);
            let mut unique = plan.clone();
            unique.sort_unstable();
            unique.dedup();
            assert_eq!(unique.len(), plan.len());
            assert!(plan.iter().all(|&index| index < count && index != current));
        }

        #[test]
        fn the_plan_fits_half_the_cache(budget in 0_usize..1000, picture in 1_usize..100, current in 0_usize..200, in_blocks: bool, which in 0_usize..3) {
            let options = PrefetchOptions { in_blocks, ..PrefetchOptions::default() }.within(budget, picture);
            let plan = prefetch_plan(current, 200, [Forward, Backward, Unknown][which], options);
            // One neighbour is fetched however small the budget; whole blocks overhang by their
            // part already shown.
            let room = (budget / 2 / picture).max(2);
            assert!(plan.len() <= room + options.behind + 1, "{} frames in room for {room}", plan.len());
        }
    }
}
