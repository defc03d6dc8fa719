//! Fits our seven-parameter camera to homographies, and finds bases that several frames share.

use super::read::SIZE;
use rayon::prelude::*;
use touchline::camera::{BaseAngles, CameraBase, Ptz, PtzCamera};
use touchline::field::FieldModel;
use touchline::geometry::{Angle, ImagePoint, Mat3, Vec2, Vec3, median};
use touchline::score::PlaneView;
use touchline::solve::base::{
    AdjustOptions, BaseModel, BasePriors, CameraClicks, CrownModel, FrameClicks, LensModel,
    adjust_base,
};
use touchline::solve::{Loss, Observation, pose_from_plane, refine};

/// Grid of pixels, columns and rows, at which a homography is sampled.
const GRID: [u32; 2] = [16, 9];
/// Minimum number of samples on the pitch. With fewer, the homography is too poorly determined.
const FEWEST_POINTS: usize = 12;
/// A base is tried only on frames with a fitted position within this distance, m. The distance is
/// generous because a homography determines the position poorly along the viewing direction.
const NEIGHBOURS_M: f64 = 12.0;
/// Maximum number of times that a group's base is fitted to the frames that agree with it.
const ROUNDS: usize = 3;

/// A frame's homography, as correspondences between pitch and picture.
#[derive(Clone, Debug)]
pub struct Sampled {
    /// Points of the pitch (m) and their pixels, over all of the pitch that the picture shows.
    points: Vec<(Vec2, ImagePoint)>,
}

/// A camera fitted to a frame's homography.
#[derive(Clone, Copy, Debug)]
pub struct Fitted {
    /// The camera. Its base is the frame's own, with an upright pan axis except for the roll that
    /// the homography needs.
    pub camera: PtzCamera,
    /// Root mean square distance between camera and homography over the visible pitch, px.
    pub rms_px: f64,
}

impl Sampled {
    /// Samples the homography at the pixels of the grid that show the pitch. None with fewer than
    /// [`FEWEST_POINTS`].
    pub fn new(view: &PlaneView, field: &FieldModel) -> Option<Self> {
        let [columns, rows] = GRID.map(f64::from);
        let (width, height) = (f64::from(SIZE.width), f64::from(SIZE.height));
        let grid = (0..GRID[0])
            .flat_map(|column| (0..GRID[1]).map(move |row| (f64::from(column), f64::from(row))));
        // The middle of each cell of the grid, px, corner convention.
        let pixels = grid.map(|(column, row)| {
            ImagePoint::new(
                (column + 0.5) / columns * width,
                (row + 0.5) / rows * height,
            )
        });
        let [half_length, half_width] = [0.5 * field.length_m, 0.5 * field.width_m];
        let points: Vec<(Vec2, ImagePoint)> = pixels
            .filter_map(|pixel| Some((view.ground_from_image(pixel)?, pixel)))
            // Beyond the pitch a homography is an extrapolation.
            .filter(|(ground, _)| ground.x.abs() <= half_length && ground.y.abs() <= half_width)
            .collect();
        (points.len() >= FEWEST_POINTS).then_some(Self { points })
    }

    /// The same points of the pitch, at the pixels where a camera sees them.
    pub fn as_seen_by(&self, camera: &PtzCamera) -> Self {
        let shown = |(ground, _): &(Vec2, ImagePoint)| {
            Some((
                *ground,
                camera
                    .image_from_world(Vec3::new(ground.x, ground.y, 0.0))
                    .ok()?,
            ))
        };
        Self {
            // Points behind the camera have no pixel and are left out.
            points: self.points.iter().filter_map(shown).collect(),
        }
    }

    fn observations(&self) -> Vec<Observation> {
        // The same sigma for all points: none is better known than another.
        let landmark = |(click, (ground, image)): (usize, &(Vec2, ImagePoint))| {
            Observation::from_point(Vec3::new(ground.x, ground.y, 0.0), *image, 1.0, click)
        };
        self.points.iter().enumerate().map(landmark).collect()
    }

    /// Root mean square distance between camera and homography, px; infinite if the camera does not
    /// see a point.
    fn rms_px(&self, camera: &PtzCamera) -> f64 {
        let squares = self.points.iter().map(|(ground, image)| {
            let shown = camera.image_from_world(Vec3::new(ground.x, ground.y, 0.0));
            shown.map_or(f64::INFINITY, |shown| {
                shown.offset_from(*image).norm_squared()
            })
        });
        (squares.sum::<f64>() / self.points.len() as f64).sqrt()
    }

    /// Fits position, rotation and focal length, with square pixels and the principal point in the
    /// middle. None if no camera above the ground gives this homography.
    pub fn fit_camera(&self, field: &FieldModel) -> Option<Fitted> {
        let principal = SIZE.centre();
        let pose = pose_from_plane(&self.points, principal).ok()?;
        // A position below the ground is no camera's. NaN is refused as well.
        if !(pose.position_m.z > 0.0) {
            return None;
        }
        let (base, ptz) = without_roll(
            &pose.cam_from_world,
            pose.position_m,
            principal,
            pose.focal_px,
        );
        // Without priors on pitch and roll: the base has to explain a single frame exactly.
        // The closed form is the start; all seven parameters are then fitted to the pixels.
        let loose = BasePriors {
            pitch: Angle::from_degrees(1000.0),
            roll: Angle::from_degrees(1000.0),
            ..BasePriors::default()
        };
        let options = AdjustOptions {
            loss: Loss::Squared,
            priors: loose,
            ..AdjustOptions::default()
        };
        let frames = [FrameClicks {
            observations: self.observations(),
            start: None,
        }];
        let adjusted = adjust_base(
            &CameraClicks::with_centred_principal_point(field, &frames, SIZE),
            &base,
            &[Some(ptz)],
            &PINHOLE,
            &options,
        );
        let camera = PtzCamera::new(adjusted.base, adjusted.ptz.first().copied().flatten()?);
        Some(Fitted {
            camera,
            rms_px: self.rms_px(&camera),
        })
    }

    /// Fits pan, tilt and focal length under a fixed base, from `start`.
    fn fit_ptz(&self, base: &CameraBase, start: Ptz) -> Fitted {
        let refined = refine(base, start, &self.observations(), Loss::Squared, None);
        let camera = PtzCamera::new(*base, refined.ptz);
        Fitted {
            camera,
            rms_px: self.rms_px(&camera),
        }
    }
}

/// The model that corresponds to a homography: a flat pitch and no distortion.
const PINHOLE: BaseModel = BaseModel {
    lens: LensModel::Pinhole,
    crown: CrownModel::Fixed(0.0),
    principal_point: None,
};

/// Splits a rotation into a base and pan and tilt. The base's pan axis is as upright as the
/// camera's horizontal axis allows: the vertical, projected perpendicularly to that axis.
fn without_roll(
    cam_from_world: &Mat3,
    position_m: Vec3,
    principal: ImagePoint,
    focal_px: f64,
) -> (CameraBase, Ptz) {
    // The base is chosen so that the rotation from it is Q_tilt Q_pan exactly (`conventions`). Pan
    // and tilt leave the camera's right axis in the plane across the pan axis, so that the pan axis
    // is perpendicular to `right`, and as near to the vertical as that allows.
    let right = cam_from_world.row(0).transpose();
    let up = (Vec3::z() - right * right.z).normalize();
    // At pan 0 the base looks along +y of the world, as far as its pan axis allows.
    let level_right = Vec3::y().cross(&up).normalize();
    let base_from_world = Mat3::from_rows(&[
        level_right.transpose(),
        -up.transpose(),
        up.cross(&level_right).transpose(),
    ]);
    let turned = cam_from_world * base_from_world.transpose();
    // The first row of Q_tilt Q_pan is (cos θ, 0, −sin θ), its middle column (0, cos φ, −sin φ).
    let pan = Angle::from_radians((-turned[(0, 2)]).atan2(turned[(0, 0)]));
    let tilt = Angle::from_radians((-turned[(2, 1)]).atan2(turned[(1, 1)]));
    (
        CameraBase::new(position_m, base_from_world, principal),
        Ptz {
            pan,
            tilt,
            focal_px,
        },
    )
}

/// A base and the frames that it explains.
#[derive(Clone, Debug)]
pub struct SharedBase {
    /// The base.
    pub base: CameraBase,
    /// Indices of the frames.
    pub frames: Vec<usize>,
}

/// Finds bases that explain several frames each, within `within_px` root mean square. Greedy,
/// largest group first; each frame is in at most one group.
///
/// Candidates are the fitted positions of all frames, each with a level base and with the frame's
/// own rotation. The candidate with most frames in agreement is adjusted to these jointly, and they
/// are removed. This is repeated until no two frames agree. All candidates are tried once; only
/// their lists of frames shrink.
pub fn groups(
    field: &FieldModel,
    sampled: &[Sampled],
    fitted: &[Fitted],
    within_px: f64,
) -> Vec<SharedBase> {
    let level = BaseAngles::default().base_from_world();
    let start_bases = |frame: usize| {
        let own = *fitted[frame].camera.base();
        [
            CameraBase {
                base_from_world: level,
                ..own
            },
            own,
        ]
    };
    // The distance is tested first, because a fit costs far more.
    let agrees = |base: &CameraBase, frame: usize| {
        let own = fitted[frame].camera;
        if (own.base().position_m - base.position_m).norm() > NEIGHBOURS_M {
            return false;
        }
        sampled[frame].fit_ptz(base, level_ptz(&own)).rms_px <= within_px
    };
    let mut left: Vec<usize> = (0..sampled.len()).collect();
    let try_base = |base: CameraBase| {
        let frames = left
            .iter()
            .copied()
            .filter(|&frame| agrees(&base, frame))
            .collect();
        SharedBase { base, frames }
    };
    // Twice as many candidates as frames, each fitted to all frames near it. This is the costly
    // part, and it is done once.
    let mut tried: Vec<SharedBase> = left
        .par_iter()
        .flat_map_iter(|&frame| start_bases(frame).map(try_base))
        .collect();
    let mut found = Vec::new();
    // Of equal groups take the first, so that the result is deterministic.
    while let Some((_, largest)) = tried
        .iter()
        .enumerate()
        .max_by_key(|(index, group)| (group.frames.len(), std::cmp::Reverse(*index)))
    {
        // A base for one frame says nothing: each frame has its own.
        if largest.frames.len() < 2 {
            break;
        }
        let mut group = largest.clone();
        // Alternate between adjusting the base and collecting the frames that agree with it.
        for _ in 0..ROUNDS {
            let base = together(field, sampled, fitted, &group);
            let frames: Vec<usize> = left
                .iter()
                .copied()
                .filter(|&frame| agrees(&base, frame))
                .collect();
            // The adjustment minimises the sum of squares, which is not the number of frames within
            // the limit: a step that loses frames is not taken.
            if frames.len() < group.frames.len() {
                break;
            }
            group = SharedBase { base, frames };
        }
        left.retain(|frame| !group.frames.contains(frame));
        for other in &mut tried {
            other.frames.retain(|frame| left.contains(frame));
        }
        found.push(group);
    }
    found.sort_by_key(|group| std::cmp::Reverse(group.frames.len()));
    found
}

/// A group's base, adjusted jointly to all of its frames.
fn together(
    field: &FieldModel,
    sampled: &[Sampled],
    fitted: &[Fitted],
    group: &SharedBase,
) -> CameraBase {
    let clicks = |&frame: &usize| FrameClicks {
        observations: sampled[frame].observations(),
        start: None,
    };
    let frames: Vec<FrameClicks> = group.frames.iter().map(clicks).collect();
    let start: Vec<Option<Ptz>> = group
        .frames
        .iter()
        .map(|&frame| Some(level_ptz(&fitted[frame].camera)))
        .collect();
    // Here with the usual priors on pitch and roll, because several frames determine one base.
    let options = AdjustOptions {
        loss: Loss::Squared,
        ..AdjustOptions::default()
    };
    adjust_base(
        &CameraClicks::with_centred_principal_point(field, &frames, SIZE),
        &group.base,
        &start,
        &PINHOLE,
        &options,
    )
    .base
}

/// The residual of each frame (root mean square, px) under one level base at the median position,
/// with pan, tilt and focal length fitted to the frame.
pub fn under_one_base(sampled: &[Sampled], fitted: &[Fitted]) -> Vec<f64> {
    let middle = Vec3::from_fn(|axis, _| {
        let mut along: Vec<f64> = fitted
            .iter()
            .map(|fitted| fitted.camera.base().position_m[axis])
            .collect();
        // There is at least one frame: `run` refuses a folder without.
        median(&mut along).unwrap_or(f64::NAN)
    });
    let base = CameraBase::new(
        middle,
        BaseAngles::default().base_from_world(),
        SIZE.centre(),
    );
    let of = |(sampled, fitted): (&Sampled, &Fitted)| {
        sampled.fit_ptz(&base, level_ptz(&fitted.camera)).rms_px
    };
    sampled.par_iter().zip(fitted).map(of).collect()
}

/// Pan and tilt of the optical axis in a level base: a start for any base that is nearly level.
fn level_ptz(camera: &PtzCamera) -> Ptz {
    // The optical axis, in the world.
    let forward = camera.cam_from_world().row(2).transpose();
    Ptz {
        pan: Angle::from_radians(forward.x.atan2(forward.y)),
        tilt: Angle::from_radians(forward.z.atan2(forward.x.hypot(forward.y))),
        focal_px: camera.ptz().focal_px,
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use touchline::field::builtin;

    fn seen(place: [f64; 3], pan_deg: f64, tilt_deg: f64, focal_px: f64) -> PtzCamera {
        let rolled = BaseAngles {
            roll: Angle::from_degrees(0.2),
            ..BaseAngles::default()
        };
        let base = CameraBase::new(Vec3::from(place), rolled.base_from_world(), SIZE.centre());
        PtzCamera::new(base, Ptz::from_degrees(pan_deg, tilt_deg, focal_px))
    }

    #[test]
    fn a_rotation_is_that_of_its_base_and_its_pan_and_tilt() {
        let camera = seen([2.0, -62.0, 14.0], -25.0, -11.0, 2000.0);
        let rotation = camera.cam_from_world();
        let position_m = camera.base().position_m;
        let (base, ptz) = without_roll(&rotation, position_m, SIZE.centre(), 2000.0);
        let again = PtzCamera::new(base, ptz).cam_from_world();
        assert!((again - rotation).norm() < 1e-9, "{again} {rotation}");
    }

    #[test]
    fn a_cameras_own_homography_is_fitted_exactly_and_bases_are_distinguished() {
        let field = builtin("soccer").unwrap().default_model().unwrap();
        let (one, other) = ([2.0, -62.0, 14.0], [-1.0, -70.0, 19.0]);
        let cameras = [
            seen(one, -25.0, -11.0, 2000.0),
            seen(other, 3.0, -13.0, 2600.0),
            seen(one, 4.0, -12.0, 1700.0),
            seen(one, 28.0, -12.0, 3000.0),
            seen(other, -22.0, -12.0, 2300.0),
            seen([30.0, -55.0, 8.0], -10.0, -8.0, 1600.0),
        ];
        let sampled: Vec<Sampled> = cameras
            .iter()
            .map(|camera| {
                Sampled::new(&PlaneView::from_camera(camera, SIZE).unwrap(), &field).unwrap()
            })
            .collect();
        let fitted: Vec<Fitted> = sampled
            .iter()
            .map(|sampled| sampled.fit_camera(&field).unwrap())
            .collect();
        for (camera, fitted) in cameras.iter().zip(&fitted) {
            assert!(fitted.rms_px < 1e-4, "{}", fitted.rms_px);
            assert!(
                (fitted.camera.base().position_m - camera.base().position_m).norm() < 1e-2,
                "{fitted:?}"
            );
            assert!(
                (fitted.camera.ptz().focal_px - camera.ptz().focal_px).abs() < 0.5,
                "{fitted:?}"
            );
        }
        let found = groups(&field, &sampled, &fitted, 1.0);
        let frames: Vec<&[usize]> = found.iter().map(|group| group.frames.as_slice()).collect();
        assert_eq!(frames, [&[0, 2, 3][..], &[1, 4]]);
        assert!(
            (found[0].base.position_m - Vec3::from(one)).norm() < 0.05,
            "{:?}",
            found[0].base
        );
        let apart = under_one_base(&sampled, &fitted);
        assert!(apart.iter().any(|rms_px| *rms_px > 2.0), "{apart:?}");
    }
}
