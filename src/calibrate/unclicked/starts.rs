//! Where an adjustment of all frames begins: places that a search found, or that clicks name.

use super::clicked::{GroundClick, poses};
use super::error::Stop;
use super::joint::FramePaint;
use super::pitch_map::PitchMap;
use super::pose::fitted;
use super::search::{Hypothesis, PLACES, Panorama, judged, search, sort};
use super::tied::TiedFrames;
use super::turn_levels::TurnLevels;
use super::{Abstention, UnclickedError, UnclickedProgress, WatchUnclicked};
use crate::field::FieldModel;
use crate::track::Turns;
use std::ops::RangeInclusive;

/// How much longer or shorter than the ties say the focal lengths may be: rotations leave their common scale uncertain.
const FOCAL_PERCENT: [u32; 5] = [100, 94, 106, 88, 113];

/// So much farther is the next one, and the widest that are tried: boards that scroll under a picture put all ties off together.
const BEYOND: f64 = 1.06;
const WIDEST_PERCENT: RangeInclusive<u32> = 67..=150;

/// The same where clicks name the places: the scale decides how far away their landmarks are.
const FINE_FOCAL_PERCENT: [u32; 11] = [100, 97, 103, 94, 106, 91, 109, 88, 112, 115, 118];

/// Pairs of clicks from which places are made, at most.
const PAIRS: usize = 6;

/// Places of one focal scale that may be adjusted.
const OF_SCALE: usize = 3;

/// A place from which everything is adjusted.
pub(super) struct Start {
    pub hypothesis: Hypothesis,
    /// The logarithm of the focal scale.
    pub log_scale: f64,
    pub turns: Turns,
    pub paint: Vec<FramePaint>,
}

/// The best places of a search for tied frames on one of several fields, the most likely first.
pub(super) fn searched(
    tied: &TiedFrames,
    maps: &[PitchMap],
    watch: WatchUnclicked<'_>,
) -> Result<(Vec<Start>, TurnLevels), Stop> {
    begun(tied, &FOCAL_PERCENT, PLACES * maps.len(), watch, |_, panorama| search(panorama, maps))
}

/// The best of the places that clicks name, on one of several fields with their maps, the most likely first.
pub(super) fn named(
    tied: &TiedFrames,
    fields: &[FieldModel],
    maps: &[PitchMap],
    clicks: &[GroundClick],
    watch: WatchUnclicked<'_>,
) -> Result<(Vec<Start>, TurnLevels), Stop> {
    begun(tied, &FINE_FOCAL_PERCENT, fields.len(), watch, |turns, panorama| {
        let mut found = Vec::new();
        for (field, map) in maps.iter().enumerate() {
            let poses = poses(turns, clicks, &fields[field]).into_iter().take(PAIRS);
            found.extend(poses.map(|pose| judged(fitted(pose, &panorama.directions, map), panorama, (field, map))));
        }
        sort(&mut found);
        found
    })
}

/// The best places for frames with focal lengths of each of some shares of what their ties say, and beyond these as long as the best
/// place of all is at the last of them.
fn begun(
    tied: &TiedFrames,
    focal_percent: &[u32],
    places: usize,
    watch: WatchUnclicked<'_>,
    of_turns: impl Fn(&Turns, &Panorama) -> Vec<Hypothesis>,
) -> Result<(Vec<Start>, TurnLevels), Stop> {
    let (mut starts, mut levels): (Vec<Start>, Vec<(u32, Turns)>) = (Vec::new(), Vec::new());
    let mut percents = focal_percent.to_vec();
    let mut best: Option<(f64, u32)> = None;
    let mut refused = None;
    let mut done = 0;
    while let Some(&percent) = percents.get(done) {
        if watch(UnclickedProgress::Trying { places, done, of: percents.len() }).is_break() {
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
            percents.extend(best.and_then(|(_, percent)| beyond(percent, &percents)));
        }
    }
    if let Some(why) = refused.filter(|_| levels.is_empty()) {
        return Err(why.into());
    }
    starts.sort_by(|a, b| b.hypothesis.score().total_cmp(&a.hypothesis.score()));
    Ok((starts, TurnLevels::new(levels)))
}

/// The best places for frames with focal lengths of a share of what their ties say, the most likely first, and how the frames turn.
fn of_scale(
    tied: &TiedFrames,
    percent: u32,
    of_turns: impl Fn(&Turns, &Panorama) -> Vec<Hypothesis>,
) -> Result<(Vec<Start>, Turns), Abstention> {
    let turns = tied.turns(percent).map_err(Abstention::NotTurning)?;
    let gathered = tied.gathered(&turns)?;
    let log_scale = (f64::from(percent) / 100.0).ln();
    let start = |hypothesis| Start { hypothesis, log_scale, turns: turns.clone(), paint: gathered.of_frames.clone() };
    let found = of_turns(&turns, &gathered.panorama).into_iter().take(OF_SCALE).map(start).collect();
    Ok((found, turns))
}

/// The share next to one that is the last of those tried, on its side; none beyond the widest.
fn beyond(percent: u32, tried: &[u32]) -> Option<u32> {
    let further = |share: f64| (f64::from(percent) * share).round() as u32;
    let next = if tried.iter().max() == Some(&percent) {
        further(BEYOND)
    } else if tried.iter().min() == Some(&percent) {
        further(BEYOND.recip())
    } else {
        return None;
    };
    WIDEST_PERCENT.contains(&next).then_some(next)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn shares_are_tried_beyond_the_last_only_and_no_farther_than_the_widest() {
        assert_eq!(beyond(113, &FOCAL_PERCENT), Some(120));
        assert_eq!(beyond(88, &FOCAL_PERCENT), Some(83));
        assert_eq!(beyond(106, &FOCAL_PERCENT), None);
        assert_eq!(beyond(113, &[100, 94, 106, 88, 113, 120]), None, "its neighbour is no better");
        assert_eq!(beyond(150, &[100, 150]), None);
        assert_eq!(beyond(67, &[100, 67]), None);
    }
}
