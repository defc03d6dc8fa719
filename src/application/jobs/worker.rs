//! The mechanism of every job: a thread that carries out orders and leaves reports.
//!
//! The owner and the thread share a mailbox. One lock guards orders and reports, so that an order
//! is always either waiting, being executed, or reported. The owner never blocks, except while
//! the thread ends. The thread blocks while there is no order, and while reports that the owner has
//! not taken fill the mailbox.

use super::{Wake, panic_message};
use std::collections::VecDeque;
use std::io;
use std::panic::{AssertUnwindSafe, catch_unwind};
use std::sync::{Arc, Condvar, Mutex, MutexGuard, PoisonError};
use std::thread::JoinHandle;
use std::time::{Duration, Instant};

/// Maximum time that the owner waits for a thread to end when its work is no longer needed. A read
/// from a network drive that does not answer cannot be cancelled; its thread is then detached.
const PATIENCE: Duration = Duration::from_secs(5);

/// Orders `O` to a thread, and its reports `R`.
pub(super) struct Mailbox<O, R> {
    state: Mutex<State<O, R>>,
    changed: Condvar,
    /// Maximum number of waiting reports; beyond it the thread blocks.
    capacity: usize,
    wake: Wake,
}

/// The state that the lock guards.
pub(super) struct State<O, R> {
    /// What is to be done, and what both sides must know about the work in progress.
    pub(super) orders: O,
    /// Reports that the owner has not taken yet, oldest first.
    pub(super) reports: VecDeque<R>,
    is_closing: bool,
    has_ended: bool,
}

/// Why [`Mailbox::wait_for`] returned.
#[derive(Debug, PartialEq, Eq)]
pub(super) enum WaitOutcome<T> {
    /// This is to be done.
    Order(T),
    TimeIsUp,
    /// There is no order left, and none will follow.
    Closing,
}

impl<O, R> Mailbox<O, R> {
    /// A mailbox for up to `capacity` waiting reports. `wake` is called after each report.
    pub(super) fn new(orders: O, capacity: usize, wake: Wake) -> Self {
        let state = State {
            orders,
            reports: VecDeque::new(),
            is_closing: false,
            has_ended: false,
        };
        Self {
            state: Mutex::new(state),
            changed: Condvar::new(),
            capacity,
            wake,
        }
    }

    /// Reads or changes orders and reports under the lock, then wakes everyone who waits for a
    /// change.
    pub(super) fn update<T>(&self, change: impl FnOnce(&mut State<O, R>) -> T) -> T {
        let result = change(&mut self.lock());
        self.changed.notify_all();
        result
    }

    /// Looks at the orders.
    pub(super) fn look<T>(&self, look: impl FnOnce(&O) -> T) -> T {
        look(&self.lock().orders)
    }

    /// Whether the thread is to end.
    pub(super) fn is_closing(&self) -> bool {
        self.lock().is_closing
    }

    /// Orders the thread to end.
    pub(super) fn begin_closing(&self) {
        self.update(|state| state.is_closing = true);
    }

    /// Takes all waiting reports.
    pub(super) fn take_reports(&self) -> Vec<R> {
        self.update(|state| state.reports.drain(..).collect())
    }

    /// Takes the oldest waiting report.
    pub(super) fn take_report(&self) -> Option<R> {
        self.update(|state| state.reports.pop_front())
    }

    /// Waits until `pick` finds something among the orders, until a time, or until the mailbox
    /// closes. Orders that are left when it closes are still returned.
    pub(super) fn wait_for<T>(
        &self,
        until: Option<Instant>,
        pick: impl Fn(&mut O) -> Option<T>,
    ) -> WaitOutcome<T> {
        let mut state = self.lock();
        loop {
            if let Some(order) = pick(&mut state.orders) {
                return WaitOutcome::Order(order);
            }
            if state.is_closing {
                return WaitOutcome::Closing;
            }
            state = match until.map(|until| until.saturating_duration_since(Instant::now())) {
                None => self
                    .changed
                    .wait(state)
                    .unwrap_or_else(PoisonError::into_inner),
                Some(left) if left.is_zero() => return WaitOutcome::TimeIsUp,
                Some(left) => {
                    self.changed
                        .wait_timeout(state, left)
                        .unwrap_or_else(PoisonError::into_inner)
                        .0
                }
            };
        }
    }

    /// Leaves a report; blocks until there is room.
    pub(super) fn report(&self, report: R) {
        self.report_done(report, |_| ());
    }

    /// Leaves the report of an order and removes the order under the same lock; blocks until there
    /// is room.
    pub(super) fn report_done(&self, report: R, strike_off: impl FnOnce(&mut O)) {
        let mut state = self
            .changed
            .wait_while(self.lock(), |state| state.reports.len() >= self.capacity)
            .unwrap_or_else(PoisonError::into_inner);
        state.reports.push_back(report);
        strike_off(&mut state.orders);
        drop(state);
        self.changed.notify_all();
        (self.wake)();
    }

    /// Leaves a report and drops those that it makes obsolete; never blocks.
    pub(super) fn report_instead(&self, report: R, is_stale: impl Fn(&R) -> bool) {
        self.update(|state| {
            state.reports.retain(|before| !is_stale(before));
            state.reports.push_back(report);
        });
        (self.wake)();
    }

    /// Leaves a report if there is room; drops it otherwise.
    pub(super) fn report_if_room(&self, report: R) {
        let has_room = self.update(|state| {
            let has_room = state.reports.len() < self.capacity;
            if has_room {
                state.reports.push_back(report);
            }
            has_room
        });
        if has_room {
            (self.wake)();
        }
    }

    /// Locks the state. No code that holds the lock can panic half-way, so the state is consistent
    /// even if the lock is poisoned.
    fn lock(&self) -> MutexGuard<'_, State<O, R>> {
        self.state.lock().unwrap_or_else(PoisonError::into_inner)
    }
}

/// A thread and its mailbox. Dropping it ends the thread and waits for at most [`PATIENCE`].
pub(super) struct Worker<O, R> {
    mailbox: Arc<Mailbox<O, R>>,
    thread: Option<JoinHandle<()>>,
}

impl<O: Send + 'static, R: Send + 'static> Worker<O, R> {
    /// Starts a thread that runs `work`. If `work` panics, `broke_down` makes the last report from
    /// the message.
    ///
    /// # Errors
    /// The operating system gives no thread.
    pub(super) fn spawn(
        name: &str,
        mailbox: Mailbox<O, R>,
        broke_down: fn(String) -> R,
        work: impl FnOnce(&Arc<Mailbox<O, R>>) + Send + 'static,
    ) -> io::Result<Self> {
        let mailbox = Arc::new(mailbox);
        let of_thread = Arc::clone(&mailbox);
        let thread = std::thread::Builder::new()
            .name(name.to_owned())
            .spawn(move || {
                if let Err(panic) = catch_unwind(AssertUnwindSafe(|| work(&of_thread))) {
                    of_thread.report(broke_down(panic_message(panic.as_ref())));
                }
                of_thread.update(|state| state.has_ended = true);
            })?;
        Ok(Self {
            mailbox,
            thread: Some(thread),
        })
    }
}

impl<O, R> Worker<O, R> {
    /// The mailbox that the owner shares with the thread.
    pub(super) const fn mailbox(&self) -> &Arc<Mailbox<O, R>> {
        &self.mailbox
    }

    /// Orders the thread to end and waits for up to `patience`. Returns its last reports and
    /// whether it has ended; a thread that has not is detached.
    pub(super) fn close(&mut self, patience: Duration) -> (Vec<R>, bool) {
        let (mut last, until) = (Vec::new(), Instant::now() + patience);
        if let Some(thread) = self.thread.take() {
            self.mailbox.begin_closing();
            // The thread may be waiting for room, so take its reports while it ends.
            while !self.has_ended_after(until, &mut last) {
                if until <= Instant::now() {
                    return (last, false);
                }
            }
            // A panic of `work` has already become a report.
            let _ = thread.join();
        }
        (last, true)
    }

    /// Waits for a report, the end of the thread, or the time `until`; moves the reports to
    /// `reports` and returns whether the thread has ended.
    fn has_ended_after(&self, until: Instant, reports: &mut Vec<R>) -> bool {
        let Mailbox { changed, .. } = &*self.mailbox;
        let left = until.saturating_duration_since(Instant::now());
        let waited = changed.wait_timeout_while(self.mailbox.lock(), left, |state| {
            state.reports.is_empty() && !state.has_ended
        });
        let (mut state, _) = waited.unwrap_or_else(PoisonError::into_inner);
        reports.extend(state.reports.drain(..));
        let has_ended = state.has_ended;
        drop(state);
        changed.notify_all();
        has_ended
    }
}

impl<O, R> Drop for Worker<O, R> {
    fn drop(&mut self) {
        self.close(PATIENCE);
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::sync::mpsc::channel;
    fn mailbox(capacity: usize) -> Mailbox<VecDeque<i32>, String> {
        Mailbox::new(VecDeque::new(), capacity, Arc::new(|| ()))
    }

    /// Reports each order until the mailbox closes.
    fn echo(mailbox: &Arc<Mailbox<VecDeque<i32>, String>>) {
        while let WaitOutcome::Order(order) = mailbox.wait_for(None, VecDeque::pop_front) {
            assert_ne!(order, -1, "an unlucky order");
            mailbox.report(order.to_string());
        }
    }

    #[test]
    fn closing_carries_out_what_is_left_although_no_report_was_taken() {
        let mut worker = Worker::spawn("test", mailbox(2), |message| message, echo).unwrap();
        worker.mailbox().update(|state| state.orders.extend(0..100));
        let expected: Vec<String> = (0..100).map(|order| order.to_string()).collect();
        assert_eq!(worker.close(PATIENCE), (expected, true));
        assert_eq!(worker.close(PATIENCE), (Vec::new(), true));
    }

    #[test]
    fn a_thread_whose_reports_are_not_taken_waits() {
        let worker = Worker::spawn("test", mailbox(3), |message| message, echo).unwrap();
        worker.mailbox().update(|state| state.orders.extend(0..10));
        // Three reports wait; the fourth order has been taken.
        while worker.mailbox().look(VecDeque::len) > 6 {
            std::thread::yield_now();
        }
        assert_eq!(worker.mailbox().look(VecDeque::len), 6);
        assert_eq!(worker.mailbox().take_report().as_deref(), Some("0"));
        while worker.mailbox().look(VecDeque::len) > 5 {
            std::thread::yield_now();
        }
    }

    #[test]
    fn a_thread_that_cannot_be_ended_is_left_to_itself() {
        let (never, waits) = channel::<()>();
        let mut worker = Worker::spawn(
            "test",
            mailbox(3),
            |message| message,
            move |mailbox| {
                mailbox.report("begun".to_owned());
                let _ = waits.recv();
            },
        )
        .unwrap();
        assert_eq!(
            worker.close(Duration::from_millis(50)),
            (vec!["begun".to_owned()], false)
        );
        drop(never);
    }

    #[test]
    fn a_panic_is_the_last_report() {
        let (wake, woken) = channel();
        let wake: Wake = Arc::new(move || wake.send(()).unwrap_or_default());
        let shared = Mailbox::new(VecDeque::from([1, -1, 2]), 8, wake);
        let mut worker = Worker::spawn("test", shared, |message| message, echo).unwrap();
        woken.recv().unwrap();
        woken.recv().unwrap();
        let [first, last] = &worker.close(PATIENCE).0[..] else {
            panic!("two reports")
        };
        assert_eq!(first, "1");
        assert!(last.contains("an unlucky order"), "{last}");
    }

    #[test]
    fn a_thread_waits_no_longer_than_it_wants() {
        let mailbox = mailbox(1);
        let soon = Instant::now() + Duration::from_millis(2);
        assert_eq!(
            mailbox.wait_for(Some(soon), VecDeque::pop_front),
            WaitOutcome::TimeIsUp
        );
        assert!(Instant::now() >= soon);
        mailbox.update(|state| state.orders.push_back(5));
        mailbox.begin_closing();
        assert_eq!(
            mailbox.wait_for(Some(soon), VecDeque::pop_front),
            WaitOutcome::Order(5),
            "what is left comes first"
        );
        assert_eq!(
            mailbox.wait_for(None, VecDeque::pop_front),
            WaitOutcome::Closing
        );
    }

    #[test]
    fn reports_replace_others_or_are_dropped_where_that_is_wanted() {
        let mailbox = mailbox(2);
        for report in ["50 %", "found", "60 %"] {
            mailbox.report_instead(report.to_owned(), |before| before.ends_with('%'));
        }
        mailbox.report_if_room("one too many".to_owned());
        assert_eq!(mailbox.take_reports(), ["found", "60 %"]);
    }
}
