//! Makes the thumbnails of the filmstrip while the decoder is idle.

use super::frame_worker::MakeReader;
use touchline_vision::media::{
    FrameRef, MediaError, Notice, Picture, ReadFrames, THUMBNAIL_SIZE, letterbox,
};

/// Memory for thumbnails, bytes: about 2,300 of them.
pub(super) const CACHE_BYTES: usize = 128 << 20;

/// Readers of thumbnails in place of readers of whole frames.
pub(super) fn make_small(make_reader: MakeReader) -> MakeReader {
    Box::new(move |counting| {
        Box::new(SmallReader {
            full: make_reader(counting),
        })
    })
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
    use crate::jobs::frame_orders::DecoderReport;
    use crate::jobs::frame_worker::FrameWorker;
    use crate::jobs::{Decoder, SharedPictures};
    use std::sync::mpsc::TryRecvError;

    fn held_pair() -> (Decoder, Controller, Decoder, Controller) {
        let (make_reader, wake, decoder_controller) = fake_reader();
        let first = FrameWorker::spawn("decoder", wake, None, make_reader).unwrap();
        let (make_reader, wake, controller) = fake_reader();
        let make_small = make_small(make_reader);
        let worker = FrameWorker::spawn("thumbnails", wake, Some(&first), make_small).unwrap();
        let with_memory = |worker| Decoder::new(worker, SharedPictures::new(CACHE_BYTES));
        (
            with_memory(first),
            decoder_controller,
            with_memory(worker),
            controller,
        )
    }

    #[test]
    fn thumbnails_are_small_and_kept() {
        let (_decoder, _, mut thumbnails, controller) = held_pair();
        thumbnails.request_all(&[frame(3), frame(4)]);
        controller.let_out(Reply::Picture);
        let reports = controller.poll_until(|| thumbnails.poll());
        let [DecoderReport::Frame(of, Ok(picture))] = reports.as_slice() else {
            panic!("{reports:?}")
        };
        assert_eq!((of, picture.size()), (&frame(3), THUMBNAIL_SIZE));
        assert_eq!(thumbnails.picture(&frame(3)).as_ref(), Some(picture));
        controller.let_out(Reply::Missing);
        // The decoder reports the reason when the user comes to the frame.
        while !thumbnails.has_failed(&frame(4)) {
            assert_eq!(thumbnails.poll(), []);
        }
        assert!(!thumbnails.has_failed(&frame(3)));
        // Neither frame is read again.
        thumbnails.request_all(&[frame(5), frame(4), frame(3)]);
        controller.let_out(Reply::Panic);
        let message = "frame 5 is cursed".to_owned();
        assert_eq!(
            controller.poll_until(|| thumbnails.poll()),
            [DecoderReport::Panicked(frame(5), message)]
        );
        assert_eq!(controller.begun.try_iter().collect::<Vec<_>>(), [3, 4, 5]);
    }

    #[test]
    fn thumbnails_wait_for_the_decoder() {
        let (mut decoder, decoder_controller, mut thumbnails, controller) = held_pair();
        decoder.request(&frame(0), &[frame(1)]);
        assert_eq!(decoder_controller.next_begun(), 0);
        thumbnails.request_all(&[frame(9)]);
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
        thumbnails.request_all(&[frame(9)]);
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
        thumbnails.request_all(&[frame(9)]);
        assert_eq!(controller.next_begun(), 9);
        controller.let_out(Reply::Picture);
        assert_eq!(controller.poll_until(|| thumbnails.poll()).len(), 1);
    }
}
