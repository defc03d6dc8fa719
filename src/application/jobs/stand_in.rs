//! A reader of frames for tests: it reports what it starts and continues when the test lets it.

use super::Wake;
use super::frame_worker::MakeReader;
use std::path::Path;
use std::sync::mpsc::{Receiver, Sender, channel};
use std::sync::{Arc, Mutex};
use touchline_core::geometry::ImageSize;
use touchline_core::progress::Progress;
use touchline_vision::media::{CountProgress, FrameRef, MediaError, Picture, ReadFrames};

/// The test's end of a stand-in.
pub(super) struct Controller {
    /// The frames whose reading has begun, in order.
    pub(super) begun: Receiver<usize>,
    go: Sender<Reply>,
    /// One for each call of the wake callback.
    pub(super) woken: Receiver<()>,
}

/// What the stand-in is to do with the frame it has begun.
pub(super) enum Reply {
    Picture,
    Missing,
    Panic,
    /// Count frames until told to stop.
    Count,
}

impl Controller {
    /// Waits until a frame is begun, and says which.
    pub(super) fn next_begun(&self) -> usize {
        self.begun.recv().unwrap()
    }

    /// Lets the frame that has been begun, or the next one, come out in a way.
    pub(super) fn let_out(&self, reply: Reply) {
        self.go.send(reply).unwrap();
    }

    /// Lets the next frames come out well.
    pub(super) fn let_out_pictures(&self, count: usize) {
        for _ in 0..count {
            self.let_out(Reply::Picture);
        }
    }

    /// Polls after each wake until something is there.
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

/// Frame `index` of a video that exists only here.
pub(super) fn frame(index: usize) -> FrameRef {
    FrameRef::video(Path::new("match.mp4"), index)
}

/// What the stand-in gives for frame `index`.
pub(super) fn picture(index: usize) -> Picture {
    Picture::filled(ImageSize::new(16, 9), [index as u8, 0, 0, 255])
}

/// A stand-in and its controller.
pub(super) fn stand_in() -> (MakeReader, Wake, Controller) {
    let (begin, begun) = channel();
    let (go, orders) = channel();
    let (wake, woken) = channel();
    let orders = Arc::new(Mutex::new(orders));
    let make: MakeReader = Box::new(move |counting| {
        Box::new(StandIn {
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

struct StandIn {
    begin: Sender<usize>,
    orders: Arc<Mutex<Receiver<Reply>>>,
    counting: Progress<'static, CountProgress>,
}

impl ReadFrames for StandIn {
    fn read(&mut self, frame: &FrameRef) -> Result<Picture, MediaError> {
        let FrameRef::Video { path, index } = frame else {
            panic!("{frame} is no frame of a video")
        };
        self.begin.send(*index).unwrap_or_default();
        // The controller was dropped: succeed.
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
                let progress = |counted| CountProgress {
                    path: Arc::clone(path),
                    counted,
                    stated: 9,
                };
                let (counting, mut counted) = (self.counting.renew(), 0);
                while counting.report(progress(counted)).is_continue() {
                    counted += 1;
                    std::thread::yield_now();
                }
                Err(MediaError::Stopped {
                    path: path.to_path_buf(),
                })
            }
        }
    }
}
