//! Where the lines could lie: every step of a camera within reach, judged by how many samples find
//! a ridge.

use super::alignment::{ClickAlignment, RidgeAlignment, StepPx};

/// Steps tried on each side, of pan and of tilt.
const TURNS: i32 = 6;

/// Steps tried on each side, of the focal length.
const ZOOMS: i32 = 2;

/// The farthest change of the focal length moves the picture's border by this share of the reach.
const ZOOM_SHARE: f64 = 0.75;

/// A step counts what lies within this many grid distances of a line.
const WITHIN: f64 = 1.0;

/// Places that found fewer votes than this share of the best one's are not looked at.
const WORTH: f64 = 0.6;

/// Places nearer to each other than this are one, grid distances.
const SAME: f64 = 2.5;

/// Clicks stay within this of where they were, sigmas.
const CLICK_SIGMAS: f64 = 5.0;

/// At most this many places are looked at.
const MOST: usize = 3;

/// The steps, far from each other, after which most samples find a ridge, best first.
pub(super) fn likely_steps(
    ridges: &RidgeAlignment,
    clicks: &ClickAlignment,
    reach_px: f64,
) -> Vec<StepPx> {
    let grid_px = reach_px / f64::from(TURNS);
    let zoom_px = reach_px * ZOOM_SHARE / f64::from(ZOOMS);
    let mut votes = Vec::new();
    for pan in -TURNS..=TURNS {
        for tilt in -TURNS..=TURNS {
            for zoom in -ZOOMS..=ZOOMS {
                let step = StepPx::new(
                    f64::from(pan) * grid_px,
                    f64::from(tilt) * grid_px,
                    f64::from(zoom) * zoom_px,
                );
                if clicks.allows(&step, CLICK_SIGMAS) {
                    votes.push((ridges.votes(&step, WITHIN * grid_px), step));
                }
            }
        }
    }
    votes.sort_by(|a, b| b.0.total_cmp(&a.0));
    let worth = WORTH * votes.first().map_or(0.0, |best| best.0);
    let mut likely: Vec<StepPx> = Vec::new();
    for (_, step) in votes
        .iter()
        .take_while(|(votes, _)| *votes >= worth && *votes > 0.0)
    {
        if likely
            .iter()
            .all(|other| (other - step).norm() > SAME * grid_px)
        {
            likely.push(*step);
        }
        if likely.len() == MOST {
            break;
        }
    }
    likely
}
