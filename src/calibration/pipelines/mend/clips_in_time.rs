//! Frames that follow each other in time, as far as their names or their video say so.
//!
//! The order of files is not that of time, and neither are consecutive numbers: stills of twenty
//! matches are numbered from 1 to 186, and a video is sampled once a second. In a clip the camera
//! of a frame lies between those of its neighbours. Where most do, the run is a clip; elsewhere
//! nothing is concluded from neighbours.

use crate::calibrate::{Disagreement, disagreement};
use std::collections::BTreeMap;
use touchline_core::camera::{Ptz, PtzCamera};
use touchline_core::geometry::median;
use touchline_documents::document::{Document, Frame, FramePtz, FrameStatus};

/// Frames farther apart than this are not compared, and no longer gap is filled, frames of the
/// video. Within a second a camera may look elsewhere.
const MAX_FRAMES_APART: f64 = 13.0;

/// A run is a clip if at most this share of its cameras is out of line, and if of the others at
/// least this share, and this number, are in line with their neighbours. Of 330 cameras of a
/// broadcast taken twelve frames apart, 65 % are; two to six frames apart, 89 % or more.
const MOST_OUT: f64 = 0.25;
const LEAST_SHARE_IN_LINE: f64 = 0.7;
const FEWEST_IN_LINE: usize = 5;

/// A frame is out of line if it is farther than this from what its neighbours predict, px at 1920
/// px width, and farther than they are apart. Programs that calibrate frames one by one scatter by
/// 10 px.
pub(super) const OUT_OF_LINE_PX: f64 = 20.0;

/// And by this multiple of how far the camera moves beside it, from one frame to the next: a camera
/// that comes back has moved there before.
const TIMES_STEP: f64 = 3.0;

/// The frames of a run, in the order of time.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct ClipInTime {
    /// The frames, by their indices in the document.
    pub frames: Vec<usize>,
    /// Those whose cameras are out of line, the farthest first, with the distance in px at 1920 px
    /// width.
    pub out_of_line: Vec<(usize, f64)>,
    /// How far the other frames are typically out of line, px at 1920 px width.
    pub typical_px: f64,
}

/// Two frames of a clip with cameras of one place, between which others have none.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Gap {
    pub from: usize,
    pub to: usize,
}

impl ClipInTime {
    /// The clips among the frames of a document, by their names and their cameras.
    pub fn all(document: &Document) -> Vec<Self> {
        let mut runs = BTreeMap::<_, Vec<usize>>::new();
        for (index, frame) in document.frames.iter().enumerate() {
            if let Some(moment) = frame.moment() {
                let key = (frame.clip.as_ref(), moment.run());
                runs.entry(key).or_default().push(index);
            }
        }
        let runs = runs.into_values().map(|mut frames| {
            frames.sort_by_key(|index| document.frames[*index].moment());
            frames
        });
        runs.filter_map(|frames| Self::from_run(document, frames))
            .collect()
    }

    /// A run as a clip, if most of its frames are in line once those that are not are taken away.
    fn from_run(document: &Document, frames: Vec<usize>) -> Option<Self> {
        let mut run = Self {
            frames,
            out_of_line: Vec::new(),
            typical_px: 0.0,
        };
        let mut solved = run.solved_frames(document);
        let most_out = MOST_OUT * solved.len() as f64;
        run.out_of_line = take_out_of_line(document, &mut solved);
        let mut apart: Vec<f64> = solved
            .windows(3)
            .filter_map(|three| compare(document, [three[0], three[1], three[2]]))
            .map(|found| found.apart_px)
            .collect();
        let in_line = apart.iter().filter(|px| **px <= OUT_OF_LINE_PX).count();
        let enough = LEAST_SHARE_IN_LINE * apart.len() as f64;
        run.typical_px = median(&mut apart)?;
        let is_clip = run.out_of_line.len() as f64 <= most_out
            && in_line >= FEWEST_IN_LINE
            && in_line as f64 >= enough;
        is_clip.then_some(run)
    }

    /// The frames with a camera. A person found that of a rejected frame wrong.
    pub fn solved_frames(&self, document: &Document) -> Vec<usize> {
        let mut solved = self.frames.clone();
        solved.retain(|index| {
            let frame = &document.frames[*index];
            frame.ptz.is_some() && frame.status != FrameStatus::Rejected
        });
        solved
    }

    /// Those frames for which `is_inside` that lie between two for which `is_end`, with cameras of
    /// one place and near in time.
    pub fn gaps(
        &self,
        document: &Document,
        is_inside: impl Fn(usize) -> bool,
        is_end: impl Fn(usize) -> bool,
    ) -> Vec<(usize, Gap)> {
        let mut last = None;
        let mut inside = Vec::new();
        let mut found = Vec::new();
        for &index in &self.frames {
            if is_inside(index) {
                inside.push(index);
            } else if is_end(index) {
                let gap = last.replace(index).map(|from| Gap { from, to: index });
                let gap = gap.filter(|gap| are_near(document, gap.from, gap.to));
                found.extend(
                    inside
                        .drain(..)
                        .filter_map(|index| gap.map(|gap| (index, gap))),
                );
            }
        }
        found
    }
}

/// Takes the frames that are out of line from the solved ones, and returns them with their distance
/// in px at 1920 px width. Those that people decided on are not among them.
///
/// The farthest is taken first: its neighbours seem out of line only as long as it is there.
fn take_out_of_line(document: &Document, solved: &mut Vec<usize>) -> Vec<(usize, f64)> {
    let mut out: Vec<Option<f64>> = (0..solved.len())
        .map(|at| out_of_line_px(document, solved, at))
        .collect();
    let mut taken = Vec::new();
    // Each round takes one frame, so the loop ends. Only its neighbours are compared anew.
    while let Some((at, apart_px)) = farthest(&out) {
        taken.push((solved.remove(at), apart_px));
        out.remove(at);
        let (first, end) = (at.saturating_sub(3), at + 3);
        for (beside, known) in out.iter_mut().enumerate().take(end).skip(first) {
            *known = out_of_line_px(document, solved, beside);
        }
    }
    taken
}

/// The position of the greatest distance, of equal ones the last.
fn farthest(out: &[Option<f64>]) -> Option<(usize, f64)> {
    let known = out.iter().enumerate();
    known
        .filter_map(|(at, px)| Some((at, (*px)?)))
        .max_by(|(_, one), (_, other)| one.total_cmp(other))
}

impl Gap {
    /// The share of the way from one end to the other at which a frame lies, and the number of
    /// frames before and after it.
    pub fn share(self, document: &Document, index: usize) -> Option<(f64, [f64; 2])> {
        let before = frames_between(document, self.from, index)?;
        let after = frames_between(document, index, self.to)?;
        (before > 0.0 && after > 0.0).then(|| (before / (before + after), [before, after]))
    }
}

/// How far a camera is out of line with those of two frames on either side that are near in time.
pub(super) fn apart_px(document: &Document, camera: &PtzCamera, gap: Gap) -> Option<f64> {
    let [from, to] = [gap.from, gap.to].map(|index| ptz_of(&document.frames[index]));
    let size = document.frames[gap.from].image_size;
    Some(disagreement(camera, from?, to?, size).apart_px)
}

/// How far the frame at a position of the solved ones is out of line; none if it is in line, at an
/// end, or if a person decided on it.
fn out_of_line_px(document: &Document, solved: &[usize], at: usize) -> Option<f64> {
    let [before, after] = [solved.get(at.checked_sub(1)?), solved.get(at + 1)];
    let [before, index, after] = [*before?, solved[at], *after?];
    if !document.frames[index].is_open() {
        return None;
    }
    let found = compare(document, [before, index, after])?;
    let steps = [
        at.checked_sub(2)
            .and_then(|at| step_px(document, solved[at], before)),
        solved
            .get(at + 2)
            .and_then(|next| step_px(document, after, *next)),
    ];
    // The smaller one: on the other side may be another wrong camera.
    let step_px = steps.into_iter().flatten().reduce(f64::min).unwrap_or(0.0);
    let least_px = OUT_OF_LINE_PX
        .max(found.neighbours_px)
        .max(TIMES_STEP * step_px);
    (found.apart_px > least_px).then_some(found.apart_px)
}

/// The disagreement of the middle one of three frames; none unless they follow each other in time
/// and have one camera.
fn compare(document: &Document, [before, index, after]: [usize; 3]) -> Option<Disagreement> {
    let follows = are_near(document, before, after)
        && document.frames[index].camera == document.frames[before].camera
        && frames_between(document, before, index)? > 0.0
        && frames_between(document, index, after)? > 0.0;
    let [from, to] = [before, after].map(|index| ptz_of(&document.frames[index]));
    let frame = &document.frames[index];
    let own = document.ptz_camera(frame).filter(|_| follows)?;
    Some(disagreement(&own, from?, to?, frame.image_size))
}

/// How far the camera moves from one frame to another, px at 1920 px width; none unless they follow
/// each other in time and have one camera.
fn step_px(document: &Document, from: usize, to: usize) -> Option<f64> {
    let own = document.ptz_camera(&document.frames[from])?;
    let ptz = ptz_of(&document.frames[to]).filter(|_| are_near(document, from, to))?;
    Some(disagreement(&own, ptz, ptz, document.frames[from].image_size).apart_px)
}

/// Whether a frame follows another within [`MAX_FRAMES_APART`] frames and has the same camera.
fn are_near(document: &Document, from: usize, to: usize) -> bool {
    let is_near =
        frames_between(document, from, to).is_some_and(|way| way > 0.0 && way <= MAX_FRAMES_APART);
    is_near && document.frames[from].camera == document.frames[to].camera
}

fn frames_between(document: &Document, from: usize, to: usize) -> Option<f64> {
    let [from, to] = [from, to].map(|index| document.frames[index].moment());
    from?.frames_to(&to?)
}

fn ptz_of(frame: &Frame) -> Option<Ptz> {
    frame.ptz.as_ref().map(FramePtz::ptz)
}
