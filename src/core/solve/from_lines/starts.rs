//! Where the fit of a picture starts: cameras in closed form at plausible places around the field.
//!
//! * Four or more straight lines on the ground: the camera of their homography (`plane.rs`).
//! * Two or more crossings of drawn lines, or landmarks: at every place, the two-point cameras of
//!   the pairs that determine it best.
//! * Else: at every other place, the same for a drawn point of each of two lines, or of one line and
//!   the one crossing, at several points of the field's lines.
//!
//! The places are the whole bowl: the main stand densely, the other side, the ends and the corners
//! sparsely. With the right place a two-point camera fits all lines; with one that is off by ten
//! metres it fits within some tens of pixels, from where the fit converges. Starts are ranked by a
//! bounded loss over all lines, so that a wrong name costs a constant and decides nothing.

use super::LinePicture;
use super::crossings::Crossing;
use super::drawn_line::DrawnLine;
use super::plane::camera_from_ground_lines;
use super::priors::{PicturePriors, scale_of};
use crate::camera::{BaseAngles, CameraBase, Ptz, PtzCamera};
use crate::field::Curve;
use crate::geometry::{Angle, Vec3, subsample};
use crate::solve::refine::cost;
use crate::solve::starts::{camera_distance, keep_distinct};
use crate::solve::{Loss, Observation, solve_two_points};

/// A camera to refine, with its cost.
#[derive(Clone, Copy, Debug)]
pub(super) struct Start {
    pub base: CameraBase,
    pub ptz: Ptz,
    pub cost: f64,
}

/// The loss that ranks starts: an error of 30 sigmas costs half of what any larger one costs.
const RANKING_LOSS: Loss = Loss::GemanMcClure { c: 30.0 };

/// Pairs of crossings that are tried at each place, at most.
const MAX_PAIRS: usize = 4;

/// The most certain crossings, whose pairs are compared.
const MAX_CROSSINGS: usize = 16;

/// Starts that are refined, at most.
pub(super) const MAX_STARTS: usize = 8;

/// Starts nearer to each other than both of these lead to one minimum: [`camera_distance`], and the
/// distance of the positions on a field 68 m wide, m.
const SAME_CAMERA: f64 = 0.1;
const SAME_PLACE_M: f64 = 20.0;

/// The best starts that differ, best first. `ranking` are the observations that rank them.
pub(super) fn find_starts(
    picture: &LinePicture<'_>,
    lines: &[DrawnLine],
    crossings: &[Crossing],
    ranking: &[Observation],
    priors: &PicturePriors,
) -> Vec<Start> {
    let centre = picture.image_size.centre();
    let place = priors.place(picture.field);
    let focal = priors.focal(picture.image_size.width);
    let rank = |base: CameraBase, ptz: Ptz| Start {
        base,
        ptz,
        cost: cost(&PtzCamera::new(base, ptz), ranking, RANKING_LOSS)
            + place.cost(base.position_m)
            + focal.cost(ptz.focal_px),
    };
    let mut starts: Vec<Start> = camera_from_ground_lines(lines, picture.image_size)
        .map(|(base, ptz)| rank(base, ptz))
        .into_iter()
        .collect();

    // At each place only the best camera counts; neighbouring places lead to one minimum.
    let mut pairs = best_pairs(crossings);
    let mut places = bowl(scale_of(picture.field));
    if pairs.is_empty() {
        pairs = pairs_along_lines(lines, crossings.first());
        places = places.into_iter().step_by(2).collect();
    }
    for position_m in places {
        let level = BaseAngles::default().base_from_world();
        let base = CameraBase::new(position_m, level, centre);
        let cameras = pairs.iter().filter_map(|[one, two]| {
            let worlds = [one.in_world, two.in_world];
            solve_two_points(&base, worlds, [one.image, two.image]).ok()
        });
        let ranked = cameras.flat_map(|found| found.iter().map(|ptz| rank(base, ptz)));
        starts.extend(ranked.min_by(|a, b| a.cost.total_cmp(&b.cost)));
    }
    starts.retain(|start| start.cost.is_finite());
    starts.sort_by(|a, b| a.cost.total_cmp(&b.cost));
    let same_place_m = SAME_PLACE_M * scale_of(picture.field);
    keep_distinct(starts, MAX_STARTS, |one, other| {
        camera_distance(&one.ptz, &other.ptz) > SAME_CAMERA
            || (one.base.position_m - other.base.position_m).norm() > same_place_m
    })
}

/// The pairs of crossings that determine a camera best: far apart for their σ.
fn best_pairs(crossings: &[Crossing]) -> Vec<[Crossing; 2]> {
    let certain = &crossings[..crossings.len().min(MAX_CROSSINGS)];
    let mut pairs: Vec<[Crossing; 2]> = Vec::new();
    for (index, one) in certain.iter().enumerate() {
        pairs.extend(certain[index + 1..].iter().map(|two| [*one, *two]));
    }
    let worth = |[one, two]: &[Crossing; 2]| {
        one.image.distance_px(two.image) / one.sigmas.hypot(two.sigmas)
    };
    pairs.sort_by(|a, b| worth(b).total_cmp(&worth(a)));
    pairs.truncate(MAX_PAIRS);
    pairs
}

/// Pairs of a drawn point of one line with one of another, each at several points of its line of
/// the field: one of the pairs is nearly right. A crossing, if there is one, stands for the first.
fn pairs_along_lines(lines: &[DrawnLine], crossing: Option<&Crossing>) -> Vec<[Crossing; 2]> {
    // The two lines with the most points; a circle, which bounds the camera from all sides, has
    // many.
    let mut by_points: Vec<&DrawnLine> = lines.iter().collect();
    by_points.sort_by_key(|line| std::cmp::Reverse(line.points.len()));
    let known: Vec<Crossing> = match (crossing, by_points.get(1)) {
        (Some(crossing), _) => vec![*crossing],
        (None, Some(two)) => candidates(two, two.points.len() - 1).collect(),
        (None, None) => Vec::new(),
    };
    let Some(one) = by_points.first() else {
        return Vec::new();
    };
    candidates(one, 0)
        .flat_map(|first| known.iter().map(move |second| [first, *second]))
        .collect()
}

/// A drawn point of a line at evenly spaced points of the line of the field.
fn candidates(line: &DrawnLine, index: usize) -> impl Iterator<Item = Crossing> {
    const ALONG_SEGMENT: u32 = 7;
    const ALONG_ARC: u32 = 16;
    let nominal = *line.curve.nominal();
    let count = match nominal {
        Curve::Segment { .. } => ALONG_SEGMENT,
        Curve::Arc { .. } => ALONG_ARC,
    };
    let image = line.points[index];
    (0..count).map(move |step| Crossing {
        in_world: nominal.point_at((f64::from(step) + 0.5) / f64::from(count)),
        image,
        sigmas: 1.0,
    })
}

/// Places of cameras around a field, `world`, m; `scale` is its size.
fn bowl(scale: f64) -> Vec<Vec3> {
    /// The main stand: x and distance y from the middle, and height over distance.
    const BESIDE: [f64; 5] = [-25.0, -10.0, 0.0, 10.0, 25.0];
    const AWAY: [f64; 4] = [45.0, 58.0, 72.0, 90.0];
    const RISE: [f64; 3] = [0.15, 0.25, 0.38];
    /// All around: on ellipses these times as large as the field, at these heights.
    const AROUND: u32 = 16;
    const FAR: [f64; 2] = [1.4, 1.9];
    const HEIGHT: [f64; 2] = [8.0, 20.0];
    let mut places = Vec::new();
    for x in BESIDE {
        for away in AWAY {
            places.extend(RISE.map(|rise| Vec3::new(x, -away, rise * away) * scale));
        }
    }
    for step in 0..AROUND {
        let (sin, cos) = Angle::from_degrees(360.0 * f64::from(step) / f64::from(AROUND)).sin_cos();
        for far in FAR {
            let around = |z: f64| Vec3::new(52.5 * far * cos, 38.0 * far * sin, z) * scale;
            places.extend(HEIGHT.map(around));
        }
    }
    places
}

/// A few observations of each line, evenly spread over its points: what ranks starts.
pub(super) fn few_per_line(lines: &[DrawnLine], observations: &[Observation]) -> Vec<Observation> {
    const MOST: usize = 4;
    let landmarks = observations
        .iter()
        .filter(|observation| observation.shape.point().is_some());
    let on_lines = lines
        .iter()
        .flat_map(|line| subsample(&line.indices, MOST))
        .map(|&index| &observations[index]);
    landmarks.chain(on_lines).copied().collect()
}
