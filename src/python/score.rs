//! How far a camera is from the true one.

use crate::arrays::{Numbers, array};
use crate::camera::PyCamera;
use crate::errors::without_panic;
use crate::field::{PyField, field_or_usual};
use pyo3::exceptions::PyValueError;
use pyo3::prelude::*;
use pyo3::types::PyDict;
use touchline_core::score::{
    AnnotatedLine, FieldView, MarkingMatch, annotated_lines, iou_part, iou_whole,
};

/// Intersection over union of the field seen from above, 0 to 1.
///
/// `kind`: "part" compares the parts of the field that the picture shows, "whole" the whole field
/// projected by one camera and back by the other. NaN where neither camera shows any of the field.
/// Both cameras are of pictures of one size.
#[pyfunction]
#[pyo3(signature = (truth, estimate, field = None, kind = "part"))]
pub fn iou(
    truth: &PyCamera,
    estimate: &PyCamera,
    field: Option<&PyField>,
    kind: &str,
) -> PyResult<f64> {
    let field = field_or_usual(field)?;
    let (one, other) = (&truth.camera, &estimate.camera);
    // Both are compared by the pixels of one picture.
    if truth.image_size != estimate.image_size {
        let (is, wanted) = (estimate.image_size, truth.image_size);
        return Err(PyValueError::new_err(format!(
            "estimate: its pictures have {} × {} px, and those of the truth {} × {} px",
            is.width, is.height, wanted.width, wanted.height
        )));
    }
    without_panic(|| match kind {
        "part" => Ok(iou_part(&field, one, other, truth.image_size).unwrap_or(f64::NAN)),
        "whole" => Ok(iou_whole(&field, one, other)),
        _ => Err(PyValueError::new_err(format!(
            "kind: {kind:?} is neither \"part\" nor \"whole\""
        ))),
    })
}

/// `SoccerNet`'s JaC of one picture, 0 to 1: the share of lines found within `threshold_px` (at 960
/// px width) of all that are annotated or shown. Of the annotation and the same after half a turn
/// the better counts.
///
/// `lines`: arrays of shape (N, 2), px of the picture, by the names of the field's lines.
#[pyfunction]
#[pyo3(signature = (camera, lines, field = None, threshold_px = 5.0))]
pub fn jac(
    camera: &PyCamera,
    lines: &Bound<'_, PyDict>,
    field: Option<&PyField>,
    threshold_px: f64,
) -> PyResult<f64> {
    let field = field_or_usual(field)?;
    let mut annotated = Vec::new();
    for (name, points) in lines {
        let name: String = name.extract()?;
        // A name that the field lacks would only lower the score, as a line that is not found.
        let Some(line) = field.lines.iter().position(|line| line.id.as_str() == name) else {
            let template = &field.template;
            return Err(PyValueError::new_err(format!(
                "lines: the field {template} has no line {name:?}; Field.lines lists them"
            )));
        };
        let points = Numbers::read(&points, "lines")?.image_points()?;
        annotated.push(AnnotatedLine { line, points });
    }
    let view = FieldView {
        field: &field,
        camera: &camera.camera,
    };
    without_panic(|| {
        Ok(
            MarkingMatch::compare(&field, &annotated, view, camera.image_size)
                .jaccard(threshold_px),
        )
    })
}

/// The lines that a camera shows, as an annotator would mark them: both ends of straight ones, nine
/// points along round ones. Arrays of shape (N, 2), px, by name.
#[pyfunction]
#[pyo3(signature = (camera, field = None))]
pub fn visible_lines<'py>(
    py: Python<'py>,
    camera: &PyCamera,
    field: Option<&PyField>,
) -> PyResult<Bound<'py, PyDict>> {
    let field = field_or_usual(field)?;
    let lines = without_panic(|| Ok(annotated_lines(&field, &camera.camera, camera.image_size)))?;
    let shown = PyDict::new(py);
    for AnnotatedLine { line, points } in lines {
        let numbers: Vec<f64> = points.iter().flat_map(|point| [point.x, point.y]).collect();
        shown.set_item(
            field.lines[line].id.as_str(),
            array(py, [points.len(), 2], numbers)?,
        )?;
    }
    Ok(shown)
}
