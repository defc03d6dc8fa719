//! Cameras of a clip's frames from those that are known: points followed, carried, adjusted, held
//! to the paint, smoothed.

use super::anchors::anchors;
use super::certainty::{
    BaseWitnesses, DIFFER_PX, PaintVerdict, certainty_under_length, confidence, with_common,
};
use super::error::TrackClipError;
use super::evidence::ClipEvidence;
use super::fit::{ClipFit, FittedClip, Judged};
use super::frames::{ClipFrame, ClipFrames};
use super::options::{ClipProgress, TrackClipOptions};
use super::pictures::ClipPictures;
use crate::calibrate::size_fit::OpenSize;
use crate::calibrate::unseen_length::UnseenLength;
use touchline_core::camera::{CameraBase, Ptz, PtzCamera};
use touchline_core::field::FieldModel;
use touchline_core::geometry::ImageSize;
use touchline_core::progress::Progress;
use touchline_core::solve::Uncertainty;
use touchline_documents::document::{DocumentAt, FieldSize, FrameStatus};
use touchline_vision::media::ReadFrames;
use touchline_vision::track::{
    AdjustedClip, Carried, CarryStop, ClipCamera, ClipLens, Jitter, PosePrior, SmoothOptions,
    Unsmoothed, carry, smooth,
};

/// Where the field is as long as it is taken for, less of a picture's paint lies on no line: at
/// most 0.17 in 568 frames of three broadcasts. Where the circle lay 40 to 130 px off, 0.3 to 0.9
/// did.
const RIGHT_UNEXPLAINED: f64 = 0.2;

/// A frame of the document whose camera was carried there.
#[derive(Clone, Debug, PartialEq)]
pub struct TrackedFrame {
    /// Its place in the document.
    pub place: usize,
    /// Pan, tilt, focal length.
    pub ptz: Ptz,
    /// The same before it was smoothed; none where nothing was smoothed.
    pub raw: Option<Ptz>,
    /// How far it is to be trusted.
    pub uncertainty: Uncertainty,
    /// How probable it is that its overlay is right within 10 px at 1920 px width.
    pub confidence: f64,
    /// How far apart the cameras carried here from before and from after are, px; none where it was
    /// reached from one side, or where the painted lines decide.
    pub apart_px: Option<f64>,
    /// Whether its painted lines contradict.
    pub contradicted: bool,
    /// 1-σ by which the lines of the field's middle may lie off, because nobody has measured its
    /// length, px; none where it is known, or hardly matters here.
    pub length_px: Option<f64>,
}

/// A frame that a person decided on, on the smoothed motion as far as its own 1-σ allows.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct MovedReference {
    /// Its place in the document.
    pub place: usize,
    /// Pan, tilt, focal length.
    pub ptz: Ptz,
    /// The same as it was.
    pub raw: Ptz,
}

/// Where carrying stopped.
#[derive(Clone, Debug, PartialEq)]
pub struct ClipStop {
    /// The picture that could not be reached.
    pub picture: String,
    /// Points that could be followed into it.
    pub seen: usize,
    /// Those of them that one turn and one zoom explain.
    pub agreeing: usize,
}

/// What came of a clip.
#[derive(Clone, Debug, PartialEq)]
pub struct TrackedClip {
    /// The base of its camera.
    pub base: CameraBase,
    /// The document's frames that were reached and that nobody decided on, in the order of time.
    pub frames: Vec<TrackedFrame>,
    /// Frames that people decided on; none unless the motion is smoothed.
    pub references: Vec<MovedReference>,
    /// Frames of the document that nobody decided on, that have no camera and that were not
    /// reached, by their places.
    pub missed: Vec<usize>,
    /// How many frames keep the camera that they had, because their paint speaks more for it than
    /// for the one that was carried there.
    pub kept: usize,
    /// Where carrying stopped.
    pub stops: Vec<ClipStop>,
    /// 1-σ of a followed point, px.
    pub sigma_px: f64,
    /// By how much the points are taken as less exact, so that what is known holds; far above 1 the
    /// base or its lens is off.
    pub widened: f64,
    /// Pictures held to their painted lines.
    pub painted: usize,
    /// How unsteady the cameras are from picture to picture.
    pub jitter: Option<Jitter>,
    /// The same before smoothing; none where nothing was smoothed.
    pub raw_jitter: Option<Jitter>,
}

/// Carries the known cameras of a clip to its other frames. Frames that people decided on keep
/// their cameras. What the pictures say goes into `evidence`; what it holds of the same pictures
/// already is not looked for again.
///
/// # Errors
/// [`TrackClipError`]: its camera has no base, no frame has a camera, a picture cannot be read, or it was stopped.
pub fn track_clip(
    at: DocumentAt<'_>,
    clip: &ClipFrames,
    field: &FieldModel,
    reader: &mut dyn ReadFrames,
    options: &TrackClipOptions,
    evidence: &mut ClipEvidence,
    progress: &Progress<'_, ClipProgress>,
) -> Result<TrackedClip, TrackClipError> {
    let document = at.document;
    let camera = document
        .cameras
        .iter()
        .find(|camera| camera.id == clip.camera);
    let frame_at = |place: usize| document.frames.get(place).map(|frame| &**frame);
    let one = clip.frames.iter().find_map(|frame| frame_at(frame.place?));
    let (base, size) = camera
        .zip(one)
        .and_then(|(camera, frame)| {
            Some((camera.base_without_frame_lens(frame)?, frame.image_size))
        })
        .ok_or_else(|| TrackClipError::NoBase {
            camera: clip.camera.to_string(),
        })?;
    let camera = ClipCamera::with_lenses(base, known_lenses(at, clip, &base, options));
    let known = anchors(document, clip, field, &camera);
    if known.is_empty() {
        return Err(TrackClipError::NothingKnown {
            frames: clip.frames.len(),
        });
    }
    let pictures = ClipPictures { at, clip, size };
    let tracks = pictures.follow_points(reader, options.follow, evidence, progress)?;
    evidence.with_camera(&camera);
    let anchors: Vec<PosePrior> = known.iter().map(|(anchor, _)| *anchor).collect();
    let carried = carry(&camera, &tracks, &anchors, &options.carry);
    let spec = document.field_of_camera(&clip.camera);
    let is_size_fitted = *spec.size() == FieldSize::Fitted;
    let fit = ClipFit {
        camera: &camera,
        field,
        tracks: &tracks,
        carried: &carried,
        known: &anchors,
        pictures,
        is_size_fitted,
        options,
    };
    let FittedClip {
        adjusted,
        painted,
        judged,
    } = fit.adjust_to_paint(reader, evidence, progress)?;
    let Judged {
        paint,
        kept,
        unexplained,
        is_of_other_field,
    } = judged;
    let is_length_open = *spec.size() == FieldSize::Assumed || is_of_other_field;
    let open = spec
        .template(at.folder)
        .ok()
        .filter(|_| is_length_open)
        .map(|template| OpenSize::new(template, field));
    let shown: Vec<(Ptz, ImageSize)> = anchors
        .iter()
        .filter(|anchor| paint[anchor.frame] != PaintVerdict::Contradicts)
        .map(|anchor| (anchor.ptz, size))
        .collect();
    let unseen = open.and_then(|open| UnseenLength::new(open, field, &base, &shown));

    let raw: Vec<Option<Ptz>> = adjusted
        .frames
        .iter()
        .map(|frame| frame.map(|frame| frame.ptz))
        .collect();
    let mut smoothed = if options.smooth {
        smoothed(at, clip, &adjusted)
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
        kept: 0,
        stops: stops(clip, &carried),
        sigma_px: adjusted.sigma_px,
        widened: adjusted.widened,
        painted,
        jitter: Jitter::of(&smoothed),
        raw_jitter: Jitter::of(&raw).filter(|_| options.smooth),
    };
    let witnesses = BaseWitnesses::new(raw.iter().copied().zip(&paint), size);
    let certain = known
        .iter()
        .map(|(_, confidence)| *confidence)
        .fold(0.0, f64::max);
    for (frame, of_clip) in clip.frames.iter().enumerate() {
        let Some((place, document_frame)) = of_clip
            .place
            .and_then(|place| Some((place, frame_at(place)?)))
        else {
            continue;
        };
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
        let reached = smoothed[frame]
            .zip(adjusted.frames[frame])
            .and_then(|(ptz, adjusted)| {
                let is_focal_known = camera.focal_px_at(frame).is_some();
                let covariance = with_common(adjusted.covariance, ptz, size, is_focal_known);
                let camera = PtzCamera::new(camera.base_at(frame), ptz);
                Some((
                    camera,
                    Uncertainty::of_known(&camera, covariance, size).ok()?,
                ))
            });
        let Some((camera, uncertainty)) = reached else {
            // A camera that it had before stays.
            tracked
                .missed
                .extend(document_frame.ptz.is_none().then_some(place));
            continue;
        };
        let apart_px = carried.apart_px[frame].filter(|_| paint[frame] != PaintVerdict::Agrees);
        // A line that lies beside its paint leaves that paint unexplained.
        let of_frame = unseen
            .as_ref()
            .filter(|_| unexplained[frame] > RIGHT_UNEXPLAINED);
        let by_length_px = of_frame.map_or(0.0, |unseen| unseen.sigma_px(camera.ptz(), size));
        let of_length = match paint[frame] {
            // It lies beside its paint for that reason already.
            PaintVerdict::Contradicts => 1.0,
            PaintVerdict::Agrees | PaintVerdict::Silent => {
                certainty_under_length(by_length_px, size)
            }
        };
        let is_base_shown = paint[frame] == PaintVerdict::Agrees || witnesses.show(camera.ptz());
        let of_camera = if is_base_shown {
            uncertainty.with_exact_base()
        } else {
            uncertainty
        };
        let confidence =
            certain * confidence(&camera, &of_camera, size, apart_px, paint[frame]) * of_length;
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
            length_px: Some(by_length_px).filter(|px| *px > DIFFER_PX * size.scale_from_1920()),
        });
    }
    Ok(tracked)
}

/// The lenses that the frames of a clip state.
fn known_lenses(
    at: DocumentAt<'_>,
    clip: &ClipFrames,
    base: &CameraBase,
    options: &TrackClipOptions,
) -> Vec<Option<ClipLens>> {
    let lens_of = |frame: &ClipFrame| {
        let lens = at.document.frames.get(frame.place?)?.lens.as_ref()?;
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
    };
    clip.frames.iter().map(lens_of).collect()
}

fn stops(clip: &ClipFrames, carried: &Carried) -> Vec<ClipStop> {
    let stop = |stop: &CarryStop| ClipStop {
        picture: clip.frames[stop.frame].source.to_string(),
        seen: stop.seen,
        agreeing: stop.agreeing,
    };
    carried.stops.iter().map(stop).collect()
}

/// The adjusted cameras, each stretch without a gap as one motion.
fn smoothed(at: DocumentAt<'_>, clip: &ClipFrames, adjusted: &AdjustedClip) -> Vec<Option<Ptz>> {
    let is_reference = |frame: usize| {
        let of_document = clip.frames[frame]
            .place
            .and_then(|place| at.document.frames.get(place));
        of_document.is_some_and(|frame| frame.status == FrameStatus::Reference)
    };
    let mut smoothed = vec![None; adjusted.frames.len()];
    let mut frame = 0;
    while frame < smoothed.len() {
        let stretch: Vec<Unsmoothed> = adjusted.frames[frame..]
            .iter()
            .map_while(|adjusted| *adjusted)
            .enumerate()
            .map(|(place, adjusted)| Unsmoothed {
                ptz: adjusted.ptz,
                covariance: adjusted.covariance,
                is_reference: is_reference(frame + place),
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
