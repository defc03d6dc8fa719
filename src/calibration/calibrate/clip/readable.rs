//! A clip whose last pictures cannot be read: a video states more frames than it decodes, a file is
//! cut off. What can be read is tracked, and the rest has no camera.

use super::error::TrackClipError;
use super::evidence::ClipEvidence;
use super::frames::ClipFrames;
use super::options::{ClipProgress, TrackClipOptions};
use super::track::{TrackedClip, track_readable};
use touchline_core::field::FieldModel;
use touchline_core::progress::Progress;
use touchline_documents::document::DocumentAt;
use touchline_vision::media::ReadFrames;

/// Tracks the known cameras of a clip to its other frames. Frames that people decided on keep their
/// cameras. Tracked points and paint are added to `evidence`; what it already contains for the same
/// pictures is not computed again. From the first picture that cannot be read, frames are missed.
///
/// # Errors
/// [`TrackClipError`]: the clip's camera has no base, no frame that can be read has a camera, a
/// picture has another size, points cannot be tracked, the known cameras do not determine the
/// others, or the tracking was cancelled.
pub fn track_clip(
    at: DocumentAt<'_>,
    clip: &ClipFrames,
    field: &FieldModel,
    reader: &mut dyn ReadFrames,
    options: &TrackClipOptions,
    evidence: &mut ClipEvidence,
    progress: &Progress<'_, ClipProgress>,
) -> Result<TrackedClip, TrackClipError> {
    let Some((readable, why)) = evidence.readable_part(clip) else {
        let tracked = track_readable(at, clip, field, reader, options, evidence, progress);
        if evidence.readable_part(clip).is_none() {
            return tracked;
        }
        // Reading failed part of the way, and the points up to there are in the evidence now.
        return track_clip(at, clip, field, reader, options, evidence, progress);
    };
    let num_readable = readable.frames.len();
    let mut tracked =
        match track_readable(at, &readable, field, reader, options, evidence, progress) {
            // What is known lies behind the picture that cannot be read, which is the reason.
            Err(TrackClipError::NothingKnown { .. }) => return Err(why.into()),
            tracked => tracked?,
        };
    let places = clip.frames[num_readable..].iter();
    let missed = places.filter_map(|frame| frame.place).filter(|place| {
        let frame = at.document.frames.get(*place);
        frame.is_some_and(|frame| frame.is_open() && frame.ptz.is_none())
    });
    tracked.missed.extend(missed);
    tracked.unreadable = Some(why.to_string());
    Ok(tracked)
}
