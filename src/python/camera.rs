//! A camera's base, a camera, and what a camera shows where.

use crate::arrays::{Numbers, array, image_point, image_size, matrix, world_point};
use crate::errors::without_panic;
use crate::progress::threads;
use pyo3::exceptions::PyValueError;
use pyo3::prelude::*;
use rayon::prelude::*;
use touchline_core::camera::{
    BaseAngles, CameraBase, FocalCurve, PIXEL_ASPECTS, Ptz, PtzCamera, Radial,
};
use touchline_core::geometry::rotation::{
    ROTATION_TOLERANCE, distance_from_rotation, nearest_rotation,
};
use touchline_core::geometry::{ImageSize, Mat3, Vec3};

/// Fewer points are computed on the thread of the caller.
const POINTS_AT_ONCE: usize = 16_384;

/// What the frames of a fixed camera share: where it stands, its base rotation, principal point and
/// lens.
///
/// `position_m`: (3,), `world`. `image_size_px`: columns and rows of its pictures.
/// `base_from_world`: (3, 3); without it the camera is level and looks along +y at pan 0.
/// `principal_point_px`: (2,); without it the middle of the picture. Lens: k1 = `k1` +
/// `per_1000_px` · (f − `at_focal_px`) / 1000, k2 = `k2_per_k1_squared` · k1². A base that is made
/// counts as exactly known; one of a document has the uncertainty that the document states.
#[pyclass(module = "touchline", frozen, name = "Base")]
#[derive(Clone)]
pub struct PyBase {
    pub base: CameraBase,
    pub image_size: ImageSize,
}

#[pymethods]
impl PyBase {
    #[new]
    #[pyo3(signature = (
        position_m, image_size_px, base_from_world = None, principal_point_px = None, *,
        k1 = 0.0, per_1000_px = 0.0, at_focal_px = 0.0, k2_per_k1_squared = 0.0,
        pixel_aspect = 1.0
    ))]
    #[allow(clippy::too_many_arguments, reason = "they are named in Python")]
    fn new(
        position_m: &Bound<'_, PyAny>,
        image_size_px: (i64, i64),
        base_from_world: Option<&Bound<'_, PyAny>>,
        principal_point_px: Option<&Bound<'_, PyAny>>,
        k1: f64,
        per_1000_px: f64,
        at_focal_px: f64,
        k2_per_k1_squared: f64,
        pixel_aspect: f64,
    ) -> PyResult<Self> {
        let image_size = image_size(image_size_px)?;
        let position = Numbers::read(position_m, "position_m")?.vector()?;
        let base_from_world = match base_from_world {
            Some(given) => rotation(&Numbers::read(given, "base_from_world")?)?,
            None => BaseAngles::default().base_from_world(),
        };
        let principal_point = match principal_point_px {
            Some(given) => Numbers::read(given, "principal_point_px")?.pixel()?,
            None => image_size.centre(),
        };
        let base = CameraBase {
            distortion: FocalCurve {
                at_focal_px,
                value: k1,
                per_1000_px,
                k2_per_k1_squared,
                pixel_aspect,
            },
            ..CameraBase::new(position, base_from_world, principal_point)
        };
        if !base.distortion.is_finite() {
            return Err(PyValueError::new_err(
                "k1, per_1000_px, at_focal_px, k2_per_k1_squared: finite numbers are needed",
            ));
        }
        if !PIXEL_ASPECTS.contains(&pixel_aspect) {
            return Err(PyValueError::new_err(format!(
                "pixel_aspect: fy / fx from 0.25 to 4 is needed, not {pixel_aspect}"
            )));
        }
        Ok(Self { base, image_size })
    }

    /// The camera with this base that looks at a pan and tilt (degrees, positive right and up) with
    /// a focal length (px).
    fn camera(&self, pan_deg: f64, tilt_deg: f64, focal_px: f64) -> PyResult<PyCamera> {
        let ptz = Ptz::from_degrees(pan_deg, tilt_deg, focal_px);
        if !ptz.is_finite() {
            return Err(PyValueError::new_err(format!(
                "finite angles and a positive focal length are needed, not {pan_deg}, {tilt_deg}, \
                 {focal_px}"
            )));
        }
        Ok(PyCamera::new(
            &PtzCamera::new(self.base, ptz),
            self.image_size,
        ))
    }

    /// Its centre of projection in `world`, (3,), m.
    #[getter]
    fn position_m<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyAny>> {
        Ok(array(py, [3], self.base.position_m.as_slice().to_vec())?.into_any())
    }

    /// The rotation from `world` to `base`, (3, 3).
    #[getter]
    fn base_from_world<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyAny>> {
        matrix(py, &self.base.base_from_world)
    }

    /// The principal point, (2,), px, corner convention.
    #[getter]
    fn principal_point_px<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyAny>> {
        let at = self.base.principal_point;
        Ok(array(py, [2], vec![at.x, at.y])?.into_any())
    }

    /// The aspect of the pixels, fy / fx; 1: square.
    #[getter]
    fn pixel_aspect(&self) -> f64 {
        self.base.distortion.pixel_aspect
    }

    /// Columns and rows of its pictures, px.
    #[getter]
    fn image_size_px(&self) -> (u32, u32) {
        (self.image_size.width, self.image_size.height)
    }

    fn __repr__(&self) -> String {
        let at = self.base.position_m;
        format!(
            "<touchline.Base at ({:.2}, {:.2}, {:.2}) m>",
            at.x, at.y, at.z
        )
    }
}

/// A rotation that Python gave, up to rounded digits.
fn rotation(given: &Numbers<'_>) -> PyResult<Mat3> {
    let stated = given.matrix()?;
    let distance = distance_from_rotation(&stated);
    // Matrices that were printed with few digits are accepted, and made exact, because projection
    // and its derivatives suppose a rotation.
    if distance <= ROTATION_TOLERANCE {
        return Ok(nearest_rotation(&stated));
    }
    Err(PyValueError::new_err(format!(
        "base_from_world: a rotation is needed; this matrix is {distance:.1e} away from one"
    )))
}

/// The camera of one frame.
///
/// Pixels are those of the corner convention: (0, 0) is the top-left corner of the picture, the
/// centre of its first pixel is (0.5, 0.5). OpenCV puts integers on the centres of pixels: to draw
/// with it subtract 0.5.
#[pyclass(module = "touchline", frozen, name = "Camera")]
#[derive(Clone)]
pub struct PyCamera {
    pub camera: PtzCamera,
    pub image_size: ImageSize,
}

impl PyCamera {
    /// A camera of pictures of this size.
    pub const fn new(camera: &PtzCamera, image_size: ImageSize) -> Self {
        let camera = *camera;
        Self { camera, image_size }
    }
}

#[pymethods]
impl PyCamera {
    /// The rotation from `world` to `cam` (x right, y down, z forward), (3, 3).
    #[getter(R)]
    fn rotation<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyAny>> {
        matrix(py, &self.camera.cam_from_world())
    }

    /// The centre of projection in `world`, (3,), m. OpenCV's `tvec` is −R C.
    #[getter(C)]
    fn centre<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyAny>> {
        Ok(array(py, [3], self.camera.base().position_m.as_slice().to_vec())?.into_any())
    }

    /// The matrix of the pinhole, (3, 3), px.
    #[getter(K)]
    fn pinhole<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyAny>> {
        matrix(py, &pinhole(&self.camera))
    }

    /// OpenCV's coefficients k1, k2, p1, p2, k3, (5,); all but k1 and k2 are 0.
    #[getter]
    fn dist<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyAny>> {
        let Radial { k1, k2, .. } = self.camera.lens();
        Ok(array(py, [5], vec![k1, k2, 0.0, 0.0, 0.0])?.into_any())
    }

    /// Pan, degrees, positive to the right.
    #[getter]
    fn pan_deg(&self) -> f64 {
        self.camera.ptz().pan.degrees()
    }

    /// Tilt, degrees, positive up.
    #[getter]
    fn tilt_deg(&self) -> f64 {
        self.camera.ptz().tilt.degrees()
    }

    /// The focal length across the picture, fx, px.
    #[getter]
    fn focal_px(&self) -> f64 {
        self.camera.ptz().focal_px
    }

    /// Its base.
    #[getter]
    fn base(&self) -> PyBase {
        PyBase {
            base: *self.camera.base(),
            image_size: self.image_size,
        }
    }

    /// Columns and rows of the picture, px.
    #[getter]
    fn image_size_px(&self) -> (u32, u32) {
        (self.image_size.width, self.image_size.height)
    }

    fn __repr__(&self) -> String {
        format!(
            "<touchline.Camera pan {:.2}, tilt {:.2}, focal length {:.0} px>",
            self.pan_deg(),
            self.tilt_deg(),
            self.focal_px()
        )
    }
}

/// The matrix of a camera's pinhole.
pub fn pinhole(camera: &PtzCamera) -> Mat3 {
    camera.calibration_matrix()
}

/// Where a camera shows points of the world.
///
/// `points`: (N, 3), m, or (N, 2) for points on the plane z = 0. Returns (N, 2), px; NaN where a
/// point has no image: behind the camera, or beyond the fold of its lens.
#[pyfunction]
pub fn project<'py>(
    py: Python<'py>,
    camera: &Bound<'py, PyCamera>,
    points: &Bound<'py, PyAny>,
) -> PyResult<Bound<'py, PyAny>> {
    // The class is frozen, so that the camera can be read without a borrow; it is copied for the
    // threads.
    let camera = camera.get().camera;
    let points = Numbers::read(points, "points")?;
    let (numbers, length) = points.rows(&[3, 2])?;
    let show = |row: &[f64], pixel: &mut [f64]| pixel.copy_from_slice(&image_of(&camera, row));
    let pixels = without_panic(|| map_rows(py, numbers, [length, 2], show))?;
    rows_for_python(py, pixels, 2, points.is_single())
}

/// The pixel of a point of the world; NaN where it has none.
fn image_of(camera: &PtzCamera, row: &[f64]) -> [f64; 2] {
    match camera.image_from_world(world_point(row)) {
        Ok(pixel) => [pixel.x, pixel.y],
        Err(_) => [f64::NAN; 2],
    }
}

/// Which points of a horizontal plane pixels show.
///
/// `pixels`: (N, 2), px. Returns (N, 3), `world`, m, on the plane z = `height_m`; NaN where a pixel
/// shows none of it (above the horizon, or beyond the fold of the lens). The crown is neglected.
#[pyfunction]
#[pyo3(signature = (camera, pixels, height_m = 0.0))]
pub fn unproject<'py>(
    py: Python<'py>,
    camera: &Bound<'py, PyCamera>,
    pixels: &Bound<'py, PyAny>,
    height_m: f64,
) -> PyResult<Bound<'py, PyAny>> {
    let camera = camera.get().camera;
    let pixels = Numbers::read(pixels, "pixels")?;
    let (numbers, length) = pixels.rows(&[2])?;
    let meet =
        |row: &[f64], point: &mut [f64]| point.copy_from_slice(&plane_of(&camera, row, height_m));
    let points = without_panic(|| map_rows(py, numbers, [length, 3], meet))?;
    rows_for_python(py, points, 3, pixels.is_single())
}

/// The point of the plane z = `height_m` that a pixel shows; NaN where it shows none.
fn plane_of(camera: &PtzCamera, row: &[f64], height_m: f64) -> [f64; 3] {
    let point = camera.plane_from_image(image_point(row), height_m);
    point.map_or([f64::NAN; 3], Vec3::into)
}

/// Maps rows of numbers to rows of another length, many of them on several threads.
fn map_rows(
    py: Python<'_>,
    numbers: &[f64],
    [length, length_out]: [usize; 2],
    map: impl Fn(&[f64], &mut [f64]) + Send + Sync,
) -> PyResult<Vec<f64>> {
    // Few rows are done at once: starting threads costs more than they save
    // (tests/benches/python.md, `project` of 100 and of a million points). The interpreter's lock
    // stays then, too.
    let mut out = vec![0.0; numbers.len() / length * length_out];
    if numbers.len() <= POINTS_AT_ONCE * length {
        map_each(numbers, &mut out, [length, length_out], &map);
        return Ok(out);
    }
    let pool = threads()?;
    // A piece of the input and one of the output have the same number of rows, so that the two
    // lists of pieces run in step.
    let pieces = numbers.par_chunks(POINTS_AT_ONCE * length);
    let pieces_out = out.par_chunks_mut(POINTS_AT_ONCE * length_out);
    let pieces = pieces.zip(pieces_out);
    py.detach(|| {
        pool.install(|| {
            pieces
                .for_each(|(rows, rows_out)| map_each(rows, rows_out, [length, length_out], &map));
        });
    });
    Ok(out)
}

/// Maps rows of numbers one after the other.
fn map_each(
    numbers: &[f64],
    out: &mut [f64],
    [length, length_out]: [usize; 2],
    map: &impl Fn(&[f64], &mut [f64]),
) {
    let rows_out = out.chunks_exact_mut(length_out);
    for (row, row_out) in numbers.chunks_exact(length).zip(rows_out) {
        map(row, row_out);
    }
}

/// Rows for Python; a single one without its dimension.
fn rows_for_python(
    py: Python<'_>,
    numbers: Vec<f64>,
    length: usize,
    is_single: bool,
) -> PyResult<Bound<'_, PyAny>> {
    if is_single {
        return Ok(array(py, [length], numbers)?.into_any());
    }
    Ok(array(py, [numbers.len() / length, length], numbers)?.into_any())
}

/// The homography from the plane z = 0 (x, y in m) to the picture (px), (3, 3).
///
/// It is that of the pinhole: distortion is neglected. H · (x, y, 1) is the pixel times a depth
/// that is positive in front of the camera.
#[pyfunction]
pub fn homography<'py>(
    py: Python<'py>,
    camera: &Bound<'py, PyCamera>,
) -> PyResult<Bound<'py, PyAny>> {
    matrix(py, &image_from_ground(&camera.get().camera))
}

/// K (r₁ r₂ −R C).
pub fn image_from_ground(camera: &PtzCamera) -> Mat3 {
    let rotation = camera.cam_from_world();
    // Points of the plane z = 0 need no third column of R; −R C takes its place (Hartley and
    // Zisserman, "Multiple View Geometry", the camera matrix of a world plane).
    let mut ground = rotation;
    ground.set_column(2, &-(rotation * camera.base().position_m));
    pinhole(camera) * ground
}
