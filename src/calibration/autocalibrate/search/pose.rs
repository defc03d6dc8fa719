//! The pose of a panorama on a field, and its fit to paint with focal scale and field held fixed.

use super::pitch_map::{OnLine, PitchMap};
use nalgebra::{SVector, Vector1};
use touchline_core::camera::{BaseAngles, CameraBase};
use touchline_core::geometry::rotation::{from_rotation_vector, nearest_rotation};
use touchline_core::geometry::{Angle, Mat3, Vec3};
use touchline_core::markings::detectability;
use touchline_core::solve::{
    BlockEquations, Linearised, Loss, Problem, Residual, Stopping, minimise,
};
use touchline_vision::track::RelativeRotations;

/// The pose of a panorama. The frame `panorama` has its origin in the camera and the pan axis as
/// its z axis.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct PanoramaPose {
    pub position_m: Vec3,
    pub world_from_panorama: Mat3,
}

impl PanoramaPose {
    /// The base of the camera whose frames have these rotations.
    pub fn base(&self, rotations: &RelativeRotations) -> CameraBase {
        // In `panorama` the cameras of the frames have a level base
        // (`RelativeRotations::camera`), so `base_from_panorama` is that of the default angles.
        let base_from_panorama = BaseAngles::default().base_from_world();
        let base_from_world = base_from_panorama * self.world_from_panorama.transpose();
        CameraBase {
            distortion: rotations.lens,
            ..CameraBase::new(self.position_m, base_from_world, rotations.principal_point)
        }
    }

    /// With a vertical pan axis; heading as in [`touchline_core::camera::BaseAngles`].
    pub fn upright(position_m: Vec3, heading: Angle) -> Self {
        let (sin, cos) = heading.sin_cos();
        Self {
            position_m,
            world_from_panorama: Mat3::new(cos, sin, 0.0, -sin, cos, 0.0, 0.0, 0.0, 1.0),
        }
    }

    /// The pose after a shift (m) and a rotation about the camera by a rotation vector (rad), both
    /// in `world`.
    pub fn move_by(&self, shift_m: Vec3, turn: Vec3) -> Self {
        self.shift_by(shift_m).turn_by(turn)
    }

    /// The pose after a shift in `world`, m.
    pub fn shift_by(&self, shift_m: Vec3) -> Self {
        Self {
            position_m: self.position_m + shift_m,
            ..*self
        }
    }

    /// The pose after a rotation about the camera by a rotation vector in `world`, rad.
    pub fn turn_by(&self, turn: Vec3) -> Self {
        let turned = from_rotation_vector(turn) * self.world_from_panorama;
        Self {
            world_from_panorama: nearest_rotation(&turned),
            ..*self
        }
    }

    /// The point at height `z_m` on the ray of a direction; none if the ray does not reach it.
    pub fn at_height(&self, direction_in_panorama: Vec3, z_m: f64) -> Option<Vec3> {
        let direction = self.world_from_panorama * direction_in_panorama;
        let range = (z_m - self.position_m.z) / direction.z;
        (range.is_finite() && range > 0.0).then(|| self.position_m + direction * range)
    }

    /// The line of a field that is seen nearest to a direction (`panorama`).
    pub fn line_at(&self, direction_in_panorama: Vec3, map: &PitchMap) -> Option<OnLine> {
        let ground = map.ground(|z_m| self.at_height(direction_in_panorama, z_m))?;
        map.nearest(ground, self.position_m)
    }

    /// The direction (`panorama`, unit) in which a point of `world` is seen.
    pub fn direction_in_panorama(&self, point_in_world: Vec3) -> Option<Vec3> {
        (self.world_from_panorama.transpose() * (point_in_world - self.position_m))
            .try_normalize(1e-9)
    }
}

/// How certain it is that paint beside a line of this width (px) belongs to it, 0 to 1: as certain
/// as that the line would be seen ([`detectability`]). What a camera sees beside a line of a fifth
/// of a pixel is as likely the foot of the boards behind it.
///
/// Drawn clip 27 of the bowl (behind a goal, filmed off a screen): where all lines counted alike,
/// the boards 10 px beside the far goal line drew the length from 108.9 to 112.5 m and the camera 3
/// to 4 m away, whatever it began with. By this weight it ends 0.5 m off.
pub fn paint_certainty(width_px: f64) -> f64 {
    const MIN_WEIGHT: f64 = 0.05;
    detectability(width_px).max(MIN_WEIGHT)
}

/// A direction of paint with the line that it should lie on.
pub struct PaintCorrespondence {
    pub direction_in_panorama: Vec3,
    pub line: OnLine,
    /// 1-σ of the direction, rad. It weights paint against the prior and is the unit of the loss.
    pub sigma: f64,
}

impl PaintCorrespondence {
    /// The plane through the camera and the line: its unit normal, and the length of the cross
    /// product before normalisation, which the derivative needs. None if the line points at the
    /// camera.
    pub fn plane(&self, at: &PanoramaPose) -> Option<(Vec3, f64)> {
        let across = (self.line.at - at.position_m).cross(&self.line.tangent);
        let length = across.norm();
        (length > 0.0).then(|| (across / length, length))
    }

    /// The angle that the paint of the line appears wide, rad, if it is painted `paint_m` wide;
    /// none if the line points at the camera.
    pub fn paint_angle(&self, at: &PanoramaPose, paint_m: f64) -> Option<f64> {
        let (normal, _) = self.plane(at)?;
        let tangent = self.line.tangent;
        let across = Vec3::new(-tangent.y, tangent.x, 0.0).try_normalize(0.0)?;
        let distance_m = (self.line.at - at.position_m).norm();
        Some(paint_m * normal.dot(&across).abs() / distance_m)
    }
}

impl Residual<1, 0, 6> for PaintCorrespondence {
    type State = PanoramaPose;

    fn sigma(&self) -> f64 {
        self.sigma
    }

    fn value(&self, at: &PanoramaPose) -> Option<SVector<f64, 1>> {
        let (normal, _) = self.plane(at)?;
        Some(Vector1::new(
            (at.world_from_panorama * self.direction_in_panorama).dot(&normal),
        ))
    }

    fn linearise(&self, at: &PanoramaPose) -> Option<Linearised<1, 0, 6>> {
        let (normal, length) = self.plane(at)?;
        let direction = at.world_from_panorama * self.direction_in_panorama;
        let value = direction.dot(&normal);
        // The residual is n·d with n = m/|m|, m = (a − C) × t, for the point a and the tangent t of
        // the line. From ∂m = −∂C × t and ∂n = (I − n nᵀ) ∂m / |m| follows ∂(n·d)/∂C = −(t × (d − n
        // (n·d))) / |m|. A rotation by ω moves d by ω × d, hence ∂(n·d)/∂ω = d × n.
        let by_position = -self.line.tangent.cross(&(direction - normal * value)) / length;
        let by_turn = direction.cross(&normal);
        let mut by_own = nalgebra::SMatrix::<f64, 1, 6>::zeros();
        by_own
            .fixed_columns_mut::<3>(0)
            .copy_from(&by_position.transpose());
        by_own
            .fixed_columns_mut::<3>(3)
            .copy_from(&by_turn.transpose());
        Some(Linearised {
            value: Vector1::new(value),
            by_shared: nalgebra::SMatrix::zeros(),
            by_own,
        })
    }
}

/// Prior: the pan axis is vertical, with this 1-σ (rad).
struct Upright(f64);

impl Residual<2, 0, 6> for Upright {
    type State = PanoramaPose;

    fn sigma(&self) -> f64 {
        self.0
    }

    fn value(&self, at: &PanoramaPose) -> Option<SVector<f64, 2>> {
        let up = at.world_from_panorama.column(2);
        Some(SVector::<f64, 2>::new(up[0], up[1]))
    }

    fn linearise(&self, at: &PanoramaPose) -> Option<Linearised<2, 0, 6>> {
        let up = at.world_from_panorama.column(2).into_owned();
        let mut by_own = nalgebra::SMatrix::<f64, 2, 6>::zeros();
        // A rotation by ω moves the pan axis by ω × up.
        for axis in 0..3 {
            let mut turn = Vec3::zeros();
            turn[axis] = 1.0;
            let moved = turn.cross(&up);
            by_own[(0, 3 + axis)] = moved.x;
            by_own[(1, 3 + axis)] = moved.y;
        }
        Some(Linearised {
            value: self.value(at)?,
            by_shared: nalgebra::SMatrix::zeros(),
            by_own,
        })
    }

    fn loss(&self, _: Loss) -> Loss {
        Loss::Squared
    }
}

/// Least squares over paint and the prior on the pan axis.
struct UprightPoseProblem {
    correspondences: Vec<PaintCorrespondence>,
    upright: Upright,
    loss: Loss,
}

impl Problem for UprightPoseProblem {
    type State = PanoramaPose;
    type Equations = BlockEquations<0, 6>;

    fn equations(&self, at: &PanoramaPose) -> BlockEquations<0, 6> {
        let mut equations = BlockEquations::zero();
        for correspondence in &self.correspondences {
            equations.add(correspondence, at, self.loss);
        }
        equations.add(&self.upright, at, self.loss);
        equations
    }

    fn apply_step(&self, from: &PanoramaPose, step: &SVector<f64, 6>) -> PanoramaPose {
        from.move_by(
            step.fixed_rows::<3>(0).into_owned(),
            step.fixed_rows::<3>(3).into_owned(),
        )
    }
}

/// The scale of the loss in each round, degrees, for a camera at the usual height ([`PitchMap::angular_scale`]); paint beyond
/// three times that is left out. Wider rounds would let paint of no line move low cameras away from
/// a good start.
const ROUNDS_DEG: [f64; 5] = [0.6, 0.6, 0.4, 0.3, 0.3];

/// 1-σ of the pan axis about the vertical.
pub const UPRIGHT_SIGMA: Angle = Angle::from_degrees(2.0);

/// Moves a panorama so that directions of paint lie on the lines of a field, each on the one
/// nearest to it (iterative closest point).
pub fn fit_pose(
    start: PanoramaPose,
    directions_in_panorama: &[Vec3],
    map: &PitchMap,
) -> PanoramaPose {
    let mut pose = start;
    for reach_deg in ROUNDS_DEG {
        let sigma = map.angular_scale(pose.position_m.z) * reach_deg.to_radians();
        // Assign each direction to its nearest line, and refine the pose for this assignment, with
        // the loss in units of the reach.
        let problem = UprightPoseProblem {
            correspondences: directions_in_panorama
                .iter()
                .filter_map(|direction| assign_to_line(*direction, &pose, map, sigma))
                .collect(),
            upright: Upright(UPRIGHT_SIGMA.radians()),
            loss: Loss::Cauchy { c: 1.0 },
        };
        // Twice as many as there are parameters, or the pose stays as it was.
        if problem.correspondences.len() < 12 {
            return pose;
        }
        pose = minimise(
            &problem,
            pose,
            Stopping {
                max_iterations: 4,
                short_step: 1e-5,
                small_gain: 1e-5,
            },
        )
        .state;
    }
    pose
}

/// A direction of paint with the line that the pose sees nearest to it, if within three times
/// `sigma` (rad).
fn assign_to_line(
    direction_in_panorama: Vec3,
    pose: &PanoramaPose,
    map: &PitchMap,
    sigma: f64,
) -> Option<PaintCorrespondence> {
    let correspondence = PaintCorrespondence {
        direction_in_panorama,
        line: pose.line_at(direction_in_panorama, map)?,
        sigma,
    };
    let off = correspondence.value(pose)?[0].abs();
    (off < 3.0 * sigma).then_some(correspondence)
}
