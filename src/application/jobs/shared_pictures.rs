//! The decoded frames that the window, the filmstrip and the trainer share, so that none of them
//! decodes what another has.

use crate::app::operation::Decoders;
use std::sync::{Arc, Condvar, Mutex, MutexGuard, PoisonError};
use std::time::Duration;
use touchline_vision::media::{
    FrameCache, FrameReader, FrameRef, MediaError, Notice, Picture, ReadFrames,
};

/// Decoded frames within a budget, for everybody who asks. The window's frames go first: what
/// others decode is kept only where there is room, and forgotten first.
#[derive(Clone, Debug)]
pub struct SharedPictures(Arc<Shared>);

#[derive(Debug)]
struct Shared {
    frames: Mutex<FrameCache>,
    /// The window waits for the picture that it shows.
    awaited: Mutex<bool>,
    /// It no longer does.
    served: Condvar,
}

/// How long work in the background waits for the window at most, before each of its frames.
const MOST_WAITED: Duration = Duration::from_millis(500);

impl SharedPictures {
    /// Keeps up to `budget_bytes` of pixels.
    #[must_use]
    pub fn new(budget_bytes: usize) -> Self {
        Self(Arc::new(Shared {
            frames: Mutex::new(FrameCache::new(budget_bytes)),
            awaited: Mutex::new(false),
            served: Condvar::new(),
        }))
    }

    /// Keeps nothing: for work without a window.
    #[must_use]
    pub fn none() -> Self {
        Self::new(0)
    }

    /// A frame, if it is kept; this counts as a use.
    #[must_use]
    pub fn get(&self, frame: &FrameRef) -> Option<Picture> {
        self.lock().get(frame)
    }

    /// Whether a frame is kept; this is no use.
    #[must_use]
    pub fn contains(&self, frame: &FrameRef) -> bool {
        self.lock().contains(frame)
    }

    /// The memory that the pixels may take, bytes.
    #[must_use]
    pub fn budget_bytes(&self) -> usize {
        self.lock().budget_bytes()
    }

    /// Changes the memory that the pixels may take, bytes.
    pub(super) fn set_budget(&self, budget_bytes: usize) {
        self.lock().set_budget(budget_bytes);
    }

    /// Keeps a frame that the window shows or is about to show; others make room.
    pub(super) fn insert(&self, frame: FrameRef, picture: Picture) {
        self.lock().insert(frame, picture);
    }

    /// Keeps a frame that somebody else decoded if there is room.
    pub(super) fn offer(&self, frame: &FrameRef, picture: &Picture) {
        self.lock().offer(frame, picture);
    }

    /// Forgets everything, as when another document is opened.
    pub(super) fn clear(&self) {
        let mut frames = self.lock();
        *frames = FrameCache::new(frames.budget_bytes());
    }

    /// Whether the window waits for the picture that it shows.
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

    /// Pauses work that nobody waits for while the window waits for its picture: both would take
    /// the same processor.
    pub(super) fn wait_for_window(&self) {
        let awaited = self
            .0
            .awaited
            .lock()
            .unwrap_or_else(PoisonError::into_inner);
        // Whether it was in vain or not: this goes on.
        let _ = self
            .0
            .served
            .wait_timeout_while(awaited, MOST_WAITED, |awaited| *awaited);
    }

    /// Nobody can panic with the lock held.
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

/// Reads frames, those that somebody has decoded already without decoding them.
pub(super) struct SharedReader {
    own: Box<dyn ReadFrames>,
    pictures: SharedPictures,
}

impl SharedReader {
    /// Reads with `own` what is not among `pictures`, and offers it to the others.
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
        self.pictures.offer(frame, &picture);
        Ok(picture)
    }

    fn take_notices(&mut self) -> Vec<Notice> {
        self.own.take_notices()
    }
}

#[cfg(test)]
mod tests {
    use super::super::stand_in::{frame, picture};
    use super::*;

    /// Counts what it reads.
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
        pictures.clear();
        window.read(&frame(1)).unwrap();
        assert_eq!(read.lock().unwrap().len(), 2);
    }

    #[test]
    fn the_windows_frames_go_first() {
        let pictures = SharedPictures::new(2 * picture(0).bytes());
        pictures.insert(frame(0), picture(0));
        pictures.offer(&frame(1), &picture(1));
        pictures.offer(&frame(2), &picture(2));
        assert!(
            pictures.contains(&frame(1)) && !pictures.contains(&frame(2)),
            "nothing makes room for an offer"
        );
        pictures.insert(frame(3), picture(3));
        assert!(
            pictures.contains(&frame(0)) && !pictures.contains(&frame(1)),
            "what was offered is forgotten first"
        );
    }
}
