//! Ctrl-C during long work: finished parts are kept.

use signal_hook::consts::{SIGINT, SIGTERM};
use signal_hook::flag;
use std::ops::ControlFlow;
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};

/// Exit code of a program that was stopped by Ctrl-C.
pub const EXIT_CODE: u8 = 130;

/// Listens for Ctrl-C (SIGINT) and SIGTERM.
pub struct Interrupt(Arc<AtomicBool>);

impl Interrupt {
    /// Begins to listen. The first Ctrl-C sets a flag, the second ends the program at once. If the
    /// system does not allow listening, the first one ends the program, as it does by default.
    pub fn listen() -> Self {
        let pressed = Arc::new(AtomicBool::new(false));
        for signal in [SIGINT, SIGTERM] {
            // Handlers run in the order of registration: the shutdown comes first and sees the flag
            // only if an earlier signal has set it.
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

    /// Answers `Break` after the first signal.
    pub fn check(&self) -> ControlFlow<()> {
        if self.is_pressed() {
            ControlFlow::Break(())
        } else {
            ControlFlow::Continue(())
        }
    }

    /// Whether a signal has arrived.
    pub fn is_pressed(&self) -> bool {
        // The flag guards no other data, so that no order of memory accesses matters.
        self.0.load(Ordering::Relaxed)
    }
}

#[cfg(unix)]
#[cfg(test)]
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
