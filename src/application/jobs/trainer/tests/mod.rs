//! The trainer with a backend that the test controls: it reports each piece of work that it begins
//! and continues when the test lets it.

mod answers;
mod control;
mod fake_backend;
mod training;
mod videos;

use super::{Trainer, TrainerOptions, TrainerReport};
use crate::app::{TrainerActivity, TrainerOrder, TrainerStatus, TrainerWishes};
use fake_backend::{BackendCall, FakeBackend, ScriptedEnd};
use std::sync::Arc;
use std::sync::mpsc::{Receiver, Sender, channel};
use std::time::Duration;
use touchline_calibration::proposals::{Proposal, TrackedProposal};
use touchline_core::geometry::ImageSize;
use touchline_core::testing::base_at;
use touchline_documents::document::{Document, Frame, FrameId, FrameStatus};
use touchline_documents::testing::{match_from, new_frame, ptz_at};

const SIZE: ImageSize = ImageSize::new(64, 36);

/// The test's control over the backend.
struct Controller {
    trainer: Option<Trainer>,
    begun: Receiver<BackendCall>,
    go: Sender<ScriptedEnd>,
    woken: Receiver<()>,
    status: TrainerStatus,
    proposals: Vec<Proposal>,
    tracked: Vec<TrackedProposal>,
    features: Vec<FrameId>,
    wishes: TrainerWishes,
}

impl Controller {
    fn start(confidence: f64) -> Self {
        let (begin, begun) = channel();
        let (go, orders) = channel();
        let (wake, woken) = channel();
        let options = TrainerOptions {
            settle: Duration::ZERO,
            gather: Duration::ZERO,
            threads: Some(1),
        };
        let make = move |_| FakeBackend {
            begun: begin,
            orders,
            confidence,
        };
        let trainer = Trainer::start_with(
            options,
            Arc::new(move || wake.send(()).unwrap_or_default()),
            make,
        )
        .unwrap();
        let (status, proposals) = (TrainerStatus::default(), Vec::new());
        let (tracked, features) = (Vec::new(), Vec::new());
        Self {
            trainer: Some(trainer),
            begun,
            go,
            woken,
            status,
            proposals,
            tracked,
            features,
            wishes: TrainerWishes::default(),
        }
    }

    fn notify(&self, order: TrainerOrder) {
        self.trainer.as_ref().unwrap().notify(order);
    }

    fn wish(&mut self, change: impl FnOnce(&mut TrainerWishes)) {
        change(&mut self.wishes);
        self.notify(TrainerOrder::Wishes(self.wishes.clone()));
    }

    fn document(&self, document: &Document) {
        self.notify(TrainerOrder::Document(Box::new(document.clone())));
    }

    /// Waits for the next piece of work, checks it, and lets it end.
    fn expect(&self, begun: &BackendCall, answer: ScriptedEnd) {
        assert_eq!(self.begun.recv().unwrap(), *begun);
        self.go.send(answer).unwrap();
    }

    fn poll(&mut self) {
        for report in self.trainer.as_ref().unwrap().poll() {
            match report {
                TrainerReport::Status(status) => self.status = *status,
                TrainerReport::Proposals(proposals) => self.proposals.extend(proposals),
                TrainerReport::Tracked(tracked) => self.tracked.extend(tracked),
                TrainerReport::Features(used) => self.features.push(used.frame),
                TrainerReport::Broken { message } => panic!("{message}"),
            }
        }
    }

    /// Polls after each wake until the status is as wanted.
    fn until(&mut self, wanted: impl Fn(&TrainerStatus) -> bool) {
        self.poll();
        while !wanted(&self.status) {
            self.woken.recv().unwrap();
            self.poll();
        }
    }

    fn until_idle(&mut self) {
        self.until(|status| status.doing == TrainerActivity::Nothing && status.forest.is_some());
    }

    /// Checks that no other work has begun.
    fn nothing_begun(&self) {
        assert_eq!(self.begun.try_recv().ok(), None);
    }
}

/// A document of which the first few frames are references.
fn document(references: usize, others: usize) -> Document {
    let mut document = match_from(&base_at([0.0, -66.0, 18.0], SIZE), SIZE);
    for index in 0..references + others {
        let mut frame = new_frame(&format!("{index}.jpg"), SIZE);
        if index < references {
            accept(&mut frame, index as f64);
        }
        document.frames.push(frame.into());
    }
    document
}

fn accept(frame: &mut Frame, pan_deg: f64) {
    frame.status = FrameStatus::Reference;
    frame.ptz = ptz_at(pan_deg, -9.0, 900.0);
}
