//! Which camera took a frame: giving frames to a camera.

use super::solve_frames::{ShownFields, is_by_clicks, record_if_solved, solve_frames};
use thiserror::Error;
use touchline_core::geometry::ImageSize;
use touchline_core::progress::Progress;
use touchline_documents::document::{Camera, CameraId, Document, Fields, FrameStatus};

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
    #[error(
        "a camera {camera:?} exists already: choose another name, or assign the frames to that one"
    )]
    NameTaken {
        /// The name.
        camera: String,
    },
    /// A camera needs a name.
    #[error("a camera needs a name")]
    NoName,
}

/// Adds a camera for pictures like those of another one: its size, masks and field; where it stands
/// is not known.
///
/// # Errors
/// The name is empty or taken, or there is no camera to go by.
pub fn add_camera_like(
    document: &mut Document,
    name: &CameraId,
    like: &CameraId,
) -> Result<(), AssignError> {
    if name.as_str().trim().is_empty() {
        return Err(AssignError::NoName);
    }
    if document.camera(name).is_some() {
        return Err(AssignError::NameTaken {
            camera: name.as_str().to_owned(),
        });
    }
    let known = document
        .camera(like)
        .ok_or_else(|| AssignError::UnknownCamera {
            camera: like.as_str().to_owned(),
        })?;
    let added = Camera {
        masks: known.masks.clone(),
        ranged_masks: known.ranged_masks.clone(),
        field: known.field.clone(),
        ..Camera::new(name.clone(), known.image_size)
    };
    document.cameras.push(added.into());
    Ok(())
}

/// Gives frames to a camera and solves them anew with its base. What was found otherwise (by the
/// forest, by tracking, by hand) rests on the other base and is dropped, unless both are the same.
/// Frames are named by their places; where an error is returned the document is as it was.
///
/// # Errors
/// There is no such camera, or a frame's picture is of another size.
pub fn assign_to_camera(
    document: &mut Document,
    frames: &[usize],
    camera: &CameraId,
    fields: &Fields,
) -> Result<(), AssignError> {
    check_assigned(document, frames, camera)?;
    assign_frames(document, frames, camera, fields, &Progress::default());
    Ok(())
}

/// Whether frames can be assigned to a camera.
pub(super) fn check_assigned(
    document: &Document,
    frames: &[usize],
    camera: &CameraId,
) -> Result<(), AssignError> {
    let known = document
        .camera(camera)
        .ok_or_else(|| AssignError::UnknownCamera {
            camera: camera.as_str().to_owned(),
        })?;
    for frame in frames
        .iter()
        .filter_map(|index| document.frames.get(*index))
    {
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

/// Assigns frames to a camera that can have them. Where `progress` cancels this, frames have
/// changed: the document is to be dropped.
pub(super) fn assign_frames(
    document: &mut Document,
    frames: &[usize],
    camera: &CameraId,
    fields: &Fields,
    progress: &Progress<'_, ()>,
) {
    let base = document.camera(camera).and_then(Camera::base);
    let changes = |index: &usize| {
        document
            .frames
            .get(*index)
            .is_some_and(|frame| frame.camera != *camera)
    };
    let given: Vec<usize> = frames.iter().copied().filter(changes).collect();
    for &index in &given {
        let same_base = document
            .camera_of(&document.frames[index])
            .and_then(Camera::base)
            == base;
        let frame = &mut *document.frames[index];
        frame.camera = camera.clone();
        if !same_base {
            frame.ptz = None;
            frame.solution = None;
        }
    }
    if base.is_some() {
        let clicked: Vec<usize> = given
            .iter()
            .copied()
            .filter(|&index| is_by_clicks(&document.frames[index]))
            .collect();
        let fields = ShownFields::Document(fields);
        if solve_frames(document, &clicked, fields, record_if_solved, progress).is_none() {
            return;
        }
    }
    for index in given {
        let frame = &document.frames[index];
        // Without a camera these promise too much.
        if frame.ptz.is_none()
            && matches!(
                frame.status,
                FrameStatus::Suggested | FrameStatus::Reference
            )
        {
            let status = if frame.clicks.is_empty() {
                FrameStatus::New
            } else {
                FrameStatus::Draft
            };
            document.frames[index].status = status;
        }
    }
}
