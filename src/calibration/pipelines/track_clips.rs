//! Tracking the clips of a document: the cameras of all frames from those that are known.
//!
//! A pass can show that the field or the base is wrong. If the field is longer than assumed, its
//! lines lie beside their paint; so do the lines with a base from a single clicked frame. Such a
//! pass is discarded: the field or base is corrected in the document as it was before, and the
//! clips are tracked again with the point tracks that were already measured.

use super::clip_evidence::ClipEvidences;
use super::kept_work::DocumentChange;
use crate::calibrate::{
    BaseEstimationError, BasePaintEvidence, BaseProblem, ClipEvidence, ClipFrames, ClipProgress,
    ClipSpan, LengthOnLines, Misnamed, TrackClipError, TrackClipOptions, TrackedClip,
    estimate_on_paint, record_tracked, rename_clicks, take_length, track_clip,
};
use crate::proposals::read_picture;
use std::collections::{BTreeMap, BTreeSet};
use std::path::Path;
use touchline_core::camera::CameraBase;
use touchline_core::field::FieldError;
use touchline_core::geometry::mean;
use touchline_core::progress::Progress;
use touchline_core::solve::base::BaseOptions;
use touchline_documents::document::{Camera, CameraId, Document, FieldSize, Fields, Frame};
use touchline_vision::media::ReadFrames;

/// Maximum number of refinements of the base. One round moves a base from a single clicked frame to
/// where the paint of all frames places it.
const MAX_ROUNDS: usize = 3;

/// The mean confidence of the tracked frames may fall by this much with a refined base, because a
/// base that is fitted to more paint states lower confidences.
const CONFIDENCE_NOISE: f64 = 0.01;

/// Options of tracking the clips of a document.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct TrackingOptions {
    /// Options for each clip.
    pub clip: TrackClipOptions,
    /// Whether the base is refined on the painted lines of the tracked frames, and the clips are
    /// tracked again with it. A camera without a base gets one from its clicks first. False by
    /// default.
    pub refine_base: bool,
}

/// Events while clips are tracked.
#[derive(Debug)]
pub enum TrackingEvent {
    /// Tracking of a clip starts.
    Begun(ClipSpan),
    /// The clicks of a camera were named for the wrong sides, and have the names now that were
    /// meant.
    Renamed(CameraId, Misnamed),
    /// Progress within the clip.
    Progress(ClipProgress),
    /// The base of a camera is being refined on the painted lines of the frames.
    Refining(CameraId),
    /// A clip was tracked.
    Tracked(ClipSpan, Box<TrackedClip>),
    /// A clip could not be tracked; the others are.
    Failed(ClipSpan, TrackClipError),
    /// The painted lines determine the length of the field. Unless the user prescribes the length,
    /// it is adopted and the clips are tracked again.
    Length(LengthOnLines),
    /// The base of a camera was refined, and the clips are tracked again with it.
    Refined(CameraId, BasePaintEvidence),
    /// With the refined bases, frames are less certain or fewer; the previous ones stay. Mean
    /// confidences, 0 to 1.
    NoBetter {
        /// With the bases that stay.
        kept: f64,
        /// With the refined bases.
        refined: f64,
    },
}

/// The result for the frames of a document's clips.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct TrackedFrames {
    /// Number of frames that got a camera.
    pub tracked: usize,
    /// Number of frames that got none.
    pub missed: usize,
    /// Whether tracking was cancelled. Clips that were finished before are tracked.
    pub is_stopped: bool,
}

/// Tracks the clips of a document and writes their frames' cameras into it as suggestions. `clips`
/// are those of this document ([`crate::calibrate::clips`]), `folder` is where its relative paths
/// start. Measurements in the pictures are kept in `evidence`, one for each clip, for later passes
/// and calls; it may be empty.
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
    let mut held = ClipEvidences::in_memory(std::mem::take(evidence));
    let tracked = track_kept_clips(
        document, folder, clips, reader, options, &mut held, progress,
    );
    *evidence = held.into_memory();
    tracked
}

/// As [`track_clips`]; passes over clips that were kept are taken from there.
///
/// # Errors
/// As there.
pub(super) fn track_kept_clips(
    document: &mut Document,
    folder: &Path,
    clips: &[ClipFrames],
    reader: &mut dyn ReadFrames,
    options: &TrackingOptions,
    evidence: &mut ClipEvidences,
    progress: &Progress<'_, TrackingEvent>,
) -> Result<TrackedFrames, FieldError> {
    evidence.resize(clips.len());
    let mut without_base = BTreeMap::new();
    if options.refine_base {
        for camera in cameras_of(clips) {
            // Why a camera gets no base is reported with its clips, where the user looks for their
            // cameras.
            match give_first_base(document, folder, camera, &BaseOptions::default()) {
                Ok(None) => {}
                Ok(Some(names)) => {
                    let _ = progress.report(TrackingEvent::Renamed(camera.clone(), names));
                }
                Err(why) => {
                    without_base.insert(camera, why);
                }
            }
        }
    }
    let mut tracking = Tracking {
        folder,
        clips,
        without_base,
        reader,
        options,
        evidence,
        progress,
        lengths: Vec::new(),
    };
    // The document before a pass. Every pass starts from it, because tracked cameras must not
    // constrain the next pass.
    let mut known = document.clone();
    // First pass; then again if it shows another length of the field, and until the bases are
    // settled.
    let mut frames = tracking.pass(document)?;
    if frames.is_stopped || frames.tracked == 0 {
        return Ok(frames);
    }
    if tracking.take_shown_lengths(document, &mut known) {
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

/// Gives a camera that has no base one from its clicks, and solves its frames with it. Clicks that
/// are named for the wrong sides get the names that are meant, which are returned.
///
/// # Errors
/// The clicks give no base, or the camera's field is not valid.
pub fn give_first_base(
    document: &mut Document,
    folder: &Path,
    camera: &CameraId,
    options: &BaseOptions,
) -> Result<Option<Misnamed>, BaseEstimationError> {
    if document.camera(camera).and_then(Camera::base).is_some() {
        return Ok(None);
    }
    let problem = BaseProblem::from_document(document.at(folder), camera)?;
    let (estimated, renamed) = match problem.estimate(document, options, &Progress::default()) {
        Err(BaseEstimationError::Misnamed(names)) => {
            rename_clicks(document, camera, &names, &problem.field);
            let problem = BaseProblem::from_document(document.at(folder), camera)?;
            let estimated = problem.estimate(document, options, &Progress::default())?;
            (estimated, Some(names))
        }
        estimated => (estimated?, None),
    };
    estimated.write_to(document, folder)?;
    Ok(renamed)
}

fn cameras_of(clips: &[ClipFrames]) -> BTreeSet<&CameraId> {
    clips.iter().map(|clip| &clip.camera).collect()
}

/// A refinement of a base that was kept: the evidence, if the base was replaced, and the change.
type KeptBase = (Option<BasePaintEvidence>, DocumentChange);

/// The state while clips are tracked.
struct Tracking<'a> {
    folder: &'a Path,
    clips: &'a [ClipFrames],
    /// Why cameras without a base got none from their clicks.
    without_base: BTreeMap<&'a CameraId, BaseEstimationError>,
    reader: &'a mut dyn ReadFrames,
    options: &'a TrackingOptions,
    evidence: &'a mut ClipEvidences,
    progress: &'a Progress<'a, TrackingEvent>,
    /// The lengths of fields that the last pass found to be others than assumed.
    lengths: Vec<LengthOnLines>,
}

impl Tracking<'_> {
    /// Tracks each clip once, from the cameras in the document.
    fn pass(&mut self, document: &mut Document) -> Result<TrackedFrames, FieldError> {
        let known = document.clone();
        let fields = Fields::from_document(known.at(self.folder))?;
        let mut frames = TrackedFrames::default();
        self.lengths.clear();
        for (index, clip) in self.clips.iter().enumerate() {
            let first = clip
                .frames
                .iter()
                .find_map(|frame| known.frames.get(frame.place?));
            // All frames of a clip are of one camera and show its field, so the first one stands
            // for them.
            let Some((span, first)) = clip.span().zip(first) else {
                continue;
            };
            let field = fields.for_frame(&known, first);
            if self
                .progress
                .report(TrackingEvent::Begun(span.clone()))
                .is_break()
            {
                break;
            }
            // All clips are tracked from the document as it was before the pass, so that their
            // order does not matter.
            let of_clip = self.progress.part(TrackingEvent::Progress);
            let at = known.at(self.folder);
            let options = &self.options.clip;
            let key = self.evidence.key(at, clip, (index, field), options);
            let kept = key
                .as_ref()
                .and_then(|key| self.evidence.recall(index, key));
            let tracked = if let Some(tracked) = kept {
                Ok(tracked)
            } else {
                let evidence = self.evidence.load(index, clip);
                let tracked = track_clip(at, clip, field, self.reader, options, evidence, &of_clip);
                self.evidence
                    .keep(index, key.as_ref(), tracked.as_ref().ok());
                tracked
            };
            let end = match tracked {
                Ok(tracked) => {
                    record_tracked(document, &tracked);
                    frames.tracked += tracked.frames.len();
                    frames.missed += tracked.missed.len();
                    self.lengths.extend_from_slice(&tracked.lengths);
                    TrackingEvent::Tracked(span, Box::new(tracked))
                }
                Err(TrackClipError::Stopped) => break,
                Err(error) => {
                    let error = self.with_reason(clip, error);
                    // A clip that fails gives no frame a camera. Pictures that the document leaves
                    // out do not count.
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

    /// The error of a clip; where its camera has no base, with the reason why the clicks gave none.
    fn with_reason(&self, clip: &ClipFrames, error: TrackClipError) -> TrackClipError {
        match (error, self.without_base.get(&clip.camera)) {
            (TrackClipError::NoBase { camera }, Some(why)) => TrackClipError::NoBaseFromClicks {
                camera,
                why: Box::new(why.clone()),
            },
            (error, _) => error,
        }
    }

    /// Adopts the lengths of fields that the tracked frames require, in the document as it was
    /// before tracking, unless the user prescribes them. Of several clips with one field, the one
    /// that shows a length in most frames decides. True if the clips have to be tracked again.
    fn take_shown_lengths(&mut self, document: &mut Document, known: &mut Document) -> bool {
        let mut lengths = std::mem::take(&mut self.lengths);
        lengths.sort_by_key(|found| std::cmp::Reverse(found.frames));
        let mut taken: Vec<LengthOnLines> = Vec::new();
        for found in lengths {
            let is_taken = |other: &LengthOnLines| {
                let mut cameras = other.shifts.iter().map(|(camera, _)| camera);
                let camera = found.shifts.first().map(|(camera, _)| camera);
                other.size.name == found.size.name && cameras.any(|it| Some(it) == camera)
            };
            if taken.iter().any(is_taken) {
                continue;
            }
            let event = TrackingEvent::Length(found.clone());
            if self.progress.report(event).is_break() {
                return false;
            }
            if !found.is_prescribed {
                taken.push(found);
            }
        }
        for found in &taken {
            take_length(known, found);
        }
        if !taken.is_empty() {
            document.clone_from(known);
        }
        !taken.is_empty()
    }

    /// Refines the bases on the paint of all tracked frames and tracks again, until no base
    /// improves. Keeps the last pass with about the confidence of the best so far and no fewer
    /// frames. A single pass may be worse, because it still starts from frames of the previous
    /// base.
    fn refine_until_settled(
        &mut self,
        document: &mut Document,
        mut known: Document,
        mut frames: TrackedFrames,
    ) -> Result<TrackedFrames, FieldError> {
        let first = mean_confidence(document);
        // `tracked` is the latest pass, `document` the one that is kept.
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
                // The best confidence so far is the measure for all later passes, so that small
                // losses do not add up.
                (best, frames) = (best.max(last), frames_again);
            }
        }
        if last < best - CONFIDENCE_NOISE {
            // Nothing follows that could be cancelled, so the answer is ignored.
            let _ = self.progress.report(TrackingEvent::NoBetter {
                kept: best,
                refined: last,
            });
        }
        Ok(frames)
    }

    /// `known` with the refined bases where the refinement is worthwhile; none if it is for no
    /// camera.
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
            // With too little paint, or with clicks that determine no base, the base stays.
            let Ok(Some(seen)) = self.refine_or_recall(tracked, camera, &mut refined) else {
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

    /// As [`refine_base`](Self::refine_base), unless the result was kept.
    fn refine_or_recall(
        &mut self,
        tracked: &Document,
        camera: &CameraId,
        refined: &mut Document,
    ) -> Result<Option<BasePaintEvidence>, BaseEstimationError> {
        let work = self.evidence.work();
        let key = work.begin_key("base").and_then(|mut parts| {
            parts.add(camera);
            for document in [tracked, &*refined] {
                let at = document.at(self.folder);
                parts.add_document(at);
                let of_camera = at.document.frames.iter().enumerate();
                for (index, _) in of_camera.filter(|(_, frame)| frame.camera == *camera) {
                    parts.add(&index);
                    parts.add_frame(at, index);
                }
            }
            parts.finish()
        });
        let kept: Option<KeptBase> = key.as_ref().and_then(|key| work.recall(key));
        if let Some((seen, change)) = kept
            && let Some(changed) = change.apply(refined)
        {
            *refined = changed;
            return Ok(seen);
        }
        let before = refined.clone();
        let seen = self.refine_base(tracked, camera, refined)?;
        if let Some(key) = key
            && let Some(change) = DocumentChange::between(&before, refined)
        {
            let kept: KeptBase = (seen.clone(), change);
            self.evidence.work().keep(&key, &kept);
        }
        Ok(seen)
    }

    /// Writes the base from the paint of the tracked frames into `refined`, with the frames known
    /// there. Returns the evidence of the paint; none if the previous base is as good.
    fn refine_base(
        &mut self,
        tracked: &Document,
        camera: &CameraId,
        refined: &mut Document,
    ) -> Result<Option<BasePaintEvidence>, BaseEstimationError> {
        let (reader, folder) = (&mut *self.reader, self.folder);
        let mut picture = |frame: &Frame| read_picture(&mut *reader, frame, folder).ok();
        let options = BaseOptions::default();
        // Fit the size of the field if it is only assumed: a wrong size would otherwise be
        // compensated by a wrong base.
        let is_size_open = *tracked.field_of_camera(camera).size() == FieldSize::Assumed;
        let found = estimate_on_paint(
            tracked.at(folder),
            camera,
            &options,
            is_size_open,
            &mut picture,
            &Progress::default(),
        );
        // Too little paint, or clicks that give no base: the base that is there stays. A field that
        // is not valid has ended the first pass already.
        let Ok(found) = found else { return Ok(None) };
        let seen = found.seen.clone();
        let known = refined.camera(camera).and_then(Camera::base);
        let is_same =
            known.is_some_and(|known| is_same_base(&known, &found.estimated.estimate.base));
        let is_better = found.is_worthwhile() && !is_same;
        if is_better {
            found
                .with_pulled_frames(refined.at(folder), &mut picture)?
                .write_to(refined, folder)?;
        }
        Ok(is_better.then_some(seen))
    }
}

/// Whether a refinement leaves a base where it was: the position within a tenth of its 1-σ, the
/// lens within 0.001 of k₁.
fn is_same_base(known: &CameraBase, refined: &CameraBase) -> bool {
    const SAME_SIGMAS: f64 = 0.1;
    const SAME_K1: f64 = 0.001;
    let moved_m = (refined.position_m - known.position_m).norm();
    // Both lenses at the focal length to which the known one refers: curves with other reference
    // lengths may be the same lens.
    let k1 = |base: &CameraBase| base.distortion.at(known.distortion.at_focal_px);
    moved_m < SAME_SIGMAS * refined.sigma.position_m.norm()
        && (k1(refined) - k1(known)).abs() < SAME_K1
}

/// The mean confidence of the tracked frames, 0 to 1; 0 without any.
pub(super) fn mean_confidence(document: &Document) -> f64 {
    let tracked = document.frames.iter().filter(|frame| frame.is_tracked());
    let confidences: Vec<f64> = tracked
        .filter_map(|frame| frame.solution.as_ref()?.confidence)
        .collect();
    mean(&confidences).unwrap_or(0.0)
}
