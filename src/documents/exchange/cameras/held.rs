//! Helpers for formats that store less than a whole camera.

use super::camera_format::{SequenceScope, stem_of};
use super::frame_camera::{FrameCamera, FrameProjection, Pinhole};
use crate::exchange::error::{ExchangeError, ExchangeResult};
use crate::exchange::files::base_name;
use crate::exchange::format::Format;
use crate::exchange::syntax::node::safe_path;
use std::collections::{BTreeMap, BTreeSet};
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
pub fn with(frame: &FrameCamera, name: String, pinhole: Pinhole) -> FrameCamera {
    FrameCamera {
        name,
        shown: FrameProjection::Camera(pinhole),
        ..frame.clone()
    }
}

/// The camera without distortion and with the principal point in the middle.
pub fn plain(pinhole: &Pinhole, size: ImageSize) -> Pinhole {
    Pinhole {
        lens: Radial::default(),
        principal_point: size.centre(),
        ..*pinhole
    }
}

/// The name of a frame's image in a file beside the document: its path if that stays within the
/// folder, else its file name; for a frame of a video, the video's name and the frame number.
pub fn relative_name(frame: &FrameCamera) -> String {
    let Some(image) = &frame.image else {
        return format!("{}.jpg", stem_of(frame));
    };
    // A picture outside the document's folder has a path that readers would refuse as leading out
    // of theirs.
    safe_path(image).unwrap_or_else(|_| base_name(image).to_owned())
}

/// Refuses frames of two videos or of two folders of images in one sequence, and images of two
/// cameras in one that does not name its camera. Cameras of one video alternate in it.
///
/// # Errors
/// The first two frames that are not of one sequence are named.
pub fn refuse_mixed_sequence(
    frames: &[FrameCamera],
    format: Format,
    sequence: SequenceScope,
) -> ExchangeResult<()> {
    let mut firsts: BTreeMap<Option<&str>, &FrameCamera> = BTreeMap::new();
    for frame in frames {
        let group = match sequence {
            SequenceScope::All => None,
            SequenceScope::CameraWithoutImages if frame.image.is_some() => continue,
            SequenceScope::Camera | SequenceScope::CameraWithoutImages => frame.camera.as_deref(),
        };
        let first = *firsts.entry(group).or_insert(frame);
        let is_one = source_of(first) == source_of(frame)
            && (frame.video.is_some() || first.camera == frame.camera);
        if !is_one {
            return Err(ExchangeError::MixedSequence {
                format,
                first: own_name(first),
                second: own_name(frame),
            });
        }
    }
    Ok(())
}

/// The video of a frame, or the folder of its image; none where neither is known.
fn source_of(frame: &FrameCamera) -> Option<&str> {
    if let Some(video) = &frame.video {
        return Some(video);
    }
    let image = frame.image.as_deref()?;
    Some(image.rfind(['/', '\\']).map_or("", |end| &image[..end]))
}

/// The note that a sequence without numbers has frames that do not follow each other.
pub fn note_lost_gaps(frames: &[FrameCamera]) -> Option<String> {
    let numbers: Option<Vec<u64>> = frames.iter().map(|frame| frame.frame_index).collect();
    let numbers = numbers?;
    let gap = numbers
        .windows(2)
        .find(|pair| pair[0].checked_add(1) != Some(pair[1]))?;
    Some(format!(
        "no frame numbers are written: frame {} follows frame {} as if nothing were between them; \
         --takes writes frames without a gap to a file each",
        gap[1], gap[0]
    ))
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
    ExchangeError::CannotHold {
        frame: own_name(frame),
        format,
        why,
    }
}

/// The picture of a frame, or its video and its number there.
fn own_name(frame: &FrameCamera) -> String {
    match (&frame.image, &frame.video, frame.frame_index) {
        (Some(image), ..) => image.clone(),
        (None, Some(video), Some(index)) => format!("{video}#{index}"),
        _ => frame.name.clone(),
    }
}
