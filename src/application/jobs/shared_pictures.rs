//! Decoded frames that window, filmstrip and trainer share, so that each is decoded once.

use crate::app::operation::Decoders;
use std::sync::{Arc, Condvar, Mutex, MutexGuard, PoisonError};
use std::time::Duration;
use touchline_vision::media::{
    FrameCache, FrameReader, FrameRef, MediaError, Notice, Picture, ReadFrames,
};

/// Decoded frames within a memory budget. The window's frames have priority: frames that others
/// decode are kept only if there is room, and dropped first.
#[derive(Clone, Debug)]
pub struct SharedPictures(Arc<Shared>);

#[derive(Debug)]
struct Shared {
    frames: Mutex<FrameCache>,
    /// Whether the window waits for the picture of its current frame.
    awaited: Mutex<bool>,
    /// Signals that it no longer waits.
    served: Condvar,
}

/// Maximum time for which background work pauses for the window before each of its frames.
const MOST_WAITED: Duration = Duration::from_millis(500);

impl SharedPictures {
    /// A memory of up to `budget_bytes` of pixels.
    pub fn new(budget_bytes: usize) -> Self {
        Self(Arc::new(Shared {
            frames: Mutex::new(FrameCache::new(budget_bytes)),
            awaited: Mutex::new(false),
            served: Condvar::new(),
        }))
    }

    /// A memory of no pixels, for work without a window.
    pub fn none() -> Self {
        Self::new(0)
    }

    /// The picture of a frame, if it is in memory. Marks it as used.
    pub fn get(&self, frame: &FrameRef) -> Option<Picture> {
        self.lock().get(frame)
    }

    /// Whether a frame is in memory. Does not mark it as used.
    pub fn contains(&self, frame: &FrameRef) -> bool {
        self.lock().contains(frame)
    }

    /// The memory budget, bytes.
    pub fn budget_bytes(&self) -> usize {
        self.lock().budget_bytes()
    }

    /// Changes the memory budget, bytes.
    pub(super) fn set_budget(&self, budget_bytes: usize) {
        self.lock().set_budget(budget_bytes);
    }

    /// Keeps a frame of the window; others make room.
    pub(super) fn insert(&self, frame: FrameRef, picture: Picture) {
        self.lock().insert(frame, picture);
    }

    /// Keeps a frame that another reader has decoded, if there is room.
    pub(super) fn insert_if_room(&self, frame: &FrameRef, picture: &Picture) {
        self.lock().offer(frame, picture);
    }

    /// Drops all frames, as when another document is opened.
    pub(super) fn clear(&self) {
        let mut frames = self.lock();
        *frames = FrameCache::new(frames.budget_bytes());
    }

    /// Sets whether the window waits for the picture of its current frame.
    pub(super) fn set_awaited(&self, awaited: bool) {
        *self
            .0
            .awaited
            .lock()
            .unwrap_or_else(PoisonError::into_inner) = awaited;
        if !awaited {
            self.0.served.notify_all();
        }
    }

    /// Pauses background work while the window waits for its picture, because both would use the
    /// same processor. Returns after [`MOST_WAITED`] at the latest.
    pub(super) fn wait_for_window(&self) {
        let awaited = self
            .0
            .awaited
            .lock()
            .unwrap_or_else(PoisonError::into_inner);
        // Continue even if the wait timed out.
        let _ = self
            .0
            .served
            .wait_timeout_while(awaited, MOST_WAITED, |awaited| *awaited);
    }

    /// Locks the frames. No code that holds this lock can panic.
    fn lock(&self) -> MutexGuard<'_, FrameCache> {
        self.0.frames.lock().unwrap_or_else(PoisonError::into_inner)
    }
}

impl Decoders for SharedPictures {
    fn open_reader(&self) -> Box<dyn ReadFrames> {
        Box::new(SharedReader::new(
            Box::new(FrameReader::new()),
            self.clone(),
        ))
    }

    fn give_way_to_window(&self) {
        self.wait_for_window();
    }
}

/// Reads frames from the shared memory, or else with a reader of its own.
pub(super) struct SharedReader {
    own: Box<dyn ReadFrames>,
    pictures: SharedPictures,
}

impl SharedReader {
    /// A reader that uses `own` for frames that are not among `pictures`, and shares those with
    /// the others.
    pub(super) fn new(own: Box<dyn ReadFrames>, pictures: SharedPictures) -> Self {
        Self { own, pictures }
    }
}

impl ReadFrames for SharedReader {
    fn read(&mut self, frame: &FrameRef) -> Result<Picture, MediaError> {
        if let Some(picture) = self.pictures.get(frame) {
            return Ok(picture);
        }
        let picture = self.own.read(frame)?;
        self.pictures.insert_if_room(frame, &picture);
        Ok(picture)
    }

    fn read_in_passing(&mut self, frame: &FrameRef) -> Result<Picture, MediaError> {
        match self.pictures.get(frame) {
            Some(picture) => Ok(picture),
            None => self.own.read_in_passing(frame),
        }
    }

    fn take_notices(&mut self) -> Vec<Notice> {
        self.own.take_notices()
    }
}

#[cfg(test)]
mod tests {
    use super::super::fake_reader::{frame, picture};
    use super::*;

    /// A reader that counts what it reads.
    struct Counting(Arc<Mutex<Vec<FrameRef>>>);

    impl ReadFrames for Counting {
        fn read(&mut self, wanted: &FrameRef) -> Result<Picture, MediaError> {
            self.0.lock().unwrap().push(wanted.clone());
            Ok(picture(1))
        }
    }

    #[test]
    fn what_one_has_decoded_no_other_decodes_again() {
        let pictures = SharedPictures::new(1 << 20);
        let read = Arc::new(Mutex::new(Vec::new()));
        let reader = || SharedReader::new(Box::new(Counting(Arc::clone(&read))), pictures.clone());
        let (mut trainer, mut window) = (reader(), reader());
        pictures.insert(frame(0), picture(0));
        assert_eq!(
            trainer.read(&frame(0)).unwrap(),
            picture(0),
            "the window had it"
        );
        trainer.read(&frame(1)).unwrap();
        window.read(&frame(1)).unwrap();
        assert_eq!(*read.lock().unwrap(), [frame(1)], "once for both");
        trainer.read_in_passing(&frame(1)).unwrap();
        trainer.read_in_passing(&frame(2)).unwrap();
        assert_eq!(*read.lock().unwrap(), [frame(1), frame(2)]);
        assert!(!pictures.contains(&frame(2)), "read in passing");
        pictures.clear();
        window.read(&frame(1)).unwrap();
        assert_eq!(read.lock().unwrap().len(), 3);
    }

    #[test]
    fn the_windows_frames_go_first() {
        let pictures = SharedPictures::new(2 * picture(0).bytes());
        pictures.insert(frame(0), picture(0));
        pictures.insert_if_room(&frame(1), &picture(1));
        pictures.insert_if_room(&frame(2), &picture(2));
        assert!(
            pictures.contains(&frame(1)) && !pictures.contains(&frame(2)),
            "no frame is dropped to make room"
        );
        pictures.insert(frame(3), picture(3));
        assert!(
            pictures.contains(&frame(0)) && !pictures.contains(&frame(1)),
            "what was offered is forgotten first"
        );
    }
}
