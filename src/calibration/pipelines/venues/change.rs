//! How a camera stands in comparison with where it was known to stand.

use std::fmt;
use touchline_core::camera::CameraBase;
use touchline_core::geometry::rotation::rotation_vector;
use touchline_core::geometry::{Mat3, Vec3};

/// The largest squared distance of two estimates of one position by their joint covariance: 99.7 %
/// of χ² with three degrees of freedom.
const MAX_DISTANCE_SQUARED: f64 = 14.2;
/// The largest difference of two estimates of one lean, joint σ.
const MAX_TURN_SIGMAS: f64 = 3.0;
/// Estimates from two matches differ by as much more than their covariances say: lens, crown and
/// paint are not quite the same. 1-σ, m and degrees.
const BETWEEN_MATCHES_M: f64 = 0.15;
const BETWEEN_MATCHES_DEG: f64 = 0.03;

/// Where a camera is, compared with where it was.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Whereabouts {
    /// At the same place, in the same position on its tripod.
    Same,
    /// At the same place; its pan axis leans in another way.
    Turned,
    /// At another place.
    Moved,
}

/// The difference of two bases, measured.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct BaseChange {
    /// What the numbers say.
    pub whereabouts: Whereabouts,
    /// The distance between the positions, m, and its 1-σ.
    pub moved_m: f64,
    /// 1-σ of that distance, m.
    pub moved_sigma_m: f64,
    /// The angle between the pan axes, degrees.
    pub turned_deg: f64,
    /// 1-σ of that angle, degrees.
    pub turned_sigma_deg: f64,
}

impl BaseChange {
    /// Compares a base with the known one. Both are in the pan gauge, so that the rotation between
    /// them is about horizontal axes: a heading is the pan's matter.
    pub fn between(known: &CameraBase, now: &CameraBase) -> Self {
        let apart_m = now.position_m - known.position_m;
        let covariance = known.sigma.position_covariance()
            + now.sigma.position_covariance()
            + Mat3::identity() * BETWEEN_MATCHES_M.powi(2);
        let turn = rotation_vector(&(now.base_from_world * known.base_from_world.transpose()));
        let lean_sigma = |base: &CameraBase| base.sigma.rotation.xy().norm();
        let turned_sigma_deg = lean_sigma(known)
            .hypot(lean_sigma(now))
            .to_degrees()
            .hypot(BETWEEN_MATCHES_DEG);
        let turned_deg = turn.norm().to_degrees();
        let distance_squared = covariance
            .cholesky()
            .map_or(f64::INFINITY, |joint| apart_m.dot(&joint.solve(&apart_m)));
        let whereabouts = if distance_squared > MAX_DISTANCE_SQUARED {
            Whereabouts::Moved
        } else if turned_deg > MAX_TURN_SIGMAS * turned_sigma_deg {
            Whereabouts::Turned
        } else {
            Whereabouts::Same
        };
        Self {
            whereabouts,
            moved_m: apart_m.norm(),
            moved_sigma_m: sigma_along(&covariance, apart_m),
            turned_deg,
            turned_sigma_deg,
        }
    }
}

/// 1-σ in the direction of a vector; in the mean of all directions for the zero vector.
fn sigma_along(covariance: &Mat3, direction: Vec3) -> f64 {
    let variance = direction.try_normalize(0.0).map_or_else(
        || covariance.trace() / 3.0,
        |unit| unit.dot(&(covariance * unit)),
    );
    variance.sqrt()
}

impl fmt::Display for BaseChange {
    fn fmt(&self, out: &mut fmt::Formatter<'_>) -> fmt::Result {
        let Self {
            whereabouts,
            moved_m,
            moved_sigma_m,
            turned_deg,
            turned_sigma_deg,
        } = self;
        match whereabouts {
            Whereabouts::Same => write!(
                out,
                "same place (measured again: {moved_m:.2} ± {moved_sigma_m:.2} m and {turned_deg:.2} ± {turned_sigma_deg:.2}° off)"
            ),
            Whereabouts::Turned => write!(
                out,
                "turned by {turned_deg:.2} ± {turned_sigma_deg:.2}° at the same place ({moved_m:.2} ± {moved_sigma_m:.2} m off)"
            ),
            Whereabouts::Moved => write!(
                out,
                "moved by {moved_m:.2} ± {moved_sigma_m:.2} m, turned by {turned_deg:.2} ± {turned_sigma_deg:.2}°"
            ),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use touchline_core::geometry::rotation::from_rotation_vector;
    use touchline_core::testing::{SIZE, turned_base};

    fn base() -> CameraBase {
        let mut base = turned_base([0.0, -60.0, 18.0], [0.0; 3], SIZE);
        base.sigma.position_m = Vec3::new(0.06, 0.2, 0.05);
        base.sigma.rotation = Vec3::new(4e-4, 4e-4, 0.0);
        base
    }

    #[test]
    fn a_base_is_the_same_turned_or_moved_by_its_numbers() {
        let known = base();
        let mut now = known;
        now.position_m.y += 0.4;
        let same = BaseChange::between(&known, &now);
        assert_eq!(same.whereabouts, Whereabouts::Same);
        assert!((same.moved_m - 0.4).abs() < 1e-9 && same.moved_sigma_m > 0.3);

        let lean = from_rotation_vector(Vec3::new(0.3_f64.to_radians(), 0.0, 0.0));
        now.base_from_world = lean * known.base_from_world;
        let turned = BaseChange::between(&known, &now);
        assert_eq!(turned.whereabouts, Whereabouts::Turned);
        assert!((turned.turned_deg - 0.3).abs() < 1e-6);

        now.position_m.x += 1.2;
        let moved = BaseChange::between(&known, &now);
        assert_eq!(moved.whereabouts, Whereabouts::Moved);
        assert!((moved.moved_m - 1.2_f64.hypot(0.4)).abs() < 1e-9);
        assert!(moved.to_string().starts_with("moved by 1.26"), "{moved}");
    }
}
