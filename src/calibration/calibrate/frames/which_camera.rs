//! Assigning frames to the camera that took them.

use super::solve_frames::{FrameFields, is_by_clicks, record_if_solved, solve_frames};
use thiserror::Error;
use touchline_core::geometry::ImageSize;
use touchline_core::progress::Progress;
use touchline_documents::document::{Camera, CameraId, Document, Fields, FrameStatus};

/// Why frames cannot be assigned to a camera.
#[derive(Clone, Debug, PartialEq, Eq, Error)]
#[non_exhaustive]
pub enum AssignError {
    /// The camera is not in the document.
    #[error("camera {camera:?} is not in the document")]
    UnknownCamera {
        /// The camera's name.
        camera: String,
    },
    /// A frame's picture has another size than the camera's.
    #[error(
        "{frame} is {} × {} px, the pictures of {camera:?} are {} × {} px: assign it to a camera of its size",
        .size.width, .size.height, .of_camera.width, .of_camera.height
    )]
    OtherSize {
        /// The frame's name.
        frame: String,
        /// The size of its picture.
        size: ImageSize,
        /// The camera's name.
        camera: String,
        /// The size of the camera's pictures.
        of_camera: ImageSize,
    },
    /// Two cameras would have the same name.
    #[error(
        "a camera {camera:?} exists already: choose another name, or assign the frames to that one"
    )]
    NameTaken {
        /// The name.
        camera: String,
    },
    /// The name is empty.
    #[error("a camera needs a name")]
    NoName,
}

/// Adds a camera for pictures like those of another one, with its picture size, masks and field but
/// without a base.
///
/// # Errors
/// The name is empty or taken, or the other camera is not in the document.
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

/// Assigns frames, by their indices, to a camera and solves them again with its base. A camera that
/// was found otherwise (by the forest, by tracking, manually) relies on the old base and is
/// removed, unless both bases are the same. If an error is returned, the document has not changed.
///
/// # Errors
/// The camera is not in the document, or a frame's picture has another size.
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

/// Checks whether frames can be assigned to a camera.
pub(in crate::calibrate) fn check_assigned(
    document: &Document,
    frames: &[usize],
    camera: &CameraId,
) -> Result<(), AssignError> {
    let known = document
        .camera(camera)
        .ok_or_else(|| AssignError::UnknownCamera {
            camera: camera.as_str().to_owned(),
        })?;
    // All frames are checked before the first one changes.
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

/// Assigns frames to a camera that fits them. If `progress` cancels this, some frames have been
/// changed and the document must be discarded.
pub(in crate::calibrate) fn assign_frames(
    document: &mut Document,
    frames: &[usize],
    camera: &CameraId,
    fields: &Fields,
    progress: &Progress<'_, ()>,
) {
    // A camera of an old base would project lines elsewhere with the new one.
    let base = document.camera(camera).and_then(Camera::base);
    let given: Vec<usize> = frames
        .iter()
        .copied()
        .filter(|index| {
            document
                .frames
                .get(*index)
                .is_some_and(|frame| frame.camera != *camera)
        })
        .collect();
    for &index in &given {
        // Two cameras may have the same base, for instance one that was copied: a camera pose is
        // then valid for both.
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
        // Without a base there is nothing to solve with: the frames wait for one.
        let clicked: Vec<usize> = given
            .iter()
            .copied()
            .filter(|&index| is_by_clicks(&document.frames[index]))
            .collect();
        let fields = FrameFields::Document(fields);
        if solve_frames(document, &clicked, fields, record_if_solved, progress).is_none() {
            return;
        }
    }
    for index in given {
        let frame = &document.frames[index];
        // Suggestions and references must have a camera.
        if frame.ptz.is_none()
            && matches!(
                frame.status,
                FrameStatus::Suggested | FrameStatus::Reference
            )
        {
            let status = frame.undecided_status();
            document.frames[index].status = status;
        }
    }
}
