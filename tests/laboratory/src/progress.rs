//! Progress of experiments.

use std::sync::atomic::{AtomicUsize, Ordering};

/// A callback with the number of finished steps and their total. Any thread may call it.
pub type Progress<'a> = &'a (dyn Fn(usize, usize) + Sync);

/// Counts steps: each call of the result reports one more of `total`.
pub(super) fn step_counter(total: usize, progress: Progress<'_>) -> impl Fn() + Sync {
    let done = AtomicUsize::new(0);
    move || progress(done.fetch_add(1, Ordering::Relaxed) + 1, total)
}
