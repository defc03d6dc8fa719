//! The clips of a document tracked: the cameras of all frames from those that are known.
//!
//! The frames that a pass reaches can show that the field or the base is not right: the lines of a
//! field that is longer than was assumed lie beside their paint, and so do those of a base that one
//! clicked frame gave. Such a pass is thrown away. Field or base is corrected in the document as it
//! was before it, and the clips are tracked again, from the points that were followed already.

use crate::calibrate::{
    BaseEstimationError, BaseProblem, ClipEvidence, ClipFrames, ClipProgress, ClipSpan,
    LengthOnLines, PaintSeen, TrackClipError, TrackClipOptions, TrackedClip, estimate_on_paint,
    length_on_lines, record_tracked, take_length, track_clip,
};
use crate::proposals::read_picture;
use std::collections::BTreeSet;
use std::path::Path;
use touchline_core::field::FieldError;
use touchline_core::geometry::mean;
use touchline_core::progress::Progress;
use touchline_core::solve::base::BaseOptions;
use touchline_documents::document::{Camera, CameraId, Document, FieldSize, Fields, Frame};
use touchline_vision::media::ReadFrames;

/// How often the base is refined at most. One round moves a base from one clicked frame to where
/// the paint of all frames has it.
const MAX_ROUNDS: usize = 3;

/// A base is replaced by one whose lines lie nearer by this share to paint that neither has seen.
/// What a base moves by below that is noise: refined on its own frames again, that of five
/// broadcasts gains 0 to 3 %.
const WORTHWHILE: f64 = 0.05;

/// The mean confidence of the tracked frames may fall by this much with a refined base. A base
/// fitted to more paint states less.
const CONFIDENCE_NOISE: f64 = 0.01;

/// How the clips of a document are tracked.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct TrackingOptions {
    /// How each clip is tracked.
    pub clip: TrackClipOptions,
    /// Whether the base is refined on the painted lines of the tracked frames, and the clips are
    /// tracked again with it. A camera without a base gets one from its clicks first. False by
    /// default.
    pub refine_base: bool,
}

/// What happens while clips are tracked.
#[derive(Debug)]
pub enum TrackingEvent {
    /// A clip is begun.
    Begun(ClipSpan),
    /// It has come so far.
    Progress(ClipProgress),
    /// The painted lines of the frames are looked at, to refine the base of a camera.
    Refining(CameraId),
    /// A clip was tracked.
    Tracked(ClipSpan, Box<TrackedClip>),
    /// A clip could not be tracked; the others are.
    Failed(ClipSpan, TrackClipError),
    /// The painted lines show the length of the field. It is taken, and the clips are tracked
    /// again, unless it is prescribed.
    Length(LengthOnLines),
    /// The base of a camera was refined, and the clips are tracked again with it.
    Refined(CameraId, PaintSeen),
    /// The frames are less certain with the refined bases, or fewer: those before stay. The mean
    /// confidences, 0 to 1.
    NoBetter {
        /// Of those that stay.
        kept: f64,
        /// With the refined bases.
        refined: f64,
    },
}

/// What came of the frames of a document's clips.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct TrackedFrames {
    /// Frames that got a camera.
    pub tracked: usize,
    /// Frames that got none.
    pub missed: usize,
    /// The tracking was ended. Clips that were finished before are tracked.
    pub is_stopped: bool,
}

/// Tracks the clips of a document, and writes their frames' cameras into it as suggestions. `clips`
/// are of this document ([`crate::calibrate::clips`]), `folder` is where its paths start. What the
/// pictures say is kept in `evidence`, one for each clip; it may be empty.
///
/// # Errors
/// The field of a camera is not valid. A clip that cannot be tracked is reported, and is no error.
pub fn track_clips(
    document: &mut Document,
    folder: &Path,
    clips: &[ClipFrames],
    reader: &mut dyn ReadFrames,
    options: &TrackingOptions,
    evidence: &mut Vec<ClipEvidence>,
    progress: &Progress<'_, TrackingEvent>,
) -> Result<TrackedFrames, FieldError> {
    evidence.resize(clips.len(), ClipEvidence::default());
    if options.refine_base {
        for camera in cameras_of(clips) {
            // What fails here fails again when the clip is tracked, and is reported then.
            let _ = give_first_base(document, folder, camera, &BaseOptions::default());
        }
    }
    let mut tracking = Tracking {
        folder,
        clips,
        reader,
        options,
        evidence,
        progress,
    };
    // What is known before a pass. Tracked cameras hold nothing, so that each pass begins from it.
    let mut known = document.clone();
    let mut frames = tracking.pass(document)?;
    if frames.is_stopped || frames.tracked == 0 {
        return Ok(frames);
    }
    if tracking.take_shown_length(document, &mut known)? {
        frames = tracking.pass(document)?;
    }
    if options.refine_base {
        frames = tracking.refine_until_settled(document, known, frames)?;
    }
    Ok(TrackedFrames {
        is_stopped: progress.is_cancelled(),
        ..frames
    })
}

/// Gives a camera that has no base one from its clicks, and solves its frames with it.
///
/// # Errors
/// The clicks give no base, or the camera's field is not valid.
pub fn give_first_base(
    document: &mut Document,
    folder: &Path,
    camera: &CameraId,
    options: &BaseOptions,
) -> Result<(), BaseEstimationError> {
    if document.camera(camera).and_then(Camera::base).is_some() {
        return Ok(());
    }
    let problem = BaseProblem::of(document.at(folder), camera)?;
    let estimated = problem.estimate(document, options, &Progress::default())?;
    estimated.write_to(document, folder)
}

fn cameras_of(clips: &[ClipFrames]) -> BTreeSet<&CameraId> {
    clips.iter().map(|clip| &clip.camera).collect()
}

/// The clips of a document while they are tracked.
struct Tracking<'a> {
    folder: &'a Path,
    clips: &'a [ClipFrames],
    reader: &'a mut dyn ReadFrames,
    options: &'a TrackingOptions,
    evidence: &'a mut [ClipEvidence],
    progress: &'a Progress<'a, TrackingEvent>,
}

impl Tracking<'_> {
    /// Tracks each clip once, from the cameras that the document knows.
    fn pass(&mut self, document: &mut Document) -> Result<TrackedFrames, FieldError> {
        let known = document.clone();
        let fields = Fields::of(known.at(self.folder))?;
        let mut frames = TrackedFrames::default();
        for (index, clip) in self.clips.iter().enumerate() {
            let first = clip
                .frames
                .iter()
                .find_map(|frame| known.frames.get(frame.place?));
            let Some((span, first)) = clip.span().zip(first) else {
                continue;
            };
            let field = fields.of_frame(&known, first);
            if self
                .progress
                .report(TrackingEvent::Begun(span.clone()))
                .is_break()
            {
                break;
            }
            let of_clip = self.progress.part(TrackingEvent::Progress);
            let (at, evidence) = (known.at(self.folder), &mut self.evidence[index]);
            let end = match track_clip(
                at,
                clip,
                field,
                self.reader,
                &self.options.clip,
                evidence,
                &of_clip,
            ) {
                Ok(tracked) => {
                    record_tracked(document, &tracked);
                    frames.tracked += tracked.frames.len();
                    frames.missed += tracked.missed.len();
                    TrackingEvent::Tracked(span, Box::new(tracked))
                }
                Err(TrackClipError::Stopped) => break,
                Err(error) => {
                    frames.missed += clip
                        .frames
                        .iter()
                        .filter(|frame| frame.place.is_some())
                        .count();
                    TrackingEvent::Failed(span, error)
                }
            };
            if self.progress.report(end).is_break() {
                break;
            }
        }
        Ok(TrackedFrames {
            is_stopped: self.progress.is_cancelled(),
            ..frames
        })
    }

    /// Measures the length of the field where the tracked frames doubt it, and takes it into the
    /// document as it was known before, if no person prescribes another. True where the clips are
    /// to be tracked again.
    fn take_shown_length(
        &mut self,
        document: &mut Document,
        known: &mut Document,
    ) -> Result<bool, FieldError> {
        let (reader, folder) = (&mut *self.reader, self.folder);
        let mut picture = |frame: &Frame| read_picture(&mut *reader, frame, folder).ok();
        let Some(found) = length_on_lines(document.at(folder), &mut picture)? else {
            return Ok(false);
        };
        if self
            .progress
            .report(TrackingEvent::Length(found.clone()))
            .is_break()
            || found.is_prescribed
        {
            return Ok(false);
        }
        take_length(known, &found);
        document.clone_from(known);
        Ok(true)
    }

    /// Refines the bases on the paint of all tracked frames and tracks again, until that moves no
    /// base. Of the passes the last one stays whose frames are about as certain as those of any: a
    /// round may begin with frames that its base has yet to settle. `known` is the document before
    /// it was tracked.
    fn refine_until_settled(
        &mut self,
        document: &mut Document,
        mut known: Document,
        mut frames: TrackedFrames,
    ) -> Result<TrackedFrames, FieldError> {
        let first = mean_confidence(document);
        let (mut best, mut last, mut tracked) = (first, first, document.clone());
        for _ in 0..MAX_ROUNDS {
            let Some(refined) = self.with_refined_bases(&tracked, &known) else {
                break;
            };
            known = refined;
            tracked.clone_from(&known);
            let frames_again = self.pass(&mut tracked)?;
            if frames_again.is_stopped {
                break;
            }
            last = mean_confidence(&tracked);
            if last >= best - CONFIDENCE_NOISE && frames_again.tracked >= frames.tracked {
                document.clone_from(&tracked);
                (best, frames) = (best.max(last), frames_again);
            }
        }
        if last < best - CONFIDENCE_NOISE {
            // Nothing is left to cancel.
            let _ = self.progress.report(TrackingEvent::NoBetter {
                kept: best,
                refined: last,
            });
        }
        Ok(frames)
    }

    /// `known` with the bases that the paint of the tracked frames gives, where that is worth it;
    /// none where it is for no camera.
    fn with_refined_bases(&mut self, tracked: &Document, known: &Document) -> Option<Document> {
        let mut refined = known.clone();
        let mut is_any = false;
        for camera in cameras_of(self.clips) {
            if self
                .progress
                .report(TrackingEvent::Refining(camera.clone()))
                .is_break()
            {
                return None;
            }
            // Too little paint, or clicks alone that give no base: the base stays.
            let Ok(Some(seen)) = self.refine_base(tracked, camera, &mut refined) else {
                continue;
            };
            is_any = true;
            if self
                .progress
                .report(TrackingEvent::Refined(camera.clone(), seen))
                .is_break()
            {
                return None;
            }
        }
        is_any.then_some(refined)
    }

    /// Writes the base that the paint of the tracked frames gives into `refined`, with the frames
    /// known there; what the paint said, or none where the base before is as good.
    fn refine_base(
        &mut self,
        tracked: &Document,
        camera: &CameraId,
        refined: &mut Document,
    ) -> Result<Option<PaintSeen>, BaseEstimationError> {
        let (reader, folder) = (&mut *self.reader, self.folder);
        let mut picture = |frame: &Frame| read_picture(&mut *reader, frame, folder).ok();
        let options = BaseOptions::default();
        // A size that was only assumed bends the base to it.
        let is_size_open = *tracked.field_of_camera(camera).size() == FieldSize::Assumed;
        let found = estimate_on_paint(
            tracked.at(folder),
            camera,
            &options,
            is_size_open,
            &mut picture,
            &Progress::default(),
        );
        let Ok(found) = found else { return Ok(None) };
        let seen = found.seen.clone();
        let is_better = seen
            .before
            .paint
            .zip(seen.after.paint)
            .is_some_and(|(before, after)| after.median_px < (1.0 - WORTHWHILE) * before.median_px);
        if is_better {
            found
                .with_pulled_frames(refined.at(folder), &mut picture)?
                .write_to(refined, folder)?;
        }
        Ok(is_better.then_some(seen))
    }
}

/// How confident the program is of the frames that it tracked, 0 to 1.
fn mean_confidence(document: &Document) -> f64 {
    let tracked = document.frames.iter().filter(|frame| frame.is_carried());
    let confidences: Vec<f64> = tracked
        .filter_map(|frame| frame.solution.as_ref()?.confidence)
        .collect();
    mean(&confidences).unwrap_or(0.0)
}
