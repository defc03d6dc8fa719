//! Which camera took a frame: giving frames to a camera, and noticing that another one fits better.

use super::{calibrate, observations};
use crate::camera::CameraBase;
use crate::document::{Camera, CameraId, Document, Fields, Frame, FrameStatus};
use crate::field::FieldModel;
use crate::geometry::ImageSize;
use crate::solve::{CHECK_MISFIT, FrameSolution, SolveContext, Warning, WarningCode, solve_frame};
use std::sync::Arc;
use thiserror::Error;

/// Another camera has to fit this many times better (as χ²).
const BETTER: f64 = 4.0;
/// And by this much (as χ²), which chance does not do.
const BETTER_BY: f64 = 16.0;
/// With fewer surplus equations another camera fits by chance.
const MIN_REDUNDANCY: usize = 2;

/// A camera of the document that fits a frame's clicks, where the frame's own does not.
#[derive(Clone, Debug, PartialEq)]
pub struct BetterCamera {
    /// Which.
    pub camera: CameraId,
    /// How far the clicks are off with it, root mean square, px.
    pub rms_px: f64,
    /// And with the frame's own camera, px.
    pub own_rms_px: f64,
}

impl BetterCamera {
    /// What a person reads.
    #[must_use]
    pub fn warning(&self) -> Warning {
        let Self { camera, rms_px, own_rms_px } = self;
        let message = format!("camera “{camera}” fits to {rms_px:.1} px, this frame's own to {own_rms_px:.1} px");
        Warning { code: WarningCode::OtherCamera, message, clicks: Vec::new() }
    }
}

/// The camera that fits a frame's clicks best, if the frame's own does not and that one does. `fields` has the field of each
/// camera of the document, in their order ([`Fields::of_cameras`]).
#[must_use]
pub fn better_camera(
    document: &Document,
    frame: &Frame,
    solved: &FrameSolution,
    fields: &[Arc<FieldModel>],
) -> Option<BetterCamera> {
    if solved.redundancy < MIN_REDUNDANCY || !solved.residuals_are_evidence() {
        return None;
    }
    let usual = CHECK_MISFIT + 1.0 / solved.redundancy as f64;
    solved.misfit().filter(|misfit| *misfit > usual)?;
    let context = SolveContext::new(frame.image_size);
    let fit = |camera: &Camera, field: &FieldModel| {
        let fit = solve_frame(&camera.base()?, &observations(frame, field).ok()?, &context).ok()?;
        let fits = fit.redundancy == solved.redundancy && fit.misfit().is_some_and(|misfit| misfit < usual);
        let better = BETTER * fit.chi_squared < solved.chi_squared && fit.chi_squared + BETTER_BY < solved.chi_squared;
        (fits && better && context.ranges.contains(&fit.ptz)).then_some(fit)
    };
    document
        .cameras
        .iter()
        .zip(fields)
        .filter(|(camera, _)| camera.id != frame.camera && camera.image_size == frame.image_size)
        .filter_map(|(camera, field)| Some((camera, fit(camera, field)?)))
        .min_by(|a, b| a.1.chi_squared.total_cmp(&b.1.chi_squared))
        .map(|(camera, fit)| BetterCamera { camera: camera.id.clone(), rms_px: fit.rms_px, own_rms_px: solved.rms_px })
}

/// Puts the warning that another camera fits before a solution's others, where one does. `fields` as for
/// [`better_camera`].
pub fn warn_of_better_camera(
    document: &Document,
    frame: &Frame,
    solved: &mut FrameSolution,
    fields: &[Arc<FieldModel>],
) {
    if let Some(better) = better_camera(document, frame, solved, fields) {
        solved.warnings.insert(0, better.warning());
    }
}

/// Why frames cannot be given to a camera.
#[derive(Clone, Debug, PartialEq, Eq, Error)]
#[non_exhaustive]
pub enum GiveError {
    /// The document lacks it.
    #[error("camera {camera:?} is not in the document")]
    UnknownCamera {
        /// Its name.
        camera: String,
    },
    /// A frame's picture is of another size.
    #[error(
        "{frame} is {} × {} px, the pictures of {camera:?} are {} × {} px: give it to a camera of its size",
        .size.width, .size.height, .of_camera.width, .of_camera.height
    )]
    OtherSize {
        /// The frame.
        frame: String,
        /// Its size.
        size: ImageSize,
        /// The camera.
        camera: String,
        /// The size of its pictures.
        of_camera: ImageSize,
    },
    /// Two cameras would share a name.
    #[error("there is a camera {camera:?} already: choose another name, or give the frames to that one")]
    NameTaken {
        /// The name.
        camera: String,
    },
    /// A camera needs a name.
    #[error("a camera needs a name")]
    NoName,
}

impl Document {
    /// A camera's name with the first free number after it: “main 2”.
    #[must_use]
    pub fn free_camera_name(&self, like: &CameraId) -> CameraId {
        let stem = like.as_str().trim_end_matches(|c: char| c.is_ascii_digit()).trim_end();
        let stem = if stem.is_empty() { "camera" } else { stem };
        let mut number = 2;
        loop {
            let name = CameraId::from(format!("{stem} {number}").as_str());
            if self.camera(&name).is_none() {
                return name;
            }
            number += 1;
        }
    }

    /// Adds a camera for pictures like those of another one: its size, masks and field; where it stands is not known.
    ///
    /// # Errors
    /// The name is empty or taken, or there is no camera to go by.
    pub fn add_camera_like(&mut self, name: &CameraId, like: &CameraId) -> Result<(), GiveError> {
        if name.as_str().trim().is_empty() {
            return Err(GiveError::NoName);
        }
        if self.camera(name).is_some() {
            return Err(GiveError::NameTaken { camera: name.as_str().to_owned() });
        }
        let known = self.camera(like).ok_or_else(|| GiveError::UnknownCamera { camera: like.as_str().to_owned() })?;
        let added = Camera {
            masks: known.masks.clone(),
            field: known.field.clone(),
            ..Camera::new(name.clone(), known.image_size)
        };
        self.cameras.push(added.into());
        Ok(())
    }

    /// Gives frames to a camera and solves them anew with its base. What was found otherwise (by the forest, by tracking, by
    /// hand) rests on the other base and is dropped, unless both are the same. Frames are named by their places; where an
    /// error is returned the document is as it was.
    ///
    /// # Errors
    /// There is no such camera, or a frame's picture is of another size.
    pub fn give_to_camera(&mut self, frames: &[usize], camera: &CameraId, fields: &Fields) -> Result<(), GiveError> {
        let known =
            self.camera(camera).ok_or_else(|| GiveError::UnknownCamera { camera: camera.as_str().to_owned() })?;
        let (of_camera, base) = (known.image_size, known.base());
        for frame in frames.iter().filter_map(|index| self.frames.get(*index)) {
            if frame.image_size != of_camera {
                return Err(GiveError::OtherSize {
                    frame: frame.name(),
                    size: frame.image_size,
                    camera: camera.as_str().to_owned(),
                    of_camera,
                });
            }
        }
        let changes = |index: &usize| self.frames.get(*index).is_some_and(|frame| frame.camera != *camera);
        let given: Vec<usize> = frames.iter().copied().filter(changes).collect();
        for &index in &given {
            let same_base = self.camera_of(&self.frames[index]).and_then(Camera::base) == base;
            let frame = &mut *self.frames[index];
            frame.camera = camera.clone();
            if !same_base {
                frame.ptz = None;
                frame.solution = None;
            }
        }
        for index in given {
            self.solve_given(index, base.as_ref(), fields);
        }
        Ok(())
    }

    /// Solves a frame that has just got its camera, and takes a status back that promises too much.
    fn solve_given(&mut self, index: usize, base: Option<&CameraBase>, fields: &Fields) {
        let frame = &self.frames[index];
        let by_clicks = frame.ptz.is_none() || frame.is_solved_by_clicks();
        if base.is_some() && by_clicks && !frame.clicks.is_empty() {
            let field = fields.of_frame(self, frame);
            if let Ok(mut solved) = calibrate(self, frame, field, index) {
                warn_of_better_camera(self, frame, &mut solved, &fields.of_cameras(self));
                self.frames[index].record(&solved);
            }
        }
        let frame = &self.frames[index];
        if frame.ptz.is_none() && matches!(frame.status, FrameStatus::Suggested | FrameStatus::Reference) {
            let status = if frame.clicks.is_empty() { FrameStatus::New } else { FrameStatus::Draft };
            self.frames[index].status = status;
        }
    }
}
