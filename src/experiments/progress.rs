//! How far an experiment has come.

use std::sync::atomic::{AtomicUsize, Ordering};

/// Called from any thread: how many steps are done, of how many.
pub type Progress<'a> = &'a (dyn Fn(usize, usize) + Sync);

/// Progress for work that only says when it has done one more.
pub(super) fn counted(total: usize, progress: Progress<'_>) -> impl Fn() + Sync {
    let done = AtomicUsize::new(0);
    move || progress(done.fetch_add(1, Ordering::Relaxed) + 1, total)
}
