//! One slow task on a thread of its own, such as opening a video of uneven frame times.

use super::{Wake, panic_message};
use std::io;
use std::panic::{AssertUnwindSafe, catch_unwind};
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::mpsc::{Receiver, SyncSender, TryRecvError, sync_channel};
use std::thread::JoinHandle;

/// What a task in the background has to say.
#[derive(Debug, PartialEq)]
pub enum BackgroundReport<P, T> {
    /// How far it has come.
    Progress(P),
    /// It ended with this result.
    Done(T),
    /// It panicked with this message.
    Panicked(String),
}

/// What a task uses to say how far it has come and to learn that nobody waits any more.
pub struct Reporter<P, T> {
    sender: SyncSender<BackgroundReport<P, T>>,
    stop: Arc<AtomicBool>,
    wake: Wake,
}

impl<P, T> Reporter<P, T> {
    /// Whether the task should end early.
    #[must_use]
    pub fn is_stopped(&self) -> bool {
        self.stop.load(Ordering::Relaxed)
    }

    /// Reports progress; dropped when the last reports have not been polled yet.
    pub fn progress(&self, progress: P) {
        if self.sender.try_send(BackgroundReport::Progress(progress)).is_ok() {
            (self.wake)();
        }
    }
}

/// A task on its own thread. Dropping it asks the task to stop and waits for it.
pub struct Background<P, T> {
    reports: Option<Receiver<BackgroundReport<P, T>>>,
    stop: Arc<AtomicBool>,
    thread: Option<JoinHandle<()>>,
}

impl<P: Send + 'static, T: Send + 'static> Background<P, T> {
    /// Starts a task on a thread of the given name.
    ///
    /// # Errors
    /// The operating system gives no thread.
    pub fn spawn(name: &str, wake: Wake, task: impl FnOnce(&Reporter<P, T>) -> T + Send + 'static) -> io::Result<Self> {
        let (sender, reports) = sync_channel(4);
        let stop = Arc::new(AtomicBool::new(false));
        let reporter = Reporter { sender, stop: Arc::clone(&stop), wake };
        let thread = std::thread::Builder::new().name(name.to_owned()).spawn(move || {
            let report = match catch_unwind(AssertUnwindSafe(|| task(&reporter))) {
                Ok(result) => BackgroundReport::Done(result),
                Err(payload) => BackgroundReport::Panicked(panic_message(payload.as_ref())),
            };
            // Nobody waits for it any more when this fails.
            let _ = reporter.sender.send(report);
            (reporter.wake)();
        })?;
        Ok(Self { reports: Some(reports), stop, thread: Some(thread) })
    }

    /// The next report, if one has arrived; [`BackgroundReport::Done`] or [`BackgroundReport::Panicked`] is the last.
    pub fn poll(&mut self) -> Option<BackgroundReport<P, T>> {
        let report = match self.reports.as_ref()?.try_recv() {
            Ok(report) => report,
            Err(TryRecvError::Empty | TryRecvError::Disconnected) => return None,
        };
        if !matches!(report, BackgroundReport::Progress(_)) {
            self.reports = None;
        }
        Some(report)
    }

    /// Whether the last report has been polled.
    #[must_use]
    pub const fn is_over(&self) -> bool {
        self.reports.is_none()
    }

    /// Asks the task to end early; its result still arrives.
    pub fn stop(&self) {
        self.stop.store(true, Ordering::Relaxed);
    }
}

impl<P, T> Drop for Background<P, T> {
    fn drop(&mut self) {
        self.stop.store(true, Ordering::Relaxed);
        self.reports = None;
        if let Some(thread) = self.thread.take() {
            // A panic has been turned into a report.
            let _ = thread.join();
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::sync::mpsc;

    /// A wake callback and what waits for it.
    fn wake() -> (Wake, Receiver<()>) {
        let (sender, woken) = mpsc::channel();
        (Arc::new(move || sender.send(()).unwrap_or_default()), woken)
    }

    #[test]
    fn progress_then_the_result_then_nothing() {
        let (wake, woken) = wake();
        let mut job = Background::spawn("test", wake, |reporter| {
            reporter.progress(1);
            42
        })
        .unwrap();
        woken.recv().unwrap();
        assert_eq!(job.poll(), Some(BackgroundReport::Progress(1)));
        woken.recv().unwrap();
        assert_eq!(job.poll(), Some(BackgroundReport::Done(42)));
        assert!(job.is_over());
        assert_eq!(job.poll(), None);
    }

    #[test]
    fn a_panic_is_a_report() {
        let (wake, woken) = wake();
        let mut job = Background::<(), ()>::spawn("test", wake, |_| panic!("out of {}", "grass")).unwrap();
        woken.recv().unwrap();
        assert_eq!(job.poll(), Some(BackgroundReport::Panicked("out of grass".to_owned())));
    }

    #[test]
    fn dropping_stops_the_task_and_waits_for_it() {
        let (sender, ended) = mpsc::channel();
        let job = Background::spawn("test", Arc::new(|| {}), move |reporter| {
            while !reporter.is_stopped() {
                reporter.progress(());
                std::thread::yield_now();
            }
            sender.send("ended").unwrap();
        })
        .unwrap();
        drop(job);
        assert_eq!(ended.try_recv(), Ok("ended"));
    }
}
