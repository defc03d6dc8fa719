//! An application and what carries its effects out: what a window is without its pixels.

use std::path::Path;
use std::sync::Arc;
use std::sync::mpsc::{Receiver, channel};
use std::time::Duration;
use touchline::app::{Action, App, Question, Settings};
use touchline::jobs::{Request, Runner};

/// An application and what carries its effects out, as a window would have them.
pub struct Headless {
    pub app: App,
    pub runner: Runner,
    /// What was left for a window to do.
    pub requests: Vec<Request>,
    woken: Receiver<()>,
}

impl Headless {
    pub fn new() -> Self {
        let (wake, woken) = channel();
        // Nobody listens once the test has seen enough.
        let runner = Runner::new(Arc::new(move || {
            let _ = wake.send(());
        }));
        Self { app: App::new(Settings::default()), runner, requests: Vec::new(), woken }
    }

    pub fn act(&mut self, action: Action) {
        for effect in self.app.update(action) {
            self.requests.extend(self.runner.carry_out(effect));
        }
    }

    pub fn answer(&mut self, question: Question, path: &Path) {
        self.act(Action::Answer(question, path.to_path_buf()));
    }

    /// Takes reports in until something holds.
    pub fn wait_until(&mut self, what: &str, holds: impl Fn(&App) -> bool) {
        while !holds(&self.app) {
            self.woken.recv_timeout(Duration::from_mins(1)).unwrap_or_else(|_| {
                panic!("{what} did not happen; notices: {:?}", self.app.session.notices);
            });
            for action in self.runner.poll() {
                self.act(action);
            }
        }
    }
}
