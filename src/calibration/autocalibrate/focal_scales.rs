//! The search over focal scales: poses that the whole search or clicks give, at one focal scale
//! after the other.
//!
//! Matches leave the common scale of the focal lengths uncertain, and the pose depends on it. So
//! the poses are scored at a few scales, then beside the best of them until both neighbours of the
//! best were tried.

use super::clicked::{GroundClick, poses};
use super::error::Stop;
use super::matched_frames::{FramesAtScale, MatchedFrames};
use super::pitch_map::PitchMap;
use super::pose::fit_pose;
use super::progress::report;
use super::rotations_by_focal_scale::RotationsByFocalScale;
use super::search::{PLACES, Panorama, ScoredPose, score_pose, search, sort};
use super::{Abstention, AutocalibrationProgress};
use std::ops::RangeInclusive;
use std::sync::Arc;
use touchline_core::field::FieldModel;
use touchline_core::progress::Progress;
use touchline_vision::track::Turns;

/// How much longer or shorter than the matches say the focal lengths may be, in per cent: rotations
/// leave their common scale uncertain, and boards that scroll under a picture put all matches off
/// together. Neighbouring values are as near as a search needs.
const FOCAL_PERCENT: [u32; 15] = [
    67, 71, 75, 79, 83, 88, 94, 100, 106, 113, 120, 127, 135, 143, 150,
];

/// Of these the first to be tried.
const FIRST_FOCAL_PERCENT: [u32; 3] = [100, 88, 113];

/// Those tried first where clicks determine the poses, nearer to each other: the scale decides how
/// far away their landmarks are.
const FINE_FOCAL_PERCENT: [u32; 11] = [100, 97, 103, 94, 106, 91, 109, 88, 112, 115, 118];

/// Rounds that a search takes on most footage.
const USUAL_ROUNDS: usize = 5;

/// Pairs of clicks that give a pose, at most.
const MAX_PAIRS: usize = 6;

/// Poses of one focal scale that go on, at most.
const MAX_PER_SCALE: usize = 3;

/// A scored pose, with the frames at the focal scale where it was found.
pub(super) struct ScaledPose {
    pub scored: ScoredPose,
    pub frames: Arc<FramesAtScale>,
}

/// The poses that were found at several focal scales, and how the frames turn at each of these.
pub(super) struct PosesByFocalScale {
    /// The most likely first.
    pub poses: Vec<ScaledPose>,
    pub rotations: RotationsByFocalScale,
}

/// Searches the poses of the panorama on several fields without any click.
pub(super) fn search_poses(
    matched: &MatchedFrames,
    maps: &[PitchMap],
    progress: &Progress<'_, AutocalibrationProgress>,
) -> Result<PosesByFocalScale, Stop> {
    let num_places = PLACES * maps.len();
    let search_at_scale = |_: &Turns, panorama: &Panorama| search(panorama, maps);
    try_focal_scales(
        matched,
        &FIRST_FOCAL_PERCENT,
        num_places,
        progress,
        search_at_scale,
    )
}

/// The poses that pairs of clicks determine, on several fields with their maps.
pub(super) fn poses_from_clicks(
    matched: &MatchedFrames,
    fields: &[FieldModel],
    maps: &[PitchMap],
    clicks: &[GroundClick],
    progress: &Progress<'_, AutocalibrationProgress>,
) -> Result<PosesByFocalScale, Stop> {
    try_focal_scales(
        matched,
        &FINE_FOCAL_PERCENT,
        fields.len(),
        progress,
        |turns, panorama| {
            let mut found = Vec::new();
            for (number, (field, map)) in fields.iter().zip(maps).enumerate() {
                for pose in poses(turns, clicks, field).into_iter().take(MAX_PAIRS) {
                    let fitted = fit_pose(pose, &panorama.directions, map);
                    found.push(score_pose(fitted, panorama, (number, map)));
                }
            }
            sort(&mut found);
            found
        },
    )
}

/// The best poses at each of some focal scales, and at the neighbours of the scale that has the
/// best pose of all. `poses_at` finds the poses at one scale, the best first.
fn try_focal_scales(
    matched: &MatchedFrames,
    focal_percent: &[u32],
    places: usize,
    progress: &Progress<'_, AutocalibrationProgress>,
    poses_at: impl Fn(&Turns, &Panorama) -> Vec<ScoredPose>,
) -> Result<PosesByFocalScale, Stop> {
    let (mut found, mut rotations) = (Vec::new(), Vec::new());
    let mut percents = focal_percent.to_vec();
    let mut best: Option<(f64, u32)> = None;
    let mut refused = None;
    let mut done = 0;
    while let Some(&percent) = percents.get(done) {
        let of = percents.len().max(USUAL_ROUNDS);
        report(
            progress,
            AutocalibrationProgress::Trying { places, done, of },
        )?;
        done += 1;
        match matched.at_scale(percent) {
            Ok((frames, panorama)) => {
                let poses = poses_at(&frames.rotations, &panorama);
                let score = poses.first().map_or(0.0, ScoredPose::score);
                if best.is_none_or(|(other, _)| score > other) {
                    best = Some((score, percent));
                }
                rotations.push((percent, frames.rotations.clone()));
                let frames = Arc::new(frames);
                let poses = poses.into_iter().take(MAX_PER_SCALE);
                found.extend(poses.map(|scored| ScaledPose {
                    scored,
                    frames: Arc::clone(&frames),
                }));
            }
            Err(why @ Abstention::NotTurning(_)) if done == 1 => return Err(why.into()),
            // One focal scale may gather little paint where another gathers enough.
            Err(why) => refused = refused.or(Some(why)),
        }
        if done == percents.len() {
            percents.extend(best.and_then(|(_, percent)| untried_beside(percent, &percents)));
        }
    }
    if let Some(why) = refused.filter(|_| rotations.is_empty()) {
        return Err(why.into());
    }
    found.sort_by(|a, b| b.scored.score().total_cmp(&a.scored.score()));
    Ok(PosesByFocalScale {
        poses: found,
        rotations: RotationsByFocalScale::new(rotations),
    })
}

/// A neighbour of a share between which and itself none was tried: one beyond all that were tried
/// before one between two of them.
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
        let nearest = |tried: &[u32]| {
            *tried
                .iter()
                .min_by_key(|share| share.abs_diff(best))
                .unwrap()
        };
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
        assert_eq!(
            tried(&FIRST_FOCAL_PERCENT, 40),
            [100, 88, 113, 83, 79, 75, 71, 67]
        );
        assert_eq!(
            tried(&FIRST_FOCAL_PERCENT, 200),
            [100, 88, 113, 120, 127, 135, 143, 150]
        );
        assert_eq!(tried(&FINE_FOCAL_PERCENT, 103), FINE_FOCAL_PERCENT);
        assert_eq!(
            tried(&FINE_FOCAL_PERCENT, 118)[FINE_FOCAL_PERCENT.len()..],
            [120]
        );
    }
}
