//! The comparison behind the paper's headline: `CalibMe`, which had three to five references chosen
//! by hand to cover the stadium, against a forest of all references.
//!
//! Here the references are chosen by a rule that needs no hand: the farthest point in pan and
//! logarithm of focal length. `CalibMe` is the homography to the best reference, as strong as in
//! [`baselines`](crate::studies::baselines). It never tests its answer, so that the forests' test
//! is left off as well.

use super::progress::{Progress, step_counter};
use super::sets::{FrameSet, Split};
use crate::report::statistics::range_of;
use crate::scoring::answers::FrameAnswer;
use crate::scoring::forests::{ForestKind, train_forest, without_test};
use crate::studies::baselines::methods::{Matched, Reference};
use rayon::prelude::*;
use touchline::camera::PtzCamera;
use touchline::geometry::{Angle, AngleRange};
use touchline::relocalize::relocalize;

/// Numbers of references that the paper's `CalibMe` had.
pub const COUNTS: [usize; 3] = [3, 4, 5];

/// The answers of one method with one number of chosen references.
#[derive(Clone, Debug)]
pub struct Chosen {
    /// Its name in files: `calibme 5`.
    pub way: String,
    pub answers: Vec<FrameAnswer>,
}

/// The answers of `CalibMe` with three, four and five references, and of both forests with the same
/// five.
pub fn measure(sets: &[FrameSet], progress: Progress) -> Vec<Chosen> {
    let step = step_counter(sets.iter().map(|set| set.splits.len()).sum(), progress);
    let names = COUNTS.map(|count| format!("calibme {count}"));
    let names = names
        .into_iter()
        .chain(ForestKind::BOTH.map(|kind| with_most(kind.key())));
    let mut ways: Vec<Chosen> = names
        .map(|way| Chosen {
            way,
            answers: Vec::new(),
        })
        .collect();
    for (repeat, set) in sets.iter().enumerate() {
        // Split by split, because all methods of a split share its references.
        for number in 0..set.splits.len() {
            for (way, answers) in ways.iter_mut().zip(answer_split(set, repeat, number)) {
                way.answers.extend(answers);
            }
            step();
        }
    }
    ways
}

/// The name of a method with as many references as `CalibMe` had at most.
pub fn with_most(method: &str) -> String {
    format!("{method} {}", COUNTS[COUNTS.len() - 1])
}

/// The answers of all methods to the test frames of a split.
fn answer_split(set: &FrameSet, repeat: usize, number: usize) -> Vec<Vec<FrameAnswer>> {
    let split = &set.splits[number];
    let chosen = farthest_points(set, split, COUNTS[COUNTS.len() - 1]);
    let references: Vec<Reference<'_>> = chosen
        .iter()
        .map(|&frame| Reference::from_known_frame(&set.frames[frame]))
        .collect();
    let forests = ForestKind::BOTH.map(|kind| {
        let known = references.iter().map(|reference| reference.known);
        let trained = train_forest(known, &kind.training(set.seed));
        (trained, without_test(&kind.asking(set.seed)))
    });
    let one = |&frame: &usize| -> Vec<FrameAnswer> {
        let known = &set.frames[frame];
        // Matched once; smaller numbers use the first references, which the farthest-point rule
        // chose first.
        let matched = Matched::to(known, &references, set.seed.wrapping_add(frame as u64));
        let by_homography = COUNTS.map(|count| {
            let count = count.min(references.len());
            matched.by_homography(&references[..count])
        });
        // The true base of the frame, as in all other experiments.
        let by_forest = forests.iter().map(|(trained, asking)| {
            let (forest, seen) = trained.as_ref()?;
            let base = known.truth.base();
            let pose = relocalize(&known.features, forest, seen, base, asking).pose;
            Some(PtzCamera::new(*base, pose.ok()?.ptz))
        });
        let blank = FrameAnswer::blank(set, repeat, number, frame);
        let answer = |camera: Option<PtzCamera>| {
            // Every camera passes: no answer is tested here.
            camera.map_or(blank, |camera| blank.with_camera(set, &camera, true))
        };
        by_homography
            .into_iter()
            .chain(by_forest)
            .map(answer)
            .collect()
    };
    let by_frame: Vec<Vec<FrameAnswer>> = split.test_frames.par_iter().map(one).collect();
    let ways = COUNTS.len() + forests.len();
    let of_way = |way: usize| by_frame.iter().map(|frame| frame[way]).collect();
    (0..ways).map(of_way).collect()
}

/// So many training frames of a split that cover its views: the one nearest to the middle, then
/// always the one farthest from all chosen so far (Gonzalez 1985), in pan and logarithm of focal
/// length, each divided by its range.
fn farthest_points(set: &FrameSet, split: &Split, count: usize) -> Vec<usize> {
    let ptz = |frame: usize| set.frames[frame].truth.ptz();
    // Pan is measured from the start of the smallest arc that has all of them, so that it does not
    // jump at ±180°.
    let pans = AngleRange::smallest(split.training_frames.iter().map(|&frame| ptz(frame).pan));
    let start = pans.map_or(Angle::ZERO, |range| range.start());
    let raw = |frame: usize| {
        [
            ptz(frame).pan.turn_from(start).radians(),
            // Zoom is a ratio: twice the focal length is as far at the short end as at the long
            // one.
            ptz(frame).focal_px.ln(),
        ]
    };
    let ends = [0, 1]
        .map(|axis: usize| range_of(split.training_frames.iter().map(|&frame| raw(frame)[axis])));
    let place = |frame: usize| -> [f64; 2] {
        std::array::from_fn(|axis| {
            let [low, high] = ends[axis];
            // A range of one value would divide by 0; all frames are then at 0.
            (raw(frame)[axis] - low) / (high - low).max(f64::EPSILON)
        })
    };
    let apart = |one: [f64; 2], two: [f64; 2]| (one[0] - two[0]).hypot(one[1] - two[1]);
    let frames = &split.training_frames;
    let middle = |frame: usize| apart(place(frame), [0.5, 0.5]);
    let first = frames
        .iter()
        .min_by(|a, b| middle(**a).total_cmp(&middle(**b)));
    let mut chosen: Vec<usize> = first.into_iter().copied().collect();
    while chosen.len() < count.min(frames.len()) {
        let nearest = |frame: usize| {
            let each = chosen
                .iter()
                .map(|&other| apart(place(frame), place(other)));
            each.fold(f64::INFINITY, f64::min)
        };
        // Quadratic in the number of frames for each reference, which is nothing for a hundred
        // frames.
        let rest = frames.iter().filter(|frame| !chosen.contains(frame));
        let Some(&next) = rest.max_by(|a, b| nearest(**a).total_cmp(&nearest(**b))) else {
            break;
        };
        chosen.push(next);
    }
    chosen
}
