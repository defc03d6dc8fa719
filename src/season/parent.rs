//! The process that started this one.

/// Sees to it that this process ends when the one that started it does, at once and wherever it is.
///
/// An engine that is killed would otherwise leave its shards running: harmless, for parts are
/// renamed into place, but hours of work that its successor does again. The kill leaves no part and
/// at most a temporary file. On other systems than Linux nothing happens.
///
/// The signal is sent by the end of the *thread* that started this process, which for all engines
/// that were tried is the one that waits for it. A parent that ended before this call is not
/// noticed: in a container the parent is often process 1, as an orphan's is.
pub fn die_with_parent() {
    #[cfg(target_os = "linux")]
    {
        use rustix::process::{Signal, set_parent_process_death_signal};
        // A system that refuses it does without.
        let _ = set_parent_process_death_signal(Some(Signal::KILL));
    }
}
