//! Helpers for formats that store less than a whole camera.

use super::camera_format::stem_of;
use super::frame_camera::{FrameCamera, FrameProjection, Pinhole};
use crate::exchange::error::ExchangeError;
use crate::exchange::files::base_name;
use crate::exchange::format::Format;
use crate::exchange::syntax::node::safe_path;
use std::collections::BTreeSet;
use touchline_core::camera::Radial;
use touchline_core::geometry::{ImageSize, pluralise};

/// The reason why a file that states one size of picture cannot take a frame of another size.
pub const OTHER_SIZE: &str =
    "its picture size differs from the first one's; export one camera at a time";

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
    safe_path(image).unwrap_or_else(|_| base_name(image).to_owned())
}

/// The note that a track has frames of several cameras, which it does not name.
pub fn note_several_cameras(frames: &[FrameCamera]) -> Option<String> {
    let cameras: BTreeSet<Option<&str>> =
        frames.iter().map(|frame| frame.camera.as_deref()).collect();
    (cameras.len() > 1).then(|| {
        let count = pluralise(cameras.len(), "camera");
        format!(
            "frames of {count} are in one track that does not tell them apart; \
             choose one with --camera"
        )
    })
}

/// The error that a format cannot represent a frame, which is named by its picture or by its number
/// in the video: its name in the format says nothing to the user.
pub fn cannot_hold(frame: &FrameCamera, format: Format, why: String) -> ExchangeError {
    let frame = match (&frame.image, &frame.video, frame.frame_index) {
        (Some(image), ..) => image.clone(),
        (None, Some(video), Some(index)) => format!("{video}#{index}"),
        _ => frame.name.clone(),
    };
    ExchangeError::CannotHold { frame, format, why }
}
