//! The orders of a frame worker: the queue, which its owner replaces, and the frame being read.

use super::worker::Mailbox;
use std::collections::{BTreeSet, VecDeque};
use std::path::Path;
use touchline_vision::media::{CountProgress, FrameRef, MediaError, Notice, Picture};

/// The mailbox of a frame worker. A frame is always either queued, being read, or reported.
pub(super) type FrameMailbox = Mailbox<FrameOrders, DecoderReport>;

/// A report about frames that were requested.
#[derive(Clone, Debug, PartialEq)]
pub enum DecoderReport {
    /// A frame of the queue has been read, or cannot be.
    Frame(FrameRef, Result<Picture, MediaError>),
    /// Reading a frame panicked with this message.
    Panicked(FrameRef, String),
    /// The worker itself panicked with this message; it reads no more frames.
    Broken(String),
    /// Progress of counting the frames of a video.
    Counting(CountProgress),
    /// A message about a video for the user.
    Notice(Notice),
}

/// The queue, and the frame being read.
#[derive(Default)]
pub(super) struct FrameOrders {
    queue: VecDeque<FrameRef>,
    reading: Option<Reading>,
    /// The frame that was begun last: roughly the position of the video decoder.
    last_read: Option<FrameRef>,
}

struct Reading {
    frame: FrameRef,
    /// Whether frames of the same file are still wanted.
    is_wanted: bool,
}

/// The frames that the owner wants now.
#[derive(Default)]
pub(super) struct Choice {
    /// All of them.
    pub(super) wanted: Vec<FrameRef>,
    /// Those that have to be read, the most urgent first.
    pub(super) missing: Vec<FrameRef>,
}

impl FrameOrders {
    /// Replaces the queue. Duplicates and the frame being read are left out.
    pub(super) fn replace(&mut self, Choice { wanted, missing }: Choice) {
        let reading = self.reading.as_ref().map(|reading| &reading.frame);
        let mut chosen = BTreeSet::new();
        self.queue = missing
            .into_iter()
            .filter(|frame| reading != Some(frame) && chosen.insert(frame.clone()))
            .collect();
        // Compare files, not frames: what can be stopped is counting the frames of a video, and all
        // its frames need that count.
        if let Some(reading) = &mut self.reading {
            reading.is_wanted = wanted
                .iter()
                .any(|frame| frame.path() == reading.frame.path());
        }
    }

    /// Whether a frame is queued or being read.
    pub(super) fn is_pending(&self, frame: &FrameRef) -> bool {
        self.queue.contains(frame)
            || self
                .reading
                .as_ref()
                .is_some_and(|reading| reading.frame == *frame)
    }

    /// Whether the queue is empty.
    pub(super) fn is_empty(&self) -> bool {
        self.queue.is_empty()
    }

    /// Whether any frame is queued or being read.
    pub(super) fn is_busy(&self) -> bool {
        self.reading.is_some() || !self.queue.is_empty()
    }

    /// Takes the next frame from the queue and marks it as being read.
    pub(super) fn begin(&mut self) -> Option<FrameRef> {
        let place = next_place(&self.queue, self.last_read.as_ref())?;
        let frame = self.queue.remove(place)?;
        self.last_read = Some(frame.clone());
        self.reading = Some(Reading {
            frame: frame.clone(),
            is_wanted: true,
        });
        Some(frame)
    }

    /// Records that the frame being read is finished.
    pub(super) fn finish(&mut self) {
        self.reading = None;
    }

    /// Records that reading was stopped. If a frame of the same file has been requested again
    /// meanwhile, the frame returns to the front of the queue.
    pub(super) fn give_up(&mut self) {
        if let Some(reading) = self.reading.take().filter(|reading| reading.is_wanted) {
            self.queue.push_front(reading.frame);
        }
    }

    /// Whether reading the current frame may continue.
    pub(super) fn is_reading_wanted(&self) -> bool {
        self.reading
            .as_ref()
            .is_none_or(|reading| reading.is_wanted)
    }
}

/// Maximum number of frames before the most urgent one that are read on the way to it.
///
/// A video is decoded forward only. Going back to a frame costs about fifty frames of decoding; the
/// frames just before it cost 3 ms each if they are decoded in the same pass. Without this, each
/// step backwards would seek.
const ON_THE_WAY_FRAMES: usize = 16;

/// The index in `queue`, which has the most urgent frame first, of the next frame to read after
/// `last`: the most urgent, or the first queued frame of the same video shortly before it that the
/// decoder passes anyway. `None` if the queue is empty.
pub(super) fn next_place(queue: &VecDeque<FrameRef>, last: Option<&FrameRef>) -> Option<usize> {
    let FrameRef::Video {
        path,
        index: urgent,
    } = queue.front()?
    else {
        return Some(0);
    };
    // The decoder cannot pass frames at or before its own position.
    let stands_at = last
        .and_then(|frame| index_in_video(frame, path))
        .filter(|at| at < urgent);
    let from = urgent
        .saturating_sub(ON_THE_WAY_FRAMES)
        .max(stands_at.map_or(0, |at| at + 1));
    // Of the queued frames in that range the earliest, because the decoder only goes forward.
    let on_the_way = queue
        .iter()
        .enumerate()
        .filter_map(|(place, frame)| Some((index_in_video(frame, path)?, place)));
    on_the_way
        .filter(|(index, _)| (from..=*urgent).contains(index))
        .min()
        .map(|(_, place)| place)
}

/// The index of a frame among the decoded frames of a video. `None` if it is of another file.
fn index_in_video(frame: &FrameRef, video: &Path) -> Option<usize> {
    match frame {
        FrameRef::Video { path, index } if **path == *video => Some(*index),
        FrameRef::Video { .. } | FrameRef::Image(_) => None,
    }
}

#[cfg(test)]
mod tests {
    use super::super::fake_reader::frame;
    use super::*;
    use std::path::Path;

    /// The order in which a queue is read when the decoder is at a frame.
    fn order(queue: &[usize], stands_at: Option<usize>) -> Vec<usize> {
        let mut queue: VecDeque<_> = queue.iter().map(|&index| frame(index)).collect();
        let mut last = stands_at.map(frame);
        let mut order = Vec::new();
        while let Some(next) =
            next_place(&queue, last.as_ref()).and_then(|place| queue.remove(place))
        {
            let FrameRef::Video { index, .. } = next else {
                panic!()
            };
            order.push(index);
            last = Some(next);
        }
        order
    }

    #[test]
    fn forward_the_order_of_the_queue_is_kept() {
        assert_eq!(order(&[5, 6, 7, 8], Some(4)), [5, 6, 7, 8]);
        assert_eq!(
            order(&[5, 6, 7, 4, 3], Some(4)),
            [5, 6, 7, 3, 4],
            "those behind come last, in one pass"
        );
        assert_eq!(
            order(&[100, 101, 5], Some(4)),
            [100, 101, 5],
            "too far to be on the way"
        );
    }

    #[test]
    fn back_a_block_is_read_in_one_pass() {
        assert_eq!(order(&[20, 16, 17, 18, 19], Some(21)), [16, 17, 18, 19, 20]);
        // The user has come to 20 while the decoder is in the middle of the block.
        assert_eq!(order(&[20, 18, 19, 8, 9], Some(17)), [18, 19, 20, 8, 9]);
        assert_eq!(order(&[40, 10, 30], None), [30, 40, 10]);
    }

    #[test]
    fn other_files_are_not_on_the_way() {
        let image = FrameRef::image(Path::new("a.png"));
        let other = FrameRef::video(Path::new("other.mp4"), 4);
        let queue: VecDeque<_> = [frame(5), other.clone(), image.clone()].into();
        assert_eq!(next_place(&queue, Some(&other)), Some(0));
        assert_eq!(next_place(&[image, frame(5)].into(), None), Some(0));
        assert_eq!(next_place(&VecDeque::new(), None), None);
    }
}
