//! Cameras of a clip's frames from those that are known: points followed, carried, adjusted, held to the paint, smoothed.

use super::anchors::anchors;
use super::error::TrackClipError;
use super::evidence::{ClipEvidence, FollowedPictures};
use super::frames::ClipFrames;
use super::paint::{Painted, painted, share_alike};
use crate::camera::{CameraBase, Ptz, PtzCamera};
use crate::document::{DocumentAt, FrameStatus};
use crate::field::FieldModel;
use crate::geometry::{ImageSize, Mat3, PixelBox, Vec3};
use crate::media::{Picture, ReadFrames};
use crate::solve::Uncertainty;
use crate::track::{
    AdjustOptions, AdjustedClip, Anchor, Carried, CarryOptions, FollowOptions, Jitter, PointFollower, PointTracks,
    SmoothOptions, TrackError, Unsmoothed, adjust_clip, carry, smooth,
};
use std::ops::ControlFlow;

/// How a clip is tracked.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct TrackClipOptions {
    /// How points are followed.
    pub follow: FollowOptions,
    /// When a frame is not carried on to.
    pub carry: CarryOptions,
    /// How all is adjusted.
    pub adjust: AdjustOptions,
    /// Every so many frames are held to their painted lines; none of them at 0. 5 by default.
    pub paint_every: usize,
    /// Whether the motion is smoothed. False by default.
    pub smooth: bool,
}

impl Default for TrackClipOptions {
    fn default() -> Self {
        Self {
            follow: FollowOptions::default(),
            carry: CarryOptions::default(),
            adjust: AdjustOptions::default(),
            paint_every: 5,
            smooth: false,
        }
    }
}

/// How far it has come.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum ClipProgress {
    /// Points are followed: frames done, of all.
    Following(usize, usize),
    /// Frames are held to their painted lines: done, of all.
    Painting(usize, usize),
    /// All frames are adjusted.
    Adjusting,
}

/// Told of the progress; may end it.
pub type WatchClip<'a> = &'a mut dyn FnMut(ClipProgress) -> ControlFlow<()>;

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
    /// How far apart the cameras carried here from before and from after are, px; none where it was reached from one side, or
    /// where the painted lines decide.
    pub apart_px: Option<f64>,
    /// Whether its painted lines contradict.
    pub contradicted: bool,
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
    /// Frames of the document that nobody decided on and that were not reached, by their places.
    pub missed: Vec<usize>,
    /// Where carrying stopped.
    pub stops: Vec<ClipStop>,
    /// 1-σ of a followed point, px.
    pub sigma_px: f64,
    /// By how much the points are taken as less exact, so that what is known holds; far above 1 the base or its lens is off.
    pub widened: f64,
    /// Pictures held to their painted lines.
    pub painted: usize,
    /// How unsteady the cameras are from picture to picture.
    pub jitter: Option<Jitter>,
    /// The same before smoothing; none where nothing was smoothed.
    pub raw_jitter: Option<Jitter>,
}

/// Carries the known cameras of a clip to its other frames. Frames that people decided on keep their cameras. What the pictures
/// say goes into `evidence`; what it holds of the same pictures already is not looked for again.
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
    watch: WatchClip<'_>,
) -> Result<TrackedClip, TrackClipError> {
    let document = at.document;
    let camera = document.cameras.iter().find(|camera| camera.id == clip.camera);
    let of_document = |place: usize| document.frames.get(place).map(|frame| &**frame);
    let one = clip.frames.iter().find_map(|frame| of_document(frame.place?));
    let (base, size) = camera
        .zip(one)
        .and_then(|(camera, frame)| Some((camera.base_for(frame)?, frame.image_size)))
        .ok_or_else(|| TrackClipError::NoBase { camera: clip.camera.to_string() })?;
    let known = anchors(document, clip, &base);
    if known.is_empty() {
        return Err(TrackClipError::NothingKnown { frames: clip.frames.len() });
    }
    let clip_pictures = ClipPictures { at, clip, size };
    let tracks = clip_pictures.followed(reader, options.follow, evidence, watch)?;
    evidence.with_base(&base);
    let mut anchors: Vec<Anchor> = known.iter().map(|(anchor, _)| *anchor).collect();
    let carried = carry(&base, &tracks, &anchors, &options.carry);
    let adjust = |anchors: &[Anchor], watch: &mut dyn FnMut(ClipProgress) -> ControlFlow<()>| {
        go_on(watch(ClipProgress::Adjusting))?;
        let undetermined = TrackClipError::Undetermined { frames: clip.frames.len() };
        adjust_clip(&base, &tracks, &carried, anchors, &options.adjust).ok_or(undetermined)
    };
    let mut adjusted = adjust(&anchors, watch)?;
    let mut paint = vec![Paint::Silent; clip.frames.len()];
    let mut painted = 0;
    if options.paint_every > 0 {
        let found = clip_pictures.painted(reader, &adjusted, (field, &base), options.paint_every, evidence, watch)?;
        for (frame, found) in found {
            let says = match found {
                Painted::Snapped(anchor) => {
                    anchors.push(anchor);
                    Paint::Agrees
                }
                Painted::Contradicts => Paint::Contradicts,
                Painted::Open => Paint::Silent,
            };
            // The frames up to the next one that is asked are like it.
            paint[frame..].iter_mut().take(options.paint_every).for_each(|paint| *paint = says);
        }
        share_alike(&mut anchors[known.len()..], size);
        painted = anchors.len() - known.len();
        if painted > 0 {
            adjusted = adjust(&anchors, watch)?;
        }
    }
    let raw: Vec<Option<Ptz>> = adjusted.frames.iter().map(|frame| frame.map(|frame| frame.ptz)).collect();
    let smoothed = if options.smooth { smoothed(at, clip, &adjusted) } else { raw.clone() };
    let mut tracked = TrackedClip {
        base,
        frames: Vec::new(),
        references: Vec::new(),
        missed: Vec::new(),
        stops: stops(clip, &carried),
        sigma_px: adjusted.sigma_px,
        widened: adjusted.widened,
        painted,
        jitter: Jitter::of(&smoothed),
        raw_jitter: Jitter::of(&raw).filter(|_| options.smooth),
    };
    let certain = known.iter().map(|(_, confidence)| *confidence).fold(0.0, f64::max);
    for (frame, of_clip) in clip.frames.iter().enumerate() {
        let Some((place, document_frame)) = of_clip.place.and_then(|place| Some((place, of_document(place)?))) else {
            continue;
        };
        if !document_frame.is_open() {
            let anchor = known.iter().find(|(anchor, _)| anchor.frame == frame).filter(|_| options.smooth);
            tracked.references.extend(anchor.zip(smoothed[frame]).map(|((anchor, _), smoothed)| MovedReference {
                place,
                ptz: anchor.towards(smoothed, 1.0),
                raw: anchor.ptz,
            }));
            continue;
        }
        let known = smoothed[frame].zip(adjusted.frames[frame]).and_then(|(ptz, adjusted)| {
            let camera = PtzCamera::new(base, ptz);
            Some((camera, Uncertainty::of_known(&camera, with_common(adjusted.covariance, ptz, size), size).ok()?))
        });
        let Some((camera, uncertainty)) = known else {
            tracked.missed.push(place);
            continue;
        };
        let apart_px = carried.apart_px[frame].filter(|_| paint[frame] != Paint::Agrees);
        tracked.frames.push(TrackedFrame {
            place,
            ptz: camera.ptz(),
            raw: raw[frame].filter(|_| options.smooth),
            uncertainty,
            confidence: certain * confidence(&camera, &uncertainty, size, apart_px, paint[frame]),
            apart_px,
            contradicted: paint[frame] == Paint::Contradicts,
        });
    }
    Ok(tracked)
}

/// What the frames of a clip err by alike, 1-σ, as no further frame mends it: their lines are half a pixel thick far away. Pan and
/// tilt in px at 1920 px width, the focal length as a share of it. A clip is one draw of it: of ten drawn clips held by exact cameras 90 %
/// of the frames lie within their stated 68 %, of one held by a person's clicks 60 %.
const COMMON_PX: f64 = 0.09;
const COMMON_OF_FOCAL: f64 = 2.5e-4;

/// The covariance (pan rad, tilt rad, focal length px) of a frame's camera with what all frames have in common.
fn with_common(mut covariance: Mat3, ptz: Ptz, size: ImageSize) -> Mat3 {
    let turn = COMMON_PX * size.scale_from_1920() / ptz.focal_px;
    let common = Vec3::new(turn, turn, COMMON_OF_FOCAL * ptz.focal_px);
    covariance += Mat3::from_diagonal(&common.component_mul(&common));
    covariance
}

/// An overlay that is off by no more is right, px at 1920 px width.
const RIGHT_PX: f64 = 10.0;

/// No camera that nobody has looked at is more certain.
const AT_MOST: f64 = 0.99;

/// What is left of the certainty where the paint contradicts, or where both sides do.
const CONTRADICTED: f64 = 0.3;

/// How probable it is that a tracked camera's overlay is right: its error has a Rayleigh distribution.
fn confidence(
    camera: &PtzCamera,
    uncertainty: &Uncertainty,
    size: ImageSize,
    apart_px: Option<f64>,
    paint: Paint,
) -> f64 {
    let px = size.scale_from_1920();
    // The root of the covariance's trace is √2 times the 1-σ of each coordinate.
    // What the base leaves open is the same for all frames, and the known ones show it.
    let uncertainty = uncertainty.with_exact_base();
    let sigma_px = uncertainty.worst_corner_sigma_px(camera, size) / 2f64.sqrt();
    let right = 1.0 - (-0.5 * (RIGHT_PX * px / sigma_px).powi(2)).exp();
    let both_sides = apart_px.is_none_or(|apart_px| apart_px <= RIGHT_PX * px);
    let is_contradicted = match paint {
        Paint::Agrees => false,
        Paint::Silent => !both_sides,
        Paint::Contradicts => true,
    };
    right.min(AT_MOST) * if is_contradicted { CONTRADICTED } else { 1.0 }
}

/// What the painted lines say about a frame's camera.
#[derive(Clone, Copy, PartialEq, Eq)]
enum Paint {
    Agrees,
    Silent,
    Contradicts,
}

fn go_on(flow: ControlFlow<()>) -> Result<(), TrackClipError> {
    if flow.is_break() { Err(TrackClipError::Stopped) } else { Ok(()) }
}

fn stops(clip: &ClipFrames, carried: &Carried) -> Vec<ClipStop> {
    let stop = |stop: &crate::track::CarryStop| ClipStop {
        picture: clip.frames[stop.frame].source.to_string(),
        seen: stop.seen,
        agreeing: stop.agreeing,
    };
    carried.stops.iter().map(stop).collect()
}

/// The adjusted cameras, each stretch without a gap as one motion.
fn smoothed(at: DocumentAt<'_>, clip: &ClipFrames, adjusted: &AdjustedClip) -> Vec<Option<Ptz>> {
    let is_reference = |frame: usize| {
        let of_document = clip.frames[frame].place.and_then(|place| at.document.frames.get(place));
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
        for (place, ptz) in smooth(&stretch, &SmoothOptions::default()).into_iter().enumerate() {
            smoothed[frame + place] = Some(ptz);
        }
        frame += stretch.len() + 1;
    }
    smoothed
}

/// The pictures of a clip.
struct ClipPictures<'a> {
    at: DocumentAt<'a>,
    clip: &'a ClipFrames,
    size: ImageSize,
}

impl ClipPictures<'_> {
    fn read(&self, reader: &mut dyn ReadFrames, frame: usize) -> Result<Picture, TrackClipError> {
        let source = &self.clip.frames[frame].source;
        let picture = reader.read(source)?;
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

    /// What gives no points in a frame. One that the document leaves out has the masks of the frame before.
    fn masks(&self, frame: usize) -> Vec<PixelBox> {
        let before = self.clip.frames[..=frame].iter().rev().find_map(|frame| frame.place);
        let of_document = before.and_then(|place| self.at.document.frames.get(place));
        of_document.map(|frame| self.at.document.masks_of(frame)).unwrap_or_default()
    }

    /// The points of all pictures.
    fn followed(
        &self,
        reader: &mut dyn ReadFrames,
        options: FollowOptions,
        evidence: &mut ClipEvidence,
        watch: WatchClip<'_>,
    ) -> Result<PointTracks, TrackClipError> {
        let pictures =
            FollowedPictures { sources: self.clip.frames.iter().map(|frame| frame.source.clone()).collect(), options };
        let masks: Vec<_> = (0..self.clip.frames.len()).map(|frame| self.masks(frame)).collect();
        if let Some(tracks) = evidence.tracks(&pictures, &masks) {
            return Ok(tracks);
        }
        let tracks = self.newly_followed(reader, options, &masks, watch)?;
        evidence.begin(pictures, masks, tracks.clone());
        Ok(tracks)
    }

    /// The points of all pictures, read one after the other; while one picture's are followed the next is read.
    fn newly_followed(
        &self,
        reader: &mut dyn ReadFrames,
        options: FollowOptions,
        masks: &[Vec<PixelBox>],
        watch: WatchClip<'_>,
    ) -> Result<PointTracks, TrackClipError> {
        let count = self.clip.frames.len();
        let mut follower = PointFollower::new(self.size, options);
        let mut next = (count > 0).then(|| self.read(reader, 0)).transpose()?;
        for (frame, masks) in masks.iter().enumerate() {
            go_on(watch(ClipProgress::Following(frame, count)))?;
            let Some(picture) = next.take() else { break };
            let mut ended: Result<usize, TrackError> = Ok(0);
            let read = rayon::in_place_scope(|scope| {
                scope.spawn(|_| ended = follower.add(&picture, masks));
                (frame + 1 < count).then(|| self.read(reader, frame + 1)).transpose()
            });
            ended?;
            next = read?;
        }
        Ok(follower.finished())
    }

    /// What the paint of every so many pictures says.
    fn painted(
        &self,
        reader: &mut dyn ReadFrames,
        adjusted: &AdjustedClip,
        (field, base): (&FieldModel, &CameraBase),
        every: usize,
        evidence: &mut ClipEvidence,
        watch: WatchClip<'_>,
    ) -> Result<Vec<(usize, Painted)>, TrackClipError> {
        let reached = adjusted.frames.iter().enumerate().filter_map(|(at, frame)| Some((at, (*frame)?.ptz)));
        let asked: Vec<(usize, Ptz)> = reached.filter(|(at, _)| at % every == 0).collect();
        let mut found = Vec::with_capacity(asked.len());
        for (done, &(frame, ptz)) in asked.iter().enumerate() {
            go_on(watch(ClipProgress::Painting(done, asked.len())))?;
            let says = if let Some(says) = evidence.paint(frame, ptz, self.size) {
                says
            } else {
                let picture = self.read(reader, frame)?;
                let says = painted(&picture, &self.masks(frame), field, base, (frame, ptz));
                evidence.keep_paint(frame, ptz, says.clone());
                says
            };
            found.push((frame, says));
        }
        Ok(found)
    }
}
