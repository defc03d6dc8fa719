//! Which camera took a frame: giving frames to a camera.

use super::solve_frames::{ShownFields, WatchFrames, is_by_clicks, record_if_solved, solve_frames};
use crate::document::{Camera, CameraId, Document, Fields, FrameStatus};
use crate::geometry::ImageSize;
use std::ops::ControlFlow;
use thiserror::Error;

/// Why frames cannot be given to a camera.
#[derive(Clone, Debug, PartialEq, Eq, Error)]
#[non_exhaustive]
pub enum AssignError {
    /// The document lacks it.
    #[error("camera {camera:?} is not in the document")]
    UnknownCamera {
        /// Its name.
        camera: String,
    },
    /// A frame's picture is of another size.
    #[error(
        "{frame} is {} × {} px, the pictures of {camera:?} are {} × {} px: assign it to a camera of its size",
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
    #[error("a camera {camera:?} exists already: choose another name, or assign the frames to that one")]
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
        let gap = if stem.ends_with(['-', '_', '.']) { "" } else { " " };
        let mut number = 2;
        loop {
            let name = CameraId::from(format!("{stem}{gap}{number}").as_str());
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
    pub fn add_camera_like(&mut self, name: &CameraId, like: &CameraId) -> Result<(), AssignError> {
        if name.as_str().trim().is_empty() {
            return Err(AssignError::NoName);
        }
        if self.camera(name).is_some() {
            return Err(AssignError::NameTaken { camera: name.as_str().to_owned() });
        }
        let known = self.camera(like).ok_or_else(|| AssignError::UnknownCamera { camera: like.as_str().to_owned() })?;
        let added = Camera {
            masks: known.masks.clone(),
            ranged_masks: known.ranged_masks.clone(),
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
    pub fn assign_to_camera(
        &mut self,
        frames: &[usize],
        camera: &CameraId,
        fields: &Fields,
    ) -> Result<(), AssignError> {
        self.check_assigned(frames, camera)?;
        self.assign_frames(frames, camera, fields, &|| ControlFlow::Continue(()))
    }

    /// Whether frames can be assigned to a camera.
    pub(super) fn check_assigned(&self, frames: &[usize], camera: &CameraId) -> Result<(), AssignError> {
        let known =
            self.camera(camera).ok_or_else(|| AssignError::UnknownCamera { camera: camera.as_str().to_owned() })?;
        for frame in frames.iter().filter_map(|index| self.frames.get(*index)) {
            if frame.image_size != known.image_size {
                return Err(AssignError::OtherSize {
                    frame: frame.name(),
                    size: frame.image_size,
                    camera: camera.as_str().to_owned(),
                    of_camera: known.image_size,
                });
            }
        }
        Ok(())
    }

    /// Assigns frames to a camera that can have them. Where `watch` ends it, frames have changed: the document is to be dropped.
    pub(super) fn assign_frames<E: Send>(
        &mut self,
        frames: &[usize],
        camera: &CameraId,
        fields: &Fields,
        watch: WatchFrames<'_, E>,
    ) -> Result<(), E> {
        let base = self.camera(camera).and_then(Camera::base);
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
        if base.is_some() {
            let clicked: Vec<usize> =
                given.iter().copied().filter(|&index| is_by_clicks(&self.frames[index])).collect();
            solve_frames(self, &clicked, ShownFields::Document(fields), record_if_solved, watch)?;
        }
        for index in given {
            let frame = &self.frames[index];
            // Without a camera these promise too much.
            if frame.ptz.is_none() && matches!(frame.status, FrameStatus::Suggested | FrameStatus::Reference) {
                let status = if frame.clicks.is_empty() { FrameStatus::New } else { FrameStatus::Draft };
                self.frames[index].status = status;
            }
        }
        Ok(())
    }
}
