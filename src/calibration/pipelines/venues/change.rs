//! How a camera stands in comparison with where it was known to stand.

use nalgebra::Matrix2;
use std::fmt;
use touchline_core::camera::CameraBase;
use touchline_core::geometry::rotation::rotation_vector;
use touchline_core::geometry::{Mat3, Vec3};

/// The largest squared distance of two estimates of one base, position and lean, by their joint
/// covariance, and of two estimates of one position: 99.7 % of χ² with five and three degrees of
/// freedom.
const MAX_BASE_SQUARED: f64 = 18.0;
const MAX_POSITION_SQUARED: f64 = 14.2;
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
    /// Compares a base with the known one.
    ///
    /// Frames of one match hardly distinguish a camera that is farther away from one that leans a
    /// little more, so that position and lean are compared together, by their joint covariance; and
    /// where the position may be the same, the lean is stated as if it were. The heading is the
    /// pan's matter and is not compared.
    pub fn between(known: &CameraBase, now: &CameraBase) -> Self {
        let apart_m = now.position_m - known.position_m;
        let [gauged_known, gauged_now] = [known, now].map(|base| base.in_pan_gauge().0);
        let turn = rotation_vector(
            &(gauged_known.base_from_world.transpose() * gauged_now.base_from_world),
        );
        let all = known.sigma.covariance() + now.sigma.covariance();
        let positions = all.fixed_view::<3, 3>(0, 0) + Mat3::identity() * BETWEEN_MATCHES_M.powi(2);
        let leans = all.fixed_view::<2, 2>(3, 3)
            + Matrix2::identity() * BETWEEN_MATCHES_DEG.to_radians().powi(2);
        // The errors of both matches add up, with what a tripod gives way between them.
        let of_both = all.fixed_view::<2, 3>(3, 0).into_owned();
        let inverse = positions.try_inverse().unwrap_or_default();
        // The lean, given that the position is the same (the conditional normal distribution).
        let lean_if_same = turn.xy() - of_both * inverse * apart_m;
        let leans_if_same = leans - of_both * inverse * of_both.transpose();
        let position_squared = apart_m.dot(&(inverse * apart_m));
        let lean_squared = leans_if_same
            .try_inverse()
            .map_or(f64::INFINITY, |inverse| {
                lean_if_same.dot(&(inverse * lean_if_same))
            });
        // Mahalanobis distances, compared with quantiles of χ².
        let (whereabouts, lean, leans) = if position_squared > MAX_POSITION_SQUARED {
            (Whereabouts::Moved, turn.xy(), leans)
        } else if position_squared + lean_squared > MAX_BASE_SQUARED {
            (Whereabouts::Turned, lean_if_same, leans_if_same)
        } else {
            (Whereabouts::Same, lean_if_same, leans_if_same)
        };
        Self {
            whereabouts,
            moved_m: apart_m.norm(),
            moved_sigma_m: sigma_along(&positions, apart_m),
            turned_deg: lean.norm().to_degrees(),
            turned_sigma_deg: (0.5 * leans.trace()).sqrt().to_degrees(),
        }
    }

    /// Whether the camera rather leans in another way or was moved, where it is not as it was.
    pub fn likelier_change(&self) -> Whereabouts {
        // In units of what is known of each.
        let turned_sigmas = self.turned_deg / self.turned_sigma_deg;
        if turned_sigmas >= self.moved_m / self.moved_sigma_m {
            Whereabouts::Turned
        } else {
            Whereabouts::Moved
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
                "same place (measured again: {moved_m:.2} ± {moved_sigma_m:.2} m off)"
            ),
            Whereabouts::Turned => write!(
                out,
                "turned by {turned_deg:.2} ± {turned_sigma_deg:.2}° at the same place \
                 ({moved_m:.2} ± {moved_sigma_m:.2} m off)"
            ),
            Whereabouts::Moved => write!(
                out,
                "moved by {moved_m:.2} ± {moved_sigma_m:.2} m, \
                 turned by {turned_deg:.2} ± {turned_sigma_deg:.2}°"
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
        now.base_from_world = known.base_from_world * lean;
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
