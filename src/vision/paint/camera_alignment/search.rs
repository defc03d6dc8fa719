//! Grid search over small changes of a camera: every step within reach is scored by the number of
//! samples that find a ridge on their line.

use super::alignment::{ClickAlignment, RidgeAlignment, StepPx};

/// Grid steps on each side, in pan and in tilt.
const ANGLE_STEPS: i32 = 6;

/// Grid steps on each side, in focal length.
const ZOOMS: i32 = 2;

/// The largest change of the focal length moves the picture's border by this share of the reach.
const ZOOM_SHARE: f64 = 0.75;

/// A ridge votes for a step within this distance of its line, in grid steps.
const VOTE_RADIUS: f64 = 1.0;

/// Steps with fewer votes than this share of the best one's are dropped.
const WORTH: f64 = 0.6;

/// Steps nearer to a better one than this are dropped, in grid steps.
const MIN_SEPARATION: f64 = 2.5;

/// A step moves no click farther off than this many σ beyond its present distance.
const CLICK_SIGMAS: f64 = 5.0;

/// Maximum number of steps that are returned.
const MAX_STEPS: usize = 3;

/// The distinct steps after which most samples find a ridge, best first; at most [`MAX_STEPS`].
///
/// A vote instead of a descent: within reach of a search there are parallel lines, and each is a
/// minimum of its own. The start alone does not say which one is right.
pub(super) fn likely_steps(
    ridges: &RidgeAlignment,
    clicks: &ClickAlignment,
    reach_px: f64,
) -> Vec<StepPx> {
    let grid_px = reach_px / f64::from(ANGLE_STEPS);
    let zoom_px = reach_px * ZOOM_SHARE / f64::from(ZOOMS);
    let mut votes = Vec::new();
    // All 13 × 13 × 5 steps that the clicks allow. The picture is not read for them: a step moves
    // the lines by their derivatives, and the ridges found once are compared with the moved lines.
    for pan in -ANGLE_STEPS..=ANGLE_STEPS {
        for tilt in -ANGLE_STEPS..=ANGLE_STEPS {
            for zoom in -ZOOMS..=ZOOMS {
                let step = StepPx::new(
                    f64::from(pan) * grid_px,
                    f64::from(tilt) * grid_px,
                    f64::from(zoom) * zoom_px,
                );
                if clicks.allows(&step, CLICK_SIGMAS) {
                    votes.push((ridges.votes(&step, VOTE_RADIUS * grid_px), step));
                }
            }
        }
    }
    // The sort is stable: steps of equal votes stay in the order of the grid, the same in every
    // run.
    votes.sort_by(|a, b| b.0.total_cmp(&a.0));
    // Greedy non-maximum suppression over the votes: the alignment that follows mostly ends in one
    // minimum from steps that are near to each other.
    let worth = WORTH * votes.first().map_or(0.0, |best| best.0);
    let mut likely: Vec<StepPx> = Vec::new();
    for (_, step) in votes
        .iter()
        .take_while(|(votes, _)| *votes >= worth && *votes > 0.0)
    {
        if likely
            .iter()
            .all(|other| (other - step).norm() > MIN_SEPARATION * grid_px)
        {
            likely.push(*step);
        }
        if likely.len() == MAX_STEPS {
            break;
        }
    }
    likely
}
