//! What Python sees of errors: exceptions with the texts of the command line, and never a panic.

use pyo3::create_exception;
use pyo3::exceptions::{PyException, PyRuntimeError};
use pyo3::prelude::*;
use std::any::Any;
use std::fmt::Display;
use std::panic::{AssertUnwindSafe, catch_unwind};
use std::path::Path;
use touchline_core::progress::panic_message;

create_exception!(
    touchline,
    Error,
    PyException,
    "What could not be done, with the text of the command line."
);

create_exception!(
    touchline,
    NoCamera,
    Error,
    "The pictures do not decide where the camera stands; the text says why."
);

/// The exception for an error of the library.
pub fn failure(error: impl Display) -> PyErr {
    Error::new_err(error.to_string())
}

/// The exception for a file that is not to be replaced.
pub fn exists(path: &Path) -> PyErr {
    let path = path.display();
    failure(format_args!(
        "{path} already exists; give overwrite=True to replace it, or another path"
    ))
}

/// Runs a function whose panic becomes a `RuntimeError` of one line.
pub fn without_panic<T>(work: impl FnOnce() -> PyResult<T>) -> PyResult<T> {
    catch_unwind(AssertUnwindSafe(work)).unwrap_or_else(|panic| Err(internal(panic.as_ref())))
}

/// The exception for a panic.
pub fn internal(panic: &(dyn Any + Send)) -> PyErr {
    // One line, as every error of the command line.
    let message = panic_message(panic).replace('\n', " ");
    PyRuntimeError::new_err(format!("internal error (please report it): {message}"))
}
