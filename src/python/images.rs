//! Pictures as NumPy arrays, and frames that Python decodes itself.

use crate::arrays::array;
use numpy::{PyArrayDyn, PyArrayMethods, PyUntypedArrayMethods};
use pyo3::exceptions::{PyTypeError, PyValueError};
use pyo3::intern;
use pyo3::prelude::*;
use std::sync::{Arc, Mutex, PoisonError};
use touchline_core::geometry::ImageSize;
use touchline_vision::media::{FrameRef, MediaError, Picture, ReadFrames, Video, load_image};

/// The bytes of a pixel of an array, and of a [`Picture`].
const RGB: usize = 3;
const RGBA: usize = 4;

/// A picture from an array of shape (height, width, 3) and type uint8; blue comes first with `bgr`.
///
/// # Errors
/// Another shape or type.
pub fn picture(image: &Bound<'_, PyAny>, bgr: bool) -> PyResult<Picture> {
    let py = image.py();
    let numpy = py.import(intern!(py, "numpy"))?;
    let given = numpy
        .call_method1(intern!(py, "asarray"), (image,))
        .map_err(|_| wrong_image("something else"))?;
    let found = format!(
        "shape {} and dtype {}",
        given.getattr(intern!(py, "shape"))?,
        given.getattr(intern!(py, "dtype"))?
    );
    // Rows that are cut out of a larger picture, or upside down, are copied here.
    let bytes = numpy.call_method1(intern!(py, "ascontiguousarray"), (given,))?;
    let bytes = bytes
        .cast_into::<PyArrayDyn<u8>>()
        .map_err(|_| wrong_image(&found))?;
    // OpenCV's arrays of grey pictures have two dimensions, those with alpha four channels:
    // refused, for a guess would take wrong colours.
    let &[height, width, RGB] = bytes.shape() else {
        return Err(wrong_image(&found));
    };
    let size = sides(width, height)?;
    let bytes = bytes
        .try_readonly()
        .map_err(|_| PyValueError::new_err("image: the array is being written by another call"))?;
    let bytes = bytes
        .as_slice()
        .map_err(|_| wrong_image("an array that is not contiguous"))?;
    // The array is read without the interpreter's lock, under pyo3's own lock against writing.
    let rgba = py.detach(|| with_alpha(bytes, bgr));
    Picture::new(size, rgba).map_err(|error| PyValueError::new_err(error.to_string()))
}

/// The exception for something that is no picture.
fn wrong_image(found: &str) -> PyErr {
    PyTypeError::new_err(format!(
        "image: an array of shape (height, width, 3) and dtype uint8 is needed, not {found}"
    ))
}

/// The size of a picture by its columns and rows.
fn sides(width: usize, height: usize) -> PyResult<ImageSize> {
    let most = ImageSize::MAX_SIDE_PX;
    match (u32::try_from(width), u32::try_from(height)) {
        (Ok(width @ 1..=ImageSize::MAX_SIDE_PX), Ok(height @ 1..=ImageSize::MAX_SIDE_PX)) => {
            Ok(ImageSize::new(width, height))
        }
        _ => Err(PyValueError::new_err(format!(
            "image: a picture of {width} x {height} px; sides from 1 to {most} px are read"
        ))),
    }
}

/// Pixels of four bytes from those of three.
fn with_alpha(bytes: &[u8], bgr: bool) -> Vec<u8> {
    let mut rgba = Vec::with_capacity(bytes.len() / RGB * RGBA);
    for pixel in bytes.chunks_exact(RGB) {
        let [red, blue] = if bgr {
            [pixel[2], pixel[0]]
        } else {
            [pixel[0], pixel[2]]
        };
        rgba.extend([red, pixel[1], blue, u8::MAX]);
    }
    rgba
}

/// A picture as an array of shape (height, width, 3), uint8; blue comes first with `bgr`.
///
/// # Errors
/// None that can occur.
pub fn picture_array<'py>(
    py: Python<'py>,
    picture: &Picture,
    bgr: bool,
) -> PyResult<Bound<'py, PyAny>> {
    let order = if bgr { [2, 1, 0] } else { [0, 1, 2] };
    let pixels = py.detach(|| {
        picture
            .rgba()
            .chunks_exact(RGBA)
            .flat_map(|pixel| order.map(|at| pixel[at]))
            .collect()
    });
    let ImageSize { width, height } = picture.size();
    Ok(array(py, [height as usize, width as usize, RGB], pixels)?.into_any())
}

/// The first exception that Python raised on another thread.
#[derive(Default)]
pub struct Raised(Mutex<Option<PyErr>>);

impl Raised {
    /// Keeps an exception, unless there is one.
    fn keep(&self, error: PyErr) {
        let mut kept = self.0.lock().unwrap_or_else(PoisonError::into_inner);
        // The first exception is the cause; later ones may follow from it.
        kept.get_or_insert(error);
    }

    /// Whether there is one.
    pub fn is_some(&self) -> bool {
        let kept = self.0.lock().unwrap_or_else(PoisonError::into_inner);
        kept.is_some()
    }

    /// The exception as a result.
    ///
    /// # Errors
    /// There is one.
    pub fn raise(&self) -> PyResult<()> {
        let mut kept = self.0.lock().unwrap_or_else(PoisonError::into_inner);
        kept.take().map_or(Ok(()), Err)
    }
}

/// A sequence of Python's that gives the frames of a video by their index.
pub struct DecodedFrames {
    frames: Py<PyAny>,
    bgr: bool,
    /// What the sequence raised: a missing picture would only be left out.
    pub raised: Arc<Raised>,
}

impl DecodedFrames {
    /// Reads frames from a sequence: `len(frames)` and `frames[index]`.
    pub fn new(frames: Py<PyAny>, bgr: bool) -> Self {
        Self {
            frames,
            bgr,
            raised: Arc::default(),
        }
    }

    /// The frame at an index.
    ///
    /// # Errors
    /// The sequence raises something, or gives no picture.
    pub fn frame(&self, py: Python<'_>, index: usize) -> PyResult<Picture> {
        picture(&self.frames.bind(py).get_item(index)?, self.bgr)
    }
}

impl ReadFrames for DecodedFrames {
    fn read(&mut self, frame: &FrameRef) -> Result<Picture, MediaError> {
        let index = match frame {
            FrameRef::Video { index, .. } => *index,
            // A document of a sequence has frames of a video alone (`document_of_sequence`).
            FrameRef::Image(_) => 0,
        };
        // The work runs on another thread and takes the interpreter's lock for this frame alone.
        let read = Python::attach(|py| self.frame(py, index));
        read.map_err(|error| {
            let reason = error.to_string();
            self.raised.keep(error);
            MediaError::ReaderFailed {
                path: frame.path().to_path_buf(),
                reader: format!("frames[{index}]"),
                reason,
            }
        })
    }
}

/// One picture, for any frame.
pub struct OnePicture(pub Picture);

impl ReadFrames for OnePicture {
    fn read(&mut self, _frame: &FrameRef) -> Result<Picture, MediaError> {
        Ok(self.0.clone())
    }
}

/// Reads frames and keeps the last video open, for frames that are read one by one.
#[derive(Default)]
pub struct KeptVideo(Option<Video>);

impl ReadFrames for KeptVideo {
    fn read(&mut self, frame: &FrameRef) -> Result<Picture, MediaError> {
        let (path, index) = match frame {
            FrameRef::Image(path) => return load_image(path),
            FrameRef::Video { path, index } => (path, *index),
        };
        // Another video takes the place of the one that is open. A failure leaves none open, so
        // that a decoder in an unknown state is not used again.
        let kept = self.0.take().filter(|video| video.info().path == *path);
        let video = match kept {
            Some(video) => video,
            None => Video::open(path)?,
        };
        self.0.insert(video).frame(index)
    }
}
