//! Makes the thumbnails of the filmstrip while the decoder is idle.

use super::frame_orders::{Choice, WorkReport};
use super::frame_worker::{FrameWorker, MakeReader};
use super::shared_pictures::SharedReader;
use super::{Decoder, Wake};
use std::collections::BTreeSet;
use std::io;
use touchline_vision::media::{
    FrameCache, FrameReader, FrameRef, MediaError, Notice, Picture, ReadFrames, THUMBNAIL_SIZE,
    letterbox,
};

/// Memory for thumbnails, bytes: about 2,300 of them.
const CACHE_BYTES: usize = 128 << 20;

/// A report about thumbnails.
#[derive(Clone, Debug, PartialEq)]
pub enum ThumbnailReport {
    /// A thumbnail has been made; [`Thumbnails::picture`] also returns it.
    Ready {
        frame: FrameRef,
        /// Its pixels, in the size [`THUMBNAIL_SIZE`].
        picture: Picture,
    },
    /// The frame cannot be read. The decoder reports the reason when it becomes the current frame.
    Failed { frame: FrameRef },
    /// Reading a frame panicked; the job continues with others.
    Panicked {
        frame: FrameRef,
        /// The panic's message.
        message: String,
    },
    /// The job panicked; it makes no more thumbnails.
    Broken {
        /// The panic's message.
        message: String,
    },
}

/// The handle of the thread that makes thumbnails. Dropping it ends and joins the thread.
pub struct Thumbnails {
    worker: FrameWorker,
    requested: Vec<FrameRef>,
    memory: Memory,
}

/// The owner's side of the job.
struct Memory {
    cache: FrameCache,
    failed: BTreeSet<FrameRef>,
    unpolled: Vec<ThumbnailReport>,
}

impl Thumbnails {
    /// Starts the job. It begins no thumbnail while `decoder` has a frame to decode.
    ///
    /// # Errors
    /// The operating system gives no thread.
    pub fn spawn(decoder: &Decoder, wake: Wake) -> io::Result<Self> {
        let pictures = decoder.pictures();
        let make_reader: MakeReader = Box::new(move |counting| {
            Box::new(SharedReader::new(
                Box::new(FrameReader::with_progress(counting)),
                pictures.clone(),
            ))
        });
        Self::with_reader(decoder, wake, make_reader)
    }

    /// Starts the job with another reader.
    pub(super) fn with_reader(
        decoder: &Decoder,
        wake: Wake,
        make_reader: MakeReader,
    ) -> io::Result<Self> {
        let make_small: MakeReader = Box::new(move |counting| {
            Box::new(SmallReader {
                full: make_reader(counting),
            })
        });
        Ok(Self {
            worker: FrameWorker::spawn("thumbnails", wake, Some(decoder.worker()), make_small)?,
            requested: Vec::new(),
            memory: Memory {
                cache: FrameCache::new(CACHE_BYTES),
                failed: BTreeSet::new(),
                unpolled: Vec::new(),
            },
        })
    }

    /// Requests the thumbnails of these frames in this order, visible ones first. Frames of earlier
    /// requests that are not in this one are dropped. Repeating a request costs nothing.
    pub fn request(&mut self, frames: &[FrameRef]) {
        if self.requested == frames {
            return;
        }
        let memory = &mut self.memory;
        self.worker.replace_queue(|reports| {
            for report in reports {
                memory.take_in(report);
            }
            let missing = frames
                .iter()
                .filter(|frame| memory.lacks(frame))
                .cloned()
                .collect();
            Choice {
                wanted: frames.to_vec(),
                missing,
            }
        });
        self.requested = frames.to_vec();
    }

    /// The reports that have arrived since the last call. Call it whenever the window is drawn.
    pub fn poll(&mut self) -> Vec<ThumbnailReport> {
        for report in self.worker.fetch_reports() {
            self.memory.take_in(report);
        }
        std::mem::take(&mut self.memory.unpolled)
    }

    /// The thumbnail of a frame, if it is in memory.
    pub fn picture(&mut self, frame: &FrameRef) -> Option<Picture> {
        self.memory.cache.get(frame)
    }

    /// Whether a frame has no thumbnail because it cannot be read.
    pub fn has_failed(&self, frame: &FrameRef) -> bool {
        self.memory.failed.contains(frame)
    }
}

impl Memory {
    /// Takes in a report of the worker: keeps thumbnails and failures, and queues what the owner
    /// should see.
    fn take_in(&mut self, report: WorkReport) {
        let report = match report {
            WorkReport::Frame(frame, Ok(picture)) => {
                self.cache.insert(frame.clone(), picture.clone());
                ThumbnailReport::Ready { frame, picture }
            }
            WorkReport::Frame(frame, Err(_)) => {
                self.failed.insert(frame.clone());
                ThumbnailReport::Failed { frame }
            }
            WorkReport::Panicked(frame, message) => {
                self.failed.insert(frame.clone());
                ThumbnailReport::Panicked { frame, message }
            }
            WorkReport::Broken(message) => ThumbnailReport::Broken { message },
            // The decoder opens the same videos and reports this.
            WorkReport::Counting(_) | WorkReport::Notice(_) => return,
        };
        self.unpolled.push(report);
    }

    fn lacks(&self, frame: &FrameRef) -> bool {
        !self.cache.contains(frame) && !self.failed.contains(frame)
    }
}

/// Reads frames and scales them to thumbnails.
struct SmallReader {
    full: Box<dyn ReadFrames>,
}

impl ReadFrames for SmallReader {
    fn read(&mut self, frame: &FrameRef) -> Result<Picture, MediaError> {
        Ok(letterbox(&self.full.read(frame)?, THUMBNAIL_SIZE))
    }

    fn take_notices(&mut self) -> Vec<Notice> {
        self.full.take_notices()
    }
}

#[cfg(test)]
mod tests {
    use super::super::fake_reader::{Controller, Reply, fake_reader, frame};
    use super::*;
    use crate::jobs::DecoderOptions;
    use std::sync::mpsc::TryRecvError;

    fn held_pair() -> (Decoder, Controller, Thumbnails, Controller) {
        let (make_reader, wake, decoder_controller) = fake_reader();
        let decoder = Decoder::with_reader(DecoderOptions::default(), wake, make_reader).unwrap();
        let (make_reader, wake, controller) = fake_reader();
        let thumbnails = Thumbnails::with_reader(&decoder, wake, make_reader).unwrap();
        (decoder, decoder_controller, thumbnails, controller)
    }

    #[test]
    fn thumbnails_are_small_and_kept() {
        let (_decoder, _, mut thumbnails, controller) = held_pair();
        thumbnails.request(&[frame(3), frame(4)]);
        controller.let_out(Reply::Picture);
        let reports = controller.poll_until(|| thumbnails.poll());
        let [ThumbnailReport::Ready { frame: of, picture }] = reports.as_slice() else {
            panic!("{reports:?}")
        };
        assert_eq!((of, picture.size()), (&frame(3), THUMBNAIL_SIZE));
        assert_eq!(thumbnails.picture(&frame(3)).as_ref(), Some(picture));
        controller.let_out(Reply::Missing);
        assert_eq!(
            controller.poll_until(|| thumbnails.poll()),
            [ThumbnailReport::Failed { frame: frame(4) }]
        );
        assert!(thumbnails.has_failed(&frame(4)) && !thumbnails.has_failed(&frame(3)));
        // Neither frame is read again.
        thumbnails.request(&[frame(5), frame(4), frame(3)]);
        controller.let_out(Reply::Panic);
        let message = "frame 5 is cursed".to_owned();
        assert_eq!(
            controller.poll_until(|| thumbnails.poll()),
            [ThumbnailReport::Panicked {
                frame: frame(5),
                message
            }]
        );
        assert_eq!(controller.begun.try_iter().collect::<Vec<_>>(), [3, 4, 5]);
    }

    #[test]
    fn thumbnails_wait_for_the_decoder() {
        let (mut decoder, decoder_controller, mut thumbnails, controller) = held_pair();
        decoder.request(&frame(0), &[frame(1)]);
        assert_eq!(decoder_controller.next_begun(), 0);
        thumbnails.request(&[frame(9)]);
        decoder_controller.let_out(Reply::Picture);
        assert_eq!(decoder_controller.next_begun(), 1);
        assert_eq!(controller.begun.try_recv(), Err(TryRecvError::Empty));
        decoder_controller.let_out(Reply::Picture);
        assert_eq!(controller.next_begun(), 9);
        controller.let_out(Reply::Picture);
        assert_eq!(controller.poll_until(|| thumbnails.poll()).len(), 1);
    }

    #[test]
    fn dropping_ends_the_wait_for_the_decoder() {
        let (mut decoder, decoder_controller, mut thumbnails, _hand) = held_pair();
        decoder.request(&frame(0), &[]);
        assert_eq!(decoder_controller.next_begun(), 0);
        thumbnails.request(&[frame(9)]);
        drop(thumbnails);
        decoder_controller.let_out(Reply::Picture);
        drop(decoder);
    }

    #[test]
    fn thumbnails_outlive_the_decoder() {
        let (mut decoder, decoder_controller, mut thumbnails, controller) = held_pair();
        decoder_controller.let_out(Reply::Picture);
        decoder.request(&frame(0), &[frame(1)]);
        decoder_controller.let_out_pictures(1);
        drop(decoder);
        thumbnails.request(&[frame(9)]);
        assert_eq!(controller.next_begun(), 9);
        controller.let_out(Reply::Picture);
        assert_eq!(controller.poll_until(|| thumbnails.poll()).len(), 1);
    }
}
