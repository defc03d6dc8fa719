//! Radial distortion on normalised coordinates, and its inverse.
//!
//! Brown's model with one coefficient, the ideal point on the right: `x_d` = `x_n` (1 + k₁ r²), r = |`x_n`|, as OpenCV has it.
//! With a zoom lens k₁ depends on the focal length, so a camera has a curve instead of a number.

use crate::geometry::Vec2;
use serde::Serialize;
use thiserror::Error;

/// k₁ as a function of the focal length: value + `per_1000_px` · (f − `at_focal_px`) / 1000.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize)]
pub struct FocalCurve {
    /// The focal length at which `value` holds, px.
    pub at_focal_px: f64,
    /// k₁ there.
    pub value: f64,
    /// The change of k₁ per 1000 px of focal length.
    pub per_1000_px: f64,
}

impl FocalCurve {
    /// No distortion.
    pub const NONE: Self = Self::constant(0.0);

    /// The same k₁ at every focal length.
    #[must_use]
    pub const fn constant(k1: f64) -> Self {
        Self { at_focal_px: 0.0, value: k1, per_1000_px: 0.0 }
    }

    /// k₁ at a focal length.
    #[must_use]
    pub fn at(&self, focal_px: f64) -> f64 {
        self.value + self.slope_per_px() * (focal_px - self.at_focal_px)
    }

    /// dk₁/df, per px.
    #[must_use]
    pub fn slope_per_px(&self) -> f64 {
        self.per_1000_px / 1000.0
    }

    /// The focal lengths at which an image point this far from the principal point (px) lies on the fold of the lens.
    ///
    /// There k₁ (r / f)² = −4/27; with k₁ linear in f that is a quadratic in f.
    pub(crate) fn fold_focals(&self, radius_px: f64) -> impl Iterator<Item = f64> + use<> {
        let squared = radius_px * radius_px * 27.0 / 4.0;
        let half = 0.5 * squared * self.slope_per_px();
        let constant = squared * (self.value - self.slope_per_px() * self.at_focal_px);
        let root = (half * half - constant).max(0.0).sqrt();
        let exists = half * half >= constant;
        [-half - root, -half + root].into_iter().filter(move |focal| exists && *focal > 0.0)
    }

    /// All three are numbers.
    #[must_use]
    pub fn is_finite(&self) -> bool {
        self.at_focal_px.is_finite() && self.value.is_finite() && self.per_1000_px.is_finite()
    }
}

/// Why a distorted point has no ideal one.
#[derive(Clone, Copy, Debug, PartialEq, Error)]
#[non_exhaustive]
pub enum UndistortError {
    /// The lens model folds before it reaches this radius.
    #[error("the distortion model (k1 = {k1}) folds at normalised radius {fold}, the point lies at {radius}")]
    BeyondFold {
        /// The coefficient.
        k1: f64,
        /// The distorted radius at which the model folds, focal lengths.
        fold: f64,
        /// The point's distorted radius, focal lengths.
        radius: f64,
    },
}

/// The largest ideal r² that has an image: 1 / (−3 k₁) for a barrel, infinite otherwise.
pub(crate) fn fold_radius_squared(k1: f64) -> f64 {
    if k1 < 0.0 { -1.0 / (3.0 * k1) } else { f64::INFINITY }
}

/// The distorted point of an ideal one (normalised coordinates).
pub(crate) fn distort(ideal: Vec2, k1: f64) -> Vec2 {
    ideal * (1.0 + k1 * ideal.norm_squared())
}

/// The ideal point of a distorted one (normalised coordinates), to the last digit.
///
/// With s = r / `r_d` and w = k₁ `r_d`², r (1 + k₁ r²) = `r_d` becomes s + w s³ = 1: Newton on s, without a root.
pub(crate) fn undistort(distorted: Vec2, k1: f64) -> Result<Vec2, UndistortError> {
    /// w at the fold, where r² = −1 / (3 k₁).
    const FOLD: f64 = -4.0 / 27.0;
    /// Up to here the series is the better start.
    const SERIES_UPTO: f64 = 0.1;
    let w = k1 * distorted.norm_squared();
    if w <= FOLD {
        let fold = fold_radius_squared(k1).sqrt() * 2.0 / 3.0;
        return Err(UndistortError::BeyondFold { k1, fold, radius: distorted.norm() });
    }
    // For a barrel (w < 0) all terms of the series are positive, so it starts below the root, where the function is concave:
    // Newton ascends and cannot leave the branch. For w > 0 the function is monotonic and convex.
    let mut s = if w < SERIES_UPTO { 1.0 - w * (1.0 - w * (3.0 - w * 12.0)) } else { 1.0 / (1.0 + w).cbrt() };
    for _ in 0..64 {
        let step = (s * (1.0 + w * s * s) - 1.0) / (1.0 + 3.0 * w * s * s);
        if !step.is_finite() {
            break;
        }
        s -= step;
        // The error after a step is of the size of its square.
        if step.abs() <= 1e-9 * s {
            break;
        }
    }
    Ok(distorted * s)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn undistorting_undoes_distorting_up_to_the_fold() {
        for k1 in [-0.2, -0.12, -0.02, 0.0, 0.1, 0.5, 4.0] {
            for step in 0..200 {
                let radius = f64::from(step) * 0.005;
                if radius * radius >= 0.98 * fold_radius_squared(k1) {
                    continue;
                }
                let ideal = Vec2::new(0.6, -0.8) * radius;
                let again = undistort(distort(ideal, k1), k1).unwrap();
                assert!((again - ideal).norm() < 1e-12, "k1 {k1} radius {radius}: {}", (again - ideal).norm());
            }
        }
    }

    #[test]
    fn beyond_the_fold_there_is_no_image() {
        let far = Vec2::new(5.0, 0.0);
        assert!(matches!(undistort(far, -0.1), Err(UndistortError::BeyondFold { .. })));
        assert!(undistort(far, 0.1).is_ok());
    }

    #[test]
    fn a_point_reaches_the_fold_at_the_focal_lengths_that_are_told() {
        let curve = FocalCurve { at_focal_px: 2000.0, value: -0.02, per_1000_px: 0.21 };
        let found: Vec<f64> = curve.fold_focals(1100.0).collect();
        assert_eq!(found.len(), 1, "{found:?}");
        for (share, has_a_ray) in [(1.0 + 1e-9, true), (1.0 - 1e-9, false)] {
            let focal_px = found[0] * share;
            assert_eq!(undistort(Vec2::new(1100.0 / focal_px, 0.0), curve.at(focal_px)).is_ok(), has_a_ray);
        }
        assert_eq!(FocalCurve::constant(0.1).fold_focals(1100.0).count(), 0);
    }

    #[test]
    fn a_curve_is_linear_in_the_focal_length() {
        let curve = FocalCurve { at_focal_px: 2000.0, value: -0.02, per_1000_px: 0.21 };
        assert!((curve.at(2410.0) - 0.0661).abs() < 1e-12);
        assert!((FocalCurve::constant(-0.1).at(9000.0) + 0.1).abs() < 1e-15);
    }
}
