//! Long work beside the interpreter: its lock is released, Ctrl-C and the caller's function are
//! attended to.

use crate::errors::{failure, internal};
use pyo3::exceptions::PyUserWarning;
use pyo3::prelude::*;
use rayon::{ThreadPool, ThreadPoolBuilder};
use std::ffi::CString;
use std::ops::ControlFlow;
use std::panic::{AssertUnwindSafe, catch_unwind};
use std::sync::atomic::{AtomicBool, AtomicUsize, Ordering};
use std::sync::{Arc, Condvar, Mutex, MutexGuard, PoisonError};
use std::time::Duration;
use touchline_core::progress::{Progress, Share};

/// How often signals are looked at where no step is reported.
const SIGNALS: Duration = Duration::from_millis(50);

/// The steps of a long function, from any thread, and whether it is to stop.
#[derive(Default)]
pub struct Steps {
    state: Mutex<State>,
    changed: Condvar,
    is_cancelled: AtomicBool,
    counted: AtomicUsize,
    notes: Mutex<Vec<String>>,
}

#[derive(Clone, Copy, Default)]
struct State {
    /// The last step that was not yet shown.
    step: Option<Share>,
    is_finished: bool,
}

impl Steps {
    /// Reports a step. A break means that the function must return early.
    pub fn report(&self, done: usize, of: usize) -> ControlFlow<()> {
        // A step that was not shown yet is replaced: the caller's function may be slower than the
        // work.
        self.state().step = Some(Share { done, of });
        self.changed.notify_one();
        self.check()
    }

    /// Notes what the caller should know: it becomes a warning of Python's when the work is done.
    pub fn note(&self, note: String) {
        let mut notes = self.notes.lock().unwrap_or_else(PoisonError::into_inner);
        notes.push(note);
    }

    /// Whether to go on.
    pub fn check(&self) -> ControlFlow<()> {
        if self.is_cancelled.load(Ordering::Relaxed) {
            ControlFlow::Break(())
        } else {
            ControlFlow::Continue(())
        }
    }

    /// The progress of a function that reports each of `of` parts when it is done.
    pub fn count(&self, of: usize) -> Progress<'_, ()> {
        self.counted.store(0, Ordering::Relaxed);
        Progress::new(move |()| self.report(self.counted.fetch_add(1, Ordering::Relaxed) + 1, of))
    }

    fn state(&self) -> MutexGuard<'_, State> {
        self.state.lock().unwrap_or_else(PoisonError::into_inner)
    }

    fn finish(&self) {
        self.state().is_finished = true;
        self.changed.notify_one();
    }

    /// Waits for the end of the work. Steps go to the caller's function; if that raises something,
    /// or Ctrl-C is pressed, the work is cancelled and the exception returned once it has ended.
    fn attend(&self, callback: Option<&Py<PyAny>>) -> PyResult<()> {
        let mut outcome = Ok(());
        loop {
            let state = {
                let state = self.state();
                // Checked under the lock, so that a step between the check and the wait is not
                // missed. The wait ends by itself, because Ctrl-C wakes no condition variable.
                let unchanged = state.step.is_none() && !state.is_finished;
                let mut state = if unchanged {
                    let waited = self.changed.wait_timeout(state, SIGNALS);
                    waited.unwrap_or_else(PoisonError::into_inner).0
                } else {
                    state
                };
                State {
                    step: state.step.take(),
                    ..*state
                }
            };
            // The interpreter's lock is taken only here, while the mutex is free: the work reports
            // steps under that mutex and would wait for Python otherwise. After an exception the
            // work runs to its next check, and no function is called any more.
            if outcome.is_ok() {
                outcome = Python::attach(|py| show(py, callback, state.step));
            }
            if outcome.is_err() {
                self.is_cancelled.store(true, Ordering::Relaxed);
            }
            if state.is_finished {
                return outcome;
            }
        }
    }
}

/// Hands a step to the caller's function and lets Python handle its signals.
fn show(py: Python<'_>, callback: Option<&Py<PyAny>>, step: Option<Share>) -> PyResult<()> {
    if let (Some(callback), Some(step)) = (callback, step) {
        callback.call1(py, (step.done, step.of))?;
    }
    py.check_signals()
}

/// The threads of this process, with the id of the process that started them.
static POOL: Mutex<Option<(u32, Arc<ThreadPool>)>> = Mutex::new(None);

/// The threads of this process. A process that was forked from another one, such as a worker of a
/// data loader, has none of the threads of that one, and gets its own.
///
/// # Errors
/// The system gives no threads.
pub fn threads() -> PyResult<Arc<ThreadPool>> {
    let mut kept = POOL.lock().unwrap_or_else(PoisonError::into_inner);
    let process = std::process::id();
    match &*kept {
        Some((owner, pool)) if *owner == process => Ok(Arc::clone(pool)),
        _ => {
            let pool = Arc::new(ThreadPoolBuilder::new().build().map_err(failure)?);
            // Threads that do not exist here cannot be ended.
            std::mem::forget(kept.replace((process, Arc::clone(&pool))));
            Ok(pool)
        }
    }
}

/// Runs long work on other threads, while this thread attends to the interpreter: only the main
/// thread receives Ctrl-C, and a thread that computes cannot look for it.
///
/// Called by one of those threads, from a decoder of the caller's own for example, it does the work
/// itself: waiting there could wait for ever.
///
/// # Errors
/// The caller's function raised something, Ctrl-C was pressed, or the work panicked.
pub fn run<T: Send>(
    py: Python<'_>,
    callback: Option<&Bound<'_, PyAny>>,
    work: impl FnOnce(&Steps) -> T + Send,
) -> PyResult<T> {
    let callback = callback.map(|callback| callback.clone().unbind());
    let steps = Steps::default();
    let result = Mutex::new(None);
    let pool = threads()?;
    if pool.current_thread_index().is_some() {
        let made = py.detach(|| catch_unwind(AssertUnwindSafe(|| work(&steps))));
        warn(py, steps.notes)?;
        return made.map_err(|panic| internal(panic.as_ref()));
    }
    let attended = py.detach(|| {
        pool.in_place_scope(|scope| {
            scope.spawn(|_| {
                // A panic must not pass through the scope: it becomes an exception on the caller's
                // thread.
                let made = catch_unwind(AssertUnwindSafe(|| work(&steps)));
                *result.lock().unwrap_or_else(PoisonError::into_inner) = Some(made);
                steps.finish();
            });
            steps.attend(callback.as_ref())
        })
    });
    attended?;
    warn(py, steps.notes)?;
    match result.into_inner().unwrap_or_else(PoisonError::into_inner) {
        Some(Ok(made)) => Ok(made),
        Some(Err(panic)) => Err(internal(panic.as_ref())),
        // The scope has ended, so that the work has stored its result. This line is reached only by
        // a fault of this file.
        None => Err(internal(&"the work did not begin")),
    }
}

/// Hands notes to Python's `warnings`.
fn warn(py: Python<'_>, notes: Mutex<Vec<String>>) -> PyResult<()> {
    for note in notes.into_inner().unwrap_or_else(PoisonError::into_inner) {
        // Python takes warnings as C strings, and a file's name is in many of them.
        let note = CString::new(note.replace('\0', " "))?;
        PyErr::warn(py, &py.get_type::<PyUserWarning>(), &note, 1)?;
    }
    Ok(())
}
