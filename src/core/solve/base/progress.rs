//! Progress and cancellation of an estimation.

use crate::progress::Progress;
use std::ops::ControlFlow;
use std::sync::atomic::{AtomicUsize, Ordering};

/// The progress of an estimation, in adjustments of the base: one for each model and each held-out
/// group.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct BaseProgress {
    /// Adjustments made.
    pub done: usize,
    /// Adjustments in all.
    pub total: usize,
}

/// Counts the adjustments of one estimation.
pub(super) struct Adjustments<'a> {
    progress: &'a Progress<'a, BaseProgress>,
    total: usize,
    done: AtomicUsize,
}

impl<'a> Adjustments<'a> {
    pub fn new(progress: &'a Progress<'_, BaseProgress>, total: usize) -> Self {
        Self {
            progress,
            total,
            done: AtomicUsize::new(0),
        }
    }

    /// Counts one more. A break cancels the estimation.
    pub fn count(&self) -> ControlFlow<()> {
        let done = self.done.fetch_add(1, Ordering::Relaxed) + 1;
        self.progress.report(BaseProgress {
            done,
            total: self.total,
        })
    }

    pub fn are_cancelled(&self) -> bool {
        self.progress.is_cancelled()
    }
}
