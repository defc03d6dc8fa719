//! The frames of a document as columns.

use crate::arrays::{array, row_by_row};
use crate::camera::{image_from_ground, pinhole};
use crate::errors::without_panic;
use crate::json;
use crate::progress::threads;
use numpy::Element;
use numpy::ndarray::IntoDimension;
use pyo3::exceptions::{PyIndexError, PyValueError};
use pyo3::intern;
use pyo3::prelude::*;
use pyo3::types::{PyDict, PyList};
use rayon::prelude::*;
use std::path::PathBuf;
use touchline_core::camera::PtzCamera;
use touchline_core::geometry::Mat3;
use touchline_documents::document::{Clip, Document, Frame, FramePtz, Frames, Target};

/// The frames of a document at the time of the access: arrays with one entry a frame.
///
/// Floating-point arrays hold NaN where a frame is unsolved (see `solved`). Every access computes
/// its array anew: keep it. Frames are changed through the document.
#[pyclass(module = "touchline", frozen, name = "Frames")]
pub struct PyFrames {
    document: Document,
    folder: PathBuf,
}

impl PyFrames {
    /// The frames of a document; they share its memory.
    pub const fn new(document: Document, folder: PathBuf) -> Self {
        Self { document, folder }
    }

    /// `N` numbers of each frame, in parallel.
    fn column<'py, const N: usize, D: numpy::ndarray::Dimension>(
        &self,
        py: Python<'py>,
        shape: impl IntoDimension<Dim = D>,
        row: impl Fn(&Document, &Frame) -> [f64; N] + Send + Sync,
    ) -> PyResult<Bound<'py, PyAny>> {
        let document = &self.document;
        // On the module's own threads: rayon's global ones do not exist in a process that was
        // forked. The lock of the interpreter is released, for documents are never changed in
        // place.
        let pool = threads()?;
        let compute = || pool.install(|| column(document, row));
        let numbers = without_panic(|| Ok(py.detach(compute)))?;
        Ok(array(py, shape, numbers)?.into_any())
    }

    /// One value of each frame.
    fn values<'py, T: Element>(
        &self,
        py: Python<'py>,
        value: impl Fn(&Frame) -> T,
    ) -> PyResult<Bound<'py, PyAny>> {
        let values: Vec<T> = self
            .document
            .frames
            .iter()
            .map(|frame| value(frame))
            .collect();
        Ok(array(py, [values.len()], values)?.into_any())
    }

    /// One text of each frame, as an array of strings.
    fn texts<'py>(
        &self,
        py: Python<'py>,
        text: impl Fn(&Frame) -> &str,
    ) -> PyResult<Bound<'py, PyAny>> {
        texts(py, self.document.frames.iter().map(|frame| text(frame)))
    }
}

/// Numbers of each frame behind each other.
fn column<const N: usize>(
    document: &Document,
    row: impl Fn(&Document, &Frame) -> [f64; N] + Send + Sync,
) -> Vec<f64> {
    let rows = document.frames.par_iter().map(|frame| row(document, frame));
    rows.collect::<Vec<[f64; N]>>().into_flattened()
}

/// An array of strings.
fn texts<'a, 'py>(
    py: Python<'py>,
    texts: impl Iterator<Item = &'a str>,
) -> PyResult<Bound<'py, PyAny>> {
    // NumPy finds the length of the longest text; `U` also makes an empty array one of texts.
    let texts = PyList::new(py, texts.collect::<Vec<_>>())?;
    let options = PyDict::new(py);
    options.set_item(intern!(py, "dtype"), intern!(py, "U"))?;
    py.import(intern!(py, "numpy"))?
        .call_method(intern!(py, "array"), (texts,), Some(&options))
}

/// Numbers of the camera of a frame; NaN where it is unsolved.
fn camera_numbers<const N: usize>(
    document: &Document,
    frame: &Frame,
    numbers: impl Fn(&PtzCamera) -> [f64; N],
) -> [f64; N] {
    document
        .ptz_camera(frame)
        .as_ref()
        .map_or([f64::NAN; N], numbers)
}

/// The covariance of a frame's solution, where it is stated.
fn covariance(frame: &Frame) -> Option<&Mat3> {
    frame.solution.as_ref()?.covariance.as_ref()
}

/// A number of a frame's solution; NaN where it is not stated.
fn or_nan(number: Option<f64>) -> [f64; 1] {
    [number.unwrap_or(f64::NAN)]
}

/// Pan, tilt and focal length as the document states them; NaN where a frame is unsolved.
fn ptz_or_nan(ptz: Option<&FramePtz>) -> [f64; 3] {
    ptz.map_or([f64::NAN; 3], |ptz| {
        [ptz.pan_deg, ptz.tilt_deg, ptz.focal_px]
    })
}

/// 1-σ of pan, tilt and focal length.
fn sigmas(covariance: &Mat3) -> [f64; 3] {
    [0, 1, 2].map(|index| covariance[(index, index)].sqrt())
}

#[pymethods]
impl PyFrames {
    fn __len__(&self) -> usize {
        self.document.frames.len()
    }

    /// A frame by its position, as a dict with the keys of the document's schema.
    fn __getitem__<'py>(&self, py: Python<'py>, index: isize) -> PyResult<Bound<'py, PyAny>> {
        let index = position(&self.document.frames, index)?;
        json::to_python(py, &*self.document.frames[index])
    }

    /// The ids, (N,) of str.
    #[getter]
    fn id<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyAny>> {
        self.texts(py, |frame| frame.id.as_str())
    }

    /// The names of the cameras, (N,) of str.
    #[getter]
    fn camera<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyAny>> {
        self.texts(py, |frame| frame.camera.as_str())
    }

    /// The statuses, (N,) of str: new, draft, suggested, reference, rejected.
    #[getter]
    fn status<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyAny>> {
        self.texts(py, |frame| frame.status.as_str())
    }

    /// Whether a frame has a camera, (N,) of bool.
    #[getter(solved)]
    fn is_solved<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyAny>> {
        self.values(py, |frame| self.document.ptz_camera(frame).is_some())
    }

    /// Columns and rows of the pictures, (N, 2), px.
    #[getter]
    fn image_size_px<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyAny>> {
        let frames = self.document.frames.iter();
        let sizes: Vec<u32> = frames
            .flat_map(|frame| <[u32; 2]>::from(frame.image_size))
            .collect();
        Ok(array(py, [sizes.len() / 2, 2], sizes)?.into_any())
    }

    /// The rotations from `world` to `cam`, (N, 3, 3).
    #[getter(R)]
    fn rotation<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyAny>> {
        self.column(py, [self.__len__(), 3, 3], |document, frame| {
            camera_numbers(document, frame, |camera| {
                row_by_row(&camera.cam_from_world())
            })
        })
    }

    /// The centres of projection in `world`, (N, 3), m.
    #[getter(C)]
    fn centre<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyAny>> {
        self.column(py, [self.__len__(), 3], |document, frame| {
            camera_numbers(document, frame, |camera| camera.base().position_m.into())
        })
    }

    /// The matrices of the pinholes, (N, 3, 3), px.
    #[getter(K)]
    fn pinhole<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyAny>> {
        self.column(py, [self.__len__(), 3, 3], |document, frame| {
            camera_numbers(document, frame, |camera| row_by_row(&pinhole(camera)))
        })
    }

    /// OpenCV's coefficients k1, k2, p1, p2, k3, (N, 5).
    #[getter]
    fn dist<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyAny>> {
        self.column(py, [self.__len__(), 5], |document, frame| {
            camera_numbers(document, frame, |camera| {
                // OpenCV's order is k1, k2, p1, p2, k3. The model has no tangential terms and none
                // of the sixth order.
                [camera.lens().k1, camera.lens().k2, 0.0, 0.0, 0.0]
            })
        })
    }

    /// The homographies from the plane z = 0 (m) to the picture (px), (N, 3, 3), as `homography`.
    #[getter(H)]
    fn homography<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyAny>> {
        self.column(py, [self.__len__(), 3, 3], |document, frame| {
            camera_numbers(document, frame, |camera| {
                row_by_row(&image_from_ground(camera))
            })
        })
    }

    /// Pan and tilt in degrees and the focal length in px, (N, 3).
    #[getter]
    fn ptz<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyAny>> {
        self.column(py, [self.__len__(), 3], |_, frame| {
            ptz_or_nan(frame.ptz.as_ref())
        })
    }

    /// 1-σ of `ptz`, (N, 3); NaN also where none is stated.
    #[getter]
    fn sigma<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyAny>> {
        self.column(py, [self.__len__(), 3], |_, frame| {
            covariance(frame).map_or([f64::NAN; 3], sigmas)
        })
    }

    /// Covariances of `ptz`, (N, 3, 3); NaN also where none is stated.
    #[getter]
    fn covariance<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyAny>> {
        self.column(py, [self.__len__(), 3, 3], |_, frame| {
            covariance(frame).map_or([f64::NAN; 9], row_by_row)
        })
    }

    /// The probability that an overlay is right within 10 px at 1920 px width, (N,); NaN where none
    /// is stated.
    #[getter]
    fn confidence<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyAny>> {
        self.column(py, [self.__len__()], |_, frame| or_nan(frame.confidence()))
    }

    /// Root mean square of the residuals, (N,), px; NaN where none is stated.
    #[getter]
    fn rms_px<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyAny>> {
        self.column(py, [self.__len__()], |_, frame| {
            or_nan(frame.solution.as_ref().and_then(|solution| solution.rms_px))
        })
    }

    /// What the cameras are good for on the ground, as a dict of columns: `grade` (N,) of str:
    /// speed, map, none ("" where a frame has no camera), `sigma_m` (N,), 1-σ of a place on the
    /// field in the picture's middle third, NaN where none is stated, and `visible_area_m`, a list
    /// of (M, 2) corners of the part of the field in each picture.
    #[getter]
    fn ground<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyDict>> {
        let pool = threads()?;
        let at = self.document.at(&self.folder);
        let compute = || pool.install(|| at.ground_of_frames());
        let grounds = without_panic(|| {
            py.detach(compute)
                .map_err(|error| PyValueError::new_err(error.to_string()))
        })?;
        let known = || grounds.iter().map(Option::as_ref);
        let sigmas = known().map(|ground| ground.and_then(|ground| ground.sigma_m));
        let areas = known().map(|ground| {
            let corners = ground.map_or(&[][..], |ground| &ground.visible_area_m);
            array(py, [corners.len(), 2], corners.as_flattened().to_vec())
        });
        let columns = PyDict::new(py);
        let grades = known().map(|ground| ground.map_or("", |ground| ground.grade.as_str()));
        columns.set_item("grade", texts(py, grades)?)?;
        let sigmas = sigmas.flat_map(or_nan).collect();
        columns.set_item("sigma_m", array(py, [grounds.len()], sigmas)?)?;
        columns.set_item("visible_area_m", areas.collect::<PyResult<Vec<_>>>()?)?;
        Ok(columns)
    }

    /// All clicks as a dict of columns: `frame` (M,) positions of their frames, `name` (M,) of str
    /// ("" where a click has no name), `is_line` (M,) of bool, `image_px` (M, 2), `check` (M,) of
    /// bool.
    #[getter]
    fn clicks<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyDict>> {
        let clicks = || {
            let frames = self.document.frames.iter().enumerate();
            frames.flat_map(|(index, frame)| frame.clicks.iter().map(move |click| (index, click)))
        };
        let indices: Vec<i64> = clicks().map(|(index, _)| index as i64).collect();
        let names = clicks().map(|(_, click)| click.target.as_ref().map_or("", Target::as_str));
        let are_lines: Vec<bool> = clicks()
            .map(|(_, click)| matches!(click.target, Some(Target::Line(_))))
            .collect();
        let pixels: Vec<f64> = clicks()
            .flat_map(|(_, click)| [click.image.x, click.image.y])
            .collect();
        let checks: Vec<bool> = clicks().map(|(_, click)| click.check).collect();
        // Each column walks the clicks anew, which costs less than rows that NumPy would have to
        // split.
        let count = indices.len();
        let columns = PyDict::new(py);
        columns.set_item("frame", array(py, [count], indices)?)?;
        columns.set_item("name", texts(py, names)?)?;
        columns.set_item("is_line", array(py, [count], are_lines)?)?;
        columns.set_item("image_px", array(py, [count, 2], pixels)?)?;
        columns.set_item("check", array(py, [count], checks)?)?;
        Ok(columns)
    }

    /// Where the pictures are, as a dict of columns: `image` and `video` lists of paths or None,
    /// `frame_index` (N,), −1 where it is no frame of a video, `pts_s` (N,), NaN where it is not
    /// stated, and `clip`, a list of numbers, names or None.
    #[getter]
    fn pictures<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyDict>> {
        let frames = || self.document.frames.iter();
        let videos = || frames().map(|frame| frame.video.as_ref());
        let images: Vec<Option<&str>> = frames().map(|frame| frame.image.as_deref()).collect();
        let paths: Vec<Option<&str>> = videos().map(|video| Some(&*video?.path)).collect();
        let clips: Vec<Option<&Clip>> = frames().map(|frame| frame.clip.as_ref()).collect();
        let indices = videos().map(|video| video.map_or(-1, |video| video.frame_index as i64));
        let times = videos().map(|video| video.and_then(|video| video.pts_s).unwrap_or(f64::NAN));
        let count = images.len();
        let columns = PyDict::new(py);
        columns.set_item("image", images)?;
        columns.set_item("video", paths)?;
        columns.set_item("frame_index", array(py, [count], indices.collect())?)?;
        columns.set_item("pts_s", array(py, [count], times.collect())?)?;
        columns.set_item("clip", json::to_python(py, &clips)?)?;
        Ok(columns)
    }

    fn __repr__(&self) -> String {
        format!("<touchline.Frames of {} frames>", self.__len__())
    }
}

/// A position counted as Python does, from the end where it is negative.
pub fn position(frames: &Frames, index: isize) -> PyResult<usize> {
    let count = frames.len();
    // Python counts −1 as the last. A number beyond either end is out of range below.
    let from_start = if index < 0 {
        index + count as isize
    } else {
        index
    };
    usize::try_from(from_start)
        .ok()
        .filter(|index| *index < count)
        .ok_or_else(|| {
            PyIndexError::new_err(format!("frame {index}: the document has {count} frames"))
        })
}
