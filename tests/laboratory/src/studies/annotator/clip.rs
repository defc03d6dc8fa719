//! The synthetic clip that a simulated annotator labels: drawn under the worst conditions of live
//! television, with exact ground truth.

use crate::sets::{MOTION_FILE, RealMotion};
use crate::{ExperimentError, ExperimentOptions};
use image::codecs::jpeg::JpegEncoder;
use rayon::prelude::*;
use std::collections::BTreeMap;
use std::path::Path;
use tempfile::{Builder, TempDir};
use touchline::camera::{CameraBase, PtzCamera};
use touchline::document::{Camera, CameraId, Click, Document, FieldSize, FieldSpec, Frame, Target};
use touchline::field::FieldModel;
use touchline::geometry::{ImageSize, PixelBox};
use touchline::synthetic::{
    ClickOptions, ClickTarget, PathStep, Preset, ShootOptions, StadiumOptions, camera_path,
    generate_clicks, stadium,
};

/// Time between frames, s: 25 frames per second.
const STEP_S: f64 = 0.04;

/// 1-σ of a simulated click along x and along y, px.
pub const CLICK_SIGMA_PX: f64 = 2.0;

/// A synthetic clip: its pictures, in a temporary folder, and its ground truth.
pub struct DrawnClip {
    /// Where the motion comes from, in words for the report.
    pub motion: &'static str,
    /// The document. Its frames have no cameras yet; base and field size are known, and no mask
    /// covers the score bug.
    pub document: Document,
    /// The true field.
    pub field: FieldModel,
    /// The true camera of each frame.
    pub truth: Vec<PtzCamera>,
    folder: TempDir,
    /// The boxes that hide the field in each frame, px: players and the score bug.
    hidden: Vec<Vec<PixelBox>>,
}

impl DrawnClip {
    /// Draws the clip. If `data` contains the published motion of a real camera, the camera follows
    /// that back and forth until there are enough frames; otherwise a synthetic operator moves it.
    ///
    /// # Errors
    /// The motion cannot be read, or a picture cannot be written.
    pub fn draw(
        options: &ExperimentOptions,
        data: Option<&Path>,
        progress: &(dyn Fn() + Sync),
    ) -> Result<Self, ExperimentError> {
        // The published motion is of pictures of this size, so that its focal lengths need no
        // scaling.
        let size = ImageSize::new(1280, 720);
        let count = frame_count(options);
        let shoot = ShootOptions {
            step_s: STEP_S,
            ..Preset::Hard.shoot()
        };
        let of_stand = shoot.main_camera(size);
        let mut spec = FieldSpec::new("soccer");
        let real = data
            .map(|folder| RealMotion::read(&folder.join(MOTION_FILE)))
            .transpose()?;
        // The published base refers to a field of this size.
        if real.is_some() {
            let [length_m, width_m] = RealMotion::FIELD_M;
            spec.params = BTreeMap::from([
                ("length_m".to_owned(), length_m),
                ("width_m".to_owned(), width_m),
            ]);
        }
        // Confirmed: tracking then leaves the field's length alone, which it would otherwise fit.
        spec.size = Some(FieldSize::Confirmed);
        let field = spec.model(Path::new(""))?;
        // Another stadium than those of the other experiments, for the same seed.
        let seed = options.seed.wrapping_add(61);
        let scene = stadium(&StadiumOptions {
            daylight: shoot.daylight,
            ..StadiumOptions::new(field.clone(), seed)
        });
        let (base, path, motion) = match &real {
            Some(real) => {
                // The published camera has no distortion. Use that of the preset `hard`.
                let base = CameraBase {
                    distortion: of_stand.distortion,
                    ..real.base
                };
                (
                    base,
                    there_and_back(real, count),
                    "the published motion of a real broadcast camera, there and back",
                )
            }
            None => (
                of_stand,
                camera_path(&scene, &of_stand, size, &shoot, count),
                "a drawn operator's motion",
            ),
        };
        let unwritten = |path: &Path, error: &std::io::Error| ExperimentError::Given {
            path: path.to_path_buf(),
            reason: format!("cannot be written: {error}"),
        };
        let folder = TempDir::new().map_err(|error| unwritten(&std::env::temp_dir(), &error))?;
        // Draws one frame and writes it as JPEG; returns the boxes that hide the field.
        let take = |(number, step): (usize, &PathStep)| -> Result<Vec<PixelBox>, ExperimentError> {
            let drawn = scene.render(
                &PtzCamera::new(base, step.ptz),
                size,
                &shoot.frame(number, step, size, options.seed),
            );
            let file = Builder::new()
                .prefix(&name(number))
                // Without random letters, so that the file has the name that the document states.
                .rand_bytes(0)
                .tempfile_in(folder.path());
            let file = file.map_err(|error| unwritten(folder.path(), &error))?;
            JpegEncoder::new_with_quality(file.as_file(), shoot.jpeg_quality)
                .encode_image(&drawn.image)?;
            // Keep it beyond this function; the folder's drop deletes it.
            file.keep()
                .map_err(|error| unwritten(folder.path(), &error.error))?;
            progress();
            Ok(drawn
                .movers
                .iter()
                .map(|mover| mover.area)
                .chain(drawn.graphics.iter().copied())
                .collect())
        };
        // Frames are drawn in parallel and collected in their order.
        let hidden: Result<Vec<_>, ExperimentError> =
            path.par_iter().enumerate().map(take).collect();
        // The document as a user has it before the first click: base known, frames unlabelled.
        let mut document = Document::new(spec);
        let mut camera = Camera::new(CameraId::from("main"), size);
        camera.set_base(&base);
        document.cameras.push(camera.into());
        let frame = |number| Frame::from_image(&name(number), CameraId::from("main"), size).into();
        document.frames.extend((0..count).map(frame));
        let truth = path
            .iter()
            .map(|step| PtzCamera::new(base, step.ptz))
            .collect();
        Ok(Self {
            motion,
            document,
            field,
            truth,
            folder,
            hidden: hidden?,
        })
    }

    /// The folder of the pictures.
    pub fn folder(&self) -> &Path {
        self.folder.path()
    }

    /// The clicks of an annotator on a frame: at most this number of landmarks that are visible,
    /// each with normal noise.
    pub fn clicks(&self, frame: usize, landmarks: usize) -> Vec<Click> {
        let options = ClickOptions {
            landmarks,
            lines: 0,
            sigma_px: CLICK_SIGMA_PX,
            // The noise of a frame's clicks is the same in every way of labelling, whichever frames
            // are clicked before.
            seed: frame as u64,
        };
        let size = self.document.frames[frame].image_size;
        generate_clicks(
            &self.field,
            &self.truth[frame],
            size,
            &self.hidden[frame],
            &options,
        )
        .into_iter()
        .map(|click| match click.target {
            ClickTarget::Landmark(id) => Click::new(Target::Landmark(id), click.image),
            ClickTarget::Line(id) => Click::new(Target::Line(id), click.image),
        })
        .collect()
    }
}

/// Number of frames of the clip.
pub const fn frame_count(options: &ExperimentOptions) -> usize {
    options.full_or_quick(800, 60)
}

fn name(number: usize) -> String {
    format!("{number:04}.jpg")
}

/// A real motion back and forth, until there are enough frames.
fn there_and_back(real: &RealMotion, count: usize) -> Vec<PathStep> {
    let last = real.ptz.len() - 1;
    let step = |number: usize| {
        // A period is there and back; its two ends are not repeated. With a single frame the period
        // would be 0.
        let way = number % (2 * last).max(1);
        let (at, is_back) = if way <= last {
            (way, false)
        } else {
            (2 * last - way, true)
        };
        let motion = real.motion_at(at);
        // Motion blur depends on the speed, which has the other sign on the way back.
        let motion = if is_back { motion.reverse() } else { motion };
        PathStep {
            time_s: number as f64 * STEP_S,
            ptz: real.ptz[at],
            motion,
        }
    };
    (0..count).map(step).collect()
}

/// The distance between each corner of the picture and where `camera` shows the same world point,
/// px. The point is the ground at that corner, or, if the ground is farther than the stand behind
/// the field or not visible, a point of the stand. Infinite if `camera` does not see it.
#[must_use]
pub fn corners_apart_px(truth: &PtzCamera, camera: &PtzCamera, size: ImageSize) -> [f64; 4] {
    size.corners().map(|corner| {
        let place = truth.base().position_m;
        let ground = truth
            .plane_from_image(corner, 0.0)
            // Beyond the stand the ground is hidden, and near the horizon a small angle moves it by
            // kilometres.
            .filter(|ground| (ground - place).norm() < STAND_M);
        let along = || Some(place + truth.world_direction_from_image(corner).ok()? * STAND_M);
        let shown = ground
            .or_else(along)
            .and_then(|at| camera.image_from_world(at).ok());
        // A point that the camera does not see at all is as far off as can be.
        shown.map_or(f64::INFINITY, |shown| shown.distance_px(corner))
    })
}

/// Assumed distance of the stand behind the field, m.
const STAND_M: f64 = 150.0;
