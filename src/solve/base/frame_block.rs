//! One frame's share of the normal equations.

use super::parameters::{CROWN, K1, PRINCIPAL_POINT, ROTATION, SHARED, SLOPE, Shared, SharedMatrix, SharedVector};
use crate::camera::{Ptz, PtzCamera};
use crate::field::FieldModel;
use crate::geometry::{ImagePoint, Mat3, Vec3};
use crate::solve::line::line_residual;
use crate::solve::observation::WorldCurve;
use crate::solve::refine::NO_IMAGE_SIGMAS;
use crate::solve::{Loss, Observation, Target};
use nalgebra::SMatrix;

/// A click whose target is nominal: the crown is a parameter.
#[derive(Clone, Copy, Debug)]
pub(super) struct NominalClick {
    pub image: ImagePoint,
    pub sigma_px: f64,
    pub target: NominalTarget,
}

/// What it shows, on flat ground.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) enum NominalTarget {
    Point(Vec3),
    Curve(WorldCurve),
}

impl NominalClick {
    /// Takes the field's crown out of an observation.
    pub fn of(observation: &Observation, field: &FieldModel) -> Self {
        let target = match observation.target {
            Target::Landmark(at) => NominalTarget::Point(Vec3::new(at.x, at.y, at.z - field.ground_z(at.y))),
            Target::Line(curve) => NominalTarget::Curve(curve),
        };
        Self { image: observation.image, sigma_px: observation.sigma_px, target }
    }

    /// How many equations it gives.
    pub const fn equations(&self) -> usize {
        match self.target {
            NominalTarget::Point(_) => 2,
            NominalTarget::Curve(_) => 1,
        }
    }

    /// Puts a crown in again.
    pub fn observation(&self, shared: &Shared, click: usize) -> Observation {
        let target = match self.target {
            NominalTarget::Point(at) => Target::Landmark(shared.crowned(at)),
            NominalTarget::Curve(curve) => Target::Line(curve.with_crown(shared.crown_m, shared.width_m)),
        };
        Observation { image: self.image, sigma_px: self.sigma_px, target, click, check: false }
    }
}

impl Shared {
    /// (2y / width)², at most 1: how far the ground drops there, as a share of the crown.
    fn drop_share(&self, y_m: f64) -> f64 {
        (2.0 * y_m / self.width_m).clamp(-1.0, 1.0).powi(2)
    }

    /// A nominal point on the crowned ground.
    pub fn crowned(&self, nominal: Vec3) -> Vec3 {
        Vec3::new(nominal.x, nominal.y, nominal.z - self.crown_m * self.drop_share(nominal.y))
    }
}

/// Jᵀ W J and Jᵀ W r of one frame: shared by shared, shared by own (pan, tilt, log f), own by own.
#[derive(Clone, Debug)]
pub(super) struct FrameBlock {
    pub shared: SharedMatrix,
    pub cross: SMatrix<f64, SHARED, 3>,
    pub own: Mat3,
    pub shared_gradient: SharedVector,
    pub own_gradient: Vec3,
    /// The robust cost.
    pub cost: f64,
    /// Weighted squares of the residuals, in sigmas.
    pub squares: f64,
}

impl FrameBlock {
    /// The block of a frame at given parameters; parameters that are not free have zero rows.
    pub fn at(shared: &Shared, ptz: Ptz, clicks: &[NominalClick], loss: Loss, free: &[bool; SHARED]) -> Self {
        let camera = PtzCamera::new(shared.base, ptz);
        let mut block = Self {
            shared: SharedMatrix::zeros(),
            cross: SMatrix::zeros(),
            own: Mat3::zeros(),
            shared_gradient: SharedVector::zeros(),
            own_gradient: Vec3::zeros(),
            cost: 0.0,
            squares: 0.0,
        };
        let kilo_px = (ptz.focal_px - shared.base.distortion.at_focal_px) / 1000.0;
        for click in clicks {
            let scale = 1.0 / click.sigma_px;
            match click.target {
                NominalTarget::Point(nominal) => {
                    let Ok(here) = camera.image_from_world_jacobian(shared.crowned(nominal)) else {
                        block.cost += loss.of(NO_IMAGE_SIGMAS * NO_IMAGE_SIGMAS).0;
                        continue;
                    };
                    let mut by_shared = SMatrix::<f64, 2, SHARED>::zeros();
                    by_shared.fixed_columns_mut::<5>(0).copy_from(&here.by_base.fixed_columns::<5>(0));
                    by_shared.set_column(K1, &here.by_k1);
                    by_shared.set_column(SLOPE, &(here.by_k1 * kilo_px));
                    by_shared.set_column(CROWN, &(here.by_world.column(2) * -shared.drop_share(nominal.y)));
                    by_shared.fixed_columns_mut::<2>(PRINCIPAL_POINT).fill_with_identity();
                    let residual = here.point.offset_from(click.image) * scale;
                    block.add(ptz.focal_px, residual, by_shared * scale, here.by_ptz * scale, loss, free);
                }
                NominalTarget::Curve(nominal) => {
                    let curve = nominal.with_crown(shared.crown_m, shared.width_m);
                    let Some(here) = line_residual(&camera, &curve, click.image) else {
                        block.cost += loss.of(NO_IMAGE_SIGMAS * NO_IMAGE_SIGMAS).0;
                        continue;
                    };
                    let mut by_shared = SMatrix::<f64, 1, SHARED>::zeros();
                    by_shared.fixed_columns_mut::<5>(0).copy_from(&here.by_base.fixed_columns::<5>(0));
                    by_shared[K1] = here.by_k1;
                    by_shared[SLOPE] = here.by_k1 * kilo_px;
                    by_shared[CROWN] = here.by_world[2] * -shared.drop_share(here.nearest_in_world.y);
                    by_shared[PRINCIPAL_POINT] = -here.across.x;
                    by_shared[PRINCIPAL_POINT + 1] = -here.across.y;
                    let residual = SMatrix::<f64, 1, 1>::new(here.distance_px * scale);
                    block.add(ptz.focal_px, residual, by_shared * scale, here.by_ptz * scale, loss, free);
                }
            }
        }
        block
    }

    fn add<const ROWS: usize>(
        &mut self,
        focal_px: f64,
        residual: SMatrix<f64, ROWS, 1>,
        mut by_shared: SMatrix<f64, ROWS, SHARED>,
        mut by_own: SMatrix<f64, ROWS, 3>,
        loss: Loss,
        free: &[bool; SHARED],
    ) {
        for (column, free) in free.iter().enumerate() {
            if !free {
                by_shared.column_mut(column).fill(0.0);
            }
        }
        by_own.column_mut(2).scale_mut(focal_px);
        let (cost, weight) = loss.of(residual.norm_squared());
        let shared_weighted = by_shared.transpose() * weight;
        let own_weighted = by_own.transpose() * weight;
        self.shared += shared_weighted * by_shared;
        self.cross += shared_weighted * by_own;
        self.own += own_weighted * by_own;
        self.shared_gradient += shared_weighted * residual;
        self.own_gradient += own_weighted * residual;
        self.cost += cost;
        self.squares += weight * residual.norm_squared();
    }
}

/// The rotation's columns follow the position's, as they do in a projection's Jacobian by the base.
const _: () = assert!(ROTATION == 3 && K1 == 5);

#[cfg(test)]
mod tests {
    use super::*;
    use crate::camera::{BaseAngles, CameraBase, FocalCurve};
    use crate::field::Curve;
    use crate::geometry::Angle;

    #[test]
    fn the_gradient_of_every_parameter_agrees_with_differences_of_the_cost() {
        let base = CameraBase {
            distortion: FocalCurve { at_focal_px: 2000.0, value: -0.05, per_1000_px: 0.2 },
            ..CameraBase::new(
                Vec3::new(3.0, -62.0, 17.0),
                BaseAngles {
                    roll: Angle::from_degrees(0.7),
                    pitch: Angle::from_degrees(-1.0),
                    ..BaseAngles::default()
                }
                .base_from_world(),
                ImagePoint::new(955.0, 543.0),
            )
        };
        let shared = Shared { base, crown_m: 0.15, width_m: 68.0 };
        let ptz = Ptz::from_degrees(-4.0, -15.0, 1910.0);
        let camera = PtzCamera::new(base, ptz);
        let halfway = Curve::Segment { from: Vec3::new(0.0, -34.0, 0.0), to: Vec3::new(0.0, 34.0, 0.0) };
        let circle =
            Curve::Arc { centre: Vec3::zeros(), radius_m: 9.15, start: Angle::ZERO, sweep: Angle::from_degrees(360.0) };
        let off = |world: Vec3| camera.image_from_world(world).unwrap().moved(crate::geometry::Vec2::new(7.0, -4.0));
        let targets = [
            (NominalTarget::Point(Vec3::new(-9.0, 20.0, 0.0)), Vec3::new(-9.0, 20.0, 0.0)),
            (NominalTarget::Point(Vec3::new(-10.0, -8.0, 2.44)), Vec3::new(-10.0, -8.0, 2.44)),
            (NominalTarget::Curve(WorldCurve::flat(halfway)), Vec3::new(0.0, -14.0, 0.0)),
            (NominalTarget::Curve(WorldCurve::flat(circle)), Vec3::new(-9.15, 0.0, 0.0)),
        ];
        let clicks = targets.map(|(target, near)| NominalClick { image: off(near), sigma_px: 2.0, target });
        let free = [true; SHARED];
        let at = |step: &SharedVector, own: Vec3| {
            let turned = Ptz {
                pan: ptz.pan + Angle::from_radians(own.x),
                tilt: ptz.tilt + Angle::from_radians(own.y),
                focal_px: ptz.focal_px * own.z.exp(),
            };
            FrameBlock::at(&shared.stepped(step), turned, &clicks, Loss::Squared, &free)
        };
        let here = at(&SharedVector::zeros(), Vec3::zeros());
        // The cost is the sum of squares: its derivative is twice Jᵀ r.
        for parameter in 0..SHARED {
            let h = if parameter >= PRINCIPAL_POINT { 1e-3 } else { 1e-6 };
            let unit = SharedVector::ith(parameter, h);
            let numeric = (at(&unit, Vec3::zeros()).cost - at(&-unit, Vec3::zeros()).cost) / (4.0 * h);
            let error = (here.shared_gradient[parameter] - numeric).abs();
            assert!(error < 1e-4 * (1.0 + numeric.abs()), "shared {parameter}: {error} of {numeric}");
        }
        for parameter in 0..3 {
            let unit = Vec3::ith(parameter, 1e-6);
            let zero = SharedVector::zeros();
            let numeric = (at(&zero, unit).cost - at(&zero, -unit).cost) / 4e-6;
            let error = (here.own_gradient[parameter] - numeric).abs();
            assert!(error < 1e-4 * (1.0 + numeric.abs()), "own {parameter}: {error} of {numeric}");
        }
    }
}
