//! The library as the Python module `touchline`.
//!
//! `touchline._touchline` is made here; the package `touchline` beside these sources hands it out,
//! with its types for type checkers. A class or function holds as much as its arguments need and
//! calls the library; what it returns is NumPy's or Python's own.
//!
//! - Errors are exceptions with the texts of the command line ([`errors`]); a panic becomes a
//!   `RuntimeError`.
//! - Long work runs beside the interpreter; its lock is released ([`progress`]).
//! - A function that changes a document works on a copy and hands it over at its end: documents
//!   share what did not change, and a cancelled call leaves nothing half done.
//!
//! | floor | rooms |
//! |---|---|
//! | 6 | `calibrate` (whole videos, tracking, snapping), `forest` |
//! | 5 | `solve` (from clicks) |
//! | 4 | `document` |
//! | 3 | `frames` (of a document as columns), `results`, `score` |
//! | 2 | `camera` (bases, cameras, projection), `field`, `images` |
//! | 1 | `arrays` (NumPy in and out), `json` (dicts with the document's keys), `progress` |
//! | 0 | `errors` |

mod arrays;
mod calibrate;
mod camera;
mod document;
mod errors;
mod field;
mod forest;
mod frames;
mod images;
mod json;
mod progress;
mod results;
mod score;
mod solve;

use pyo3::prelude::*;

/// Cameras of pan-tilt-zoom sports broadcasts, as `touchline` finds them.
#[pymodule]
fn _touchline(module: &Bound<'_, PyModule>) -> PyResult<()> {
    let py = module.py();
    module.add("__version__", env!("CARGO_PKG_VERSION"))?;
    module.add("Error", py.get_type::<errors::Error>())?;
    module.add("NoCamera", py.get_type::<errors::NoCamera>())?;
    module.add_class::<camera::PyBase>()?;
    module.add_class::<camera::PyCamera>()?;
    module.add_class::<document::PyDocument>()?;
    module.add_class::<field::PyField>()?;
    module.add_class::<forest::Answer>()?;
    module.add_class::<forest::PyForest>()?;
    module.add_class::<frames::PyFrames>()?;
    module.add_class::<results::Report>()?;
    module.add_class::<results::PySolution>()?;
    module.add_function(wrap_pyfunction!(calibrate::calibrate, module)?)?;
    module.add_function(wrap_pyfunction!(calibrate::snap, module)?)?;
    module.add_function(wrap_pyfunction!(calibrate::track, module)?)?;
    module.add_function(wrap_pyfunction!(camera::homography, module)?)?;
    module.add_function(wrap_pyfunction!(camera::project, module)?)?;
    module.add_function(wrap_pyfunction!(camera::unproject, module)?)?;
    module.add_function(wrap_pyfunction!(document::load, module)?)?;
    module.add_function(wrap_pyfunction!(field::field, module)?)?;
    module.add_function(wrap_pyfunction!(field::field_names, module)?)?;
    module.add_function(wrap_pyfunction!(score::iou, module)?)?;
    module.add_function(wrap_pyfunction!(score::jac, module)?)?;
    module.add_function(wrap_pyfunction!(score::visible_lines, module)?)?;
    module.add_function(wrap_pyfunction!(solve::estimate_base, module)?)?;
    module.add_function(wrap_pyfunction!(solve::solve, module)?)?;
    module.add_function(wrap_pyfunction!(solve::solve_frame, module)?)?;
    module.add_function(wrap_pyfunction!(solve::two_point, module)?)?;
    Ok(())
}
