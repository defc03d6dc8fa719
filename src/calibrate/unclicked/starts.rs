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

/// How much longer or shorter than the ties say the focal lengths may be: rotations leave their common scale uncertain.
const FOCAL_PERCENT: [u32; 5] = [100, 94, 106, 88, 113];

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

/// The best places for frames with focal lengths of each of some shares of what their ties say.
fn begun(
    tied: &TiedFrames,
    focal_percent: &[u32],
    places: usize,
    watch: WatchUnclicked<'_>,
    of_turns: impl Fn(&Turns, &Panorama) -> Vec<Hypothesis>,
) -> Result<(Vec<Start>, TurnLevels), Stop> {
    let (mut starts, mut levels): (Vec<Start>, Vec<(u32, Turns)>) = (Vec::new(), Vec::new());
    // One focal scale may gather little paint where another gathers enough.
    let mut too_little = None;
    for (done, percent) in focal_percent.iter().enumerate() {
        if watch(UnclickedProgress::Trying { places, done, of: focal_percent.len() }).is_break() {
            return Err(UnclickedError::Stopped.into());
        }
        let turns = match tied.turns(*percent) {
            Ok(turns) => turns,
            Err(error) if done == 0 => return Err(Abstention::NotTurning(error).into()),
            Err(_) => continue,
        };
        let gathered = match tied.gathered(&turns) {
            Ok(gathered) => gathered,
            Err(little) => {
                too_little.get_or_insert(little);
                continue;
            }
        };
        let log_scale = (f64::from(*percent) / 100.0).ln();
        let start =
            |hypothesis| Start { hypothesis, log_scale, turns: turns.clone(), paint: gathered.of_frames.clone() };
        starts.extend(of_turns(&turns, &gathered.panorama).into_iter().take(OF_SCALE).map(start));
        levels.push((*percent, turns));
    }
    if let Some(little) = too_little.filter(|_| levels.is_empty()) {
        return Err(little.into());
    }
    starts.sort_by(|a, b| b.hypothesis.score().total_cmp(&a.hypothesis.score()));
    Ok((starts, TurnLevels::new(levels)))
}
