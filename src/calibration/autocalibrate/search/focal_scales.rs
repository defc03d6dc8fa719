//! The search over focal scales: the poses from the exhaustive search or from clicks, at one focal
//! scale after the other.
//!
//! Matches leave the common scale of the focal lengths uncertain, and the pose depends on it. So
//! poses are scored at a few scales first, then at the untried neighbours of the best scale until
//! the best has been compared with both.

use super::clicked::{GroundClick, poses_of_pairs};
use super::exhaustive::{fit_coarse_pose, search};
use super::pitch_map::PitchMap;
use super::places::SearchPlaces;
use super::pose::PanoramaPose;
use super::pose_score::{ScoredPose, score_roughly, sort_by_score};
use crate::autocalibrate::error::Stop;
use crate::autocalibrate::frames::matched_frames::{FramesAtScale, MatchedFrames};
use crate::autocalibrate::frames::panorama::Panorama;
use crate::autocalibrate::frames::rotations_by_focal_scale::RotationsByFocalScale;
use crate::autocalibrate::progress::report;
use crate::autocalibrate::{Abstention, AutocalibrationProgress, SearchedPanorama};
use crate::calibrate::kept::{KeepParts, Kept};
use rayon::prelude::*;
use std::convert::Infallible;
use std::ops::RangeInclusive;
use std::sync::Arc;
use touchline_core::camera::PanTilt;
use touchline_core::field::FieldModel;
use touchline_core::geometry::{Angle, Vec3};
use touchline_core::progress::Progress;
use touchline_vision::track::RelativeRotations;

/// The focal scales of the search, in per cent of the scale that fits the matches best. Rotations
/// alone determine the scale badly, and scrolling boards bias all matches alike. Neighbouring
/// values differ by about 6 %, as finely as the search needs.
const FOCAL_PERCENT: [u32; 15] = [
    67, 71, 75, 79, 83, 88, 94, 100, 106, 113, 120, 127, 135, 143, 150,
];

/// The scales that are tried first.
const FIRST_FOCAL_PERCENT: [u32; 3] = [100, 88, 113];

/// The scales that are tried first where clicks determine the poses. They lie closer together,
/// because the scale decides how far away the clicked landmarks are.
const FINE_FOCAL_PERCENT: [u32; 11] = [100, 97, 103, 94, 106, 91, 109, 88, 112, 115, 118];

/// The usual number of scales that a search tries; for the progress display only.
const USUAL_ROUNDS: usize = 5;

/// Maximum number of poses from pairs of clicks, per field.
const MAX_PAIRS: usize = 6;

/// The number of poses of a pair, of different leans, that are fitted.
const LEANS_FITTED: usize = 2;

/// Maximum number of poses of one focal scale that are refined further.
const MAX_PER_SCALE: usize = 3;

/// The finished parts of one stage of a search.
#[derive(Clone, Copy)]
pub struct PartsOfStage<'a> {
    /// Those of the whole search.
    pub parts: &'a dyn KeepParts,
    /// The number of the stage.
    pub stage: usize,
}

impl PartsOfStage<'_> {
    /// A part of the stage that was kept; else it is made, and kept.
    ///
    /// # Errors
    /// It cannot be made.
    pub fn part<T: Kept, E>(self, name: &str, make: impl FnOnce() -> Result<T, E>) -> Result<T, E> {
        let name = format!("{name}-{}", self.stage);
        self.parts.part(&name, make, || true)
    }

    /// The poses at a focal scale that were kept; else they are searched, and kept.
    fn poses_at(self, percent: u32, search: impl FnOnce() -> Vec<ScoredPose>) -> Vec<ScoredPose> {
        let name = format!("poses-{percent}");
        let Ok(poses) = self.part(&name, || Ok::<_, Infallible>(search()));
        poses
    }
}

/// A scored pose, with the frames at the focal scale where it was found.
pub struct ScaledPose {
    pub scored: ScoredPose,
    pub frames: Arc<FramesAtScale>,
}

/// The poses that were found at several focal scales, and the rotations of the frames at each.
pub struct PosesByFocalScale {
    /// The most likely first.
    pub poses: Vec<ScaledPose>,
    pub rotations: RotationsByFocalScale,
}

/// Searches the poses of the panorama at some places around several fields, without clicks. The
/// poses at one focal scale are a part that is kept.
pub fn search_poses(
    matched: &MatchedFrames,
    fields: &[FieldModel],
    maps: &[PitchMap],
    places: &SearchPlaces,
    parts: PartsOfStage<'_>,
    progress: &Progress<'_, AutocalibrationProgress>,
) -> Result<PosesByFocalScale, Stop> {
    let num_places = places.len() * maps.len();
    try_focal_scales(
        matched,
        &FIRST_FOCAL_PERCENT,
        (fields, num_places),
        progress,
        |percent, _, panorama| parts.poses_at(percent, || search(panorama, maps, places)),
    )
}

/// The poses that pairs of clicks determine, on several fields with their maps.
pub fn poses_from_clicks(
    matched: &MatchedFrames,
    fields: &[FieldModel],
    maps: &[PitchMap],
    clicks: &[GroundClick],
    progress: &Progress<'_, AutocalibrationProgress>,
) -> Result<PosesByFocalScale, Stop> {
    try_focal_scales(
        matched,
        &FINE_FOCAL_PERCENT,
        (fields, fields.len()),
        progress,
        |_, rotations, panorama| {
            let mut found = Vec::new();
            for (number, (field, map)) in fields.iter().zip(maps).enumerate() {
                for poses in poses_of_pairs(rotations, clicks, field, MAX_PAIRS) {
                    found.extend(best_of_pair(&poses, panorama, (number, map)));
                }
            }
            sort_by_score(&mut found);
            found
        },
    )
}

/// The best of the poses that one pair of clicks gives for different leans of the pan axis, fitted.
fn best_of_pair(
    poses: &[PanoramaPose],
    panorama: &Panorama,
    (field, map): (usize, &PitchMap),
) -> Vec<ScoredPose> {
    let mut scored: Vec<ScoredPose> = poses
        .par_iter()
        .map(|pose| score_roughly(*pose, panorama, (field, map)))
        .collect();
    sort_by_score(&mut scored);
    scored.truncate(LEANS_FITTED);
    scored
        .par_iter()
        .map(|scored| fit_coarse_pose(scored.pose, panorama, (field, map)))
        .collect()
}

/// The best poses at each of some focal scales, and at the neighbours of the scale that has the
/// best pose of all. `poses_at` returns the poses at one scale, the best first; they are on one of
/// `fields`.
///
/// # Errors
/// The search was stopped, no scale could be evaluated, or the frames are not those of a rotating
/// camera, which shows at the first scale.
fn try_focal_scales(
    matched: &MatchedFrames,
    focal_percent: &[u32],
    (fields, places): (&[FieldModel], usize),
    progress: &Progress<'_, AutocalibrationProgress>,
    poses_at: impl Fn(u32, &RelativeRotations, &Panorama) -> Vec<ScoredPose>,
) -> Result<PosesByFocalScale, Stop> {
    let (mut found, mut rotations) = (Vec::new(), Vec::new());
    let mut percents = focal_percent.to_vec();
    let mut best: Option<(f64, u32)> = None;
    let mut refused = None;
    let mut shown = None;
    let mut done = 0;
    while let Some(&percent) = percents.get(done) {
        let at_scale = matched.at_scale(percent);
        // What is shown first has no field: the paint alone, until a pose is found.
        if let (None, Ok((frames, panorama))) = (&shown, &at_scale) {
            shown = Some(view_panorama(matched, &frames.rotations, panorama, None));
        }
        let of = percents.len().max(USUAL_ROUNDS);
        report(progress, begin_round(places, [done, of], shown.as_ref()))?;
        done += 1;
        match at_scale {
            Ok((frames, panorama)) => {
                // Find the poses at this scale, and remember the scale with the best pose.
                let poses = poses_at(percent, &frames.rotations, &panorama);
                let score = poses.first().map_or(0.0, ScoredPose::score);
                if best.is_none_or(|(other, _)| score > other) {
                    best = Some((score, percent));
                    let first = poses.first();
                    let placed = first.and_then(|best| Some((&best.pose, fields.get(best.field)?)));
                    let rotations = &frames.rotations;
                    shown = Some(view_panorama(matched, rotations, &panorama, placed));
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
        // All planned scales are done: add a neighbour of the best, until there is none.
        if done == percents.len() {
            percents.extend(best.and_then(|(_, percent)| next_scale_beside(percent, &percents)));
        }
    }
    // Fail only if no scale worked, with the first reason.
    if let Some(why) = refused.filter(|_| rotations.is_empty()) {
        return Err(why.into());
    }
    report(progress, begin_round(places, [done, done], shown.as_ref()))?;
    // Poses of all scales compete; the sort is stable.
    found.sort_by(|a, b| b.scored.score().total_cmp(&a.scored.score()));
    Ok(PosesByFocalScale {
        poses: found,
        rotations: RotationsByFocalScale::new(rotations),
    })
}

/// The progress at the beginning of a round, and after the last one.
fn begin_round(
    places: usize,
    [done, of]: [usize; 2],
    panorama: Option<&Arc<SearchedPanorama>>,
) -> AutocalibrationProgress {
    AutocalibrationProgress::Trying {
        places,
        done,
        of,
        panorama: panorama.map(Arc::clone),
    }
}

/// The panorama at one focal scale as it is shown, with the field where a pose puts it.
fn view_panorama(
    matched: &MatchedFrames,
    rotations: &RelativeRotations,
    panorama: &Panorama,
    placed: Option<(&PanoramaPose, &FieldModel)>,
) -> Arc<SearchedPanorama> {
    let unplaced = PanoramaPose::upright(Vec3::zeros(), Angle::default());
    let pose = placed.map_or(&unplaced, |(pose, _)| pose);
    let base = pose.base(rotations);
    // Pan and tilt refer to the base, whose rotation in the panorama is the same for all poses.
    let base_from_panorama = base.base_from_world * pose.world_from_panorama;
    let directions = panorama.directions.iter();
    let frames = rotations.ptz.iter();
    Arc::new(SearchedPanorama {
        base,
        field: placed.map(|(_, field)| field.clone()),
        frames: frames.map(|ptz| (*ptz, matched.image_size)).collect(),
        paint: directions
            .map(|direction| PanTilt::from_direction(base_from_panorama * direction))
            .collect(),
    })
}

/// The next scale to try beside the best one, from [`FOCAL_PERCENT`]: a neighbour such that no
/// tried scale lies between it and the best, or equals it. Scales beyond all tried ones come before
/// those between two of them.
fn next_scale_beside(percent: u32, tried: &[u32]) -> Option<u32> {
    let above = FOCAL_PERCENT.into_iter().find(|share| *share > percent);
    let below = FOCAL_PERCENT.into_iter().rfind(|share| *share < percent);
    // A neighbour counts as tried if any scale between it and the best was tried: scales from the
    // finer list may lie between two of the table.
    let above = above.filter(|above| !is_any_within(tried, &(percent + 1..=*above)));
    let below = below.filter(|below| !is_any_within(tried, &(*below..=percent - 1)));
    // A scale beyond all tried ones sorts first: `false` comes before `true`.
    above.into_iter().chain(below).min_by_key(|share| {
        is_any_within(tried, &(0..=*share)) && is_any_within(tried, &(*share..=u32::MAX))
    })
}

/// Whether any of some scales lies within a range, per cent.
fn is_any_within(scales: &[u32], range: &RangeInclusive<u32>) -> bool {
    scales.iter().any(|scale| range.contains(scale))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::autocalibrate::rotating_camera::{matched_views_with_pixels, soccer};
    use crate::calibrate::kept::{KeptInMemory, NothingKept};
    use std::cell::RefCell;
    use std::ops::ControlFlow;

    /// The scales that are tried if the best is always the one nearest to `best`.
    fn tried(first: &[u32], best: u32) -> Vec<u32> {
        let mut tried = first.to_vec();
        let nearest = |tried: &[u32]| {
            *tried
                .iter()
                .min_by_key(|share| share.abs_diff(best))
                .unwrap()
        };
        while let Some(next) = next_scale_beside(nearest(&tried), &tried) {
            tried.push(next);
        }
        tried
    }

    /// A search that is killed at the third focal scale, and made again with what it kept: the
    /// scales that were searched each time.
    fn search_killed_at_the_third_scale(parts: &dyn KeepParts) -> [Vec<u32>; 2] {
        let matched = matched_views_with_pixels(&soccer().assumed, &[1, 3, 5]);
        let pose = |percent| ScoredPose {
            pose: PanoramaPose::upright(Vec3::new(0.0, -60.0, 14.0), Angle::default()),
            field: 0,
            explained: 1.0 / f64::from(percent),
            visible: 0.7,
        };
        let mut outcomes = Vec::new();
        let searched = [2, usize::MAX].map(|killed_at| {
            let progress = Progress::new(|step| match step {
                AutocalibrationProgress::Trying { done, .. } if done >= killed_at => {
                    ControlFlow::Break(())
                }
                _ => ControlFlow::Continue(()),
            });
            let searched = RefCell::new(Vec::new());
            let stage = PartsOfStage { parts, stage: 1 };
            let poses_at = |percent, _: &RelativeRotations, _: &Panorama| {
                stage.poses_at(percent, || {
                    searched.borrow_mut().push(percent);
                    vec![pose(percent)]
                })
            };
            let first = &FIRST_FOCAL_PERCENT;
            outcomes.push(try_focal_scales(&matched, first, (&[], 1), &progress, poses_at).is_ok());
            searched.into_inner()
        });
        assert_eq!(outcomes, [false, true]);
        searched
    }

    #[test]
    fn a_search_that_is_killed_loses_one_focal_scale() {
        let [before, after] = search_killed_at_the_third_scale(&KeptInMemory::default());
        assert_eq!(before, FIRST_FOCAL_PERCENT[..2]);
        assert_eq!(after[0], FIRST_FOCAL_PERCENT[2], "the first two are kept");
        let [before, again] = search_killed_at_the_third_scale(&NothingKept);
        assert_eq!([before, after].concat(), again, "in one run");
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
