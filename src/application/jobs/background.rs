//! One slow task on a thread of its own, such as opening a video with irregular frame times, and what
//! is left of a task that panicked.

use super::Wake;
use super::worker::{Mailbox, Worker};
use std::cell::Cell;
use std::io;
use std::panic::{self, AssertUnwindSafe, catch_unwind};
use std::sync::{Arc, Mutex, PoisonError};
use thiserror::Error;
use touchline_core::progress::panic_message;

/// Maximum number of waiting reports.
const MOST_REPORTS: usize = 4;

/// A report of a background task.
#[derive(Debug, PartialEq)]
pub enum BackgroundReport<P, T> {
    Progress(P),
    /// The task's result.
    Done(T),
    /// The message of the panic that ended the task.
    Panicked(String),
}

/// The task's link to its owner: reports progress and says whether the result is still needed.
pub struct Reporter<P, T> {
    mailbox: Arc<Mailbox<(), BackgroundReport<P, T>>>,
}

impl<P, T> Reporter<P, T> {
    /// Whether the task should end early.
    pub fn is_stopped(&self) -> bool {
        self.mailbox.is_closing()
    }

    /// Reports progress; dropped if too many reports wait already.
    pub fn progress(&self, progress: P) {
        self.mailbox
            .report_if_room(BackgroundReport::Progress(progress));
    }
}

/// A task on its own thread. Dropping it stops the task and waits for it.
pub struct Background<P, T> {
    worker: Worker<(), BackgroundReport<P, T>>,
    is_over: bool,
}

impl<P: Send + 'static, T: Send + 'static> Background<P, T> {
    /// Starts a task on a thread of the given name.
    ///
    /// # Errors
    /// The operating system gives no thread.
    pub fn spawn(
        name: &str,
        wake: Wake,
        task: impl FnOnce(&Reporter<P, T>) -> T + Send + 'static,
    ) -> io::Result<Self> {
        let mailbox = Mailbox::new((), MOST_REPORTS, wake);
        let worker = Worker::spawn(name, mailbox, BackgroundReport::Panicked, move |mailbox| {
            let result = task(&Reporter {
                mailbox: Arc::clone(mailbox),
            });
            mailbox.report(BackgroundReport::Done(result));
        })?;
        Ok(Self {
            worker,
            is_over: false,
        })
    }

    /// The next report, if one has arrived; [`BackgroundReport::Done`] or
    /// [`BackgroundReport::Panicked`] is the last.
    pub fn poll(&mut self) -> Option<BackgroundReport<P, T>> {
        let report = self.worker.mailbox().take_report()?;
        self.is_over = !matches!(report, BackgroundReport::Progress(_));
        Some(report)
    }

    /// Whether the last report has been polled.
    pub const fn is_over(&self) -> bool {
        self.is_over
    }

    /// Stops the task; its result still arrives.
    pub fn stop(&self) {
        self.worker.mailbox().begin_closing();
    }
}

/// A panic of this program or of a library.
#[derive(Clone, Debug, PartialEq, Eq, Error)]
#[error("{message} ({place})")]
pub struct Panicked {
    /// The panic's message, in one line.
    pub message: String,
    /// The file and line of the panic.
    pub place: String,
}

/// Runs `work` on this thread and returns a panic as an error.
///
/// A panic of this thread prints nothing, here and later: the hook stays installed. Panics of other
/// threads are printed as before.
///
/// # Errors
/// `work` panicked.
pub fn until_it_panics<T>(work: impl FnOnce() -> T) -> Result<T, Panicked> {
    thread_local! {
        static IS_HERE: Cell<bool> = const { Cell::new(false) };
    }
    IS_HERE.set(true);
    let place = Arc::new(Mutex::new(String::new()));
    let (noted, before) = (Arc::clone(&place), panic::take_hook());
    panic::set_hook(Box::new(move |panicked| {
        if !IS_HERE.get() {
            before(panicked);
        } else if let Some(location) = panicked.location() {
            *noted.lock().unwrap_or_else(PoisonError::into_inner) =
                format!("{}:{}", location.file(), location.line());
        }
    }));
    catch_unwind(AssertUnwindSafe(work)).map_err(|payload| Panicked {
        message: panic_message(payload.as_ref()).replace('\n', " "),
        place: place.lock().unwrap_or_else(PoisonError::into_inner).clone(),
    })
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::sync::mpsc::{self, Receiver};

    /// A wake callback, and a receiver that gets a value for each call.
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
        let mut job =
            Background::<(), ()>::spawn("test", wake, |_| panic!("out of {}", "grass")).unwrap();
        woken.recv().unwrap();
        assert_eq!(
            job.poll(),
            Some(BackgroundReport::Panicked("out of grass".to_owned()))
        );
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

    #[test]
    fn a_panic_is_an_error_with_its_place() {
        assert_eq!(until_it_panics(|| 5), Ok(5));
        let panicked = until_it_panics(|| -> u8 { panic!("the display\nwent away") }).unwrap_err();
        assert_eq!(panicked.message, "the display went away");
        assert!(
            panicked.place.contains("background.rs:"),
            "{}",
            panicked.place
        );
        assert!(
            panicked.to_string().starts_with("the display went away ("),
            "{panicked}"
        );
        let silent = until_it_panics(|| std::panic::panic_any(7_u8)).unwrap_err();
        assert_eq!(silent.message, "without a message");
    }
}
