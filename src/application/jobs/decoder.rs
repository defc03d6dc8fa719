//! Decodes the current frame and its neighbours, and keeps them in memory.

use super::frame_orders::{Choice, DecoderReport};
use super::frame_worker::{FrameWorker, MakeReader};
use super::shared_pictures::{SharedPictures, SharedReader};
use super::{Wake, thumbnails};
use std::collections::BTreeMap;
use std::io;
use touchline_vision::media::{FrameReader, FrameRef, MediaError, Picture};

/// What can be shown for a frame now.
#[derive(Clone, Debug, PartialEq)]
pub enum FrameState {
    /// Its pixels.
    Ready(Picture),
    /// The frame is being decoded or waits.
    Pending,
    /// The frame cannot be read.
    Failed(MediaError),
    /// The frame has not been requested, or has been dropped from memory.
    Absent,
}

/// The handle of the decoder. Dropping it ends and joins the thread.
pub struct Decoder {
    worker: FrameWorker,
    memory: Memory,
    /// The frames of the last request.
    requested: Vec<FrameRef>,
}

/// The owner's side of the decoder.
struct Memory {
    current: Option<FrameRef>,
    cache: SharedPictures,
    failures: BTreeMap<FrameRef, MediaError>,
    unpolled: Vec<DecoderReport>,
}

impl Decoder {
    /// Starts the decoder with a memory of so many bytes. `wake` is called from its thread when a
    /// report waits.
    ///
    /// # Errors
    /// The operating system gives no thread.
    pub fn spawn(cache_bytes: usize, wake: Wake) -> io::Result<Self> {
        let pictures = SharedPictures::new(cache_bytes);
        let worker = FrameWorker::spawn("decoder", wake, None, make_reader(&pictures))?;
        Ok(Self::new(worker, pictures))
    }

    /// Starts a decoder of thumbnails beside this one. It begins no frame while this one has some
    /// to read, and takes the pictures that this one has.
    ///
    /// # Errors
    /// The operating system gives no thread.
    pub fn spawn_thumbnails(&self, wake: Wake) -> io::Result<Self> {
        let make_small = thumbnails::make_small(make_reader(&self.memory.cache));
        let worker = FrameWorker::spawn("thumbnails", wake, Some(&self.worker), make_small)?;
        Ok(Self::new(
            worker,
            SharedPictures::new(thumbnails::CACHE_BYTES),
        ))
    }

    pub(super) const fn new(worker: FrameWorker, pictures: SharedPictures) -> Self {
        Self {
            worker,
            memory: Memory::new(pictures),
            requested: Vec::new(),
        }
    }

    /// Requests the current frame and then, in this order, others. Frames of earlier requests that
    /// are not in this one are dropped. Queued frames of a video that lie shortly before another
    /// one are decoded on the way to it. Frames in memory are not decoded again. Repeating a
    /// request costs nothing, so this can be called whenever the window is drawn.
    ///
    /// A frame that failed is tried again when it becomes the current one: its file may have been
    /// repaired.
    pub fn request(&mut self, current: &FrameRef, prefetch: &[FrameRef]) {
        let is_new = self.memory.current.as_ref() != Some(current);
        self.memory.current = Some(current.clone());
        let again = Some(current).filter(|_| is_new);
        self.replace_request(std::iter::once(current).chain(prefetch), again);
    }

    /// Requests frames of which none is the current one, such as those of the filmstrip.
    pub fn request_all(&mut self, frames: &[FrameRef]) {
        self.replace_request(frames.iter(), None);
    }

    /// `again`: a frame that is tried again if it failed before.
    fn replace_request<'a>(
        &mut self,
        frames: impl Iterator<Item = &'a FrameRef> + Clone,
        again: Option<&FrameRef>,
    ) {
        if self.requested.iter().eq(frames.clone()) {
            return;
        }
        self.requested = frames.cloned().collect();
        let (memory, wanted) = (&mut self.memory, self.requested.clone());
        self.worker.replace_queue(|reports| {
            // Reports come first: a frame that has arrived is not missing any more.
            for report in reports {
                memory.take_in(report);
            }
            // Forget the failure of a frame only when the user comes to it. Otherwise each request
            // would read a damaged neighbour again.
            if let Some(again) = again {
                memory.failures.remove(again);
            }
            let missing = wanted.iter().filter(|frame| memory.lacks(frame));
            let missing = missing.cloned().collect();
            Choice { wanted, missing }
        });
    }

    /// Drops all requests, pictures and failures, as when a document is closed.
    pub fn clear(&mut self) {
        self.worker.replace_queue(|_| Choice::default());
        self.requested.clear();
        // The cache is emptied, not replaced: filmstrip, trainer and operations share it.
        self.memory.cache.clear();
        self.memory = Memory::new(self.memory.cache.clone());
    }

    /// The reports that have arrived since the last call. Call it whenever the window is drawn.
    pub fn poll(&mut self) -> Vec<DecoderReport> {
        for report in self.worker.fetch_reports() {
            self.memory.take_in(report);
        }
        std::mem::take(&mut self.memory.unpolled)
    }

    /// The pixels of a frame, if they are in memory.
    pub fn picture(&mut self, frame: &FrameRef) -> Option<Picture> {
        self.memory.cache.get(frame)
    }

    /// What can be shown for a frame now.
    pub fn state(&mut self, frame: &FrameRef) -> FrameState {
        if let Some(picture) = self.picture(frame) {
            FrameState::Ready(picture)
        } else if let Some(error) = self.memory.failures.get(frame) {
            FrameState::Failed(error.clone())
        } else if self.worker.is_pending(frame) {
            FrameState::Pending
        } else {
            FrameState::Absent
        }
    }

    /// The decoded frames, for other readers.
    pub fn pictures(&self) -> SharedPictures {
        self.memory.cache.clone()
    }

    /// The memory for decoded frames, bytes.
    pub fn cache_bytes(&self) -> usize {
        self.memory.cache.budget_bytes()
    }

    /// Whether a frame cannot be read.
    pub fn has_failed(&self, frame: &FrameRef) -> bool {
        self.memory.failures.contains_key(frame)
    }
}

/// Makes readers that decode no frame which is in memory.
fn make_reader(pictures: &SharedPictures) -> MakeReader {
    let pictures = pictures.clone();
    Box::new(move |counting| {
        let own = Box::new(FrameReader::with_progress(counting));
        Box::new(SharedReader::new(own, pictures.clone()))
    })
}

impl Memory {
    const fn new(cache: SharedPictures) -> Self {
        Self {
            current: None,
            cache,
            failures: BTreeMap::new(),
            unpolled: Vec::new(),
        }
    }

    /// Takes in a report of the worker: keeps pictures and failures, and queues what the owner
    /// should see.
    fn take_in(&mut self, report: DecoderReport) {
        match &report {
            DecoderReport::Frame(frame, Ok(picture)) => {
                self.failures.remove(frame);
                self.cache.insert(frame.clone(), picture.clone());
                self.keep_current();
            }
            DecoderReport::Frame(frame, Err(error)) => {
                self.failures.insert(frame.clone(), error.clone());
                if self.current.as_ref() != Some(frame) {
                    return;
                }
            }
            DecoderReport::Panicked(frame, message) => {
                // Also a failure, so that the frame is not requested, and panics, once more.
                let (path, message) = (frame.path().to_path_buf(), message.clone());
                let error = MediaError::Panicked { path, message };
                self.failures.insert(frame.clone(), error);
            }
            DecoderReport::Broken(_) | DecoderReport::Counting(_) | DecoderReport::Notice(_) => {}
        }
        self.unpolled.push(report);
    }

    /// Marks the current frame as used, so that arriving neighbours do not displace it.
    fn keep_current(&mut self) {
        if let Some(current) = &self.current {
            let _ = self.cache.get(current);
        }
    }

    fn lacks(&self, frame: &FrameRef) -> bool {
        !self.cache.contains(frame) && !self.failures.contains_key(frame)
    }
}

#[cfg(test)]
mod tests {
    use super::super::fake_reader::{Controller, Reply, fake_reader, frame, picture};
    use super::*;
    use std::path::Path;
    use touchline_vision::media::CountProgress;

    fn held_decoder() -> (Decoder, Controller) {
        let (make_reader, wake, controller) = fake_reader();
        let worker = FrameWorker::spawn("decoder", wake, None, make_reader).unwrap();
        let decoder = Decoder::new(worker, SharedPictures::new(64 * picture(0).bytes()));
        (decoder, controller)
    }

    fn frames(indices: &[usize]) -> Vec<FrameRef> {
        indices.iter().map(|&index| frame(index)).collect()
    }

    fn ready(index: usize) -> DecoderReport {
        DecoderReport::Frame(frame(index), Ok(picture(index)))
    }

    #[test]
    fn the_current_frame_comes_first_then_its_neighbours_in_order() {
        let (mut decoder, controller) = held_decoder();
        assert_eq!(decoder.state(&frame(5)), FrameState::Absent);
        decoder.request(&frame(5), &frames(&[6, 7, 50, 5, 6]));
        assert_eq!(decoder.state(&frame(5)), FrameState::Pending);
        let mut order = Vec::new();
        for _ in 0..4 {
            order.push(controller.next_begun());
            controller.let_out(Reply::Picture);
            assert_eq!(
                controller.poll_until(|| decoder.poll()),
                [ready(*order.last().unwrap())]
            );
        }
        assert_eq!(order, [5, 6, 7, 50]);
        assert_eq!(decoder.state(&frame(50)), FrameState::Ready(picture(50)));
    }

    #[test]
    fn what_is_no_longer_requested_is_not_read() {
        let (mut decoder, controller) = held_decoder();
        decoder.request(&frame(0), &frames(&[1, 2, 3]));
        assert_eq!(controller.next_begun(), 0);
        decoder.request(&frame(50), &frames(&[51]));
        assert_eq!(decoder.state(&frame(1)), FrameState::Absent);
        controller.let_out_pictures(3);
        assert_eq!([controller.next_begun(), controller.next_begun()], [50, 51]);
        let mut reports = Vec::new();
        while reports.len() < 3 {
            reports.extend(controller.poll_until(|| decoder.poll()));
        }
        assert_eq!(
            reports,
            [ready(0), ready(50), ready(51)],
            "what had been begun is kept all the same"
        );
        assert!(controller.begun.try_recv().is_err());
    }

    #[test]
    fn a_frame_kept_or_being_read_is_not_read_again() {
        let (mut decoder, controller) = held_decoder();
        decoder.request(&frame(0), &frames(&[1]));
        controller.let_out_pictures(1);
        assert_eq!([controller.next_begun(), controller.next_begun()], [0, 1]);
        // Frame 0 waits to be polled, frame 1 is being read.
        decoder.request(&frame(1), &frames(&[0, 2]));
        assert_eq!(
            decoder.picture(&frame(0)),
            Some(picture(0)),
            "taken in with the request"
        );
        controller.let_out_pictures(2);
        assert_eq!(controller.next_begun(), 2);
        let mut reports = Vec::new();
        while reports.len() < 3 {
            reports.extend(controller.poll_until(|| decoder.poll()));
        }
        assert_eq!(reports, [ready(0), ready(1), ready(2)]);
        decoder.request(&frame(2), &frames(&[1, 0]));
        assert_eq!(decoder.state(&frame(2)), FrameState::Ready(picture(2)));
        assert!(controller.begun.try_recv().is_err());
    }

    #[test]
    fn a_neighbour_that_fails_is_reported_when_the_user_comes_to_it() {
        let (mut decoder, controller) = held_decoder();
        let error = MediaError::Missing {
            path: Path::new("match.mp4").to_path_buf(),
        };
        decoder.request(&frame(0), &frames(&[1]));
        controller.let_out(Reply::Picture);
        controller.let_out(Reply::Missing);
        assert_eq!(controller.poll_until(|| decoder.poll()), [ready(0)]);
        while decoder.state(&frame(1)) == FrameState::Pending {
            assert_eq!(decoder.poll(), []);
        }
        assert_eq!(decoder.poll(), []);
        assert_eq!(decoder.state(&frame(1)), FrameState::Failed(error.clone()));
        // The frame becomes the current one: it is tried again, and fails again.
        controller.let_out(Reply::Missing);
        decoder.request(&frame(1), &frames(&[0]));
        let failed = DecoderReport::Frame(frame(1), Err(error));
        assert_eq!(controller.poll_until(|| decoder.poll()), [failed]);
        // Repeating the request is no new attempt; coming back to the frame is.
        decoder.request(&frame(1), &frames(&[0]));
        decoder.request(&frame(0), &[]);
        controller.let_out(Reply::Picture);
        decoder.request(&frame(1), &[]);
        assert_eq!(controller.poll_until(|| decoder.poll()), [ready(1)]);
        assert_eq!(
            controller.begun.try_iter().collect::<Vec<_>>(),
            [0, 1, 1, 1]
        );
    }

    #[test]
    fn a_panic_is_reported_and_the_next_frame_is_read() {
        let (mut decoder, controller) = held_decoder();
        decoder.request(&frame(0), &frames(&[1]));
        controller.let_out(Reply::Panic);
        controller.let_out(Reply::Picture);
        let mut reports = Vec::new();
        while reports.len() < 2 {
            reports.extend(controller.poll_until(|| decoder.poll()));
        }
        let message = "frame 0 is cursed".to_owned();
        assert_eq!(
            reports,
            [DecoderReport::Panicked(frame(0), message), ready(1)]
        );
        let FrameState::Failed(error) = decoder.state(&frame(0)) else {
            panic!("not failed")
        };
        assert_eq!(
            error.to_string(),
            "match.mp4: internal error while reading it (frame 0 is cursed); please report it together with the file"
        );
    }

    #[test]
    fn a_long_count_ends_when_the_user_goes_to_another_file() {
        let (mut decoder, controller) = held_decoder();
        decoder.request(&frame(0), &[]);
        controller.let_out(Reply::Count);
        let reports = controller.poll_until(|| decoder.poll());
        assert!(matches!(
            reports[0],
            DecoderReport::Counting(CountProgress { stated: 9, .. })
        ));
        let elsewhere = FrameRef::video(Path::new("other.mp4"), 3);
        decoder.request(&elsewhere, &[]);
        controller.let_out(Reply::Picture);
        let is_ready = |report: &DecoderReport| matches!(report, DecoderReport::Frame(frame, Ok(_)) if *frame == elsewhere);
        while !controller
            .poll_until(|| decoder.poll())
            .iter()
            .any(is_ready)
        {}
        assert_eq!(decoder.state(&frame(0)), FrameState::Absent);
    }

    #[test]
    fn dropping_ends_a_count_and_a_worker_that_waits_for_room() {
        let (mut decoder, controller) = held_decoder();
        decoder.request(&frame(0), &[]);
        controller.let_out(Reply::Count);
        assert_eq!(controller.next_begun(), 0);
        drop(decoder);
        let (mut decoder, controller) = held_decoder();
        decoder.request(&frame(0), &(1..100).map(frame).collect::<Vec<_>>());
        controller.let_out_pictures(100);
        while controller.next_begun() < 32 {}
        drop(decoder);
        assert!(
            controller.begun.try_recv().is_err(),
            "the worker pauses while it is not polled"
        );
    }

    #[test]
    fn closing_a_document_forgets_its_frames() {
        let (mut decoder, controller) = held_decoder();
        decoder.request(&frame(0), &[]);
        controller.let_out(Reply::Picture);
        assert_eq!(controller.poll_until(|| decoder.poll()), [ready(0)]);
        decoder.clear();
        assert_eq!(decoder.state(&frame(0)), FrameState::Absent);
        controller.let_out(Reply::Picture);
        decoder.request(&frame(0), &[]);
        assert_eq!(controller.poll_until(|| decoder.poll()), [ready(0)]);
    }

    #[test]
    fn a_small_cache_keeps_the_current_frame() {
        let (mut decoder, controller) = held_decoder();
        decoder.pictures().set_budget(2 * picture(0).bytes());
        decoder.request(&frame(0), &frames(&[1, 2, 3]));
        controller.let_out_pictures(4);
        let mut reports = Vec::new();
        while reports.len() < 4 {
            reports.extend(controller.poll_until(|| decoder.poll()));
        }
        assert_eq!(decoder.picture(&frame(0)), Some(picture(0)));
        assert_eq!(decoder.picture(&frame(1)), None);
        assert_eq!(decoder.picture(&frame(3)), Some(picture(3)));
    }
}
