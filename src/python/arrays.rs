//! NumPy arrays in and out.
//!
//! Whatever NumPy makes an array of numbers from is taken. An array of 64-bit numbers that is
//! contiguous is read in place, any other one is copied; what is returned is not copied.

use numpy::ndarray::{Array, Dimension};
use numpy::{
    Element, IntoPyArray, PyArray, PyArrayDyn, PyArrayMethods, PyReadonlyArrayDyn,
    PyUntypedArrayMethods,
};
use pyo3::exceptions::{PyTypeError, PyValueError};
use pyo3::intern;
use pyo3::prelude::*;
use touchline_core::geometry::{ImagePoint, ImageSize, Mat3, Vec3};

/// The kinds of NumPy's types that hold numbers: floating, signed, unsigned, bool.
const NUMBERS: &str = "fiub";

/// Numbers that Python gave, row by row.
pub struct Numbers<'py> {
    array: PyReadonlyArrayDyn<'py, f64>,
    /// What they are, for errors.
    name: &'static str,
}

impl<'py> Numbers<'py> {
    /// Reads an argument called `name`.
    ///
    /// # Errors
    /// It is no array of numbers.
    pub fn read(value: &Bound<'py, PyAny>, name: &'static str) -> PyResult<Self> {
        let py = value.py();
        let numpy = py.import(intern!(py, "numpy"))?;
        let given = numpy
            .call_method1(intern!(py, "asarray"), (value,))
            .map_err(|error| not_numbers(name, &error.value(py).to_string()))?;
        let dtype = given.getattr(intern!(py, "dtype"))?;
        // NumPy makes an array of nearly everything. Texts, dates and objects would fail later,
        // with a message that does not name the argument.
        let kind: String = dtype.getattr(intern!(py, "kind"))?.extract()?;
        if !NUMBERS.contains(&kind) {
            return Err(not_numbers(name, &format!("dtype {dtype}")));
        }
        // Other types, strides, byte orders and odd addresses are copied here.
        let numbers = numpy.call_method1(
            intern!(py, "require"),
            (given, intern!(py, "f8"), ("C_CONTIGUOUS", "ALIGNED")),
        )?;
        let numbers = numbers.cast_into::<PyArrayDyn<f64>>()?;
        // The borrow is that of the crate `numpy` and lasts as long as `Self`. It keeps other calls
        // of this module from writing, not Python.
        let array = numbers.try_readonly().map_err(|_| {
            PyValueError::new_err(format!(
                "{name}: the array is being written by another call"
            ))
        })?;
        Ok(Self { array, name })
    }

    /// All numbers, and the length of each dimension.
    ///
    /// # Errors
    /// The array is not contiguous, which reading has seen to.
    pub fn slice(&self) -> PyResult<&[f64]> {
        self.array
            .as_slice()
            .map_err(|_| self.wrong("contiguous numbers"))
    }

    /// The shape.
    pub fn shape(&self) -> &[usize] {
        self.array.shape()
    }

    /// The exception for another shape than the one wanted.
    fn wrong(&self, wanted: &str) -> PyErr {
        let (name, shape) = (self.name, self.shape());
        PyValueError::new_err(format!("{name}: shape {wanted} is needed, not {shape:?}"))
    }

    /// Rows of any of these lengths, and the length; a single row may come without its dimension.
    ///
    /// # Errors
    /// Another shape.
    pub fn rows(&self, lengths: &[usize]) -> PyResult<(&[f64], usize)> {
        match *self.shape() {
            [_, length] | [length] if lengths.contains(&length) => Ok((self.slice()?, length)),
            _ => {
                let wanted: Vec<String> = lengths
                    .iter()
                    .map(|length| format!("(N, {length})"))
                    .collect();
                Err(self.wrong(&wanted.join(" or ")))
            }
        }
    }

    /// Whether a single row came without its dimension.
    pub fn is_single(&self) -> bool {
        self.shape().len() == 1
    }

    /// Points of the world, m; where only x and y are given they lie on the plane z = 0.
    ///
    /// # Errors
    /// Another shape than (N, 3), (N, 2), (3,) or (2,).
    pub fn world_points(&self) -> PyResult<Vec<Vec3>> {
        let (numbers, length) = self.rows(&[3, 2])?;
        Ok(numbers.chunks_exact(length).map(world_point).collect())
    }

    /// Points of the picture, px.
    ///
    /// # Errors
    /// Another shape than (N, 2) or (2,).
    pub fn image_points(&self) -> PyResult<Vec<ImagePoint>> {
        let (numbers, length) = self.rows(&[2])?;
        Ok(numbers.chunks_exact(length).map(image_point).collect())
    }

    /// One point of the picture, px.
    ///
    /// # Errors
    /// Another shape than (2,) or (1, 2), or a number that is not finite.
    pub fn pixel(&self) -> PyResult<ImagePoint> {
        self.finite()?;
        match *self.image_points()? {
            [point] => Ok(point),
            _ => Err(self.wrong("(2,)")),
        }
    }

    /// Three numbers.
    ///
    /// # Errors
    /// Another shape than (3,), or a number that is not finite.
    pub fn vector(&self) -> PyResult<Vec3> {
        match self.finite()? {
            &[x, y, z] if self.is_single() => Ok(Vec3::new(x, y, z)),
            _ => Err(self.wrong("(3,)")),
        }
    }

    /// Three rows of three numbers.
    ///
    /// # Errors
    /// Another shape than (3, 3), or a number that is not finite.
    pub fn matrix(&self) -> PyResult<Mat3> {
        match *self.shape() {
            [3, 3] => Ok(Mat3::from_row_slice(self.finite()?)),
            _ => Err(self.wrong("(3, 3)")),
        }
    }

    /// All numbers.
    ///
    /// # Errors
    /// One of them is NaN or infinite.
    pub fn finite(&self) -> PyResult<&[f64]> {
        let numbers = self.slice()?;
        match numbers.iter().find(|number| !number.is_finite()) {
            Some(number) => Err(PyValueError::new_err(format!(
                "{}: a finite number is needed, not {number}",
                self.name
            ))),
            None => Ok(numbers),
        }
    }
}

/// A row of two or three numbers as a point of the world.
pub fn world_point(row: &[f64]) -> Vec3 {
    Vec3::new(row[0], row[1], row.get(2).copied().unwrap_or(0.0))
}

/// A row of two numbers as a point of the picture.
pub fn image_point(row: &[f64]) -> ImagePoint {
    ImagePoint::new(row[0], row[1])
}

/// The exception for something that is no array of numbers.
fn not_numbers(name: &str, found: &str) -> PyErr {
    PyTypeError::new_err(format!(
        "{name}: an array of numbers is needed, not {found}"
    ))
}

/// An array for Python, which takes its memory over. A single row comes without its dimension.
///
/// # Errors
/// The shape does not fit the numbers.
pub fn array<T: Element, D: Dimension>(
    py: Python<'_>,
    shape: impl numpy::ndarray::IntoDimension<Dim = D>,
    values: Vec<T>,
) -> PyResult<Bound<'_, PyArray<T, D>>> {
    let array = Array::from_shape_vec(shape.into_dimension(), values)
        .map_err(|error| PyValueError::new_err(error.to_string()))?;
    Ok(array.into_pyarray(py))
}

/// A 3 × 3 matrix for Python.
///
/// # Errors
/// None that can occur.
pub fn matrix<'py>(py: Python<'py>, matrix: &Mat3) -> PyResult<Bound<'py, PyAny>> {
    Ok(array(py, [3, 3], row_by_row(matrix).to_vec())?.into_any())
}

/// The numbers of a matrix, row by row.
pub fn row_by_row(matrix: &Mat3) -> [f64; 9] {
    let mut rows = [0.0; 9];
    for (index, number) in rows.iter_mut().enumerate() {
        // nalgebra stores columns, NumPy rows.
        *number = matrix[(index / 3, index % 3)];
    }
    rows
}

/// The size of a picture from its columns and rows.
///
/// # Errors
/// No such size.
pub fn image_size((width, height): (i64, i64)) -> PyResult<ImageSize> {
    // Python's numbers may be negative or larger than a side can be: checked before they are cast.
    if ImageSize::is_side_px(width as f64) && ImageSize::is_side_px(height as f64) {
        return Ok(ImageSize::new(width as u32, height as u32));
    }
    let most = ImageSize::MAX_SIDE_PX;
    Err(PyValueError::new_err(format!(
        "image_size_px: width and height from 1 to {most} px are needed, not {width} x {height}"
    )))
}
