//! The arrays of a file: frames are read from them and written into them.

use crate::exchange::cameras::calibration_matrix::Calibration;
use crate::exchange::cameras::frame_camera::{FrameCamera, FrameProjection, KnownLens, Pinhole};
use crate::exchange::error::Problem;
use crate::exchange::options::Pixels;
use crate::exchange::syntax::npy::Array;
use crate::exchange::syntax::npz::Npz;
use crate::exchange::syntax::values::{coefficient, refuse_further_coefficients};
use touchline_core::camera::Radial;
use touchline_core::geometry::{ImageSize, Mat3, Vec3};

/// The coefficients that an export writes for a frame: k1, k2, p1, p2, k3.
const COEFFICIENTS: usize = 5;
/// The maximum number of frames of a file: five hours at 50 frames per second.
const MAX_FRAMES: usize = 900_000;

/// The shape of an array in a message.
fn shape_text(shape: &[usize]) -> String {
    let sides: Vec<String> = shape.iter().map(ToString::to_string).collect();
    format!("({})", sides.join(", "))
}

/// Refuses an array of another shape.
fn check_shape(
    name: &str,
    array: &Array,
    is_right: bool,
    wanted: &'static str,
) -> Result<(), Problem> {
    if is_right {
        return Ok(());
    }
    Err(Problem::Kind {
        what: format!("the shape of {name}"),
        wanted,
        found: shape_text(&array.shape),
    })
}

/// The arrays of a file, with shapes that fit together.
pub(super) struct Sequence {
    calibrations: Array,
    distortions: Array,
    /// Rotations and translations, equal in number.
    poses: Option<(Array, Array)>,
    pub(super) frames: usize,
}

impl Sequence {
    pub(super) fn read(bytes: &[u8]) -> Result<Self, Problem> {
        let archive = Npz::open(bytes)?;
        let (calibrations, distortions) = (archive.array("K")?, archive.array("k")?);
        let frames = calibrations.shape.first().copied().unwrap_or(0);
        // `K` says how many frames there are, and the other arrays must agree. All shapes are
        // checked here, so that `Array::row` finds a row for each frame.
        let has_k = calibrations.shape == [frames, 3, 3] && (1..=MAX_FRAMES).contains(&frames);
        check_shape(
            "K",
            &calibrations,
            has_k,
            "(frames, 3, 3), at most 900 000 frames,",
        )?;
        let is_right =
            matches!(distortions.shape[..], [rows, numbers] if rows == frames && numbers >= 2);
        check_shape(
            "k",
            &distortions,
            is_right,
            "(frames, 2 or 5), as many frames as K has,",
        )?;
        // Rotation and translation are there for all frames, for the first one, or for none; one
        // without the other means nothing.
        let poses = match (archive.find("R")?, archive.find("t")?) {
            (None, None) => None,
            (Some(rotations), Some(translations)) => {
                let count = rotations.shape.first().copied().unwrap_or(0);
                let is_right = rotations.shape == [count, 3, 3] && (count == 1 || count == frames);
                check_shape("R", &rotations, is_right, "(1, 3, 3) or (frames, 3, 3)")?;
                let is_right = translations.shape == [count, 3];
                check_shape(
                    "t",
                    &translations,
                    is_right,
                    "(1, 3) or (frames, 3), as R has,",
                )?;
                Some((rotations, translations))
            }
            (Some(_), None) => return Err(Problem::Missing("the array t".to_owned())),
            (None, Some(_)) => return Err(Problem::Missing("the array R".to_owned())),
        };
        Ok(Self {
            calibrations,
            distortions,
            poses,
            frames,
        })
    }

    /// The projection of a frame: a camera if the file has its rotation and translation, else its
    /// lens. With how far it is from the file's own at most, px.
    pub(super) fn projection(
        &self,
        frame: usize,
        size: ImageSize,
    ) -> Result<(FrameProjection, f64), Problem> {
        let (rows, coefficients) = (self.calibrations.row(frame), self.distortions.row(frame));
        let (lens, off_px) = lens_of(rows, coefficients, size)?;
        // A row beyond the only pose gives no numbers, so that this frame has its lens alone.
        if let Some((rotations, translations)) = &self.poses
            && let &[x, y, z] = translations.row(frame)
        {
            let cam_from_world = Mat3::from_row_slice(rotations.row(frame));
            let position_m = -(cam_from_world.transpose() * Vec3::new(x, y, z));
            let pinhole = Pinhole {
                cam_from_world,
                position_m,
                ..lens.camera_at_origin()
            };
            let pinhole = pinhole.validate("the camera")?;
            return Ok((FrameProjection::Camera(pinhole), off_px));
        }
        lens.camera_at_origin()
            .validate("the camera")
            .map(|_| (FrameProjection::Lens(lens), off_px))
    }
}

/// The lens that a frame's rows of `K` and `k` state, and how far it is from theirs at most, px.
fn lens_of(
    calibration: &[f64],
    distortion: &[f64],
    size: ImageSize,
) -> Result<(KnownLens, f64), Problem> {
    let rows: &[f64; 9] = calibration
        .try_into()
        .map_err(|_| Problem::wrong_count("K", 9, calibration.len()))?;
    if !calibration
        .iter()
        .chain(distortion)
        .all(|number| number.is_finite())
    {
        return Err(Problem::NotFinite("a number of K or k".to_owned()));
    }
    let taken = Calibration::from_rows(rows, Pixels::Centre)?.without_skew(size)?;
    refuse_further_coefficients(distortion.get(2..).unwrap_or_default())?;
    let lens = KnownLens {
        focal_px: taken.focal_px,
        principal_point: taken.principal_point,
        radial: Radial {
            k1: coefficient(distortion, 0),
            k2: coefficient(distortion, 1),
            pixel_aspect: taken.pixel_aspect,
        },
    };
    Ok((lens, taken.off_px))
}

/// The arrays of some frames.
pub(super) fn arrays_of(held: &[FrameCamera]) -> Vec<(&'static str, Array)> {
    let shift = Pixels::Centre.to_corner_px();
    let (mut calibrations, mut distortions) = (Vec::new(), Vec::new());
    let (mut rotations, mut translations) = (Vec::new(), Vec::new());
    // A frame without a pose adds to `K` and `k` alone, so that `R` and `t` have one row or as many
    // as the others: `hold` gives the first frame its pose, and the others all or none.
    for frame in held {
        let lens = match frame.shown {
            FrameProjection::Camera(pinhole) => {
                rotations.extend(pinhole.cam_from_world.transpose().iter());
                translations.extend(pinhole.translation().iter());
                pinhole.known_lens()
            }
            FrameProjection::Lens(lens) => lens,
            FrameProjection::Ground(_) | FrameProjection::Nothing => continue,
        };
        let (cx, cy) = (
            lens.principal_point.x - shift,
            lens.principal_point.y - shift,
        );
        calibrations.extend([
            lens.focal_px,
            0.0,
            cx,
            0.0,
            lens.focal_px * lens.radial.pixel_aspect,
            cy,
            0.0,
            0.0,
            1.0,
        ]);
        distortions.extend([lens.radial.k1, lens.radial.k2, 0.0, 0.0, 0.0]);
    }
    let (frames, poses) = (distortions.len() / COEFFICIENTS, translations.len() / 3);
    vec![
        (
            "K",
            Array {
                shape: vec![frames, 3, 3],
                values: calibrations,
            },
        ),
        (
            "k",
            Array {
                shape: vec![frames, COEFFICIENTS],
                values: distortions,
            },
        ),
        (
            "R",
            Array {
                shape: vec![poses, 3, 3],
                values: rotations,
            },
        ),
        (
            "t",
            Array {
                shape: vec![poses, 3],
                values: translations,
            },
        ),
    ]
}
