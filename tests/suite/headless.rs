//! An application and what carries its effects out: what a window is without its pixels.

use std::path::Path;
use std::sync::Arc;
use std::sync::mpsc::{Receiver, channel};
use std::time::Duration;
use touchline::app::{Action, App, Question, Settings};
use touchline::jobs::Runner;

/// An application and what carries its effects out, as a window would have them.
pub struct Headless {
    pub app: App,
    pub runner: Runner,
    woken: Receiver<()>,
}

impl Headless {
    pub fn new() -> Self {
        let (wake, woken) = channel();
        // Nobody listens once the test has seen enough.
        let runner = Runner::new(Arc::new(move || {
            let _ = wake.send(());
        }));
        Self { app: App::new(Settings::default()), runner, woken }
    }

    pub fn act(&mut self, action: Action) {
        let effects = self.app.update(action);
        for effect in effects {
            self.runner.carry_out(effect);
        }
    }

    pub fn answer(&mut self, question: Question, path: &Path) {
        for effect in self.app.update(Action::Answer(question, path.to_path_buf())) {
            self.runner.carry_out(effect);
        }
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
