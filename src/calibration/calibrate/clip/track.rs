//! Cameras of all frames of a clip from the cameras that are known: tracks points, propagates the
//! known cameras along them, adjusts all frames jointly with the painted lines, and smooths the
//! motion on request.

use super::anchors::anchors;
use super::certainty::{
    BaseWitnesses, DIFFER_PX, PaintVerdict, TrackedOverlay, confidence, most_certain, with_common,
    with_unseen_lines,
};
use super::error::TrackClipError;
use super::evidence::ClipEvidence;
use super::fit::{ClipFit, FittedClip, PaintVerdicts};
use super::frames::{ClipFrame, ClipFrames};
use super::options::{ClipProgress, TrackClipOptions};
use super::pictures::ClipPictures;
use super::unmeasured::Unmeasured;
use crate::calibrate::LengthOnLines;
use touchline_core::camera::{CameraBase, Ptz, PtzCamera};
use touchline_core::field::FieldModel;
use touchline_core::progress::Progress;
use touchline_core::solve::Uncertainty;
use touchline_documents::document::{Document, DocumentAt, FrameStatus};
use touchline_vision::media::ReadFrames;
use touchline_vision::track::{
    AdjustedClip, ClipCamera, ClipLens, Jitter, PosePrior, PropagatedClip, SmoothOptions,
    UnsmoothedFrame, propagate, smooth,
};

/// A frame of the document to which a camera was propagated.
#[derive(Clone, Debug, PartialEq)]
pub struct TrackedFrame {
    /// Its index in the document.
    pub place: usize,
    /// Pan, tilt, focal length.
    pub ptz: Ptz,
    /// Pan, tilt and focal length before smoothing; none where nothing was smoothed.
    pub raw: Option<Ptz>,
    /// The uncertainty of the camera.
    pub uncertainty: Uncertainty,
    /// The probability that its overlay is right within 10 px at 1920 px width.
    pub confidence: f64,
    /// Distance between the cameras propagated from the known frame before and from the one after,
    /// px; none where only one side reached the frame, or where the painted lines decide.
    pub apart_px: Option<f64>,
    /// Whether the painted lines contradict the camera.
    pub contradicted: bool,
    /// 1-σ of the projected lines that no known camera shows, px, as the field's size is not
    /// measured; none where it is known or hardly matters here.
    pub length_px: Option<f64>,
}

/// A frame that a person decided on, moved towards the smoothed motion by at most its own 1-σ.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct MovedReference {
    /// Its index in the document.
    pub place: usize,
    /// Pan, tilt, focal length.
    pub ptz: Ptz,
    /// The same before it was moved.
    pub raw: Ptz,
}

/// A picture that propagation could not reach.
#[derive(Clone, Debug, PartialEq)]
pub struct ClipStop {
    /// The file, and its frame.
    pub picture: String,
    /// Points that could be tracked into it.
    pub seen: usize,
    /// Those of them that one rotation and one zoom explain.
    pub agreeing: usize,
}

/// The result of tracking a clip.
#[derive(Clone, Debug, PartialEq)]
pub struct TrackedClip {
    /// The base of its camera.
    pub base: CameraBase,
    /// The frames of the document that were reached and that no person decided on, in order of
    /// time.
    pub frames: Vec<TrackedFrame>,
    /// Frames that people decided on; empty unless the motion is smoothed.
    pub references: Vec<MovedReference>,
    /// Frames of the document that were not reached, have no camera and were not decided on by a
    /// person, by their indices.
    pub missed: Vec<usize>,
    /// Why the pictures from some frame on could not be read; these are among the missed ones.
    pub unreadable: Option<String>,
    /// Number of frames that keep their earlier camera because it explains their paint better than
    /// the tracked one.
    pub kept: usize,
    /// Where propagation stopped.
    pub stops: Vec<ClipStop>,
    /// 1-σ of a tracked point, px.
    pub sigma_px: f64,
    /// Factor by which the covariance of the points was inflated so that the known cameras prevail.
    /// Far above 1, the base or its lens is wrong.
    pub inflation: f64,
    /// Number of pictures aligned to their painted lines.
    pub painted: usize,
    /// Other lengths of the field than the assumed ones, which the painted lines require.
    pub lengths: Vec<LengthOnLines>,
    /// How unsteady the cameras are from picture to picture.
    pub jitter: Option<Jitter>,
    /// The same before smoothing; none where nothing was smoothed.
    pub raw_jitter: Option<Jitter>,
}

/// Tracks the known cameras of a clip to its other frames, all of which can be read; see
/// [`track_clip`](super::track_clip).
///
/// # Errors
/// As there; a picture that cannot be read is one.
pub(super) fn track_readable(
    at: DocumentAt<'_>,
    clip: &ClipFrames,
    field: &FieldModel,
    reader: &mut dyn ReadFrames,
    options: &TrackClipOptions,
    evidence: &mut ClipEvidence,
    progress: &Progress<'_, ClipProgress>,
) -> Result<TrackedClip, TrackClipError> {
    let document = at.document;
    // The base and the picture size are those of the clip's camera; lenses that frames state
    // override the base's lens frame by frame.
    let camera = document.camera(&clip.camera);
    let one = clip
        .frames
        .iter()
        .find_map(|frame| document.frames.get(frame.place?));
    let (base, size) = camera
        .zip(one)
        .and_then(|(camera, frame)| {
            Some((camera.base_without_frame_lens(frame)?, frame.image_size))
        })
        .ok_or_else(|| TrackClipError::NoBase {
            camera: clip.camera.to_string(),
        })?;
    // What is open of the field's size follows below from the lines that known frames show, and
    // measured where the clip shows it. It must not count twice.
    let mut tracked_base = base;
    tracked_base.sigma.size = Default::default();
    let lenses = known_lenses(at, clip, &base, options);
    let camera = ClipCamera::with_lenses(tracked_base, lenses);
    // Pose priors: the frames whose cameras are already known.
    let known = anchors(document, clip, field, &camera);
    if known.is_empty() {
        return Err(TrackClipError::NothingKnown {
            frames: clip.frames.len(),
        });
    }
    // Track points, propagate the priors along them to initialise all frames, then adjust jointly.
    let pictures = ClipPictures { at, clip, size };
    let tracks = pictures.follow_points(reader, options, evidence, progress)?;
    evidence.with_camera(&camera, field);
    let anchors: Vec<PosePrior> = known.iter().map(|(anchor, _)| *anchor).collect();
    let propagated = propagate(&camera, &tracks, &anchors, &options.propagate);
    let spec = document.field_of_camera(&clip.camera);
    let fit = ClipFit {
        camera: &camera,
        field,
        tracks: &tracks,
        propagated: &propagated,
        known: &anchors,
        pictures,
        options,
    };
    let FittedClip {
        adjusted,
        by_points,
        painted,
        paint_verdicts,
    } = fit.adjust_to_paint(reader, evidence, progress)?;
    let PaintVerdicts {
        paint,
        kept,
        is_of_other_field,
    } = paint_verdicts;
    // The size of the field is open unless it is stated, and where the paint contradicts what is
    // stated.
    let unmeasured = if spec.is_size_stated() && !is_of_other_field {
        Unmeasured::default()
    } else {
        Unmeasured::measure(&fit, &by_points, &paint, reader)?
    };

    let raw: Vec<Option<Ptz>> = adjusted
        .frames
        .iter()
        .map(|frame| frame.map(|frame| frame.ptz))
        .collect();
    // Smoothing changes the focal length of all frames; a frame that states its lens gets its own
    // back.
    let mut smoothed = if options.smooth {
        smooth_cameras(at, clip, &adjusted)
    } else {
        raw.clone()
    };
    for (frame, ptz) in smoothed.iter_mut().enumerate() {
        *ptz = ptz.map(|ptz| camera.with_known_focal(frame, ptz));
    }
    let mut tracked = TrackedClip {
        base,
        frames: Vec::new(),
        references: Vec::new(),
        missed: Vec::new(),
        unreadable: None,
        kept: 0,
        stops: stops(clip, &propagated),
        sigma_px: adjusted.sigma_px,
        inflation: adjusted.inflation,
        painted,
        lengths: unmeasured.lengths.clone(),
        jitter: Jitter::measure(&smoothed),
        raw_jitter: Jitter::measure(&raw).filter(|_| options.smooth),
    };
    let witnesses = BaseWitnesses::new(raw.iter().copied().zip(&paint), size);
    // No tracked frame is more certain than the most certain prior.
    let certain = most_certain(known.iter().map(|(anchor, of)| (*of, paint[anchor.frame])));
    for (frame, of_clip) in clip.frames.iter().enumerate() {
        let Some((place, document_frame)) = of_clip
            .place
            .and_then(|place| Some((place, document.frames.get(place)?)))
        else {
            continue;
        };
        // A frame that a person decided on keeps its camera, unless the motion is smoothed: then it
        // follows by at most 1 σ of its prior.
        if !document_frame.is_open() {
            let anchor = known
                .iter()
                .find(|(anchor, _)| anchor.frame == frame)
                .filter(|_| options.smooth);
            tracked.references.extend(anchor.zip(smoothed[frame]).map(
                |((anchor, _), smoothed)| MovedReference {
                    place,
                    ptz: anchor.towards(smoothed, 1.0),
                    raw: anchor.ptz,
                },
            ));
            continue;
        }
        // The uncertainty of the frame: its part of the joint covariance, the error common to all
        // frames, that of lines that no known frame shows, and the base's.
        let reached = smoothed[frame]
            .zip(adjusted.frames[frame])
            .and_then(|(ptz, adjusted)| {
                let is_focal_known = camera.focal_px_at(frame).is_some();
                let covariance = with_common(adjusted.covariance, ptz, size, is_focal_known);
                let camera = PtzCamera::new(camera.base_at(frame), ptz);
                let length_px = unmeasured.sigma_px(&camera, size);
                let covariance = with_unseen_lines(covariance, length_px, ptz);
                let known = Uncertainty::from_covariance(&camera, covariance, size).ok()?;
                Some((camera, known, length_px))
            });
        let Some((camera, uncertainty, length_px)) = reached else {
            // A camera that it had before stays.
            tracked
                .missed
                .extend(document_frame.ptz.is_none().then_some(place));
            continue;
        };
        // Where the paint agrees, a disagreement between the two directions of propagation is
        // settled.
        let apart_px = propagated.apart_px[frame].filter(|_| paint[frame] != PaintVerdict::Agrees);
        // Paint that agrees here, or in a frame that shows nearly the same, confirms the base in
        // this direction: its σ then does not count.
        let is_base_shown = paint[frame] == PaintVerdict::Agrees || witnesses.show(camera.ptz());
        let of_camera = if is_base_shown {
            uncertainty.with_exact_base()
        } else {
            uncertainty
        };
        let overlay = TrackedOverlay {
            corner_px: of_camera.worst_corner_sigma_px(&camera, size),
            apart_px,
            paint: paint[frame],
        };
        let confidence = certain * confidence(&overlay, size);
        if kept.contains(&frame) {
            tracked.kept += 1;
            continue;
        }
        tracked.frames.push(TrackedFrame {
            place,
            ptz: camera.ptz(),
            raw: raw[frame].filter(|_| options.smooth),
            uncertainty,
            confidence,
            apart_px,
            contradicted: paint[frame] == PaintVerdict::Contradicts,
            length_px: Some(length_px).filter(|px| *px > DIFFER_PX * size.scale_from_1920()),
        });
    }
    Ok(tracked)
}

/// The lenses that the frames of a clip state, one entry per frame. With `seek_focal` a stated
/// focal length is only a start and is not fixed.
fn known_lenses(
    at: DocumentAt<'_>,
    clip: &ClipFrames,
    base: &CameraBase,
    options: &TrackClipOptions,
) -> Vec<Option<ClipLens>> {
    clip.frames
        .iter()
        .map(|frame| known_lens(at.document, frame, base, options))
        .collect()
}

/// The lens that a frame of a clip states; see [`known_lenses`].
fn known_lens(
    document: &Document,
    frame: &ClipFrame,
    base: &CameraBase,
    options: &TrackClipOptions,
) -> Option<ClipLens> {
    let lens = document.frames.get(frame.place?)?.lens.as_ref()?;
    let CameraBase {
        principal_point,
        distortion,
        ..
    } = lens.base_with(base);
    let focal_px = Some(lens.focal_px).filter(|_| !options.seek_focal);
    Some(ClipLens {
        principal_point,
        distortion,
        focal_px,
    })
}

fn stops(clip: &ClipFrames, propagated: &PropagatedClip) -> Vec<ClipStop> {
    propagated
        .stops
        .iter()
        .map(|stop| ClipStop {
            picture: clip.frames[stop.frame].source.to_string(),
            seen: stop.seen,
            agreeing: stop.agreeing,
        })
        .collect()
}

/// The smoothed cameras. Each run of reached frames without a gap is smoothed as one motion.
fn smooth_cameras(
    at: DocumentAt<'_>,
    clip: &ClipFrames,
    adjusted: &AdjustedClip,
) -> Vec<Option<Ptz>> {
    let mut smoothed = vec![None; adjusted.frames.len()];
    let mut frame = 0;
    while frame < smoothed.len() {
        // A frame that was not reached ends a run: across the gap the motion is not known.
        let stretch: Vec<UnsmoothedFrame> = adjusted.frames[frame..]
            .iter()
            .map_while(|adjusted| *adjusted)
            .enumerate()
            .map(|(place, adjusted)| UnsmoothedFrame {
                ptz: adjusted.ptz,
                covariance: adjusted.covariance,
                is_reference: is_reference(at.document, &clip.frames[frame + place]),
            })
            .collect();
        for (place, ptz) in smooth(&stretch, &SmoothOptions::default())
            .into_iter()
            .enumerate()
        {
            smoothed[frame + place] = Some(ptz);
        }
        frame += stretch.len() + 1;
    }
    smoothed
}

fn is_reference(document: &Document, frame: &ClipFrame) -> bool {
    let of_document = frame.place.and_then(|place| document.frames.get(place));
    of_document.is_some_and(|frame| frame.status == FrameStatus::Reference)
}
