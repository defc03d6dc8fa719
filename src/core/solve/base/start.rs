//! The start of the adjustment: a base that many frames agree on, from the clicks alone.
//!
//! Every frame with four ground landmarks determines a camera by itself; a frame with lines alone
//! may have one that was found before ([`CameraClicks::own_cameras`]). Its position is noisy, and a
//! few positions are grossly wrong. Each such position, and their median, is tested as the base
//! on a sample of frames, with a level head and with the rotation of least roll. The base with the
//! lowest robust cost wins. Wrong names in some frames therefore do not spoil the start.

use super::{BaseError, CameraClicks, FrameClicks};
use crate::camera::{BaseAngles, CameraBase, FocalCurve, Ptz, PtzCamera};
use crate::geometry::{ImagePoint, ImageSize, Mat3, Vec2, Vec3, median_high, subsample};
use crate::solve::initial_cameras::plane_pose::pose_from_plane;
use crate::solve::refine::squared_sigmas;
use crate::solve::{Loss, SolveContext, solve_frame};

/// Number of frames on which a position is tested.
const SAMPLE: usize = 12;

/// Maximum number of positions tested.
const MAX_POSITIONS: usize = 16;

/// The loss that ranks positions. It grows slowly, so that a frame with wrong names does not
/// decide.
const SCORE_LOSS: Loss = Loss::Cauchy { c: 5.0 };

/// A first base, and each frame's camera under it.
#[derive(Clone, Debug, PartialEq)]
pub struct BaseStart {
    /// The base: no distortion.
    pub base: CameraBase,
    /// Pan, tilt, focal length of each frame that could be solved with it.
    pub ptz: Vec<Option<Ptz>>,
}

/// Finds a first base from the frames' clicks alone.
///
/// # Errors
/// No frame has four ground landmarks that determine a camera.
pub fn start_base(clicks: &CameraClicks<'_>) -> Result<BaseStart, BaseError> {
    let CameraClicks {
        frames,
        image_size,
        principal_point,
        own_cameras,
        pixel_aspect,
        ..
    } = *clicks;
    let pinhole = FocalCurve::NONE.with_pixel_aspect(pixel_aspect);
    // Position and x axis (`world`) of each frame's own camera.
    let ground: Vec<Vec<(Vec2, ImagePoint)>> = frames
        .iter()
        .map(|frame| ground_landmarks(frame, &pinhole, principal_point))
        .collect();
    let most_landmarks = ground.iter().map(Vec::len).max().unwrap_or(0);
    let by_landmarks = ground.iter().filter_map(|ground| {
        let pose = pose_from_plane(ground, principal_point).ok()?;
        Some((pose.position_m, pose.cam_from_world.row(0).transpose()))
    });
    let by_lines = own_cameras.iter().map(|camera| {
        let x_axis = camera.cam_from_world().row(0).transpose();
        (camera.base().position_m, x_axis)
    });
    // Positions below 1 m, above 200 m or farther than 500 m away are no sports cameras.
    let poses: Vec<(Vec3, Vec3)> = by_landmarks
        .chain(by_lines)
        .filter(|(position_m, _)| (1.0..200.0).contains(&position_m.z) && position_m.norm() < 500.0)
        .collect();
    if poses.is_empty() {
        let frames = frames.iter().filter(|frame| frame.equations() > 0).count();
        return Err(BaseError::NoStart {
            frames,
            most_landmarks,
        });
    }

    // Hypotheses: positions × rotations, tested on frames with surplus equations (six for three
    // unknowns).
    let rotations = [
        BaseAngles::default().base_from_world(),
        least_roll(poses.iter().map(|pose| pose.1)),
    ];
    let enough: Vec<_> = frames
        .iter()
        .filter(|frame| frame.equations() >= 6)
        .collect();
    let sample: Vec<_> = subsample(enough, SAMPLE).collect();
    let mut positions: Vec<Vec3> = subsample(&poses, MAX_POSITIONS)
        .map(|pose| pose.0)
        .collect();
    // The median of all, which no single frame has to be right for.
    positions.push(Vec3::from_fn(|axis, _| {
        median_high(&mut poses.iter().map(|pose| pose.0[axis]).collect::<Vec<_>>()).unwrap_or(0.0)
    }));

    // Keep the hypothesis with the lowest cost on the sample.
    let mut best: Option<(f64, CameraBase)> = None;
    for position_m in positions {
        for rotation in rotations {
            let base = CameraBase {
                distortion: pinhole,
                ..CameraBase::new(position_m, rotation, principal_point)
            };
            let base = base.in_pan_gauge().0;
            let cost: f64 = sample
                .iter()
                .map(|frame| frame_cost(&base, frame, image_size))
                .sum();
            if best.is_none_or(|(least, _)| cost < least) {
                best = Some((cost, base));
            }
        }
    }
    let Some((_, base)) = best else {
        return Err(BaseError::NoStart {
            frames: frames.len(),
            most_landmarks,
        });
    };
    let ptz = solve_all(&base, frames, image_size);
    Ok(BaseStart { base, ptz })
}

/// Each frame's pan, tilt and focal length under a base; none where its clicks determine no camera.
pub(super) fn solve_all(
    base: &CameraBase,
    frames: &[FrameClicks],
    image_size: ImageSize,
) -> Vec<Option<Ptz>> {
    let context = SolveContext::new(image_size);
    frames
        .iter()
        .map(|frame| {
            solve_frame(base, &frame.observations, &context)
                .ok()
                .map(|solved| solved.ptz)
        })
        .collect()
}

/// Robust cost of a frame, solved under a base. Clicks without an image, and all clicks of a frame
/// that cannot be solved, have a large constant cost.
fn frame_cost(base: &CameraBase, frame: &FrameClicks, image_size: ImageSize) -> f64 {
    let solved = solve_frame(base, &frame.observations, &SolveContext::new(image_size)).ok();
    let camera = solved.map(|solved| PtzCamera::new(*base, solved.ptz));
    frame
        .used_clicks()
        .map(|click| {
            let distance = camera.as_ref().and_then(|camera| click.distance_px(camera));
            SCORE_LOSS
                .evaluate(squared_sigmas(distance, click.sigma_px))
                .0
        })
        .sum()
}

/// The ground landmarks of a frame: x and y in `world`, m, and the pixel where it would be if the
/// pixels behind the lens were square.
fn ground_landmarks(
    frame: &FrameClicks,
    lens: &FocalCurve,
    principal_point: ImagePoint,
) -> Vec<(Vec2, ImagePoint)> {
    /// Maximum height of ground above z = 0: a crowned pitch counts as flat here, m.
    const GROUND_M: f64 = 0.4;
    frame
        .used_clicks()
        .filter_map(|click| {
            click
                .shape
                .point()
                .filter(|at| at.z.abs() < GROUND_M)
                .map(|at| (at.xy(), lens.square_point(click.image, principal_point)))
        })
        .collect()
}

/// The base rotation with the least roll of all cameras, given their x axes in `world`. Pan about
/// the base's y axis and then tilt about x leave a camera's x axis perpendicular to the pan axis.
/// So the pan axis u minimises Σ (xᵢ · u)²: it is the eigenvector of Σ xᵢ xᵢᵀ with the smallest
/// eigenvalue. A small horizontal term added to the matrix favours the vertical where the cameras
/// do not determine u.
fn least_roll(x_axes_in_world: impl Iterator<Item = Vec3>) -> Mat3 {
    let mut spread = Mat3::from_diagonal(&Vec3::new(0.3, 0.3, 0.0));
    for axis in x_axes_in_world {
        spread += axis * axis.transpose();
    }
    let eigen = spread.symmetric_eigen();
    let smallest = eigen.eigenvalues.imin();
    let mut up = Vec3::from(eigen.eigenvectors.column(smallest));
    if up.z < 0.0 {
        up = -up;
    }
    CameraBase::rotation_about(&up)
}
