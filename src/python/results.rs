//! What solving gives: the camera of a frame, and what became of the frames of a document.

use crate::arrays::{array, matrix};
use crate::camera::PyCamera;
use crate::json;
use pyo3::prelude::*;
use std::collections::BTreeMap;
use std::fmt::Display;
use touchline_core::geometry::Mat3;
use touchline_core::solve::Warning;
use touchline_documents::document::Frame;

/// A frame's camera with its uncertainty.
#[pyclass(module = "touchline", frozen, name = "Solution")]
pub struct PySolution {
    pub camera: PyCamera,
    pub covariance: Mat3,
    pub rms_px: f64,
    pub worst_corner_sigma_px: f64,
    pub residuals_px: Vec<[f64; 2]>,
    pub alternatives: Vec<PyCamera>,
    pub warnings: Vec<Warning>,
}

#[pymethods]
impl PySolution {
    /// The camera.
    #[getter]
    fn camera(&self) -> PyCamera {
        self.camera.clone()
    }

    /// Covariance of pan (deg), tilt (deg) and focal length (px), (3, 3).
    #[getter]
    fn covariance<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyAny>> {
        matrix(py, &self.covariance)
    }

    /// Root mean square of the residuals, px.
    #[getter]
    fn rms_px(&self) -> f64 {
        self.rms_px
    }

    /// 1-σ of the overlay at the worst corner of the picture, px.
    #[getter]
    fn worst_corner_sigma_px(&self) -> f64 {
        self.worst_corner_sigma_px
    }

    /// From where the camera puts what was clicked to the clicks that took part, (M, 2), px; NaN
    /// where it has no image.
    #[getter]
    fn residuals_px<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyAny>> {
        // NumPy takes the memory over, so that each access gets an array of its own.
        let numbers = self.residuals_px.as_flattened().to_vec();
        Ok(array(py, [self.residuals_px.len(), 2], numbers)?.into_any())
    }

    /// Other cameras that fit the same clicks, best first.
    #[getter]
    fn alternatives(&self) -> Vec<PyCamera> {
        self.alternatives.clone()
    }

    /// What a person should know: dicts with `code`, `message` and `clicks`.
    #[getter]
    fn warnings<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyAny>> {
        json::to_python(py, &self.warnings)
    }

    fn __repr__(&self) -> String {
        let ptz = self.camera.camera.ptz();
        format!(
            "<touchline.Solution pan {:.2}, tilt {:.2}, focal length {:.0} px, rms {:.2} px>",
            ptz.pan, ptz.tilt, ptz.focal_px, self.rms_px
        )
    }
}

impl PySolution {
    /// A camera that rests on no clicks.
    pub const fn without_clicks(
        camera: PyCamera,
        covariance: Mat3,
        rms_px: f64,
        worst_corner_sigma_px: f64,
    ) -> Self {
        Self {
            camera,
            covariance,
            rms_px,
            worst_corner_sigma_px,
            residuals_px: Vec::new(),
            alternatives: Vec::new(),
            warnings: Vec::new(),
        }
    }
}

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
