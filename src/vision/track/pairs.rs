//! Two frames that show the same: matches that one rotation and one zoom explain.

use super::cycles::uncontradicted;
use super::matches::{Described, mutual_matches};
use super::tie::{brought, zoom_and_turn};
use super::{Tie, TrackError};
use crate::features::{Features, STANDING_PX, WHOLE_PICTURE, place_share};
use rayon::prelude::*;
use std::sync::atomic::{AtomicUsize, Ordering};
use touchline_core::geometry::{ImagePoint, Mat3};
use touchline_core::progress::{Progress, Share};

/// Matches agree with a homography within this distance, px at 1920 px width.
const WITHIN_PX: f64 = 6.0;

/// A tie has at least as many matches.
const MIN_MATCHES: usize = 15;

/// At least this share of the features that both frames should show has to be matched: boards that
/// say the same in two places match too, but nothing around them does.
const MIN_SHARE: f64 = 0.06;

/// Between two frames of one camera the focal length changes by this factor at most.
const MAX_ZOOM: f64 = 2.5;

/// A camera that pans and tilts turns its picture no further in its own plane, degrees.
const MAX_TURN_DEG: f64 = 20.0;

/// At most as many matches of a tie are kept, spread over the picture.
const KEPT: usize = 48;

/// Ties every pair of frames that show the same; ties that the others contradict are left out. If
/// `progress` cancels it, what was found until then is returned. A step counts pairs.
///
/// # Errors
/// The program was built without OpenCV, or OpenCV refused.
pub fn tie_frames(
    frames: &[Features],
    progress: &Progress<'_, Share>,
) -> Result<Vec<Tie>, TrackError> {
    let pairs: Vec<(usize, usize)> = (0..frames.len())
        .flat_map(|first| (first + 1..frames.len()).map(move |second| (first, second)))
        .collect();
    let described: Vec<Described> = frames.par_iter().map(Described::of).collect();
    let done = AtomicUsize::new(0);
    let ties: Vec<Option<Tie>> = pairs
        .par_iter()
        .map(|&(first, second)| {
            if progress.is_cancelled() {
                return Ok(None);
            }
            let tie = tie_pair(frames, &described, first, second);
            // The pairs that follow ask whether it is cancelled.
            let _ = progress.report(Share {
                done: done.fetch_add(1, Ordering::Relaxed) + 1,
                of: pairs.len(),
            });
            tie
        })
        .collect::<Result<_, _>>()?;
    let ties: Vec<Tie> = ties.into_iter().flatten().collect();
    Ok(frames
        .first()
        .map_or_else(Vec::new, |first| uncontradicted(&ties, first.image_size)))
}

/// The tie of two frames; none where they do not show the same, or a graphic alone.
fn tie_pair(
    frames: &[Features],
    described: &[Described],
    first: usize,
    second: usize,
) -> Result<Option<Tie>, TrackError> {
    let (one, other) = (&frames[first], &frames[second]);
    let scale = one.image_size.scale_from_1920();
    let point = |features: &Features, index: usize| features.keypoints[index].point;
    let mut pairs: Vec<(ImagePoint, ImagePoint)> =
        mutual_matches(&described[first], &described[second])
            .into_iter()
            .map(|(a, b)| (point(one, a), point(other, b)))
            .collect();
    if one.image_size == other.image_size {
        let still =
            |pair: &(ImagePoint, ImagePoint)| pair.0.distance_px(pair.1) < STANDING_PX * scale;
        // A camera that stands shows still things everywhere; graphics lie in a few places of the
        // picture.
        let standing = pairs.iter().filter(|pair| still(pair)).map(|pair| pair.0);
        let all = one.keypoints.iter().map(|keypoint| keypoint.point);
        if place_share(standing, all, one.image_size) < WHOLE_PICTURE {
            pairs.retain(|pair| !still(pair));
        }
    }
    if pairs.len() < MIN_MATCHES {
        return Ok(None);
    }
    let Some((second_from_first, agree)) =
        super::homography::robust_homography(&pairs, WITHIN_PX * scale)?
    else {
        return Ok(None);
    };
    let mut agreed = agree.into_iter();
    pairs.retain(|_| agreed.next().unwrap_or(false));
    let agreeing = pairs.len();
    let plausible = is_of_a_turning_camera(&second_from_first, one.image_size.centre());
    let common = shown_by_both(one, other, &second_from_first);
    let needed = MIN_MATCHES.max((MIN_SHARE * common as f64) as usize);
    Ok((agreeing >= needed && plausible).then(|| Tie {
        first,
        second,
        matches: spread(pairs, one),
        agreeing,
        second_from_first,
    }))
}

/// How many features of each frame lie where the other looks: of the frame with fewer.
fn shown_by_both(one: &Features, other: &Features, other_from_one: &Mat3) -> usize {
    let inside = |from: &Features, to: &Features, to_from: &Mat3| {
        let seen = |at: ImagePoint| {
            brought(to_from, at).is_some_and(|there| to.image_size.contains(there))
        };
        from.keypoints
            .iter()
            .filter(|keypoint| seen(keypoint.point))
            .count()
    };
    let back = other_from_one
        .try_inverse()
        .map_or(0, |one_from_other| inside(other, one, &one_from_other));
    inside(one, other, other_from_one).min(back)
}

fn is_of_a_turning_camera(second_from_first: &Mat3, centre: ImagePoint) -> bool {
    zoom_and_turn(second_from_first, centre).is_some_and(|(zoom, turn_deg)| {
        (1.0 / MAX_ZOOM..=MAX_ZOOM).contains(&zoom) && turn_deg.abs() < MAX_TURN_DEG
    })
}

/// Some of the matches, one after the other from cells of a grid over the first frame: one board's
/// many matches count no more than a stand's few.
fn spread(pairs: Vec<(ImagePoint, ImagePoint)>, of: &Features) -> Vec<(ImagePoint, ImagePoint)> {
    const CELLS: (usize, usize) = (12, 7);
    if pairs.len() <= KEPT {
        return pairs;
    }
    let cell = |at: ImagePoint| {
        let along = |position: f64, extent: u32, count: usize| {
            ((position / f64::from(extent.max(1)) * count as f64).max(0.0) as usize).min(count - 1)
        };
        along(at.y, of.image_size.height, CELLS.1) * CELLS.0
            + along(at.x, of.image_size.width, CELLS.0)
    };
    let mut taken = vec![0_usize; CELLS.0 * CELLS.1];
    let mut ranked: Vec<(usize, usize)> = pairs
        .iter()
        .enumerate()
        .map(|(index, pair)| {
            let rank = &mut taken[cell(pair.0)];
            *rank += 1;
            (*rank, index)
        })
        .collect();
    ranked.sort_unstable();
    ranked.truncate(KEPT);
    ranked.sort_unstable_by_key(|&(_, index)| index);
    ranked.into_iter().map(|(_, index)| pairs[index]).collect()
}
