//! Cameras from clicks: of two points, of a frame, of a document.

use crate::arrays::Numbers;
use crate::camera::{PyBase, PyCamera};
use crate::document::PyDocument;
use crate::errors::{failure, without_panic};
use crate::field::{PyField, field_or_usual};
use crate::json;
use crate::progress::{self, Steps};
use crate::results::{PySolution, Report};
use pyo3::exceptions::PyValueError;
use pyo3::prelude::*;
use std::path::Path;
use touchline_calibration::calibrate::{
    BaseProblem, DecidedFrames, SolveOutcome, follow_all_bases, observations, solve_document_with,
};
use touchline_core::camera::PtzCamera;
use touchline_core::geometry::pluralise;
use touchline_core::progress::Progress;
use touchline_core::solve::base::{BaseOptions, BaseProgress, CrownModel, LensModel};
use touchline_core::solve::{SolveContext, solve_two_points};
use touchline_documents::document::{CameraId, Click, Document, Frame};

/// The cameras for which two points of the world appear at two pixels, in ascending order of focal
/// length: one, or rarely two.
///
/// `pixels`: (2, 2), px. `points`: (2, 3), m, or (2, 2) on the plane z = 0.
#[pyfunction]
pub fn two_point(
    base: &PyBase,
    pixels: &Bound<'_, PyAny>,
    points: &Bound<'_, PyAny>,
) -> PyResult<Vec<PyCamera>> {
    let pixels = Numbers::read(pixels, "pixels")?;
    pixels.finite()?;
    let points = Numbers::read(points, "points")?;
    points.finite()?;
    // A single row is one point, so that the numbers of points are checked, not the shapes.
    let (&[a, b], &[at_a, at_b]) = (&*pixels.image_points()?, &*points.world_points()?) else {
        return Err(PyValueError::new_err(
            "pixels, points: two of each are needed",
        ));
    };
    without_panic(|| {
        let found = solve_two_points(&base.base, [at_a, at_b], [a, b]).map_err(failure)?;
        let cameras = found
            .iter()
            .map(|ptz| PyCamera::new(&PtzCamera::new(base.base, ptz), base.image_size));
        Ok(cameras.collect())
    })
}

/// Pan, tilt and focal length of a frame from its clicks and a known base.
///
/// `clicks`: dicts with `landmark` or `line`, `image_px`, and `check=True` for one that is held
/// out, as in documents. `field`: by default a soccer pitch of 105 × 68 m.
#[pyfunction]
#[pyo3(signature = (base, clicks, field = None))]
pub fn solve_frame(
    base: &PyBase,
    clicks: &Bound<'_, PyAny>,
    field: Option<&PyField>,
) -> PyResult<PySolution> {
    let clicks: Vec<Click> = json::from_python(clicks, "clicks")?;
    let field = field_or_usual(field)?;
    // The clicks of a frame are read as those of a document, names and held-out clicks included.
    let frame = Frame {
        clicks,
        ..Frame::from_image("", CameraId::from("main"), base.image_size)
    };
    without_panic(|| {
        let clicks = observations(&frame, &field).map_err(failure)?;
        let context = SolveContext::new(base.image_size);
        let found =
            touchline_core::solve::solve_frame(&base.base, &clicks, &context).map_err(failure)?;
        let camera = |ptz| PyCamera::new(&PtzCamera::new(base.base, ptz), base.image_size);
        let residuals = found
            .residuals
            .iter()
            .map(|click| click.offset_px.map_or([f64::NAN; 2], Into::into));
        Ok(PySolution {
            camera: camera(found.ptz),
            covariance: found.covariance,
            rms_px: found.rms_px,
            worst_corner_sigma_px: found.worst_corner_sigma_px,
            residuals_px: residuals.collect(),
            alternatives: found
                .alternatives
                .iter()
                .map(|other| camera(other.ptz))
                .collect(),
            warnings: found.warnings,
        })
    })
}

/// Solves every frame of a document with enough clicks, as `touchline solve`. Statuses stay. Frames
/// whose camera was set by hand, aligned to paint or accepted from another source keep it, unless
/// `replace_decided`; the report's notes count them.
///
/// `progress(done, of)` is called as frames are done; what it raises, or Ctrl-C, stops the work and
/// leaves the document as it was.
#[pyfunction]
#[pyo3(signature = (document, progress = None, replace_decided = false))]
pub fn solve(
    document: &Bound<'_, PyDocument>,
    progress: Option<&Bound<'_, PyAny>>,
    replace_decided: bool,
) -> PyResult<Report> {
    let decided = decided_frames(replace_decided);
    let (mut solved, folder) = document.try_borrow()?.copy();
    let (outcomes, solved) = progress::run(document.py(), progress, |steps| {
        let all = solved.frames.len();
        let outcomes = solve_document_with(&mut solved, &folder, decided, &steps.count(all));
        (outcomes, solved)
    })?;
    let report = report(&solved, &outcomes.map_err(failure)?);
    document.try_borrow_mut()?.document = solved;
    Ok(report)
}

const fn decided_frames(replace: bool) -> DecidedFrames {
    if replace {
        DecidedFrames::Replace
    } else {
        DecidedFrames::Keep
    }
}

/// What became of the frames.
fn report(document: &Document, outcomes: &[SolveOutcome]) -> Report {
    let mut report = Report::default();
    let kept = outcomes
        .iter()
        .filter(|outcome| matches!(outcome, SolveOutcome::Kept));
    let kept = kept.count();
    if kept > 0 {
        report.notes.push(format!(
            "{} with enough clicks kept as decided; replace_decided=True solves them, too",
            pluralise(kept, "frame")
        ));
    }
    for (frame, outcome) in document.frames.iter().zip(outcomes) {
        match outcome {
            SolveOutcome::Solved => report.solved += 1,
            SolveOutcome::Failed(error) => report.fail(frame, error),
            // Too few clicks, or decided: the frame is left as it is, which is no failure.
            _ => report.passed += 1,
        }
    }
    report
}

/// The lens models by name, as `touchline refine-base --distortion` has them.
fn lens_model(name: &str) -> PyResult<Option<LensModel>> {
    match name {
        "auto" => Ok(None),
        "none" => Ok(Some(LensModel::Pinhole)),
        "k1" => Ok(Some(LensModel::K1)),
        "k1-focal" => Ok(Some(LensModel::K1Focal)),
        "k1-focal-k2" => Ok(Some(LensModel::K1FocalK2)),
        _ => Err(PyValueError::new_err(format!(
            "distortion: {name:?} is none of auto, none, k1, k1-focal, k1-focal-k2"
        ))),
    }
}

/// Estimates where the cameras of a document stand, their base rotations and lenses, from the
/// clicks of all frames but rejected ones, and solves all frames, as `touchline refine-base`.
///
/// Three and more frames with four landmarks or lines each are a good start. `crown_m`: None chooses it by
/// cross-validation. `progress(done, of)` and `replace_decided` as in `solve`.
#[pyfunction]
#[pyo3(signature = (
    document, distortion = "auto", crown_m = None, principal_point = true, progress = None,
    replace_decided = false
))]
pub fn estimate_base(
    document: &Bound<'_, PyDocument>,
    distortion: &str,
    crown_m: Option<f64>,
    principal_point: bool,
    progress: Option<&Bound<'_, PyAny>>,
    replace_decided: bool,
) -> PyResult<Report> {
    let decided = decided_frames(replace_decided);
    if crown_m.is_some_and(|crown_m| !crown_m.is_finite()) {
        return Err(PyValueError::new_err("crown_m: a finite number is needed"));
    }
    let options = BaseOptions {
        lens: lens_model(distortion)?,
        crown: crown_m.map(CrownModel::Fixed),
        principal_point,
        ..BaseOptions::default()
    };
    let (mut solved, folder) = document.try_borrow()?.copy();
    let estimated = progress::run(document.py(), progress, |steps| {
        estimate_all(&mut solved, &folder, &options, decided, steps).map(|report| (solved, report))
    })?;
    let (solved, report) = estimated.map_err(failure)?;
    document.try_borrow_mut()?.document = solved;
    Ok(report)
}

/// Estimates the base of each camera, and solves all frames with them.
fn estimate_all(
    document: &mut Document,
    folder: &Path,
    options: &BaseOptions,
    decided: DecidedFrames,
    steps: &Steps,
) -> Result<Report, String> {
    // Every camera is estimated from the document as it was, so that their order does not matter.
    let before = document.clone();
    let adjusting = Progress::new(|at: BaseProgress| steps.report(at.done, at.total));

    // A camera without an estimate does not stop the others.
    let (mut estimates, mut notes) = (Vec::new(), Vec::new());
    for camera in &before.cameras {
        let problem = BaseProblem::from_document(before.at(folder), &camera.id);
        match problem.and_then(|problem| problem.estimate(&before, options, &adjusting.renew())) {
            Ok(estimate) => estimates.push(estimate),
            Err(error) => notes.push(format!("camera {:?}: {error}", camera.id.as_str())),
        }
    }
    // Checked here, for the loop above is empty then, too, and its error would be an empty text.
    if before.cameras.is_empty() {
        return Err("the document has no camera".to_owned());
    }
    if estimates.is_empty() {
        return Err(notes.join("; "));
    }

    for estimate in &estimates {
        estimate.write_camera(document);
    }
    // Progress begins again: the steps of the estimates count iterations, these count frames.
    let counting = steps.count(document.frames.len());
    let outcomes = solve_document_with(document, folder, decided, &counting)
        .map_err(|error| error.to_string())?;
    // Proposals that were made with the old base are no longer valid.
    let withdrawn = follow_all_bases(document, &before);
    if withdrawn > 0 {
        let proposals = pluralise(withdrawn, "proposal");
        notes.push(format!("{proposals} for the base before withdrawn"));
    }
    for estimate in &estimates {
        estimate.mark_disputes(document);
    }
    let mut report = report(document, &outcomes);
    report.notes.splice(..0, notes);
    Ok(report)
}
