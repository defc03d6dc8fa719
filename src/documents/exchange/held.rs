//! Helpers for formats that store less than a whole camera.

use super::camera_format::stem_of;
use super::frame_camera::{FrameCamera, FrameProjection, Pinhole};
use super::node::safe_path;
use std::path::Path;
use touchline_core::camera::Radial;
use touchline_core::geometry::ImageSize;

/// The camera and picture size of a frame that is to be written.
///
/// # Errors
/// One of them is missing, in words.
pub fn parts(frame: &FrameCamera) -> Result<(Pinhole, ImageSize), String> {
    let pinhole = frame.pinhole().ok_or("it has a homography and no camera")?;
    Ok((
        *pinhole,
        frame.size.ok_or("the size of its picture is not known")?,
    ))
}

/// The frame with another camera.
#[must_use]
pub fn with(frame: &FrameCamera, name: String, pinhole: Pinhole) -> FrameCamera {
    FrameCamera {
        name,
        shown: FrameProjection::Camera(pinhole),
        ..frame.clone()
    }
}

/// The camera without distortion and with the principal point in the middle.
#[must_use]
pub fn plain(pinhole: &Pinhole, size: ImageSize) -> Pinhole {
    Pinhole {
        lens: Radial::default(),
        principal_point: size.centre(),
        ..*pinhole
    }
}

/// The name of a frame's image in a file beside the document: its path if that stays within the
/// folder, else its file name; for a frame of a video, the video's name and the frame number.
#[must_use]
pub fn relative_name(frame: &FrameCamera) -> String {
    let Some(image) = &frame.image else {
        return format!("{}.jpg", stem_of(frame));
    };
    // A picture outside the document's folder has a path that readers would refuse as leading out
    // of theirs.
    safe_path(image).unwrap_or_else(|_| {
        Path::new(image)
            .file_name()
            .unwrap_or_default()
            .to_string_lossy()
            .into_owned()
    })
}
