//! The pictures of a clip: reading in order, tracking points through them, and searching their
//! paint.

use super::anchors::is_anchor;
use super::error::TrackClipError;
use super::evidence::{ClipEvidence, FollowedPictures};
use super::frames::{ClipFrame, ClipFrames};
use super::options::{ClipProgress, TrackClipOptions};
use super::paint::{MaskedPicture, PaintAlignmentOutcome};
use std::collections::BTreeSet;
use touchline_core::camera::Ptz;
use touchline_core::field::FieldModel;
use touchline_core::geometry::{ImageSize, PixelBox};
use touchline_core::progress::{Progress, Share};
use touchline_documents::document::DocumentAt;
use touchline_vision::media::{
    FrameRef, FrameStream, MediaError, Picture, ReadFrames, StreamedFrame,
};
use touchline_vision::track::{ClipCamera, PointFollower, PointTracks, TrackError};

/// The pictures of a clip.
pub(super) struct ClipPictures<'a> {
    pub at: DocumentAt<'a>,
    pub clip: &'a ClipFrames,
    pub size: ImageSize,
}

impl ClipPictures<'_> {
    /// A frame's picture with its masks.
    pub fn read_masked(
        &self,
        reader: &mut dyn ReadFrames,
        frame: usize,
    ) -> Result<MaskedPicture, TrackClipError> {
        Ok(MaskedPicture {
            picture: self.read(reader, frame)?,
            masks: self.masks(frame),
        })
    }

    fn read(&self, reader: &mut dyn ReadFrames, frame: usize) -> Result<Picture, TrackClipError> {
        let source = &self.clip.frames[frame].source;
        self.check_size(source, reader.read(source))
    }

    /// A picture of the clip, if it could be read and has the size of the others.
    fn check_size(
        &self,
        source: &FrameRef,
        picture: Result<Picture, MediaError>,
    ) -> Result<Picture, TrackClipError> {
        // Tracked points are pixels, which pictures of another size do not share.
        let picture = picture?;
        let (actual, expected) = (picture.size(), self.size);
        if actual == expected {
            return Ok(picture);
        }
        Err(TrackClipError::Size {
            picture: source.to_string(),
            actual: (actual.width, actual.height),
            expected: (expected.width, expected.height),
        })
    }

    /// The pixels of a frame that give no points. A frame that the document leaves out has the
    /// masks of the frame before.
    fn masks(&self, frame: usize) -> Vec<PixelBox> {
        let before = self.clip.frames[..=frame]
            .iter()
            .rev()
            .find_map(|frame| frame.place);
        let of_document = before.and_then(|place| self.at.document.frames.get(place));
        of_document
            .map(|frame| self.at.document.masks_of(frame))
            .unwrap_or_default()
    }

    /// Point tracks through all pictures, from `evidence` if it has them.
    pub fn follow_points(
        &self,
        reader: &mut dyn ReadFrames,
        options: &TrackClipOptions,
        evidence: &mut ClipEvidence,
        progress: &Progress<'_, ClipProgress>,
    ) -> Result<PointTracks, TrackClipError> {
        let pictures = FollowedPictures {
            sources: self
                .clip
                .frames
                .iter()
                .map(|frame| frame.source.clone())
                .collect(),
            options: options.follow,
        };
        let masks: Vec<_> = (0..self.clip.frames.len())
            .map(|frame| self.masks(frame))
            .collect();
        // The same pictures and options give the same points.
        if let Some(tracks) = evidence.tracks(&pictures, &masks) {
            return Ok(tracks);
        }
        let (tracks, unreadable) = self.follow_afresh(reader, options, &masks, progress)?;
        if let Some(error) = unreadable {
            evidence.begin_readable(pictures, &masks, tracks, error.clone());
            return Err(error.into());
        }
        evidence.begin(pictures, masks, tracks.clone());
        Ok(tracks)
    }

    /// Tracks points through all pictures, which are read in order, up to the first that cannot be
    /// read, with the reason. While points are tracked in one picture, the next is read.
    fn follow_afresh(
        &self,
        reader: &mut dyn ReadFrames,
        options: &TrackClipOptions,
        masks: &[Vec<PixelBox>],
        progress: &Progress<'_, ClipProgress>,
    ) -> Result<(PointTracks, Option<MediaError>), TrackClipError> {
        let mut follower = PointFollower::new(self.size, options.follow);
        let mut frames =
            FrameStream::new(self.clip.frames.iter().map(|frame| frame.source.clone()))
                .with_reader(reader)
                .with_read_again(self.pictures_of_paint_search(options.paint_every))
                .with_progress(
                    progress.part(|Share { done, of }| ClipProgress::Following(done, of)),
                );
        let mut next = frames.next();
        for masks in masks {
            let Some(StreamedFrame { source, picture }) = next else {
                break;
            };
            let picture = match self.check_size(&source, picture) {
                // A single picture is nothing to track through.
                Err(TrackClipError::Media(error)) if follower.frames() > 1 => {
                    return Ok((follower.into_tracks(), Some(error)));
                }
                picture => picture?,
            };
            let mut ended: Result<usize, TrackError> = Ok(0);
            // Decoding the next picture overlaps with tracking through this one.
            next = frames.next_during(|| ended = follower.add(&picture, masks));
            ended?;
        }
        // The stream also ends early when it is cancelled. Tracks through a part of the clip would
        // leave the rest without points, and are not returned.
        if progress.is_cancelled() {
            return Err(TrackClipError::Stopped);
        }
        Ok((follower.into_tracks(), None))
    }

    /// The pictures that are read again after the points were tracked, to search their paint:
    /// every n-th one, and those whose camera was known before.
    fn pictures_of_paint_search(&self, paint_every: usize) -> BTreeSet<FrameRef> {
        let frames = self.clip.frames.iter().enumerate();
        frames
            .filter(|(at, frame)| at.is_multiple_of(paint_every) || self.is_known(frame))
            // 0 disables the search: then no picture is read again.
            .filter(|_| paint_every > 0)
            .map(|(_, frame)| frame.source.clone())
            .collect()
    }

    /// Whether the document has a camera of a frame that is propagated.
    fn is_known(&self, frame: &ClipFrame) -> bool {
        let of_document = frame.place.and_then(|at| self.at.document.frames.get(at));
        of_document.is_some_and(|frame| is_anchor(frame))
    }

    /// The verdicts of the paint of some frames on their cameras. Verdicts on nearby cameras in
    /// `evidence` are reused.
    pub fn ask_paint(
        &self,
        reader: &mut dyn ReadFrames,
        (field, camera): (&FieldModel, &ClipCamera),
        frames: &[(usize, Ptz)],
        evidence: &mut ClipEvidence,
        progress: &Progress<'_, ClipProgress>,
    ) -> Result<Vec<(usize, PaintAlignmentOutcome)>, TrackClipError> {
        let mut found = Vec::with_capacity(frames.len());
        for (done, &(frame, ptz)) in frames.iter().enumerate() {
            report(progress, ClipProgress::Painting(done, frames.len()))?;
            // Reading and aligning a picture is most of the time of a round, and between two rounds
            // most frames hardly move.
            let says = if let Some(says) = evidence.paint(frame, ptz, self.size) {
                says
            } else {
                let base = camera.base_at(frame);
                let says = PaintAlignmentOutcome::from_picture(
                    &self.read_masked(reader, frame)?,
                    field,
                    &base,
                    (frame, ptz),
                );
                evidence.keep_paint(frame, ptz, says.clone());
                says
            };
            found.push((frame, says));
        }
        Ok(found)
    }
}

/// Reports the progress of a clip.
///
/// # Errors
/// [`TrackClipError::Stopped`] if the receiver cancels the tracking.
pub(super) fn report(
    progress: &Progress<'_, ClipProgress>,
    step: ClipProgress,
) -> Result<(), TrackClipError> {
    if progress.report(step).is_break() {
        Err(TrackClipError::Stopped)
    } else {
        Ok(())
    }
}
