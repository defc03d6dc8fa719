//! Pairwise matching: features of two frames that one rotation and one zoom explain.

use super::cycles::{brought, cycle_consistent_edges, zoom_and_turn};
use super::descriptor_matches::{DescriptorColumns, mutual_matches};
use super::homography::robust_homography;
use super::{TrackError, ViewGraphEdge};
use crate::features::{Features, STANDING_PX, WHOLE_PICTURE, cell_in_grid, place_share};
use rayon::prelude::*;
use std::sync::atomic::{AtomicUsize, Ordering};
use touchline_core::geometry::{ImagePoint, Mat3};
use touchline_core::progress::{Progress, Share};

/// Inlier threshold of the homography, px at 1920 px width.
const WITHIN_PX: f64 = 6.0;

/// Minimum number of inliers of a pairwise match.
const MIN_MATCHES: usize = 15;

/// Minimum share of the features in the common view that match. Boards that repeat in two places of
/// the stadium match too, but nothing around them does.
const MIN_SHARE: f64 = 0.06;

/// Largest ratio of the focal lengths of two frames.
const MAX_ZOOM: f64 = 2.5;

/// Largest rotation between two frames in the image plane, degrees: a camera that only pans and
/// tilts has little.
const MAX_TURN_DEG: f64 = 20.0;

/// Maximum number of point pairs kept per pairwise match, spread over the picture.
const KEPT: usize = 48;

/// Matches every pair of frames, and drops pairwise matches that contradict the others.
///
/// If `progress` cancels it, the matches found so far are returned. One step of the progress is one
/// pair.
///
/// # Errors
/// The program was built without OpenCV, or OpenCV returned an error.
pub fn match_frames_pairwise(
    frames: &[Features],
    progress: &Progress<'_, Share>,
) -> Result<Vec<ViewGraphEdge>, TrackError> {
    // All pairs, because frames sampled from a match have no order in which neighbours overlap.
    // Descriptors are converted once per frame, not once per pair.
    let pairs: Vec<(usize, usize)> = (0..frames.len())
        .flat_map(|first| (first + 1..frames.len()).map(move |second| (first, second)))
        .collect();
    let described: Vec<DescriptorColumns> = frames
        .par_iter()
        .map(DescriptorColumns::from_features)
        .collect();
    let done = AtomicUsize::new(0);
    let edges: Vec<Option<ViewGraphEdge>> = pairs
        .par_iter()
        .map(|&(first, second)| {
            if progress.is_cancelled() {
                return Ok(None);
            }
            let edge = match_pair(frames, &described, first, second);
            // Cancellation is checked at the start of every pair.
            let _ = progress.report(Share::new(
                done.fetch_add(1, Ordering::Relaxed) + 1,
                pairs.len(),
            ));
            edge
        })
        .collect::<Result<_, _>>()?;
    // Cycles are compared at the size of the first frame: frames of one camera have one size.
    let edges: Vec<ViewGraphEdge> = edges.into_iter().flatten().collect();
    Ok(frames.first().map_or_else(Vec::new, |first| {
        cycle_consistent_edges(&edges, first.image_size)
    }))
}

/// The pairwise match of two frames; `None` if they do not show the same, or share only a graphic.
fn match_pair(
    frames: &[Features],
    described: &[DescriptorColumns],
    first: usize,
    second: usize,
) -> Result<Option<ViewGraphEdge>, TrackError> {
    let (one, other) = (&frames[first], &frames[second]);
    let scale = one.image_size.scale_from_1920();
    // Putative correspondences by descriptor alone.
    let mut pairs: Vec<(ImagePoint, ImagePoint)> =
        mutual_matches(&described[first], &described[second])
            .into_iter()
            .map(|(a, b)| (one.keypoints[a].point, other.keypoints[b].point))
            .collect();
    // Drop burnt-in graphics: correspondences that stand still in the image.
    if one.image_size == other.image_size {
        // A camera at rest also shows points that stand still, but all over the picture; a graphic
        // occupies few cells of it.
        let standing = pairs
            .iter()
            .filter(|pair| stands_still(pair, scale))
            .map(|pair| pair.0);
        let all = one.keypoints.iter().map(|keypoint| keypoint.point);
        if place_share(standing, all, one.image_size) < WHOLE_PICTURE {
            pairs.retain(|pair| !stands_still(pair, scale));
        }
    }
    if pairs.len() < MIN_MATCHES {
        return Ok(None);
    }
    // A rotating and zooming camera maps one image to another by a homography (Hartley and
    // Zisserman: "Multiple View Geometry", section 8.4).
    let Some((second_from_first, agree)) = robust_homography(&pairs, WITHIN_PX * scale)? else {
        return Ok(None);
    };
    let mut agreed = agree.into_iter();
    pairs.retain(|_| agreed.next().unwrap_or(false));
    let agreeing = pairs.len();
    // Accept only a homography of plausible zoom and image rotation whose inliers are a sufficient
    // share of what both frames show.
    let plausible = is_of_a_turning_camera(&second_from_first, one.image_size.centre());
    let common = count_in_overlap(one, other, &second_from_first);
    let needed = MIN_MATCHES.max((MIN_SHARE * common as f64) as usize);
    Ok((agreeing >= needed && plausible).then(|| ViewGraphEdge {
        first,
        second,
        matches: spread(pairs, one),
        agreeing,
        second_from_first,
    }))
}

/// Whether a correspondence stands still in the image; `scale` is image px per px at 1920 px width.
fn stands_still((here, there): &(ImagePoint, ImagePoint), scale: f64) -> bool {
    here.distance_px(*there) < STANDING_PX * scale
}

/// The number of features of one frame that lie in the view of the other; the smaller of the two
/// directions.
fn count_in_overlap(one: &Features, other: &Features, other_from_one: &Mat3) -> usize {
    let back = other_from_one.try_inverse().map_or(0, |one_from_other| {
        count_in_view(other, one, &one_from_other)
    });
    count_in_view(one, other, other_from_one).min(back)
}

/// The number of features of the frame `from` that a homography maps into the picture of `to`.
fn count_in_view(from: &Features, to: &Features, to_from: &Mat3) -> usize {
    from.keypoints
        .iter()
        .filter(|keypoint| {
            brought(to_from, keypoint.point).is_some_and(|there| to.image_size.contains(there))
        })
        .count()
}

/// Whether a homography zooms and rotates the image, at its centre, as little as a camera on a pan
/// axis does.
fn is_of_a_turning_camera(second_from_first: &Mat3, centre: ImagePoint) -> bool {
    zoom_and_turn(second_from_first, centre).is_some_and(|(zoom, turn_deg)| {
        (1.0 / MAX_ZOOM..=MAX_ZOOM).contains(&zoom) && turn_deg.abs() < MAX_TURN_DEG
    })
}

/// Subsamples the matches evenly over a grid of 12 × 7 cells of the first frame, so that a board
/// with many matches does not outweigh a stand with few.
fn spread(pairs: Vec<(ImagePoint, ImagePoint)>, of: &Features) -> Vec<(ImagePoint, ImagePoint)> {
    const CELLS: (usize, usize) = (12, 7);
    if pairs.len() <= KEPT {
        return pairs;
    }
    let mut taken = vec![0_usize; CELLS.0 * CELLS.1];
    // Rank each match within its cell; lower ranks of all cells come before higher ones. The
    // original order is restored at the end.
    let mut ranked: Vec<(usize, usize)> = pairs
        .iter()
        .enumerate()
        .map(|(index, pair)| {
            let rank = &mut taken[cell_in_grid(pair.0, of.image_size, CELLS)];
            *rank += 1;
            (*rank, index)
        })
        .collect();
    ranked.sort_unstable();
    ranked.truncate(KEPT);
    ranked.sort_unstable_by_key(|&(_, index)| index);
    ranked.into_iter().map(|(_, index)| pairs[index]).collect()
}
