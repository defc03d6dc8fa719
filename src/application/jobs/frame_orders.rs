//! The orders of a frame worker: the queue, which its owner replaces, and the frame being read.

use super::queue::next_place;
use super::worker::Mailbox;
use std::collections::{BTreeSet, VecDeque};
use touchline_vision::media::{CountProgress, FrameRef, MediaError, Notice, Picture};

/// The mailbox of a frame worker. A frame is always either queued, being read, or reported.
pub(super) type FrameMailbox = Mailbox<FrameOrders, WorkReport>;

/// A worker's report.
#[derive(Debug)]
pub(super) enum WorkReport {
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
