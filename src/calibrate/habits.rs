//! What a camera usually does, from the document's other frames.

use crate::camera::Ptz;
use crate::document::{Document, Frame, FrameStatus};
use crate::geometry::{Angle, AngleRange};
use crate::solve::{Habits, Motion, PtzRanges, PtzStep};

/// So many accepted frames tell where a camera looks.
const MIN_ACCEPTED: usize = 5;

/// So many moves tell how fast it turns.
const MIN_MOVES: usize = 8;

/// Frames farther apart say nothing about how fast a camera moves.
const WITHIN_FRAMES: u64 = 50;

/// What the camera of a frame usually does, the frame itself left out: where accepted frames look, and how fast it moves in
/// frames of one video whose numbers are known.
#[must_use]
pub fn habits(document: &Document, index: usize) -> Habits {
    let Some(frame) = document.frames.get(index) else { return Habits::default() };
    let others = || {
        let all = document.frames.iter().enumerate();
        all.filter(move |(other, candidate)| *other != index && candidate.camera == frame.camera)
            .map(|(_, other)| &**other)
    };
    Habits { seen: seen(others()), motion: motion(frame, others()) }
}

/// The ranges of pan, tilt and focal length of the accepted frames.
fn seen<'a>(frames: impl Iterator<Item = &'a Frame>) -> Option<PtzRanges> {
    let accepted = frames.filter(|frame| frame.status == FrameStatus::Reference);
    let accepted: Vec<Ptz> = accepted.filter_map(|frame| Some(frame.ptz.as_ref()?.ptz())).collect();
    if accepted.len() < MIN_ACCEPTED {
        return None;
    }
    let range = |of: fn(&Ptz) -> f64| {
        let values = accepted.iter().map(of);
        values.fold([f64::INFINITY, f64::NEG_INFINITY], |[from, upto], value| [from.min(value), upto.max(value)])
    };
    let (tilt, focal) = (range(|ptz| ptz.tilt.radians()), range(|ptz| ptz.focal_px));
    Some(PtzRanges {
        pan: AngleRange::smallest(accepted.iter().map(|ptz| ptz.pan))?,
        tilt: Angle::from_radians(tilt[0])..=Angle::from_radians(tilt[1]),
        focal_px: focal[0]..=focal[1],
    })
}

/// Where the camera was in the nearest solved frame of the same shot, and how far it usually gets from there.
fn motion<'a>(frame: &Frame, others: impl Iterator<Item = &'a Frame>) -> Option<Motion> {
    let video = frame.video.as_ref()?;
    let of_shot = |other: &&Frame| {
        other.status != FrameStatus::Rejected
            && other.clip == frame.clip
            && other.video.as_ref().is_some_and(|known| known.path == video.path)
    };
    let mut solved: Vec<(u64, Ptz)> = others
        .filter(of_shot)
        .filter_map(|other| Some((other.video.as_ref()?.frame_index, other.ptz.as_ref()?.ptz())))
        .collect();
    solved.sort_by_key(|(number, _)| *number);
    let mut rates: [Vec<f64>; 3] = Default::default();
    for pair in solved.windows(2) {
        let ((before, from), (after, to)) = (pair[0], pair[1]);
        let frames = after - before;
        if (1..=WITHIN_FRAMES).contains(&frames) {
            let step = PtzStep::between(&from, &to);
            for (rates, moved) in rates.iter_mut().zip([step.pan.degrees(), step.tilt.degrees(), step.log_focal]) {
                rates.push(moved / frames as f64);
            }
        }
    }
    if rates[0].len() < MIN_MOVES {
        return None;
    }
    let nearest = solved.iter().min_by_key(|(number, _)| number.abs_diff(video.frame_index))?;
    let frames = nearest.0.abs_diff(video.frame_index).max(1);
    if frames > WITHIN_FRAMES {
        return None;
    }
    let [pan, tilt, log_focal] = rates.map(|rates| nine_of_ten(rates) * frames as f64);
    let usual = PtzStep { pan: Angle::from_degrees(pan), tilt: Angle::from_degrees(tilt), log_focal };
    Some(Motion { from: nearest.1, frames, usual })
}

/// What nine of ten values stay within.
fn nine_of_ten(mut values: Vec<f64>) -> f64 {
    let place = values.len() * 9 / 10;
    *values.select_nth_unstable_by(place, f64::total_cmp).1
}
