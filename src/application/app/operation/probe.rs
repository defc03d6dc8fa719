//! An operation for tests: a channel dictates what it does.

use super::{Context, Failure, Operation, Slot};
use crate::app::{App, Effect};
use std::sync::Mutex;
use std::sync::mpsc::{Receiver, Sender, channel};

/// The next thing that the work does.
pub enum Step {
    Report(u32),
    Return(u32),
    Panic,
    WaitUntilCancelled,
}

pub struct Probe(Mutex<Receiver<Step>>);

/// The probe's state in the application, for tests to inspect.
#[derive(Debug, Default)]
pub struct ProbeState {
    pub slot: Slot<Probe>,
    pub must_wait: bool,
    pub taken: Vec<Result<u32, Failure<&'static str>>>,
}

impl Probe {
    /// A probe, and the channel that dictates its steps.
    pub fn new() -> (Self, Sender<Step>) {
        let (sender, steps) = channel();
        (Self(Mutex::new(steps)), sender)
    }

    /// A probe that does these steps.
    pub fn from_steps(steps: impl IntoIterator<Item = Step>) -> Self {
        let (probe, sender) = Self::new();
        steps
            .into_iter()
            .for_each(|step| sender.send(step).unwrap());
        probe
    }
}

impl App {
    /// Starts a probe, as a command would, and returns the effect.
    pub(crate) fn start_probe(&mut self, probe: Probe) -> Effect {
        self.start(probe);
        self.effects.pop().unwrap()
    }
}

impl Operation for Probe {
    type Progress = u32;
    type Output = u32;
    type Error = &'static str;

    const NAME: &'static str = "probe";

    fn run(&self, context: &Context<'_, u32>) -> Result<u32, &'static str> {
        for step in self.0.lock().unwrap().iter() {
            match step {
                Step::Report(progress) if context.report(progress).is_break() => break,
                Step::Report(_) => {}
                Step::Return(output) => return Ok(output),
                Step::Panic => panic!("the probe broke"),
                Step::WaitUntilCancelled => {
                    while context.check().is_continue() {
                        std::thread::yield_now();
                    }
                    break;
                }
            }
        }
        Err("stopped")
    }

    fn slot(app: &mut App) -> &mut Slot<Self> {
        &mut app.operations.probe.slot
    }

    fn must_wait(app: &App) -> bool {
        app.operations.probe.must_wait
    }

    fn take_over(&self, app: &mut App, result: Result<u32, Failure<&'static str>>) {
        app.operations.probe.taken.push(result);
    }
}
