//! Where an adjustment of all frames begins: places that a search found, or that clicks name.

use super::clicked::{GroundClick, poses};
use super::error::Stop;
use super::joint::FramePaint;
use super::matched_frames::MatchedFrames;
use super::pitch_map::PitchMap;
use super::pose::fit_pose;
use super::rotations_by_focal_scale::RotationsByFocalScale;
use super::search::{Hypothesis, PLACES, Panorama, score_pose, search, sort};
use super::{Abstention, UnclickedError, UnclickedProgress, WatchUnclicked};
use std::ops::RangeInclusive;
use touchline_core::field::FieldModel;
use touchline_vision::track::Turns;

/// How much longer or shorter than the ties say the focal lengths may be, in per cent: rotations leave their common scale uncertain,
/// and boards that scroll under a picture put all ties off together. Neighbouring values are as near as a search needs.
const FOCAL_PERCENT: [u32; 15] = [67, 71, 75, 79, 83, 88, 94, 100, 106, 113, 120, 127, 135, 143, 150];

/// Of these the first to be tried.
const FIRST_FOCAL_PERCENT: [u32; 3] = [100, 88, 113];

/// Those tried first where clicks name the places, nearer to each other: the scale decides how far away their landmarks are.
const FINE_FOCAL_PERCENT: [u32; 11] = [100, 97, 103, 94, 106, 91, 109, 88, 112, 115, 118];

/// Rounds that a search takes on most footage.
const USUAL_ROUNDS: usize = 5;

/// Pairs of clicks from which places are made, at most.
const PAIRS: usize = 6;

/// Places of one focal scale that may be adjusted.
const OF_SCALE: usize = 3;

/// A hypothesis of the search at one focal scale, with what the frames show at that scale.
pub(super) struct ScaledHypothesis {
    pub hypothesis: Hypothesis,
    /// The logarithm of the focal scale.
    pub log_scale: f64,
    pub rotations: Turns,
    /// Persistent paint of each frame.
    pub paint: Vec<FramePaint>,
}

/// Searches the poses of the panorama on several fields without any click; the most likely first.
pub(super) fn search_hypotheses(
    tied: &MatchedFrames,
    maps: &[PitchMap],
    watch: WatchUnclicked<'_>,
) -> Result<(Vec<ScaledHypothesis>, RotationsByFocalScale), Stop> {
    begun(tied, &FIRST_FOCAL_PERCENT, PLACES * maps.len(), watch, |_, panorama| search(panorama, maps))
}

/// The poses that pairs of clicks determine, on several fields with their maps; the most likely first.
pub(super) fn hypotheses_from_clicks(
    tied: &MatchedFrames,
    fields: &[FieldModel],
    maps: &[PitchMap],
    clicks: &[GroundClick],
    watch: WatchUnclicked<'_>,
) -> Result<(Vec<ScaledHypothesis>, RotationsByFocalScale), Stop> {
    begun(tied, &FINE_FOCAL_PERCENT, fields.len(), watch, |turns, panorama| {
        let mut found = Vec::new();
        for (field, map) in maps.iter().enumerate() {
            let poses = poses(turns, clicks, &fields[field]).into_iter().take(PAIRS);
            found.extend(
                poses.map(|pose| score_pose(fit_pose(pose, &panorama.directions, map), panorama, (field, map))),
            );
        }
        sort(&mut found);
        found
    })
}

/// The best places for frames with focal lengths of each of some shares of what their ties say, and of the neighbours of the share that
/// has the best place of all.
fn begun(
    tied: &MatchedFrames,
    focal_percent: &[u32],
    places: usize,
    watch: WatchUnclicked<'_>,
    of_turns: impl Fn(&Turns, &Panorama) -> Vec<Hypothesis>,
) -> Result<(Vec<ScaledHypothesis>, RotationsByFocalScale), Stop> {
    let (mut starts, mut levels): (Vec<ScaledHypothesis>, Vec<(u32, Turns)>) = (Vec::new(), Vec::new());
    let mut percents = focal_percent.to_vec();
    let mut best: Option<(f64, u32)> = None;
    let mut refused = None;
    let mut done = 0;
    while let Some(&percent) = percents.get(done) {
        if watch(UnclickedProgress::Trying { places, done, of: percents.len().max(USUAL_ROUNDS) }).is_break() {
            return Err(UnclickedError::Stopped.into());
        }
        done += 1;
        match of_scale(tied, percent, &of_turns) {
            Ok((found, turns)) => {
                let score = found.first().map_or(0.0, |start| start.hypothesis.score());
                if best.is_none_or(|(other, _)| score > other) {
                    best = Some((score, percent));
                }
                starts.extend(found);
                levels.push((percent, turns));
            }
            Err(why @ Abstention::NotTurning(_)) if done == 1 => return Err(why.into()),
            // One focal scale may gather little paint where another gathers enough.
            Err(why) => refused = refused.or(Some(why)),
        }
        if done == percents.len() {
            percents.extend(best.and_then(|(_, percent)| untried_beside(percent, &percents)));
        }
    }
    if let Some(why) = refused.filter(|_| levels.is_empty()) {
        return Err(why.into());
    }
    starts.sort_by(|a, b| b.hypothesis.score().total_cmp(&a.hypothesis.score()));
    Ok((starts, RotationsByFocalScale::new(levels)))
}

/// The best places for frames with focal lengths of a share of what their ties say, the most likely first, and how the frames turn.
fn of_scale(
    tied: &MatchedFrames,
    percent: u32,
    of_turns: impl Fn(&Turns, &Panorama) -> Vec<Hypothesis>,
) -> Result<(Vec<ScaledHypothesis>, Turns), Abstention> {
    let turns = tied.relative_rotations(percent).map_err(Abstention::NotTurning)?;
    let gathered = tied.gather_paint(&turns)?;
    let log_scale = (f64::from(percent) / 100.0).ln();
    let start = |hypothesis| ScaledHypothesis {
        hypothesis,
        log_scale,
        rotations: turns.clone(),
        paint: gathered.of_frames.clone(),
    };
    let found = of_turns(&turns, &gathered.panorama).into_iter().take(OF_SCALE).map(start).collect();
    Ok((found, turns))
}

/// A neighbour of a share between which and itself none was tried: one beyond all that were tried before one between two of them.
fn untried_beside(percent: u32, tried: &[u32]) -> Option<u32> {
    let above = FOCAL_PERCENT.into_iter().find(|share| *share > percent);
    let below = FOCAL_PERCENT.into_iter().rfind(|share| *share < percent);
    let is_tried = |range: RangeInclusive<u32>| tried.iter().any(|share| range.contains(share));
    let above = above.filter(|above| !is_tried(percent + 1..=*above));
    let below = below.filter(|below| !is_tried(*below..=percent - 1));
    let is_between = |share: &u32| is_tried(0..=*share) && is_tried(*share..=u32::MAX);
    above.into_iter().chain(below).min_by_key(is_between)
}

#[cfg(test)]
mod tests {
    use super::*;

    /// The shares that are tried where the best of all lies at one of them.
    fn tried(first: &[u32], best: u32) -> Vec<u32> {
        let mut tried = first.to_vec();
        let nearest = |tried: &[u32]| *tried.iter().min_by_key(|share| share.abs_diff(best)).unwrap();
        while let Some(next) = untried_beside(nearest(&tried), &tried) {
            tried.push(next);
        }
        tried
    }

    #[test]
    fn both_neighbours_of_the_best_share_are_tried_and_few_others() {
        assert_eq!(tried(&FIRST_FOCAL_PERCENT, 100), [100, 88, 113, 106, 94]);
        assert_eq!(tried(&FIRST_FOCAL_PERCENT, 120), [100, 88, 113, 120, 127]);
        assert_eq!(tried(&FIRST_FOCAL_PERCENT, 113), [100, 88, 113, 120, 106]);
        assert_eq!(tried(&FIRST_FOCAL_PERCENT, 79), [100, 88, 113, 83, 79, 75]);
        assert_eq!(tried(&FIRST_FOCAL_PERCENT, 40), [100, 88, 113, 83, 79, 75, 71, 67]);
        assert_eq!(tried(&FIRST_FOCAL_PERCENT, 200), [100, 88, 113, 120, 127, 135, 143, 150]);
        assert_eq!(tried(&FINE_FOCAL_PERCENT, 103), FINE_FOCAL_PERCENT);
        assert_eq!(tried(&FINE_FOCAL_PERCENT, 118)[FINE_FOCAL_PERCENT.len()..], [120]);
    }
}
