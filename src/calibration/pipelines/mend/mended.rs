//! What became of each given camera.

use super::common_error::CommonError;
use super::given::GivenCamera;
use super::kept::{AS_IT_CAME_PX, Move, keep_given};
use crate::calibrate::{BaseOnPaintError, LINE_CHECK, ground_moved_px};
use std::collections::BTreeSet;
use std::fmt;
use touchline_core::camera::PtzCamera;
use touchline_core::solve::UNSTATED_PX;
use touchline_core::solve::base::SharedPlace;
use touchline_documents::document::{CameraId, Document, Frame, FrameId, Solution};

/// A mended frame below this confidence is left for a person.
const DOUBT_LIMIT: f64 = 0.5;

/// The result of mending.
#[derive(Clone, Debug, PartialEq)]
pub struct Mended {
    /// Each frame of the document, in its order.
    pub frames: Vec<MendedFrame>,
    /// The places that the given cameras share, the one with the most frames first.
    pub places: Vec<SharedPlace>,
    /// The errors that all given cameras had in common.
    pub common: Vec<CommonError>,
    /// The cameras whose base and lens stay those of the given cameras.
    pub not_aligned: Vec<NotAligned>,
}

/// A camera whose base and lens could not be estimated from the painted lines.
#[derive(Clone, Debug, PartialEq)]
pub struct NotAligned {
    /// The camera.
    pub camera: CameraId,
    /// Why not.
    pub reason: BaseOnPaintError,
}

impl fmt::Display for NotAligned {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let Self { camera, reason } = self;
        write!(
            f,
            "{camera}: base and lens stay those of the given cameras: {reason}"
        )
    }
}

/// What became of the camera of one frame.
#[derive(Clone, Debug, PartialEq)]
pub struct MendedFrame {
    /// The frame.
    pub id: FrameId,
    /// The camera that it came with.
    pub given: GivenCamera,
    /// What became of it.
    pub outcome: Outcome,
    /// How far the ground moved in the picture against the given camera, px: the median over the
    /// picture. None without a given or a mended camera.
    pub moved_px: Option<f64>,
}

/// What became of a frame's camera.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Outcome {
    /// A person decided on the frame; it was not touched.
    Decided,
    /// It is as it came, within 3 px at 1920 px width.
    AsItCame,
    /// It was aligned to the painted lines.
    Aligned,
    /// It was tracked from its neighbours.
    Tracked,
    /// The painted lines contradict the best camera that was found.
    Contradicted,
    /// The best camera that was found is uncertain.
    Uncertain,
    /// No camera was found.
    Missing,
}

impl Outcome {
    /// Why a person has to look at the frame; none if that is not needed.
    pub const fn why_left(self) -> Option<&'static str> {
        match self {
            Self::Contradicted => Some("the painted lines contradict its camera"),
            Self::Uncertain => Some("its camera is uncertain"),
            Self::Missing => Some("no camera was found"),
            Self::Decided | Self::AsItCame | Self::Aligned | Self::Tracked => None,
        }
    }
}

/// How many frames had each outcome.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Tally {
    /// Frames that came with a camera, impossible ones included.
    pub came: usize,
    /// Those of them whose camera was impossible.
    pub impossible: usize,
    /// Those of them that were mirrored.
    pub mirrored: usize,
    /// Frames that people had decided on.
    pub decided: usize,
    /// Frames whose camera is as it came.
    pub as_they_came: usize,
    /// Frames that were aligned to the painted lines.
    pub aligned: usize,
    /// Frames that were tracked from their neighbours.
    pub tracked: usize,
    /// Frames that are left for a person.
    pub left: usize,
}

/// Compares the frames of the documents before and after. `aligned` are the frames that were
/// aligned to their paint before the others were tracked, by their indices.
pub(super) fn compare_frames(
    before: &Document,
    after: &Document,
    given: &[GivenCamera],
    aligned: &BTreeSet<usize>,
) -> Vec<MendedFrame> {
    let frames = given.iter().enumerate().map(|(index, given)| {
        let frame = &after.frames[index];
        let now = after.ptz_camera(frame);
        // An impossible camera cannot be begun with, but how far it was off can still be stated
        // where it projects the ground at all.
        let camera = given
            .usable()
            .copied()
            .or_else(|| before.ptz_camera(&before.frames[index]));
        let moved_px = camera
            .zip(now)
            .and_then(|(given, now)| ground_moved_px(&given, &now, frame.image_size));
        MendedFrame {
            id: frame.id.clone(),
            given: given.clone(),
            outcome: outcome(frame, now.as_ref(), moved_px, aligned.contains(&index)),
            moved_px,
        }
    });
    frames.collect()
}

impl Mended {
    /// Writes into each mended frame the camera that it came with, and how far it was moved.
    pub(super) fn record_imported(&self, before: &Document, after: &mut Document) {
        for (index, mended) in self.frames.iter().enumerate() {
            // Frames that people decided on were not touched, and state no camera of another
            // program.
            let is_mended = mended.outcome != Outcome::Decided;
            if !is_mended {
                continue;
            }
            keep_given(after, before, index, mended.given.fault(), Move::ByPicture);
            // What stays of the given cameras is as uncertain as they are.
            if after.frames[index].is_uncertainty_unstated() {
                after.state_uncertainty(index, UNSTATED_PX);
            }
        }
    }

    /// How many frames had each outcome.
    pub fn tally(&self) -> Tally {
        let mut tally = Tally::default();
        for frame in &self.frames {
            tally.came += usize::from(!matches!(frame.given, GivenCamera::Missing));
            tally.impossible += usize::from(matches!(frame.given, GivenCamera::Impossible(_)));
            tally.mirrored += usize::from(matches!(frame.given, GivenCamera::Mirrored(_)));
            let count = match frame.outcome {
                Outcome::Decided => &mut tally.decided,
                Outcome::AsItCame => &mut tally.as_they_came,
                Outcome::Aligned => &mut tally.aligned,
                Outcome::Tracked => &mut tally.tracked,
                Outcome::Contradicted | Outcome::Uncertain | Outcome::Missing => &mut tally.left,
            };
            *count += 1;
        }
        tally
    }
}

fn outcome(
    frame: &Frame,
    now: Option<&PtzCamera>,
    moved_px: Option<f64>,
    was_aligned: bool,
) -> Outcome {
    if !frame.is_open() {
        return Outcome::Decided;
    }
    let (Some(_), Some(solution)) = (now, &frame.solution) else {
        return Outcome::Missing;
    };
    // Doubt comes before distance: the paint may contradict a camera that hardly moved.
    if is_contradicted(solution) {
        return Outcome::Contradicted;
    }
    if is_uncertain(solution) {
        return Outcome::Uncertain;
    }
    let same_px = AS_IT_CAME_PX * frame.image_size.scale_from_1920();
    match moved_px {
        Some(moved_px) if moved_px <= same_px => Outcome::AsItCame,
        _ if was_aligned => Outcome::Aligned,
        _ => Outcome::Tracked,
    }
}

/// Whether an open frame's camera is to be compared with its paint: it is in doubt, or nothing is
/// recorded about it.
pub(super) fn wants_check(frame: &Frame) -> bool {
    let is_unknown = frame.paint_verdict().is_none();
    is_doubted(frame) || (frame.is_open() && frame.ptz.is_some() && is_unknown)
}

/// Whether an open frame's camera is contradicted by its paint or uncertain.
pub(super) fn is_doubted(frame: &Frame) -> bool {
    frame.is_open()
        && frame.ptz.is_some()
        && frame
            .solution
            .as_ref()
            .is_some_and(|known| is_contradicted(known) || is_uncertain(known))
}

fn is_contradicted(solution: &Solution) -> bool {
    let warnings = &solution.warnings;
    warnings.iter().any(|warning| warning.code == LINE_CHECK)
}

fn is_uncertain(solution: &Solution) -> bool {
    solution
        .confidence
        .is_none_or(|confidence| confidence < DOUBT_LIMIT)
}
