//! A base from scratch in the application: clicks, the guidance that counts them, the estimate, the
//! decision, undo.

mod clicked;
mod estimated;

use std::path::PathBuf;
use std::sync::Arc;
use std::sync::mpsc::{Receiver, channel};
use std::time::Duration;
use touchline::app::{Action, App, Command, Effect, Opened, Settings};
use touchline::camera::{CameraBase, PtzCamera};
use touchline::document::{Click, Document, FrameStatus, Target};
use touchline::geometry::{ImagePoint, ImageSize};
use touchline::jobs::{Runner, SharedPictures};
use touchline_core::testing::{TestBase, soccer, turned_base};
use touchline_documents::testing::{a_match, new_frame};

const SIZE: ImageSize = ImageSize::new(1280, 720);

fn truth(frame: usize) -> PtzCamera {
    let base = turned_base([2.0, -63.0, 19.0], [0.0, -0.4, 0.0], SIZE);
    let pan = [-28.0, 0.0, 27.0, -14.0, 14.0, 5.0][frame % 6];
    base.aim(pan, -12.0, 1300.0 + 60.0 * frame as f64)
}

/// The landmarks on the ground that a frame shows, well inside.
fn visible(frame: usize) -> Vec<(Target, ImagePoint)> {
    let field = soccer();
    let inside = |at: &ImagePoint| at.x > 20.0 && at.x < 1260.0 && at.y > 20.0 && at.y < 700.0;
    let on_ground = field
        .landmarks
        .iter()
        .filter(|landmark| landmark.nominal_m.z == 0.0);
    on_ground
        .filter_map(|landmark| {
            let at = truth(frame)
                .image_from_world(field.landmark_in_world(landmark))
                .ok()
                .filter(inside)?;
            Some((Target::Landmark(landmark.id.clone()), at))
        })
        .collect()
}

/// A project whose first `clicked` of `frames` frames have points, off by up to a px.
fn document(frames: usize, clicked: usize) -> Document {
    let mut document = a_match(SIZE);
    for index in 0..frames {
        let mut frame = new_frame(&format!("{index}.png"), SIZE);
        if index < clicked {
            frame.status = FrameStatus::Draft;
            frame.clicks = visible(index)
                .into_iter()
                .enumerate()
                .map(|(number, (target, at))| {
                    let (dx, dy) = (
                        f64::from((number * 7 % 5) as u8) - 2.0,
                        f64::from((number * 3 % 5) as u8) - 2.0,
                    );
                    Click::new(target, ImagePoint::new(at.x + 0.4 * dx, at.y + 0.4 * dy))
                })
                .collect();
        }
        document.frames.push(frame.into());
    }
    document
}

struct Fixture {
    app: App,
    runner: Runner,
    woken: Receiver<()>,
}

impl Fixture {
    fn on(document: Document) -> Self {
        Self::at(document, "/match/project.json".into())
    }

    fn at(document: Document, file: PathBuf) -> Self {
        let (wake, woken) = channel();
        // Nobody listens once the test has seen enough.
        let wake = Arc::new(move || {
            let _ = wake.send(());
        });
        let runner = Runner::new(wake, SharedPictures::none());
        let mut fixture = Self {
            app: App::new(Settings::default()),
            runner,
            woken,
        };
        fixture.act(Action::Opened(Box::new(Opened::new(document, file))));
        fixture
    }

    fn act(&mut self, action: Action) {
        for effect in self.app.update(action) {
            // There is no disk behind this project.
            if !matches!(effect, Effect::Journal { .. }) {
                self.runner.carry_out(effect);
            }
        }
    }

    fn command(&mut self, command: Command) {
        self.act(Action::Command(command));
    }

    fn estimate(&mut self) {
        self.run(Command::EstimateBase);
    }

    /// Asks for an estimate and waits for it.
    fn run(&mut self, command: Command) {
        self.command(command);
        while self.app.operations.base_estimate.running().is_some() {
            self.woken.recv_timeout(Duration::from_mins(1)).unwrap();
            for action in self.runner.poll() {
                self.act(action);
            }
        }
    }

    fn document(&self) -> &Document {
        &self.app.open().unwrap().document
    }

    fn base(&self) -> Option<CameraBase> {
        self.document().cameras[0].base()
    }
}
