//! The motion of a real broadcast camera in a synthetic stadium.

use super::drawn::{Order, Players, picture_size, take};
use super::{FrameSet, SetKind, Split};
use crate::given::MAX_GIVEN_BYTES;
use crate::setting::{FIELD_YD, field_of_yards};
use crate::{ExperimentError, ExperimentOptions};
use serde::Deserialize;
use std::path::Path;
use touchline::camera::{CameraBase, Ptz, PtzCamera};
use touchline::field::YARD_M;
use touchline::files::read_named_text;
use touchline::geometry::{ImagePoint, ImageSize, Mat3, Vec3};
use touchline::synthetic::{CameraMotion, Moment, PathStep, Preset, StadiumOptions, stadium};

/// The name of the published file.
pub const MOTION_FILE: &str = "soccer_ground_truth.json";
/// Size of the published pictures, px.
const PUBLISHED_SIZE: ImageSize = ImageSize::new(1280, 720);
/// Offset from the file's pixel coordinates, which are 0 at the first pixel's centre, to corner
/// coordinates, px.
const CORNER_FROM_CENTRE: f64 = 0.5;
/// Assumed frames per second. The file does not state it; only the motion of synthetic players and
/// the blur depend on it.
const FRAMES_A_SECOND: f64 = 25.0;

/// A real camera's base and its motion.
#[derive(Clone, Debug)]
pub struct RealMotion {
    /// The base, for pictures of 1280 × 720 px.
    pub base: CameraBase,
    /// Pan, tilt and focal length of each frame.
    pub ptz: Vec<Ptz>,
}

/// The published file.
#[derive(Deserialize)]
struct MotionFile {
    principal_point_px: [f64; 2],
    #[serde(rename = "C_m")]
    position_m: [f64; 3],
    base_rotation: [[f64; 3]; 3],
    frames: Vec<MotionFrame>,
}

/// A frame in the published file.
#[derive(Deserialize)]
struct MotionFrame {
    pan_deg: f64,
    tilt_deg: f64,
    f_px: f64,
}

impl RealMotion {
    /// Length and width of the file's field (118 × 70 yards), m. The file's origin is a corner of
    /// it.
    pub const FIELD_M: [f64; 2] = [FIELD_YD[0] * YARD_M, FIELD_YD[1] * YARD_M];

    /// Reads the published file and moves its origin to the field's centre.
    ///
    /// # Errors
    /// The file cannot be read or has another format.
    pub fn read(path: &Path) -> Result<Self, ExperimentError> {
        let wrong = |reason: String| ExperimentError::Given {
            path: path.to_path_buf(),
            reason,
        };
        let text =
            read_named_text(path, MAX_GIVEN_BYTES).map_err(|error| wrong(error.to_string()))?;
        let file: MotionFile =
            serde_json::from_str(&text).map_err(|error| wrong(error.to_string()))?;
        // NaN is refused as well. `motion_at` relies on at least one frame.
        if file.frames.is_empty() || file.frames.iter().any(|frame| !(frame.f_px > 0.0)) {
            return Err(wrong(
                "frames with focal lengths above 0 are wanted".to_owned(),
            ));
        }
        let [x, y] = file.principal_point_px.map(|at| at + CORNER_FROM_CENTRE);
        let corner_m = Vec3::new(0.5 * Self::FIELD_M[0], 0.5 * Self::FIELD_M[1], 0.0);
        let rotation = Mat3::from_fn(|row, column| file.base_rotation[row][column]);
        Ok(Self {
            base: CameraBase::new(
                Vec3::from(file.position_m) - corner_m,
                rotation,
                ImagePoint::new(x, y),
            ),
            ptz: file
                .frames
                .iter()
                .map(|f| Ptz::from_degrees(f.pan_deg, f.tilt_deg, f.f_px))
                .collect(),
        })
    }

    /// The same motion for pictures of another width.
    fn scale_to(&self, size: ImageSize) -> Self {
        // In the corner convention all lengths in px scale with the width; angles do not change.
        let scale = f64::from(size.width) / f64::from(PUBLISHED_SIZE.width);
        let principal = self.base.principal_point;
        let principal_point = ImagePoint::new(principal.x * scale, principal.y * scale);
        let ptz = self.ptz.iter().map(|ptz| Ptz {
            focal_px: ptz.focal_px * scale,
            ..*ptz
        });
        Self {
            base: CameraBase {
                principal_point,
                ..self.base
            },
            ptz: ptz.collect(),
        }
    }

    /// The speed of pan, tilt and zoom at a frame, from its neighbours.
    pub fn motion_at(&self, index: usize) -> CameraMotion {
        let last = self.ptz.len() - 1;
        let (before, after) = (index.saturating_sub(1), (index + 1).min(last));
        // A central difference; at the ends of the motion a difference to one side, and none for a
        // single frame.
        let per_s = FRAMES_A_SECOND / (after - before).max(1) as f64;
        let (from, to) = (self.ptz[before], self.ptz[after]);
        CameraMotion {
            pan_per_s: to.pan.turn_from(from.pan) * per_s,
            tilt_per_s: (to.tilt - from.tilt) * per_s,
            zoom_per_s: (to.focal_px / from.focal_px).ln() * per_s,
        }
    }
}

/// Draws every `stride`-th frame of a motion. Of these, every `every`-th is used for training.
///
/// # Errors
/// This program was built without OpenCV, or a picture cannot be encoded.
pub fn motion(
    real: &RealMotion,
    [stride, every]: [usize; 2],
    options: &ExperimentOptions,
    progress: &(dyn Fn() + Sync),
) -> Result<FrameSet, ExperimentError> {
    let size = picture_size(options);
    let scaled = real.scale_to(size);
    let shoot = Preset::Paper.shoot();
    let seed = options.seed;
    let scene = stadium(&StadiumOptions {
        daylight: shoot.daylight,
        ..StadiumOptions::new(field_of_yards(FIELD_YD)?, seed.wrapping_add(37))
    });
    let orders: Vec<Order<'_>> = (0..scaled.ptz.len())
        .step_by(stride)
        .map(|number| Order {
            scene: &scene,
            moment: Moment::default(),
            camera: PtzCamera::new(scaled.base, scaled.ptz[number]),
            step: PathStep {
                time_s: number as f64 / FRAMES_A_SECOND,
                ptz: scaled.ptz[number],
                motion: scaled.motion_at(number),
            },
            number,
            exposure_ev: 0.0,
            shoot: &shoot,
            size,
            seed,
        })
        .collect();
    let frames = take(&orders, Players::Masked, progress)?;
    let is_for_training = |index: &usize| index.is_multiple_of(every);
    Ok(FrameSet {
        kind: SetKind::Drawn,
        seed,
        title: format!(
            "drawn, {} frames along the published motion of a real broadcast camera, {} × {} px",
            frames.len(),
            size.width,
            size.height
        ),
        protocol: format!("One frame in {every} is used for training, all others for testing."),
        splits: vec![Split {
            name: "motion".to_owned(),
            training_frames: (0..frames.len()).filter(is_for_training).collect(),
            test_frames: (0..frames.len())
                .filter(|index| !is_for_training(index))
                .collect(),
        }],
        frames,
    })
}
