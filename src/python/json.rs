//! Values of the document between Rust and Python: dicts with the keys of the document's schema.

use pyo3::exceptions::{PyTypeError, PyValueError};
use pyo3::intern;
use pyo3::prelude::*;
use pyo3::types::PyDict;
use serde::Serialize;
use serde::de::DeserializeOwned;

/// A value as Python's `json` reads it.
///
/// # Errors
/// A number is not finite.
pub fn to_python<'py>(py: Python<'py>, value: &impl Serialize) -> PyResult<Bound<'py, PyAny>> {
    let text =
        serde_json::to_string(value).map_err(|error| PyValueError::new_err(error.to_string()))?;
    // Through text, so that keys and numbers are those of the file.
    py.import(intern!(py, "json"))?
        .call_method1(intern!(py, "loads"), (text,))
}

/// A value from what Python's `json` writes; arrays of NumPy are taken for lists. `name` is what it
/// is, for errors.
///
/// # Errors
/// It is not of this kind; a number is not finite.
pub fn from_python<T: DeserializeOwned>(value: &Bound<'_, PyAny>, name: &str) -> PyResult<T> {
    let py = value.py();
    let options = PyDict::new(py);
    // JSON has no NaN, but Python writes one. NumPy's arrays and numbers have `tolist`, which
    // `json` calls for what it does not know.
    options.set_item(intern!(py, "allow_nan"), false)?;
    let to_list = py
        .import(intern!(py, "operator"))?
        .call_method1(intern!(py, "methodcaller"), ("tolist",))?;
    options.set_item(intern!(py, "default"), to_list)?;
    let text: String = py
        .import(intern!(py, "json"))?
        .call_method(intern!(py, "dumps"), (value,), Some(&options))
        .map_err(|error| PyTypeError::new_err(format!("{name}: {}", error.value(py))))?
        .extract()
        .map_err(|_| PyValueError::new_err(format!("{name}: text that is not UTF-8")))?;
    serde_json::from_str(&text)
        .map_err(|error| PyValueError::new_err(format!("{name}: {}", without_place(&error))))
}

/// The message of an error without its place in a text that the user never sees.
fn without_place(error: &serde_json::Error) -> String {
    let text = error.to_string();
    text.split(" at line ")
        .next()
        .unwrap_or_default()
        .to_owned()
}
