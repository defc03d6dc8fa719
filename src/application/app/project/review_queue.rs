//! The review queue of a season: frames of many projects, in the order in which they are looked at.
//!
//! While a queue is open, *Next frame to do* and accepting go to its next frame, which may be in
//! another project: that one is then opened. Opening anything else, and going past the end, ends
//! the queue.

use crate::app::App;
use crate::app::window_state::session::Level;
use std::path::PathBuf;

/// What is said past the last frame and before the first.
const END: &str = "That was the last frame of the queue.";
const BEGINNING: &str = "This is the first frame of the queue.";

/// A frame of a review queue.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct QueuedFrame {
    /// The file of its project.
    pub project: PathBuf,
    /// Its id in the project.
    pub frame: String,
}

/// A review queue, and how far it was looked through.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct ReviewQueue {
    frames: Vec<QueuedFrame>,
    index: usize,
}

impl ReviewQueue {
    /// A queue at its first frame.
    pub const fn new(frames: Vec<QueuedFrame>) -> Self {
        Self { frames, index: 0 }
    }

    /// The frame that is being looked at; none if the queue is empty.
    pub fn current(&self) -> Option<&QueuedFrame> {
        self.frames.get(self.index)
    }

    /// The number of that frame, counted from 1, and of all frames.
    const fn position(&self) -> (usize, usize) {
        (self.index + 1, self.frames.len())
    }

    /// Goes to the next frame, or to the previous one. False if there is none.
    fn step(&mut self, forward: bool) -> bool {
        let next = if forward {
            self.index.checked_add(1)
        } else {
            self.index.checked_sub(1)
        };
        let next = next.filter(|next| *next < self.frames.len());
        self.index = next.unwrap_or(self.index);
        next.is_some()
    }
}

impl App {
    /// Takes a queue that was opened with a document, or goes on with the one that opened it.
    pub(in crate::app) fn continue_queue(&mut self, queue: Option<ReviewQueue>) {
        if queue.is_some() {
            self.queue = queue;
        }
        if !self.show_queued_frame() {
            self.queue = None;
        }
    }

    /// The number of the frame in the review queue, counted from 1, and of all its frames; none
    /// without a queue.
    pub fn queue_position(&self) -> Option<(usize, usize)> {
        self.queue.as_ref().map(ReviewQueue::position)
    }

    /// Goes on to the next frame of the queue. False if there is no queue.
    pub(in crate::app) fn go_on_in_queue(&mut self, forward: bool) -> bool {
        let Some(queue) = &mut self.queue else {
            return false;
        };
        let has_next = queue.step(forward);
        let next = queue.current().map(|next| next.project.clone());
        if !has_next {
            let text = if forward { END } else { BEGINNING };
            self.session.notify(Level::Info, text.to_owned());
            if forward {
                self.queue = None;
            }
            return true;
        }
        // In another project the queue waits; `continue_queue` shows the frame once that is open.
        if let Some(project) = next
            && !self.show_queued_frame()
        {
            self.open_path(project);
        }
        true
    }

    /// Shows the present frame of the queue. False if it is in another project.
    fn show_queued_frame(&mut self) -> bool {
        let queued = self.queue.as_ref().and_then(ReviewQueue::current);
        let Some((open, queued)) = self.open.as_ref().zip(queued) else {
            return false;
        };
        if open.file != queued.project {
            return false;
        }
        let frames = &open.document.frames;
        // A frame that was taken out since is passed over with the next step.
        if let Some(index) = frames
            .iter()
            .position(|frame| frame.id.as_str() == queued.frame)
        {
            self.go_to(index);
        }
        true
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::app::window_state::session::SidePanel;
    use crate::app::{Action, Command, Opened, Settings};
    use touchline_core::geometry::ImageSize;
    use touchline_documents::document::{Camera, FrameStatus};
    use touchline_documents::testing::{new_frame, ptz_at, soccer_document};

    #[test]
    fn accepting_goes_on_in_the_queue_also_while_the_review_panel_is_open() {
        let size = ImageSize::new(64, 36);
        let mut document = soccer_document();
        let camera = Camera::new("main".into(), size);
        document.cameras.push(camera.into());
        for name in ["a.jpg", "b.jpg", "c.jpg"] {
            let mut frame = new_frame(name, size);
            frame.ptz = ptz_at(0.0, -9.0, 90.0);
            frame.status = FrameStatus::Suggested;
            document.frames.push(frame.into());
        }
        let queued = [0, 2].map(|index: usize| QueuedFrame {
            project: "/match/project.json".into(),
            frame: document.frames[index].id.as_str().to_owned(),
        });
        let mut opened = Opened::new(document, "/match/project.json");
        opened.queue = Some(ReviewQueue::new(queued.to_vec()));
        let mut app = App::new(Settings::default());
        app.update(Action::Opened(Box::new(opened)));
        app.session.panel = SidePanel::Review;
        app.update(Action::Command(Command::Accept));
        assert_eq!(app.session.frame, 2);
    }
}
