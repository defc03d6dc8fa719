//! How far an estimation has come, and whether anybody still waits for it.

use std::ops::ControlFlow;
use std::sync::atomic::{AtomicBool, AtomicUsize, Ordering};

/// How far an estimation has come, in adjustments of the base: each model on each group of clicks held out is one.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct BaseProgress {
    /// Adjustments made.
    pub done: usize,
    /// Adjustments in all.
    pub total: usize,
}

/// Is told after each adjustment, from any thread; a break ends the estimation.
pub type WatchBase<'a> = &'a (dyn Fn(BaseProgress) -> ControlFlow<()> + Sync);

/// Counts the adjustments of one estimation.
pub(super) struct Adjustments<'a> {
    watch: WatchBase<'a>,
    total: usize,
    done: AtomicUsize,
    stopped: AtomicBool,
}

impl<'a> Adjustments<'a> {
    pub fn new(watch: WatchBase<'a>, total: usize) -> Self {
        Self { watch, total, done: AtomicUsize::new(0), stopped: AtomicBool::new(false) }
    }

    /// One more is made.
    pub fn made(&self) {
        let done = self.done.fetch_add(1, Ordering::Relaxed) + 1;
        if (self.watch)(BaseProgress { done, total: self.total }).is_break() {
            self.stopped.store(true, Ordering::Relaxed);
        }
    }

    /// Nobody waits any more.
    pub fn are_stopped(&self) -> bool {
        self.stopped.load(Ordering::Relaxed)
    }
}
