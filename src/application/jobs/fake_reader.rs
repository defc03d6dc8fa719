//! A fake reader for tests: it reports the frames that it begins and continues when the test lets
//! it.

use super::Wake;
use super::frame_worker::MakeReader;
use std::path::Path;
use std::sync::mpsc::{Receiver, Sender, channel};
use std::sync::{Arc, Mutex};
use touchline_core::geometry::ImageSize;
use touchline_core::progress::Progress;
use touchline_vision::media::{CountProgress, FrameRef, MediaError, Picture, ReadFrames};

/// The test's control over the fake reader.
pub(super) struct Controller {
    /// The frames that the reader has begun, in order.
    pub(super) begun: Receiver<usize>,
    go: Sender<Reply>,
    /// One value for each call of the wake callback.
    pub(super) woken: Receiver<()>,
}

/// What the reader does with the frame that it has begun.
pub(super) enum Reply {
    Picture,
    Missing,
    Panic,
    /// Counts frames until it is stopped.
    Count,
}

impl Controller {
    /// Waits until the reader begins a frame and returns its index.
    pub(super) fn next_begun(&self) -> usize {
        self.begun.recv().unwrap()
    }

    /// Says what happens to the frame that has been begun, or to the next one.
    pub(super) fn let_out(&self, reply: Reply) {
        self.go.send(reply).unwrap();
    }

    /// Lets the next frames succeed.
    pub(super) fn let_out_pictures(&self, count: usize) {
        for _ in 0..count {
            self.let_out(Reply::Picture);
        }
    }

    /// Polls after each wake until there are reports.
    pub(super) fn poll_until<R>(&self, mut poll: impl FnMut() -> Vec<R>) -> Vec<R> {
        loop {
            let reports = poll();
            if !reports.is_empty() {
                return reports;
            }
            self.woken.recv().unwrap();
        }
    }
}

/// Frame `index` of a video that does not exist.
pub(super) fn frame(index: usize) -> FrameRef {
    FrameRef::video(Path::new("match.mp4"), index)
}

/// The picture that the reader gives for frame `index`.
pub(super) fn picture(index: usize) -> Picture {
    Picture::with_colour(ImageSize::new(16, 9), [index as u8, 0, 0, 255])
}

/// A fake reader, its wake callback and its controller.
pub(super) fn fake_reader() -> (MakeReader, Wake, Controller) {
    let (begin, begun) = channel();
    let (go, orders) = channel();
    let (wake, woken) = channel();
    let orders = Arc::new(Mutex::new(orders));
    let make: MakeReader = Box::new(move |counting| {
        Box::new(FakeReader {
            begin: begin.clone(),
            orders: Arc::clone(&orders),
            counting,
        })
    });
    (
        make,
        Arc::new(move || wake.send(()).unwrap_or_default()),
        Controller { begun, go, woken },
    )
}

struct FakeReader {
    begin: Sender<usize>,
    orders: Arc<Mutex<Receiver<Reply>>>,
    counting: Progress<'static, CountProgress>,
}

impl ReadFrames for FakeReader {
    fn read(&mut self, frame: &FrameRef) -> Result<Picture, MediaError> {
        let FrameRef::Video { path, index } = frame else {
            panic!("{frame} is no frame of a video")
        };
        self.begin.send(*index).unwrap_or_default();
        // Succeed if the controller was dropped.
        let answer = self.orders.lock().map_or(Reply::Picture, |orders| {
            orders.recv().unwrap_or(Reply::Picture)
        });
        match answer {
            Reply::Picture => Ok(picture(*index)),
            Reply::Missing => Err(MediaError::Missing {
                path: path.to_path_buf(),
            }),
            Reply::Panic => panic!("frame {index} is cursed"),
            Reply::Count => {
                let counting = self.counting.renew();
                let mut progress = CountProgress {
                    path: Arc::clone(path),
                    counted: 0,
                    stated: 9,
                };
                while counting.report(progress.clone()).is_continue() {
                    progress.counted += 1;
                    std::thread::yield_now();
                }
                Err(MediaError::Stopped {
                    path: path.to_path_buf(),
                })
            }
        }
    }
}
