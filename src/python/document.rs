//! A document in Python.

use crate::camera::{PyBase, PyCamera};
use crate::errors::{Error, exists, failure, without_panic};
use crate::field::PyField;
use crate::frames::{PyFrames, position};
use crate::images::{KeptVideo, picture_array};
use crate::json;
use crate::progress::{self, Steps};
use pyo3::exceptions::{PyKeyError, PyTypeError, PyValueError};
use pyo3::intern;
use pyo3::prelude::*;
use std::path::{Path, PathBuf};
use std::sync::{Mutex, PoisonError};
use touchline_calibration::proposals::read_picture;
use touchline_core::geometry::{ImageSize, PixelBox};
use touchline_documents::document::{
    Camera, CameraId, Click, Document, Frame, FrameId, FrameStatus, MAX_CLICKS, RejectReason,
    Target, VideoFrame, document_from_bytes, document_to_string, resolve_path,
};
use touchline_documents::store::{self, FilesRead, Location, StoreError};

/// A project or dataset: a field, cameras, frames. Read it with `load`.
///
/// `document[index]` and `document["id"]` are frames as dicts with the keys of the document's
/// schema. What is changed is on disk after `save`.
#[pyclass(module = "touchline", name = "Document")]
pub struct PyDocument {
    pub document: Document,
    /// As it was read or last saved: frames that differ count as edited when it is saved.
    before: Document,
    pub folder: PathBuf,
    file: Option<PathBuf>,
    /// What its files held when it was read or last saved.
    files: Option<FilesRead>,
    reader: Mutex<KeptVideo>,
}

/// What the files of a document hold; none where they cannot be read.
fn files_now(path: &Path) -> Option<FilesRead> {
    FilesRead::now(&Location::find(path).ok()?).ok()
}

/// Reads a document: a project folder, its `project.json`, or a dataset file. Edits in its journal
/// are included, with a warning that says so; nothing is written.
#[pyfunction]
pub fn load(py: Python<'_>, path: PathBuf) -> PyResult<PyDocument> {
    let read = progress::run(py, None, move |steps| read(&path, steps))?;
    let (location, document, files) = read.map_err(failure)?;
    let file = Some(location.file().to_path_buf());
    Ok(PyDocument {
        files: Some(files),
        ..PyDocument::new(document, location.folder().to_path_buf(), file)
    })
}

/// Reads a document, and notes what was recovered from its journal. Returns what its files held as
/// well, by which `save` notices what other programs write meanwhile.
fn read(path: &Path, steps: &Steps) -> Result<(Location, Document, FilesRead), StoreError> {
    let (location, document, recovery, files) = store::read_with_state(path)?;
    if let Some(message) = recovery.message() {
        steps.note(message);
    }
    Ok((location, document, files))
}

/// A frame of a video by its index.
pub fn video_frame(name: &str, index: usize, camera: &CameraId, size: ImageSize) -> Frame {
    Frame::from_video(
        VideoFrame::new(name, index as u64, None),
        camera.clone(),
        size,
    )
}

impl PyDocument {
    /// A document whose relative paths start from a folder.
    pub fn new(document: Document, folder: PathBuf, file: Option<PathBuf>) -> Self {
        Self {
            before: document.clone(),
            document,
            folder,
            files: file.as_deref().and_then(files_now),
            file,
            reader: Mutex::default(),
        }
    }

    /// A copy for a function to change, and the folder that its paths start from. It shares what is
    /// not changed.
    pub fn copy(&self) -> (Document, PathBuf) {
        (self.document.clone(), self.folder.clone())
    }

    /// The position of the frame that Python names: by its position or its id.
    pub fn position(&self, frame: &Bound<'_, PyAny>) -> PyResult<usize> {
        // Positions first: an id is a text, which is never extracted as a number.
        if let Ok(index) = frame.extract::<isize>() {
            return position(&self.document.frames, index);
        }
        let id: String = frame
            .extract()
            .map_err(|_| PyTypeError::new_err("frame: a position or an id is needed"))?;
        let found = self.document.frames.position_of(&FrameId::from(&*id));
        found.ok_or_else(|| {
            PyKeyError::new_err(format!(
                "frame {id:?}: the document has no frame of this id"
            ))
        })
    }

    fn frame(&self, frame: &Bound<'_, PyAny>) -> PyResult<&Frame> {
        let index = self.position(frame)?;
        Ok(&self.document.frames[index])
    }

    /// The camera of this name; without a name the first.
    fn camera_by_name(&self, id: Option<&str>) -> PyResult<&Camera> {
        let found = match id {
            Some(id) => self.document.camera(&CameraId::from(id)),
            None => self.document.cameras.first().map(|camera| &**camera),
        };
        found.ok_or_else(|| {
            PyKeyError::new_err(format!(
                "camera {:?}: the document has no such camera",
                id.unwrap_or_default()
            ))
        })
    }

    /// Writes the document to `path`; paths in it are rewritten for there. A document of no file
    /// then belongs to that one.
    fn write(&mut self, path: &Path, overwrite: bool) -> PyResult<()> {
        // Frames that differ from the last saved state count as edited once. The copy with these
        // counts becomes the document's state only after it is written.
        let location = Location::for_new_document(path).map_err(failure)?;
        let mut document = self.document.clone();
        document.count_edits_since(&self.before);
        let written = document.clone().relocate(&self.folder, location.folder());
        if let Some(path) = written.unwritable_path(location.folder()) {
            return Err(Error::new_err(format!(
                "{path}: a document cannot name it, for a folder's name in it is not UTF-8; \
                 rename the folder"
            )));
        }
        let is_own = self.file.as_deref() == Some(location.file());
        // The own file is written as long as it is the one that was read; any other, or one that
        // another program changed, is replaced.
        let written_back = self
            .files
            .as_ref()
            .filter(|_| is_own)
            .map(|files| files.write_back(&location, &written));
        let files = match written_back {
            Some(Err(StoreError::ChangedOutside { .. })) if overwrite => None,
            Some(written) => Some(written.map_err(failure)?),
            None => None,
        };
        let files = match files {
            Some(files) => Some(files),
            None => store::write_document(&location, &written, overwrite)
                .map(|()| FilesRead::now(&location).ok())
                .map_err(failure)?,
        };
        // A document of no file moves to the first one. A copy elsewhere changes neither place nor
        // paths.
        if self.file.is_none() {
            self.file = Some(location.file().to_path_buf());
            self.folder = location.folder().to_path_buf();
            document = written;
        }
        // A copy elsewhere says nothing of the document's own file.
        if self.file.as_deref() == Some(location.file()) {
            self.files = files;
        }
        self.before = document.clone();
        self.document = document;
        Ok(())
    }
}

/// Whether a folder exists and is empty; it counts as absent.
fn is_empty_folder(path: &Path) -> bool {
    path.read_dir()
        .is_ok_and(|mut entries| entries.next().is_none())
}

#[pymethods]
impl PyDocument {
    /// A document from the text of its JSON; relative paths start from `folder`, by default the
    /// working folder.
    #[staticmethod]
    #[pyo3(signature = (text, folder = None))]
    fn from_json(text: &str, folder: Option<PathBuf>) -> PyResult<Self> {
        // As that of a file: paths are rewritten for another folder by their names alone.
        let folder = resolve_path(&folder.unwrap_or_else(|| PathBuf::from(".")));
        without_panic(|| {
            let document = document_from_bytes(text.as_bytes()).map_err(failure)?;
            Ok(Self::new(document, folder, None))
        })
    }

    /// The text of its JSON, with paths as they start from its folder.
    fn to_json(&self) -> PyResult<String> {
        without_panic(|| document_to_string(&self.document).map_err(failure))
    }

    /// Writes the document: to a file, or a folder for a project. Without a path to where it was
    /// read or first saved; a project keeps what it replaces as `project.json.bak`. What exists
    /// elsewhere, or was changed by another program meanwhile, is replaced only with
    /// `overwrite=True`.
    #[pyo3(signature = (path = None, overwrite = false))]
    fn save(&mut self, path: Option<PathBuf>, overwrite: bool) -> PyResult<()> {
        if let Some(path) = path {
            if !overwrite && path.exists() && !is_empty_folder(&path) {
                return Err(exists(&path));
            }
            return without_panic(|| self.write(&path, overwrite));
        }
        let Some(path) = self.file.clone() else {
            return Err(PyValueError::new_err(
                "path: the document was not read from a file; say where to save it",
            ));
        };
        without_panic(|| self.write(&path, overwrite))
    }

    /// The file that it was read from, or first saved to.
    #[getter]
    fn path(&self) -> Option<&Path> {
        self.file.as_deref()
    }

    /// The frames as they are now, as columns.
    #[getter]
    fn frames(&self) -> PyFrames {
        PyFrames::new(self.document.clone(), self.folder.clone())
    }

    /// The cameras as dicts with the keys of the document's schema.
    #[getter]
    fn cameras<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyAny>> {
        let cameras: Vec<&Camera> = self
            .document
            .cameras
            .iter()
            .map(|camera| &**camera)
            .collect();
        json::to_python(py, &cameras)
    }

    /// The field, unless a camera has its own.
    #[getter]
    fn field(&self) -> PyResult<PyField> {
        without_panic(|| PyField::from_spec(&self.document.field, &self.folder))
    }

    /// The field that a frame shows.
    fn field_of(&self, frame: &Bound<'_, PyAny>) -> PyResult<PyField> {
        let spec = self.document.field_of(self.frame(frame)?);
        without_panic(|| PyField::from_spec(spec, &self.folder))
    }

    /// The base of a camera, by default the first one's; None where it is not known yet.
    #[pyo3(signature = (camera = None))]
    fn base(&self, camera: Option<&str>) -> PyResult<Option<PyBase>> {
        let camera = self.camera_by_name(camera)?;
        let image_size = camera.image_size;
        Ok(camera.base().map(|base| PyBase { base, image_size }))
    }

    /// The camera of a frame; None where it is unsolved.
    fn camera(&self, frame: &Bound<'_, PyAny>) -> PyResult<Option<PyCamera>> {
        let frame = self.frame(frame)?;
        let camera = self.document.ptz_camera(frame);
        Ok(camera.map(|camera| PyCamera::new(&camera, frame.image_size)))
    }

    /// The picture of a frame: (height, width, 3), uint8, red first, or blue with `bgr`.
    #[pyo3(signature = (frame, bgr = false))]
    fn image<'py>(
        &self,
        py: Python<'py>,
        frame: &Bound<'py, PyAny>,
        bgr: bool,
    ) -> PyResult<Bound<'py, PyAny>> {
        let frame = self.frame(frame)?;
        let picture = progress::run(py, None, |_| {
            // The video stays open between calls, so that frames in order are read without seeking.
            let mut reader = self.reader.lock().unwrap_or_else(PoisonError::into_inner);
            read_picture(&mut *reader, frame, &self.folder)
        })?;
        picture_array(py, &picture.map_err(failure)?, bgr)
    }

    /// Sets the clicks of a frame: dicts with `landmark` or `line`, `image_px`, and `check=True`
    /// for one that is held out. The frame keeps its camera until it is solved again.
    fn set_clicks(&mut self, frame: &Bound<'_, PyAny>, clicks: &Bound<'_, PyAny>) -> PyResult<()> {
        let index = self.position(frame)?;
        let clicks: Vec<Click> = json::from_python(clicks, "clicks")?;
        // All clicks are checked before the first is set.
        self.check_clicks(&self.document.frames[index], &clicks)?;
        self.document.frames[index].clicks = clicks;
        Ok(())
    }

    /// Sets the masks of a frame: boxes (x, y, width, height), px, an array of shape (M, 4). Their
    /// pixels give no features.
    fn set_masks(&mut self, frame: &Bound<'_, PyAny>, masks_px: &Bound<'_, PyAny>) -> PyResult<()> {
        let index = self.position(frame)?;
        let boxes: Vec<[f64; 4]> = json::from_python(masks_px, "masks_px")?;
        self.document.frames[index].masks = boxes.into_iter().map(mask).collect::<PyResult<_>>()?;
        Ok(())
    }

    /// Sets the status of a frame: new, draft, suggested, reference, or rejected with a `reason`
    /// (`close_up`, `replay`, `other_camera`, `graphic`, `blur`, `too_little_field`).
    #[pyo3(signature = (frame, status, reason = None))]
    fn set_status(
        &mut self,
        frame: &Bound<'_, PyAny>,
        status: &Bound<'_, PyAny>,
        reason: Option<&Bound<'_, PyAny>>,
    ) -> PyResult<()> {
        let index = self.position(frame)?;
        let status: FrameStatus = json::from_python(status, "status")?;
        let reason: Option<RejectReason> = reason
            .map(|reason| json::from_python(reason, "reason"))
            .transpose()?;
        if reason.is_some() && status != FrameStatus::Rejected {
            return Err(PyValueError::new_err(
                "reason: only a rejected frame has one",
            ));
        }
        let frame = &mut self.document.frames[index];
        (frame.status, frame.reason) = (status, reason);
        Ok(())
    }

    /// The frames as a pandas `DataFrame`, one row each; pandas is imported here.
    fn to_dataframe<'py>(slf: &Bound<'py, Self>) -> PyResult<Bound<'py, PyAny>> {
        let py = slf.py();
        py.import(intern!(py, "touchline.interchange"))?
            .call_method1(intern!(py, "to_dataframe"), (slf,))
    }

    fn __len__(&self) -> usize {
        self.document.frames.len()
    }

    fn __getitem__<'py>(
        &self,
        py: Python<'py>,
        frame: &Bound<'py, PyAny>,
    ) -> PyResult<Bound<'py, PyAny>> {
        json::to_python(py, self.frame(frame)?)
    }

    fn __repr__(&self) -> String {
        let place = self
            .file
            .as_ref()
            .map_or_else(|| "not saved".to_owned(), |file| file.display().to_string());
        format!(
            "<touchline.Document of {} frames, {place}>",
            self.document.frames.len()
        )
    }
}

impl PyDocument {
    /// Refuses more clicks than a frame may have, and names that the field lacks.
    fn check_clicks(&self, frame: &Frame, clicks: &[Click]) -> PyResult<()> {
        if clicks.len() > MAX_CLICKS {
            return Err(PyValueError::new_err(format!(
                "clicks: {} in a frame, and {MAX_CLICKS} are the most",
                clicks.len()
            )));
        }
        let field = PyField::from_spec(self.document.field_of(frame), &self.folder)?.model;
        for click in clicks {
            let target = click.target.as_ref();
            if let Some(unknown) = target.filter(|target| target.element(&field).is_none()) {
                return Err(unknown_name(unknown, &field.template));
            }
        }
        Ok(())
    }
}

/// The exception for a name that a field lacks.
pub fn unknown_name(target: &Target, template: &str) -> PyErr {
    let kind = match target {
        Target::Landmark(_) => "landmark",
        Target::Line(_) => "line",
    };
    PyValueError::new_err(format!(
        "clicks: the field {template} has no {kind} {:?}",
        target.as_str()
    ))
}

/// A mask from its numbers.
fn mask([x, y, width, height]: [f64; 4]) -> PyResult<PixelBox> {
    // NaN fails the comparison as well; infinite numbers are refused by `json::from_python`.
    if width > 0.0 && height > 0.0 {
        return Ok(PixelBox::new(x, y, width, height));
    }
    Err(PyValueError::new_err(format!(
        "masks_px: a box of {width} x {height} px; both sides must be positive"
    )))
}
