//! A panic as an error, for messages to the user.

use std::cell::Cell;
use std::panic::{self, AssertUnwindSafe, catch_unwind};
use std::sync::{Arc, Mutex, PoisonError};
use thiserror::Error;
use touchline_core::progress::panic_message;

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

    #[test]
    fn a_panic_is_an_error_with_its_place() {
        assert_eq!(until_it_panics(|| 5), Ok(5));
        let panicked = until_it_panics(|| -> u8 { panic!("the display\nwent away") }).unwrap_err();
        assert_eq!(panicked.message, "the display went away");
        assert!(
            panicked.place.contains("panicked.rs:"),
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
