//! An application and what carries its effects out: what a window is without its pixels.

use std::path::{Path, PathBuf};
use std::sync::Arc;
use std::sync::mpsc::{Receiver, channel};
use std::time::Duration;
use tempfile::TempDir;
use touchline_application::app::session::Saving;
use touchline_application::app::{Action, App, Question, Settings};
use touchline_application::jobs::{PictureState, Pictures, Request, Runner, Wake};
use touchline_documents::document::Document;
use touchline_documents::store::{Location, Store};

/// A project with this document in the folder `match` of a temporary one.
pub fn project_of(document: &Document) -> (TempDir, PathBuf) {
    let root = tempfile::tempdir().unwrap();
    let path = root.path().join("match");
    let location = Location::for_new_document(&path.join("")).unwrap();
    drop(Store::create(&location, document).unwrap());
    (root, path)
}

/// An application and what carries its effects out, as a window would have them.
pub struct Headless {
    pub app: App,
    pub runner: Runner,
    pub pictures: Pictures,
    /// What was left for a window to do.
    pub requests: Vec<Request>,
    woken: Receiver<()>,
}

impl Headless {
    pub fn new() -> Self {
        let (wake, woken) = channel();
        // Nobody listens once the test has seen enough.
        let wake: Wake = Arc::new(move || {
            let _ = wake.send(());
        });
        let pictures = Pictures::start(wake.clone()).unwrap();
        let runner = Runner::new(wake, pictures.shared_pictures());
        Self {
            app: App::new(Settings::default()),
            runner,
            pictures,
            requests: Vec::new(),
            woken,
        }
    }

    /// With a project, folder or video open.
    pub fn open(path: &Path) -> Self {
        let mut headless = Self::new();
        headless.act(Action::Open(path.to_path_buf()));
        headless.wait_until("opening", |app| app.open().is_some());
        headless
    }

    pub fn act(&mut self, action: Action) {
        for effect in self.app.update(action) {
            self.requests.extend(self.runner.carry_out(effect));
        }
    }

    pub fn answer(&mut self, question: Question, path: &Path) {
        self.act(Action::Answer(question, path.to_path_buf()));
    }

    /// Takes pictures in until the shown frame's is there, or cannot be had.
    pub fn wait_for_picture(&mut self) -> PictureState {
        loop {
            for action in self.pictures.update(&self.app).actions {
                self.act(action);
            }
            match self.pictures.current() {
                PictureState::Loading => self.woken.recv_timeout(Duration::from_mins(1)).unwrap(),
                state => return state,
            }
        }
    }

    /// Takes reports in until everything is on disk.
    pub fn wait_until_saved(&mut self) {
        self.wait_until("saving", |app| {
            matches!(app.session.disk.saving, Saving::Saved { .. })
        });
    }

    /// Takes reports in until a message has this.
    pub fn wait_for_notice(&mut self, what: &str, part: &str) {
        self.wait_until(what, |app| {
            let notices = &app.session.messages.notices;
            notices.iter().any(|notice| notice.text.contains(part))
        });
    }

    /// Takes reports in until something holds.
    pub fn wait_until(&mut self, what: &str, holds: impl Fn(&App) -> bool) {
        while !holds(&self.app) {
            self.woken
                .recv_timeout(Duration::from_mins(1))
                .unwrap_or_else(|_| {
                    panic!(
                        "{what} did not happen; notices: {:?}; trainer: {:?}",
                        self.app.session.messages.notices, self.app.session.trainer.status
                    );
                });
            for action in self.runner.poll() {
                self.act(action);
            }
        }
    }
}
