//! What became of the frames of a document.

use pyo3::prelude::*;
use std::collections::BTreeMap;
use std::fmt::Display;
use touchline_documents::document::Frame;

/// What a function that changes the frames of a document did.
#[pyclass(module = "touchline", frozen, get_all)]
#[derive(Default)]
pub struct Report {
    /// How many frames got a camera.
    pub solved: usize,
    /// How many were left as they are.
    pub passed: usize,
    /// Why a frame got none, by its id.
    pub failed: BTreeMap<String, String>,
    /// What else there is to say.
    pub notes: Vec<String>,
}

impl Report {
    /// Notes that a frame got no camera.
    pub fn fail(&mut self, frame: &Frame, error: impl Display) {
        self.failed
            .insert(frame.id.as_str().to_owned(), error.to_string());
    }
}

#[pymethods]
impl Report {
    fn __repr__(&self) -> String {
        let (solved, failed, passed) = (self.solved, self.failed.len(), self.passed);
        format!("<touchline.Report {solved} solved, {failed} failed, {passed} left as they are>")
    }
}
