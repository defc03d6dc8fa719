//! The least-squares problem of one frame: its pan, tilt and focal length from points whose
//! directions are known.
//!
//! The parameters are pan, tilt and ln f. Each point measures the camera by the distance between
//! its image and the projection of its direction. A focal length that is known beforehand enters as
//! one more measurement, with a σ so small that no point can move it.

use crate::track::pose_problem::{KNOWN_FOCAL_SIGMA, apply_offset};
use nalgebra::{SMatrix, SVector};
use touchline_core::camera::{CameraBase, PanTilt, Ptz, PtzCamera};
use touchline_core::geometry::{ImagePoint, Vec2, Vec3};
use touchline_core::solve::{BlockEquations, Linearised, Loss, Problem, Residual};

/// The adjustment of one frame's pan, tilt and log focal length, with known directions.
pub(super) struct OneFrame<'a> {
    /// The base with its position at the origin, so that the camera projects directions.
    pub base: &'a CameraBase,
    pub known_focal: Option<KnownFocal>,
    pub correspondences: &'a [Correspondence],
    pub loss: Loss,
}

impl Problem for OneFrame<'_> {
    type State = Ptz;
    type Equations = BlockEquations<0, 3>;

    fn equations(&self, at: &Ptz) -> BlockEquations<0, 3> {
        // The state of the residuals is the camera, so that it is built once for all points.
        let camera = PtzCamera::new(*self.base, *at);
        let mut equations = BlockEquations::zero();
        if let Some(known) = &self.known_focal {
            equations.add(known, &camera, Loss::Squared);
        }
        for correspondence in self.correspondences {
            equations.add(correspondence, &camera, self.loss);
        }
        equations
    }

    fn apply_step(&self, from: &Ptz, step: &Vec3) -> Ptz {
        apply_offset(*from, *step)
    }
}

/// A known focal length, px, as a measurement of ln f that outweighs all points.
#[derive(Clone, Copy)]
pub(super) struct KnownFocal(pub f64);

impl Residual<1, 0, 3> for KnownFocal {
    type State = PtzCamera;

    fn sigma(&self) -> f64 {
        KNOWN_FOCAL_SIGMA
    }

    fn value(&self, at: &PtzCamera) -> Option<SVector<f64, 1>> {
        Some(SVector::<f64, 1>::new((at.ptz().focal_px / self.0).ln()))
    }

    fn linearise(&self, at: &PtzCamera) -> Option<Linearised<1, 0, 3>> {
        let by_own = SMatrix::<f64, 1, 3>::new(0.0, 0.0, 1.0);
        Some(Linearised::without_shared(self.value(at)?, by_own))
    }
}

/// A correspondence: a known direction, and where a frame shows it.
#[derive(Clone, Copy)]
pub(super) struct Correspondence {
    /// Unit, `base`.
    pub direction: Vec3,
    pub image: ImagePoint,
    pub sigma_px: f64,
}

impl Residual<2, 0, 3> for Correspondence {
    /// The camera at the origin; pan, tilt and focal length are its parameters.
    type State = PtzCamera;

    fn sigma(&self) -> f64 {
        self.sigma_px
    }

    fn value(&self, at: &PtzCamera) -> Option<Vec2> {
        Some(
            at.image_from_ray(PanTilt::from_direction(self.direction))
                .ok()?
                .offset_from(self.image),
        )
    }

    fn linearise(&self, at: &PtzCamera) -> Option<Linearised<2, 0, 3>> {
        let here = at.image_from_direction_jacobian(self.direction).ok()?;
        let mut by_own = here.by_ptz;
        // ∂/∂(ln f) = f ∂/∂f.
        by_own.column_mut(2).scale_mut(at.ptz().focal_px);
        Some(Linearised::without_shared(
            here.point.offset_from(self.image),
            by_own,
        ))
    }
}
