//! A field with its landmarks and lines.

use crate::arrays::array;
use crate::errors::{failure, without_panic};
use pyo3::exceptions::{PyKeyError, PyValueError};
use pyo3::prelude::*;
use pyo3::types::PyDict;
use std::collections::BTreeMap;
use std::path::Path;
use std::sync::Arc;
use touchline_core::field::{FieldModel, builtin_names};
use touchline_core::geometry::Vec3;
use touchline_documents::document::FieldSpec;

/// The most points of a sampled line.
const MAX_POINTS: f64 = 100_000.0;

/// The field of one venue: landmarks and lines by name, in `world` (m): origin at the centre, x to
/// the right as the main camera sees it, y away from it, z up.
#[pyclass(module = "touchline", frozen, name = "Field")]
pub struct PyField {
    pub model: Arc<FieldModel>,
}

/// A field by the name of its template: `field("soccer", length_m=105.0, width_m=68.0)`.
///
/// `touchline fields` lists the templates and their parameters; `field_names()` lists the names.
#[pyfunction]
#[pyo3(signature = (name = "soccer", **params))]
pub fn field(name: &str, params: Option<BTreeMap<String, f64>>) -> PyResult<PyField> {
    let spec = FieldSpec::with_params(name, params.unwrap_or_default());
    without_panic(|| PyField::from_spec(&spec, Path::new("")))
}

/// The names of the built-in templates.
#[pyfunction]
pub fn field_names() -> Vec<&'static str> {
    builtin_names()
}

/// The field that an argument gives, else the usual soccer pitch.
pub fn field_or_usual(given: Option<&PyField>) -> PyResult<Arc<FieldModel>> {
    match given {
        Some(field) => Ok(Arc::clone(&field.model)),
        None => Ok(PyField::from_spec(&FieldSpec::new("soccer"), Path::new(""))?.model),
    }
}

impl PyField {
    /// The field of a specification; `folder` is that of its document.
    pub fn from_spec(spec: &FieldSpec, folder: &Path) -> PyResult<Self> {
        let model = spec.model(folder).map_err(failure)?;
        Ok(Self {
            model: Arc::new(model),
        })
    }
}

#[pymethods]
impl PyField {
    /// The template's name.
    #[getter]
    fn template(&self) -> &str {
        &self.model.template
    }

    /// Its parameters, such as `length_m`.
    #[getter]
    fn params(&self) -> BTreeMap<String, f64> {
        self.model.params.clone()
    }

    /// The extent along x, m.
    #[getter]
    fn length_m(&self) -> f64 {
        self.model.length_m
    }

    /// The extent along y, m.
    #[getter]
    fn width_m(&self) -> f64 {
        self.model.width_m
    }

    /// How much the middle is higher than the touchlines, m.
    #[getter]
    fn crown_m(&self) -> f64 {
        self.model.crown_m
    }

    /// The landmarks by name: arrays of shape (3,), m, the crown included.
    #[getter]
    fn landmarks<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyDict>> {
        let found = PyDict::new(py);
        for landmark in &self.model.landmarks {
            let place = self.model.landmark_in_world(landmark);
            found.set_item(
                landmark.id.as_str(),
                array(py, [3], place.as_slice().to_vec())?,
            )?;
        }
        Ok(found)
    }

    /// The names of the lines.
    #[getter]
    fn lines(&self) -> Vec<&str> {
        self.model
            .lines
            .iter()
            .map(|line| line.id.as_str())
            .collect()
    }

    /// Points along a line, at most `step_m` apart: an array of shape (N, 3), m, the crown
    /// included.
    #[pyo3(signature = (name, step_m = 0.5))]
    fn line<'py>(&self, py: Python<'py>, name: &str, step_m: f64) -> PyResult<Bound<'py, PyAny>> {
        let Some(line) = self.model.line(name) else {
            let template = &self.model.template;
            return Err(PyKeyError::new_err(format!(
                "the field {template} has no line {name:?}; lines lists them"
            )));
        };
        // At least the two ends. A step of 0 gives infinitely many pieces, one that is negative or
        // NaN fails the comparison below.
        let pieces = (line.curve.length_m() / step_m).ceil().max(1.0);
        if !(step_m > 0.0 && pieces <= MAX_POINTS) {
            return Err(PyValueError::new_err(format!(
                "step_m: {step_m} m gives no line of at most {MAX_POINTS} points"
            )));
        }
        let count = pieces as usize;
        let points: Vec<Vec3> = (0..=count)
            .map(|index| {
                // Along the flat field first; the crown then lifts the point.
                let nominal = line.curve.point_at(index as f64 / pieces);
                self.model.world_from_nominal(nominal)
            })
            .collect();
        let numbers: Vec<f64> = points
            .iter()
            .flat_map(|point| [point.x, point.y, point.z])
            .collect();
        Ok(array(py, [count + 1, 3], numbers)?.into_any())
    }

    fn __repr__(&self) -> String {
        let FieldModel {
            template,
            length_m,
            width_m,
            ..
        } = &*self.model;
        format!("<touchline.Field {template} {length_m} x {width_m} m>")
    }
}
