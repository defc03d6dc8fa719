//! The pan-tilt forest: cameras of pictures without clicks.

use crate::camera::PyCamera;
use crate::document::{PyDocument, video_frame};
use crate::errors::{Error, exists, failure};
use crate::images::{OnePicture, picture};
use crate::progress::{self, Steps};
use crate::results::PySolution;
use pyo3::exceptions::{PyKeyError, PyValueError};
use pyo3::prelude::*;
use std::ops::ControlFlow;
use std::path::{Path, PathBuf};
use touchline_calibration::pipelines::{ForestRequest, PictureFiles, label_frames};
use touchline_calibration::proposals::{
    CameraOfSizeError, FeatureStore, FramePictures, LearnError, LearnOptions, TrainingFrames,
    adopt_bases, camera_of_size, learn, measure, study,
};
use touchline_core::files::{read_named, refuse_part_of_project};
use touchline_core::geometry::Mat3;
use touchline_core::progress::{Progress, Share};
use touchline_documents::document::{Camera, CameraId, Document, document_from_bytes};
use touchline_documents::store::{write_new, write_output};
use touchline_vision::media::{FrameReader, Picture};
use touchline_vision::relocalize::{
    ForestModel, PoseOptions, RelocalizeOptions, Stopped, TrainOptions, TrainProgress,
};

/// Maximum size of a forest's file, bytes; the command line has the same limit.
const MAX_FOREST_BYTES: u64 = 8 << 30;

/// What reading a forest needs to know its field and cameras by.
const FILE: &str = "the forest";

/// A forest that was trained on the references of a document, and finds the cameras of other
/// pictures of the same cameras.
#[pyclass(module = "touchline", frozen, name = "Forest")]
pub struct PyForest {
    model: ForestModel,
    /// The field and cameras of the document that it was trained on.
    trained_on: Document,
}

impl PyForest {
    /// A forest with the document that it holds.
    fn new(model: ForestModel, place: &str) -> PyResult<Self> {
        let trained_on = document_from_bytes(model.document.as_bytes());
        let trained_on = trained_on.map_err(|error| failure(format_args!("{place}: {error}")))?;
        Ok(Self { model, trained_on })
    }

    /// The camera of the forest by its name; without a name the only one with pictures of this
    /// size.
    fn camera(&self, name: Option<&str>, picture: &Picture) -> PyResult<&Camera> {
        let size = picture.size();
        let Some(name) = name else {
            let found = camera_of_size(&self.trained_on, &self.model, size);
            return found.map_err(|error| refuse_size(&error));
        };
        let named = self.trained_on.camera(&CameraId::from(name));
        let named = named.ok_or_else(|| {
            PyKeyError::new_err(format!("camera {name:?}: the forest has no such camera"))
        })?;
        if named.image_size == size {
            Ok(named)
        } else {
            Err(refuse_size(&CameraOfSizeError::Missing { size }))
        }
    }
}

/// The exception for a picture whose size does not decide its camera.
fn refuse_size(error: &CameraOfSizeError) -> PyErr {
    let remedy = match error {
        CameraOfSizeError::Several { .. } => ": name it with `camera=`",
        CameraOfSizeError::Missing { .. } => "",
    };
    PyValueError::new_err(format!("image: {error}{remedy}"))
}

#[pymethods]
impl PyForest {
    /// Trains a forest on the `reference` frames of a document, as `touchline train`.
    ///
    /// `all_references`: also those that came from a forest or from tracking. `measured`: ask for
    /// each reference with a forest without it, and bound the stated probabilities by the answers.
    /// The same `seed` gives the same forest. `progress(done, of)` counts within the present step.
    #[staticmethod]
    #[pyo3(signature = (
        document, *, trees = None, seed = 0, all_references = false, measured = true,
        progress = None
    ))]
    fn train(
        document: &Bound<'_, PyDocument>,
        trees: Option<u32>,
        seed: u64,
        all_references: bool,
        measured: bool,
        progress: Option<&Bound<'_, PyAny>>,
    ) -> PyResult<Self> {
        if trees.is_some_and(|trees| !(1..=64).contains(&trees)) {
            return Err(PyValueError::new_err("trees: 1 to 64 are possible"));
        }
        let usual = TrainOptions::default();
        let options = LearnOptions {
            train: TrainOptions {
                trees: trees.unwrap_or(usual.trees),
                seed,
                ..usual
            },
            ..LearnOptions::default()
        };
        let (given, folder) = document.try_borrow()?.copy();
        // Checked before the work begins, as the command line does.
        let references = TrainingFrames::from_document(&given, all_references).frames;
        if references.is_empty() {
            return Err(Error::new_err(
                "there are no references to train with; accept solved frames first",
            ));
        }
        let trained = progress::run(document.py(), progress, |steps| {
            train(&given, &folder, &references, &options, measured, steps)
        })?;
        Self::new(trained?, FILE)
    }

    /// Reads the file of a forest.
    #[staticmethod]
    fn load(py: Python<'_>, path: PathBuf) -> PyResult<Self> {
        let place = path.display().to_string();
        // Reading and decoding each run beside the interpreter: a forest may have gigabytes.
        let bytes = progress::run(py, None, move |_| read_named(&path, MAX_FOREST_BYTES))?;
        let bytes = bytes.map_err(|error| failure(format_args!("cannot read {place}: {error}")))?;
        let model = progress::run(py, None, |_| ForestModel::from_bytes(&bytes))?;
        Self::new(
            model.map_err(|error| failure(format_args!("{place}: {error}")))?,
            &place,
        )
    }

    /// Writes the forest to a file; one that exists is replaced only with `overwrite=True`.
    #[pyo3(signature = (path, overwrite = false))]
    fn save(&self, py: Python<'_>, path: PathBuf, overwrite: bool) -> PyResult<()> {
        let place = path.display().to_string();
        refuse_part_of_project(&path).map_err(failure)?;
        if !overwrite && path.exists() {
            return Err(exists(&path));
        }
        let written = progress::run(py, None, move |_| {
            write(&path, &self.model.to_bytes(), overwrite)
        })?;
        written.map_err(|error| failure(format_args!("cannot write {place}: {error}")))
    }

    /// The names of its cameras.
    #[getter]
    fn cameras(&self) -> Vec<&str> {
        self.model
            .cameras
            .iter()
            .map(|forest| forest.camera.as_str())
            .collect()
    }

    /// Refuses a document whose bases are not those that the forest was trained with.
    fn check_bases(&self, document: &PyDocument) -> PyResult<()> {
        adopt_bases(
            &mut document.document.clone(),
            &self.trained_on,
            &self.model,
        )
        .map_err(failure)
    }

    /// The camera of a picture: (height, width, 3), uint8, red first, or blue with `bgr`.
    ///
    /// The answer is that of `touchline relocalize`, the check against the painted lines included.
    /// `camera`: which camera took it, by default the only one with pictures of this size. `snap`:
    /// align the answer to the painted lines. Where no camera is found, `Answer.camera` is None.
    #[pyo3(signature = (
        image, camera = None, *, bgr = false, min_confidence = None, snap = false, seed = 0
    ))]
    fn relocalize(
        &self,
        image: &Bound<'_, PyAny>,
        camera: Option<&str>,
        bgr: bool,
        min_confidence: Option<f64>,
        snap: bool,
        seed: u64,
    ) -> PyResult<Answer> {
        let picture = picture(image, bgr)?;
        let camera = self.camera(camera, &picture)?;
        let usual = PoseOptions::default();
        let min_confidence = min_confidence.unwrap_or(usual.min_confidence);
        if !(0.0..=1.0).contains(&min_confidence) {
            return Err(PyValueError::new_err(
                "min_confidence: a probability is a number from 0 to 1",
            ));
        }
        let pose = PoseOptions {
            min_confidence,
            seed,
            ..usual
        };
        let request = ForestRequest {
            model: &self.model,
            generation: 0,
            options: RelocalizeOptions {
                pose,
                ..RelocalizeOptions::default()
            },
        };
        // The picture becomes a frame of the document that the forest was trained on, with its
        // field and cameras, so that the answer is that of the command line.
        let mut document = self.trained_on.clone();
        // A frame of a video is read by its index alone, so that the picture needs no file.
        let frame = video_frame("image", 0, &camera.id, picture.size());
        document.frames.push(frame.into());
        progress::run(image.py(), None, |_| {
            answer(document, picture, &request, snap)
        })?
        .map_err(failure)
    }

    fn __repr__(&self) -> String {
        format!("<touchline.Forest of {} cameras>", self.model.cameras.len())
    }
}

/// Trains a forest; where it is measured, its stated probabilities are bounded by the answers.
fn train(
    document: &Document,
    folder: &Path,
    references: &[usize],
    options: &LearnOptions,
    measured: bool,
    steps: &Steps,
) -> PyResult<ForestModel> {
    let store = FeatureStore::in_memory();
    let pictures = FramePictures::new(document, folder, options.features, &store);
    let studied = study(
        &pictures,
        &mut FrameReader::new(),
        references,
        &steps.count(references.len()),
    );
    // Only a cancelled study gives nothing; `progress::run` then raises what cancelled it.
    let studied = studied.ok_or_else(stop_error)?;
    for (index, error) in &studied.failed {
        steps.note(format!("{}: {error}", document.frames[*index].name()));
    }
    if studied
        .training_samples
        .iter()
        .all(|sample| sample.fine.rays.is_empty())
    {
        let first = studied.failed.first();
        let why = first.map_or_else(String::new, |(index, error)| {
            format!("; {}: {error}", document.frames[*index].name())
        });
        return Err(Error::new_err(format!(
            "no reference gave features to train with{why}"
        )));
    }
    let training = Progress::new(|at: TrainProgress| steps.report(at.placed, at.total));
    let mut model = learn(document, &studied, options, &training).map_err(|error| match error {
        // The same for the training.
        LearnError::Stopped(Stopped::Cancelled) => stop_error(),
        error => failure(error),
    })?;
    if measured {
        let measuring = Progress::new(|share: Share| steps.report(share.done, share.of));
        let relocalizing = RelocalizeOptions::default();
        let quality = measure(
            &pictures,
            &mut FrameReader::new(),
            references,
            options,
            &relocalizing,
            &measuring,
        );
        // Too few references to leave some out: the stated probabilities stay as they are.
        if let Some(quality) = quality {
            quality.bound(document, &mut model);
        }
    }
    Ok(model)
}

/// A cancelled function returns nothing; whoever cancelled it raises its own exception.
fn stop_error() -> PyErr {
    Error::new_err("stopped")
}

/// Writes a file completely or not at all.
fn write(path: &Path, bytes: &[u8], overwrite: bool) -> std::io::Result<()> {
    if overwrite {
        write_output(path, bytes)
    } else {
        write_new(path, bytes)
    }
}

/// What a forest says about a picture.
#[pyclass(module = "touchline", frozen, get_all)]
pub struct Answer {
    /// The camera with its uncertainty; None where none was found.
    pub solution: Option<Py<PySolution>>,
    /// The probability that the overlay is right within 10 px at 1920 px width; None where no
    /// camera was found.
    pub confidence: Option<f64>,
    /// Why no camera was found; None where one was.
    pub reason: Option<String>,
}

#[pymethods]
impl Answer {
    /// The camera; None where none was found.
    #[getter]
    fn camera(&self) -> Option<PyCamera> {
        self.solution
            .as_ref()
            .map(|solution| solution.get().camera.clone())
    }

    fn __repr__(&self) -> String {
        match (&self.reason, self.confidence) {
            (None, Some(confidence)) => {
                format!("<touchline.Answer with confidence {confidence:.3}>")
            }
            (reason, _) => format!(
                "<touchline.Answer without a camera: {}>",
                reason.as_deref().unwrap_or_default()
            ),
        }
    }
}

/// The answer of a forest for the last frame of a document; `picture` is that of the frame.
fn answer(
    mut document: Document,
    picture: Picture,
    request: &ForestRequest<'_>,
    snap: bool,
) -> Result<Answer, String> {
    // `relocalize` has appended a frame, so that there is one.
    let last = document.frames.len() - 1;
    let store = FeatureStore::in_memory();
    let files = PictureFiles {
        folder: Path::new(""),
        store: &store,
    };
    let mut reader = OnePicture(picture);
    let progress = Progress::new(|_: usize| ControlFlow::Continue(()));
    let proposals = label_frames(
        &mut document,
        files,
        &mut reader,
        &[last],
        request,
        snap,
        &progress,
    );
    let proposals = proposals.map_err(|error| error.to_string())?;
    let reason = proposals
        .first()
        .and_then(|proposal| proposal.outcome.as_ref().err());
    let frame = &document.frames[last];
    let solved = document.ptz_camera(frame).zip(frame.solution.as_ref());
    // A frame with a reason got no camera, whatever the document states.
    let (Some((camera, solution)), None) = (solved, reason) else {
        let reason = reason.map_or_else(|| "no camera was found".to_owned(), ToString::to_string);
        return Ok(Answer {
            solution: None,
            confidence: None,
            reason: Some(reason),
        });
    };
    let confidence = solution.confidence;
    let solution = PySolution::without_clicks(
        PyCamera::new(&camera, frame.image_size),
        solution
            .covariance
            // NaN says that nothing is stated; zeros would say that the camera is exact.
            .unwrap_or_else(|| Mat3::repeat(f64::NAN)),
        solution.rms_px.unwrap_or(f64::NAN),
        solution.worst_corner_sigma_px.unwrap_or(f64::NAN),
    );
    let solution = Python::attach(|py| Py::new(py, solution)).map_err(|error| error.to_string())?;
    Ok(Answer {
        solution: Some(solution),
        confidence,
        reason: None,
    })
}
