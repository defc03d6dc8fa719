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
use super::plane::camera_from_ground_lines;
use super::priors::{FocalPrior, PicturePriors, PlacePrior, scale_of};
use crate::camera::{BaseAngles, CameraBase, Ptz, PtzCamera};
use crate::geometry::{Angle, Vec3, keep_distinct};
use crate::solve::initial_cameras::line_pairs::{find_pairs, solve_pair};
use crate::solve::initial_cameras::starts::camera_distance;
use crate::solve::observations::crossings::Crossing;
use crate::solve::observations::drawn_line::DrawnLine;
use crate::solve::refine::cost;
use crate::solve::{Loss, Observation};

/// A camera to refine, with its cost.
#[derive(Clone, Copy, Debug)]
pub(super) struct Start {
    pub base: CameraBase,
    pub ptz: Ptz,
    pub cost: f64,
}

/// The loss that ranks starts: an error of 30 sigmas costs half of what any larger one costs.
const RANKING_LOSS: Loss = Loss::GemanMcClure { c: 30.0 };

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
    let centre = picture.lens.principal_point_in(picture.image_size);
    let ranking = Ranking {
        observations: ranking,
        place: priors.place(picture.field),
        focal: priors.focal(picture.image_size),
    };
    let pinhole = picture.lens.without_distortion();
    let by_lines = camera_from_ground_lines(lines, picture.image_size, (centre, pinhole));
    let mut starts: Vec<Start> = by_lines
        .map(|camera| ranking.rank(camera.base(), camera.ptz()))
        .into_iter()
        .collect();

    // At each place only the best camera counts; neighbouring places lead to one minimum.
    let pairs = find_pairs(lines, crossings);
    let mut places = bowl(scale_of(picture.field));
    if crossings.len() < 2 {
        // There are many pairs then.
        places = places.into_iter().step_by(2).collect();
    }
    for position_m in places {
        // A level head in the pan gauge: the fit finds how it leans.
        let level = BaseAngles::default().base_from_world();
        let base = CameraBase {
            distortion: pinhole,
            ..CameraBase::new(position_m, level, centre)
        };
        let cameras = pairs.iter().filter_map(|pair| solve_pair(&base, pair));
        let ranked = cameras.flat_map(|found| found.iter().map(|ptz| ranking.rank(&base, ptz)));
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

/// What starts are ranked by: the points of the lines, and the priors of place and focal length.
struct Ranking<'a> {
    observations: &'a [Observation],
    place: PlacePrior,
    focal: FocalPrior,
}

impl Ranking<'_> {
    /// A start with its cost, sigmas².
    fn rank(&self, base: &CameraBase, ptz: Ptz) -> Start {
        let camera = PtzCamera::new(*base, ptz);
        let cost = cost(&camera, self.observations, RANKING_LOSS)
            + self.place.cost(base.position_m)
            + self.focal.cost(ptz.focal_px);
        Start {
            base: *base,
            ptz,
            cost,
        }
    }
}

/// Places of cameras around a field, `world`, m; `scale` is its size.
fn bowl(scale: f64) -> Vec<Vec3> {
    /// The main stand: x and distance y from the middle, and height over distance.
    const STAND_X: [f64; 5] = [-25.0, -10.0, 0.0, 10.0, 25.0];
    const STAND_DISTANCE: [f64; 4] = [45.0, 58.0, 72.0, 90.0];
    const STAND_RISE: [f64; 3] = [0.15, 0.25, 0.38];
    /// All around: on ellipses these times as large as these semi-axes, m, at these heights. The
    /// axes are a soccer pitch's with the ground beside its touchlines; `scale` fits other fields.
    const STEPS: u32 = 16;
    const SEMI_AXES: [f64; 2] = [52.5, 38.0];
    const ELLIPSE_FACTORS: [f64; 2] = [1.4, 1.9];
    const ELLIPSE_HEIGHTS: [f64; 2] = [8.0, 20.0];
    let mut places = Vec::new();
    for x in STAND_X {
        for away in STAND_DISTANCE {
            places.extend(STAND_RISE.map(|rise| Vec3::new(x, -away, rise * away) * scale));
        }
    }
    for step in 0..STEPS {
        let (sin, cos) = Angle::from_degrees(360.0 * f64::from(step) / f64::from(STEPS)).sin_cos();
        for far in ELLIPSE_FACTORS {
            let (x, y) = (SEMI_AXES[0] * far * cos, SEMI_AXES[1] * far * sin);
            places.extend(ELLIPSE_HEIGHTS.map(|z| Vec3::new(x, y, z) * scale));
        }
    }
    places
}
