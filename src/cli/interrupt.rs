//! Ctrl-C during long work: what is done is kept.

use signal_hook::consts::{SIGINT, SIGTERM};
use signal_hook::flag;
use std::ops::ControlFlow;
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};

/// The exit code of a program that was stopped by Ctrl-C.
pub const EXIT_CODE: u8 = 130;

/// Listens for Ctrl-C, and for being asked to end.
pub struct Interrupt(Arc<AtomicBool>);

impl Interrupt {
    /// Begins to listen. Pressed twice, Ctrl-C ends the program at once; where the system lets
    /// nobody listen, it does so the first time, as it always does.
    pub fn listen() -> Self {
        let pressed = Arc::new(AtomicBool::new(false));
        for signal in [SIGINT, SIGTERM] {
            // The second time ends it: whoever is asked first sees the flag that the first time has
            // set.
            let ends = flag::register_conditional_shutdown(
                signal,
                i32::from(EXIT_CODE),
                Arc::clone(&pressed),
            );
            if ends.is_ok() {
                let _ = flag::register(signal, Arc::clone(&pressed));
            }
        }
        Self(pressed)
    }

    /// Whether to go on: a break once it was pressed.
    pub fn check(&self) -> ControlFlow<()> {
        if self.is_pressed() {
            ControlFlow::Break(())
        } else {
            ControlFlow::Continue(())
        }
    }

    /// Whether it was pressed.
    pub fn is_pressed(&self) -> bool {
        self.0.load(Ordering::Relaxed)
    }
}

#[cfg(test)]
#[cfg(unix)]
mod tests {
    use super::*;

    #[test]
    fn the_first_time_is_noticed_and_does_not_end_the_program() {
        let interrupt = Interrupt::listen();
        assert!(!interrupt.is_pressed());
        let process = std::process::id().to_string();
        assert!(
            std::process::Command::new("kill")
                .args(["-INT", &process])
                .status()
                .unwrap()
                .success()
        );
        while !interrupt.is_pressed() {
            std::thread::yield_now();
        }
    }
}
