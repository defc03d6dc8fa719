//! What a worker is to read: the queue that its owner replaces, and the frame being read.

use super::queue::next_place;
use super::worker::Mailbox;
use std::collections::{BTreeSet, VecDeque};
use touchline_vision::media::{CountProgress, FrameRef, MediaError, Notice, Picture};

/// A frame is at every moment either to be read, being read, or reported.
pub(super) type FrameMailbox = Mailbox<FrameOrders, WorkReport>;

/// A worker's report.
#[derive(Debug)]
pub(super) enum WorkReport {
    /// A frame of the queue is done.
    Frame(FrameRef, Result<Picture, MediaError>),
    /// Reading a frame panicked with this message.
    Panicked(FrameRef, String),
    /// The worker itself panicked with this message; it reads nothing more.
    Broken(String),
    /// The frames of a video are being counted.
    Counting(CountProgress),
    /// Something the user should know.
    Notice(Notice),
}

/// The queue of a worker and the frame being read.
#[derive(Default)]
pub(super) struct FrameOrders {
    queue: VecDeque<FrameRef>,
    reading: Option<Reading>,
    /// Where the reader stands, as far as is known.
    last_read: Option<FrameRef>,
}

struct Reading {
    frame: FrameRef,
    /// Frames of its file are still asked for.
    is_wanted: bool,
}

/// What the owner wants now.
#[derive(Default)]
pub(super) struct Choice {
    /// All frames of interest.
    pub(super) wanted: Vec<FrameRef>,
    /// Those to be read, the most urgent first.
    pub(super) missing: Vec<FrameRef>,
}

impl FrameOrders {
    /// Replaces the queue. Each frame is read once; the one being read is not read again.
    pub(super) fn replace(&mut self, Choice { wanted, missing }: Choice) {
        let reading = self.reading.as_ref().map(|reading| &reading.frame);
        let mut chosen = BTreeSet::new();
        let is_new = |frame: &FrameRef| reading != Some(frame) && chosen.insert(frame.clone());
        self.queue = missing.into_iter().filter(is_new).collect();
        if let Some(reading) = &mut self.reading {
            reading.is_wanted = wanted
                .iter()
                .any(|frame| frame.path() == reading.frame.path());
        }
    }

    /// Whether a frame is being read or waits to be.
    pub(super) fn is_pending(&self, frame: &FrameRef) -> bool {
        self.queue.contains(frame)
            || self
                .reading
                .as_ref()
                .is_some_and(|reading| reading.frame == *frame)
    }

    /// Whether nothing waits to be read.
    pub(super) fn is_empty(&self) -> bool {
        self.queue.is_empty()
    }

    /// Whether a frame is being read or waits to be.
    pub(super) fn is_busy(&self) -> bool {
        self.reading.is_some() || !self.queue.is_empty()
    }

    /// Takes the next frame to read.
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

    /// The frame being read has been read.
    pub(super) fn finish(&mut self) {
        self.reading = None;
    }

    /// Leaves the frame being read unread; it comes first again if somebody has asked for it
    /// meanwhile.
    pub(super) fn give_up(&mut self) {
        if let Some(reading) = self.reading.take().filter(|reading| reading.is_wanted) {
            self.queue.push_front(reading.frame);
        }
    }

    /// Whether the frame being read may take longer.
    pub(super) fn is_reading_wanted(&self) -> bool {
        self.reading
            .as_ref()
            .is_none_or(|reading| reading.is_wanted)
    }
}
