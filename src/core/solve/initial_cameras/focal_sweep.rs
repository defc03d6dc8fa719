//! Starts from one landmark, or from one straight line, for every focal length.
//!
//! With the focal length known, one point gives pan and tilt (`one_point.rs`). So does one straight
//! line, by the same equations: the plane through the camera and the field's line has a normal m in
//! `base`, and the plane through the camera and the drawn line one n in `cam`. A camera that shows
//! the line where it was drawn rotates m into n or into −n, as a camera that shows a point where it
//! was clicked rotates the point's direction into the pixel's. (n is the image of the line under
//! the transposed projection: Hartley and Zisserman, *Multiple View Geometry*, 2nd ed., eq. 8.2.)
//!
//! One parameter is left to sweep. Every local minimum of the cost over all observations is the
//! start of one solution: none is missed that is wider than a step of 10 % in focal length.

use super::one_point::{pan_tilt_from_one_point, pan_tilts_from_directions};
use crate::camera::{CameraBase, Ptz, PtzCamera};
use crate::geometry::{ImagePoint, Vec3};
use crate::solve::SolveContext;
use crate::solve::observations::drawn_line::DrawnLine;
use crate::solve::observations::observation::Observation;
use crate::solve::optimiser::loss::Loss;
use crate::solve::refine::cost;

/// Steps of a sweep over the plausible range of focal lengths.
const STEPS: usize = 48;

/// The loss that ranks starts. A click beyond 5 σ hardly counts, so one wrong name does not hide a
/// good start.
const RANKING_LOSS: Loss = Loss::Cauchy { c: 5.0 };

/// A landmark click.
#[derive(Clone, Copy)]
pub(super) struct LandmarkClick {
    pub point_in_world: Vec3,
    pub image: ImagePoint,
    pub click: usize,
}

/// A start with its cost; lower is better.
#[derive(Clone, Copy)]
pub(in crate::solve) struct RankedStart {
    pub cost: f64,
    pub ptz: Ptz,
}

/// A start with its robust cost over the observations.
pub(in crate::solve) fn rank(
    base: &CameraBase,
    ptz: Ptz,
    observations: &[Observation],
) -> RankedStart {
    RankedStart {
        cost: cost(&PtzCamera::new(*base, ptz), observations, RANKING_LOSS),
        ptz,
    }
}

/// The cameras that show a landmark where it was clicked and fit the other observations locally
/// best.
pub(super) fn sweep_landmark(
    base: &CameraBase,
    landmark: LandmarkClick,
    observations: &[Observation],
    context: &SolveContext,
) -> Vec<RankedStart> {
    let LandmarkClick {
        point_in_world,
        image,
        ..
    } = landmark;
    sweep(base, observations, context, |focal_px| {
        pan_tilt_from_one_point(base, focal_px, point_in_world, image).ok()
    })
}

/// The cameras that show a straight line where it was drawn and fit the other observations locally
/// best; none for an arc, or where the points of the line coincide.
pub(super) fn sweep_line(
    base: &CameraBase,
    line: &DrawnLine,
    observations: &[Observation],
    context: &SolveContext,
) -> Vec<RankedStart> {
    let (Some(segment), Some(straight)) = (line.segment(), line.straight()) else {
        return Vec::new();
    };
    // A line through the camera has no plane: its normal is NaN, and no camera is upright then.
    let [from, to] = segment.map(|end| base.base_from_world_point(end));
    let normal_in_base = from.cross(&to).normalize();
    // Either sign of the normal, and either branch of its pan and tilt: the normal of a plane does
    // not say on which side of it the picture is up.
    let mut found = Vec::new();
    for normal in [normal_in_base, -normal_in_base] {
        for branch in 0..2 {
            found.extend(sweep(base, observations, context, |focal_px| {
                let in_cam = plane_normal(base, focal_px, straight.ends)?;
                let (pan, tilt) = pan_tilts_from_directions(normal, in_cam)[branch];
                Some(Ptz {
                    pan,
                    tilt,
                    focal_px,
                })
            }));
        }
    }
    found
}

/// The unit normal, in `cam`, of the plane through the camera and two pixels; none where a pixel
/// has no ray.
fn plane_normal(base: &CameraBase, focal_px: f64, pixels: [ImagePoint; 2]) -> Option<Vec3> {
    // Pan and tilt do not matter for rays in `cam`.
    let lens = PtzCamera::new(*base, Ptz::from_degrees(0.0, 0.0, focal_px));
    let [one, two] = pixels.map(|pixel| lens.cam_plane_from_image(pixel));
    Some(one.ok()?.push(1.0).cross(&two.ok()?.push(1.0)).normalize())
}

/// The local minima of the cost over the focal length.
fn sweep(
    base: &CameraBase,
    observations: &[Observation],
    context: &SolveContext,
    at_focal: impl Fn(f64) -> Option<Ptz>,
) -> Vec<RankedStart> {
    // Focal lengths without a camera are skipped, so that the neighbours of a gap count as its
    // ends.
    let swept: Vec<RankedStart> = log_spaced_focals(context, STEPS)
        .filter_map(at_focal)
        .filter(is_upright)
        .map(|ptz| rank(base, ptz, observations))
        .collect();
    (0..swept.len())
        .filter(|&index| is_local_minimum(&swept, index))
        .map(|index| swept[index])
        .collect()
}

/// Whether neither neighbour has a lower cost. The ends of the range count as minima if the cost
/// falls towards them.
fn is_local_minimum(swept: &[RankedStart], index: usize) -> bool {
    let cost = swept[index].cost;
    let falls_to = index == 0 || swept[index - 1].cost >= cost;
    let rises_from = swept.get(index + 1).is_none_or(|next| next.cost >= cost);
    falls_to && rises_from
}

/// Whether a camera is finite and not upside down.
pub(in crate::solve) fn is_upright(ptz: &Ptz) -> bool {
    ptz.is_finite() && ptz.tilt.abs().degrees() <= 90.0
}

/// Focal lengths over the plausible range, evenly spaced in log f.
pub(super) fn log_spaced_focals(
    context: &SolveContext,
    count: usize,
) -> impl Iterator<Item = f64> + use<> {
    // A range from zero has no logarithm; no lens is shorter than a pixel.
    let (from, upto) = (
        context.ranges.focal_px.start().max(1.0).ln(),
        context.ranges.focal_px.end().max(1.0).ln(),
    );
    (0..=count).map(move |step| (from + (upto - from) * step as f64 / count as f64).exp())
}
