//! The ellipse of a covariance in a plane.

use super::Vec2;
use nalgebra::{Matrix2, SymmetricEigen};
use std::f64::consts::TAU;

/// The 1-σ ellipse of a covariance as offsets from its centre, in the unit of the covariance's
/// root: `corners` points, evenly spread in the angle of the unit circle that the ellipse is the
/// image of. Where rounding left a variance below zero it counts as zero.
pub fn covariance_ellipse(covariance: Matrix2<f64>, corners: u32) -> Vec<Vec2> {
    // C = V diag(λ) Vᵀ, so V diag(√λ) takes the unit circle to the 1-σ ellipse.
    let axes = SymmetricEigen::new(covariance);
    let radii = axes.eigenvalues.map(|value| value.max(0.0).sqrt());
    (0..corners)
        .map(|step| {
            let angle = f64::from(step) / f64::from(corners) * TAU;
            axes.eigenvectors * Vec2::new(radii.x * angle.cos(), radii.y * angle.sin())
        })
        .collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_corner_lies_one_sigma_out() {
        let covariance = Matrix2::new(4.0, 1.2, 1.2, 0.9);
        let inverse = covariance.try_inverse().unwrap();
        for corner in covariance_ellipse(covariance, 48) {
            assert!(
                (corner.dot(&(inverse * corner)) - 1.0).abs() < 1e-12,
                "{corner:?}"
            );
        }
    }

    #[test]
    fn a_covariance_of_rank_one_is_a_line() {
        let flat = covariance_ellipse(Matrix2::new(9.0, 0.0, 0.0, -1e-18), 8);
        assert!(flat.iter().all(|corner| corner.y == 0.0));
        assert!(
            flat.iter()
                .any(|corner| (corner.x.abs() - 3.0).abs() < 1e-12)
        );
    }
}
