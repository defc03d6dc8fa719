//! Radial distortion on normalised coordinates, and its inverse.
//!
//! Brown's model of the distorted point: `x_d` = `x_n` (1 + k₁ r² + k₂ r⁴), with the ideal point
//! `x_n` and r = |`x_n`|, as in OpenCV. In a zoom lens k₁ depends on the focal length, so a camera
//! has a curve of k₁ over f instead of one number.
//!
//! With k₂ = 0 a barrel lens (k₁ < 0) folds: beyond some radius the distorted radius decreases
//! again, and such points count as having no image. k₂ = α k₁² has no fold where α > 9/20, since
//! the derivative 1 + 3 u + 5 α u², u = k₁ r², then has no root. So such a lens needs no further
//! parameter, and k₁ keeps its meaning.
//!
//! Pixels that are not square are part of the lens, too, as in other bundle adjustments
//! (affinity): behind the distortion, y is multiplied by the pixels' aspect fy / fx. So [`distort`]
//! and [`undistort`] alone know of it, and everything between the camera and the distorted point
//! has square pixels.

use crate::geometry::{ImagePoint, Vec2};
use nalgebra::Matrix2;
use serde::Serialize;
use thiserror::Error;

/// The lens as a function of the focal length: k₁ = value + `per_1000_px` · (f − `at_focal_px`) /
/// 1000, and k₂ = α k₁².
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct FocalCurve {
    /// The focal length at which `value` holds, px.
    pub at_focal_px: f64,
    /// k₁ there.
    pub value: f64,
    /// The change of k₁ per 1000 px of focal length.
    pub per_1000_px: f64,
    /// α of k₂ = α k₁²; 0: k₂ is zero.
    pub k2_per_k1_squared: f64,
    /// The aspect of the pixels, their width over their height: fy / fx, the focal length down the
    /// picture over that across it. 1: square. The focal length of a camera is fx.
    #[serde(skip_serializing_if = "is_square")]
    pub pixel_aspect: f64,
}

/// The coefficients of a lens at one focal length.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct Radial {
    /// Of r².
    pub k1: f64,
    /// Of r⁴.
    pub k2: f64,
    /// The aspect of the pixels, fy / fx; 1: square.
    #[serde(skip_serializing_if = "is_square")]
    pub pixel_aspect: f64,
}

/// The aspects of pixels that pictures have. Anamorphic lenses squeeze by 2, and the strongest usual
/// scaling, 16:9 to 9:16, by 3.2; a number beyond that is a mistake.
pub const PIXEL_ASPECTS: std::ops::RangeInclusive<f64> = 0.25..=4.0;

#[expect(
    clippy::trivially_copy_pass_by_ref,
    reason = "serde passes fields by reference"
)]
fn is_square(pixel_aspect: &f64) -> bool {
    *pixel_aspect == 1.0
}

impl Default for FocalCurve {
    fn default() -> Self {
        Self::NONE
    }
}

impl Default for Radial {
    /// No distortion, square pixels.
    fn default() -> Self {
        Self::k1(0.0)
    }
}

impl FocalCurve {
    /// No distortion, square pixels.
    pub const NONE: Self = Self::constant(0.0);

    /// α of the lens without a fold: the division model `x_n` = `x_d` / (1 + λ `r_d`²) (Fitzgibbon,
    /// CVPR 2001) as far as r⁴, with λ = k₁. The derivative stays above 3/4.
    pub const WITHOUT_FOLD: f64 = 2.0;

    /// The same k₁ at every focal length.
    pub const fn constant(k1: f64) -> Self {
        Self {
            at_focal_px: 0.0,
            value: k1,
            per_1000_px: 0.0,
            k2_per_k1_squared: 0.0,
            pixel_aspect: 1.0,
        }
    }

    /// The same lens in front of pixels of another aspect.
    #[must_use]
    pub const fn with_pixel_aspect(self, pixel_aspect: f64) -> Self {
        Self {
            pixel_aspect,
            ..self
        }
    }

    /// Whether it is a pinhole's, whatever the pixels' aspect.
    pub(crate) fn is_pinhole(&self) -> bool {
        self.with_pixel_aspect(1.0) == Self::NONE
    }

    /// A point of the picture where it would be if the pixels were square and as wide as they are.
    pub(crate) fn square_point(&self, at: ImagePoint, principal_point: ImagePoint) -> ImagePoint {
        let offset = at.offset_from(principal_point);
        principal_point.translate(Vec2::new(offset.x, offset.y / self.pixel_aspect))
    }

    /// The lens with these coefficients at every focal length; none where k₂ comes without k₁.
    pub fn through(
        Radial {
            k1,
            k2,
            pixel_aspect,
        }: Radial,
    ) -> Option<Self> {
        // The curve has k₂ only as a multiple of k₁².
        if k1 == 0.0 && k2 != 0.0 {
            return None;
        }
        let k2_per_k1_squared = if k2 == 0.0 { 0.0 } else { k2 / (k1 * k1) };
        Some(Self {
            k2_per_k1_squared,
            pixel_aspect,
            ..Self::constant(k1)
        })
    }

    /// k₁ at a focal length.
    #[inline]
    pub fn at(&self, focal_px: f64) -> f64 {
        self.value + self.slope_per_px() * (focal_px - self.at_focal_px)
    }

    /// Both coefficients at a focal length.
    #[inline]
    pub fn radial_at(&self, focal_px: f64) -> Radial {
        let k1 = self.at(focal_px);
        Radial {
            k1,
            k2: self.k2_per_k1_squared * k1 * k1,
            pixel_aspect: self.pixel_aspect,
        }
    }

    /// The derivative of the stretch at an ideal radius (squared) by k₁, with k₂ = α k₁² following.
    #[inline]
    pub fn stretch_by_k1(&self, focal_px: f64, radius_squared: f64) -> f64 {
        radius_squared * (1.0 + radius_squared * 2.0 * self.k2_per_k1_squared * self.at(focal_px))
    }

    /// dk₁/df, per px.
    #[inline]
    pub fn slope_per_px(&self) -> f64 {
        self.per_1000_px / 1000.0
    }

    /// The focal lengths at which an image point this far from the principal point (px) lies on the
    /// fold of the lens.
    ///
    /// With u = k₁ r² of the ideal radius the fold is the first root of 1 + 3 u + 5 α u² that has
    /// the sign of k₁.
    pub(crate) fn fold_focals(&self, radius_px: f64) -> impl Iterator<Item = f64> + use<> {
        // Below zero is the root of smaller magnitude, in the form that does not cancel and covers
        // α = 0. A root above zero, which bends a pincushion lens (k₁ > 0) back, exists for α < 0.
        let share = self.k2_per_k1_squared;
        let spread = 3.0 + (9.0 - 20.0 * share).max(0.0).sqrt();
        let of_barrel = (20.0 * share <= 9.0).then_some(-2.0 / spread);
        let of_pincushion = (share < 0.0).then_some(spread / (-10.0 * share));
        let curve = *self;
        of_barrel
            .into_iter()
            .chain(of_pincushion)
            .flat_map(move |u| curve.focals_with_fold_at(u, radius_px))
    }

    /// The focal lengths at which an image point this far from the principal point (px) shows an
    /// ideal radius r with k₁ r² = u.
    ///
    /// There k₁ (r / f)² of the image point is u (1 + u + α u²)² (−4/27 at the fold where α is
    /// zero); with k₁ linear in f that is a quadratic in f.
    fn focals_with_fold_at(&self, u: f64, radius_px: f64) -> impl Iterator<Item = f64> + use<> {
        let share = self.k2_per_k1_squared;
        // With c the value of k₁ (r / f)² at the fold and q = −r² / c: f² + q k₁(f) = 0, which is
        // f² + q k₁' f + q (k₁(f₀) − k₁' f₀) = 0.
        let squared = -radius_px * radius_px / (u * (1.0 + u * (1.0 + share * u)).powi(2));
        let half = 0.5 * squared * self.slope_per_px();
        let constant = squared * (self.value - self.slope_per_px() * self.at_focal_px);
        let root = (half * half - constant).max(0.0).sqrt();
        let exists = half * half >= constant;
        [-half - root, -half + root]
            .into_iter()
            .filter(move |focal| exists && *focal > 0.0)
    }

    /// Whether all coefficients are finite.
    pub fn is_finite(&self) -> bool {
        [
            self.at_focal_px,
            self.value,
            self.per_1000_px,
            self.k2_per_k1_squared,
            self.pixel_aspect,
        ]
        .iter()
        .all(|x| x.is_finite())
    }
}

impl Radial {
    /// A lens with k₁ alone, and square pixels.
    pub const fn k1(k1: f64) -> Self {
        Self {
            k1,
            k2: 0.0,
            pixel_aspect: 1.0,
        }
    }

    /// An offset in the picture as it is with square pixels (any unit).
    #[inline]
    pub fn square_from_pixels(&self, offset: Vec2) -> Vec2 {
        Vec2::new(offset.x, offset.y / self.pixel_aspect)
    }

    /// An offset with square pixels as it is in the picture (any unit).
    #[inline]
    pub fn pixels_from_square(&self, offset: Vec2) -> Vec2 {
        Vec2::new(offset.x, offset.y * self.pixel_aspect)
    }

    /// The same pixels behind a lens without distortion.
    #[must_use]
    pub const fn without_distortion(&self) -> Self {
        Self {
            pixel_aspect: self.pixel_aspect,
            ..Self::k1(0.0)
        }
    }

    /// The factor by which distortion scales a point at this ideal radius (squared).
    #[inline]
    pub fn stretch(&self, radius_squared: f64) -> f64 {
        1.0 + radius_squared * (self.k1 + radius_squared * self.k2)
    }

    /// The derivative of the distorted radius by the ideal one.
    #[inline]
    pub fn slope(&self, radius_squared: f64) -> f64 {
        1.0 + radius_squared * (3.0 * self.k1 + radius_squared * 5.0 * self.k2)
    }

    /// The largest [`Self::slope`] up to an ideal radius (squared), at least 1.
    pub(crate) fn greatest_slope(&self, radius_squared: f64) -> f64 {
        // With k₁ > 0 and k₂ < 0 the slope is greatest where its derivative 3 k₁ + 10 k₂ s
        // vanishes, with any other signs at an end.
        let steepest = if self.k1 > 0.0 && self.k2 < 0.0 {
            radius_squared.min(-0.3 * self.k1 / self.k2)
        } else {
            radius_squared
        };
        self.slope(steepest).max(1.0)
    }

    /// The derivative of the distorted point by the ideal one, as `distort` gives it.
    #[inline]
    pub fn by_ideal(&self, ideal: Vec2) -> Matrix2<f64> {
        // d(x s(r²))/dx = s I + 2 s' x xᵀ, with s' the derivative of the stretch s by r²; the row
        // of y times the pixels' aspect.
        let squared = ideal.norm_squared();
        let (stretch, along) = (
            self.stretch(squared),
            2.0 * self.k1 + 4.0 * self.k2 * squared,
        );
        let across = along * ideal.x * ideal.y;
        Matrix2::new(
            stretch + along * ideal.x * ideal.x,
            across,
            across * self.pixel_aspect,
            (stretch + along * ideal.y * ideal.y) * self.pixel_aspect,
        )
    }

    /// Whether there is no distortion.
    pub fn is_none(&self) -> bool {
        self.k1 == 0.0 && self.k2 == 0.0
    }

    /// The ideal r² at which the stretch has its minimum; none where it has none.
    pub fn narrowest_radius_squared(&self) -> Option<f64> {
        (self.k1 < 0.0 && self.k2 > 0.0).then(|| self.k1 / (-2.0 * self.k2))
    }

    /// The largest ideal r² that has an image, where the slope vanishes first; infinite where it
    /// never does.
    #[inline]
    pub fn fold_radius_squared(&self) -> f64 {
        if self.k2 == 0.0 {
            return if self.k1 < 0.0 {
                -1.0 / (3.0 * self.k1)
            } else {
                f64::INFINITY
            };
        }
        // The smallest positive root of the slope 1 + 3 k₁ s + 5 k₂ s² in s = r², in the form 2 /
        // (√(9 k₁² − 20 k₂) − 3 k₁), which does not cancel for k₁ < 0.
        let discriminant = 9.0 * self.k1 * self.k1 - 20.0 * self.k2;
        if discriminant < 0.0 {
            return f64::INFINITY;
        }
        let divisor = discriminant.sqrt() - 3.0 * self.k1;
        if divisor > 0.0 {
            2.0 / divisor
        } else {
            f64::INFINITY
        }
    }
}

/// Why a distorted point has no ideal one.
#[derive(Clone, Copy, Debug, PartialEq, Error)]
#[non_exhaustive]
pub enum UndistortError {
    /// The lens model folds before it reaches this radius.
    #[error(
        "the distortion model (k1 = {k1}) folds at normalised radius {fold}, the point lies at {radius}"
    )]
    BeyondFold {
        /// The coefficient.
        k1: f64,
        /// The distorted radius at which the model folds, focal lengths.
        fold: f64,
        /// The point's distorted radius, focal lengths.
        radius: f64,
    },
}

/// The distorted point of an ideal one (normalised coordinates), in widths of pixels across and
/// their heights down.
#[inline]
pub(crate) fn distort(ideal: Vec2, lens: Radial) -> Vec2 {
    lens.pixels_from_square(ideal * lens.stretch(ideal.norm_squared()))
}

/// The ideal point of a distorted one (normalised coordinates), to machine precision.
///
/// # Errors
/// The lens model folds before it reaches the point.
pub fn undistort(distorted: Vec2, lens: Radial) -> Result<Vec2, UndistortError> {
    let distorted = lens.square_from_pixels(distorted);
    if lens.k2 == 0.0 {
        return undistort_k1(distorted, lens.k1);
    }
    let radius_squared = distorted.norm_squared();
    // Only ideal radii up to the fold have an image; beyond it the inverse is undefined.
    let fold_squared = lens.fold_radius_squared();
    let mut upper = f64::INFINITY;
    if fold_squared.is_finite() {
        let fold = fold_squared.sqrt() * lens.stretch(fold_squared);
        let radius = radius_squared.sqrt();
        if radius >= fold {
            return Err(UndistortError::BeyondFold {
                k1: lens.k1,
                fold,
                radius,
            });
        }
        upper = (fold_squared / radius_squared).sqrt();
    }
    // With s = r / r_d, w = k₁ r_d², v = k₂ r_d⁴: s + w s³ + v s⁵ = 1. The left side is monotonic
    // up to the fold, but its slope may be near zero there. Hence Newton's method with a bracket:
    // where a step leaves the bracket, bisect it instead (Press et al., Numerical Recipes, section
    // 9.4).
    let (w, v) = (
        lens.k1 * radius_squared,
        lens.k2 * radius_squared * radius_squared,
    );
    let (mut lower, mut s) = (0.0, if upper > 1.0 { 1.0 } else { 0.5 * upper });
    for _ in 0..100 {
        let squared = s * s;
        let excess = s * (1.0 + squared * (w + squared * v)) - 1.0;
        // A point that is not finite stays so: no comparison would end the search.
        if excess.is_nan() {
            s = excess;
            break;
        }
        if excess > 0.0 {
            upper = s;
        } else {
            lower = s;
        }
        let newton = s - excess / (1.0 + squared * (3.0 * w + squared * 5.0 * v));
        // Newton's method converges quadratically: after a relative step of 1e-9 the error is
        // rounding.
        if (newton - s).abs() <= 1e-9 * s {
            s = newton;
            break;
        }
        // Without a fold the bracket is open above until a step overshoots; doubling closes it.
        s = if newton > lower && newton < upper {
            newton
        } else if upper.is_finite() {
            f64::midpoint(lower, upper)
        } else {
            2.0 * s
        };
    }
    Ok(distorted * s)
}

/// The same with k₁ alone.
///
/// With s = r / `r_d` and w = k₁ `r_d`², r (1 + k₁ r²) = `r_d` becomes s + w s³ = 1: Newton on s,
/// without a root.
fn undistort_k1(distorted: Vec2, k1: f64) -> Result<Vec2, UndistortError> {
    /// w at the fold, where r² = −1 / (3 k₁).
    const FOLD: f64 = -4.0 / 27.0;
    /// Up to here the series is the better start.
    const SERIES_UPTO: f64 = 0.1;
    let w = k1 * distorted.norm_squared();
    if w <= FOLD {
        // At the fold k₁ r² = −1/3, so the distorted radius is 2/3 of the ideal one.
        let fold = Radial::k1(k1).fold_radius_squared().sqrt() * 2.0 / 3.0;
        return Err(UndistortError::BeyondFold {
            k1,
            fold,
            radius: distorted.norm(),
        });
    }
    // For a barrel (w < 0) all terms of the series are positive, so it starts below the root, where
    // the function is concave: Newton ascends and cannot leave the branch. For w > 0 the function
    // is monotonic and convex.
    let mut s = if w < SERIES_UPTO {
        1.0 - w * (1.0 - w * (3.0 - w * 12.0))
    } else {
        1.0 / (1.0 + w).cbrt()
    };
    for _ in 0..64 {
        let step = (s * (1.0 + w * s * s) - 1.0) / (1.0 + 3.0 * w * s * s);
        if !step.is_finite() {
            break;
        }
        s -= step;
        // Newton's method converges quadratically: after a relative step of 1e-9 the error is
        // rounding.
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
        let lens = |k1: f64, k2_per_k1_squared: f64| Radial {
            k1,
            k2: k2_per_k1_squared * k1 * k1,
            pixel_aspect: 1.0 + k1,
        };
        for k1 in [-0.2, -0.12, -0.02, 0.0, 0.1, 0.5, 4.0] {
            for lens in [-0.3, 0.0, 0.3, 0.5, 2.0].map(|share| lens(k1, share)) {
                for step in 0..200 {
                    let radius = f64::from(step) * 0.005;
                    if radius * radius >= 0.98 * lens.fold_radius_squared() {
                        continue;
                    }
                    let ideal = Vec2::new(0.6, -0.8) * radius;
                    let again = undistort(distort(ideal, lens), lens).unwrap();
                    assert!(
                        (again - ideal).norm() < 1e-12,
                        "{lens:?} radius {radius}: {}",
                        (again - ideal).norm()
                    );
                }
            }
        }
    }

    #[test]
    fn tied_as_it_is_k2_leaves_no_fold_at_any_radius() {
        for k1 in [-30.0, -1.0, -0.25, -0.02] {
            let lens = FocalCurve {
                k2_per_k1_squared: FocalCurve::WITHOUT_FOLD,
                ..FocalCurve::constant(k1)
            }
            .radial_at(900.0);
            assert_eq!(lens.fold_radius_squared(), f64::INFINITY);
            for step in 1..400 {
                let ideal = Vec2::new(0.05 * f64::from(step), 0.0);
                assert!(lens.slope(ideal.norm_squared()) > 0.75, "{k1} {ideal}");
                let again = undistort(distort(ideal, lens), lens).unwrap();
                assert!(
                    (again - ideal).norm() < 1e-9 * ideal.norm(),
                    "{k1} {ideal}: {again}"
                );
            }
        }
    }

    #[test]
    fn beyond_the_fold_there_is_no_image() {
        let far = Vec2::new(5.0, 0.0);
        for share in [0.0, 0.3, -0.2] {
            let barrel = Radial {
                k1: -0.1,
                k2: share * 0.01,
                ..Radial::default()
            };
            assert!(matches!(
                undistort(far, barrel),
                Err(UndistortError::BeyondFold { .. })
            ));
        }
        assert!(undistort(far, Radial::k1(0.1)).is_ok());
    }

    #[test]
    fn a_point_reaches_the_fold_at_the_focal_lengths_that_are_returned() {
        for k2_per_k1_squared in [0.0, 0.2, -0.1] {
            let curve = FocalCurve {
                at_focal_px: 2000.0,
                value: -0.02,
                per_1000_px: 0.21,
                k2_per_k1_squared,
                ..FocalCurve::NONE
            };
            let found: Vec<f64> = curve.fold_focals(1100.0).collect();
            assert_eq!(found.len(), 1, "{found:?}");
            for (share, has_a_ray) in [(1.0 + 1e-9, true), (1.0 - 1e-9, false)] {
                let focal_px = found[0] * share;
                assert_eq!(
                    undistort(Vec2::new(1100.0 / focal_px, 0.0), curve.radial_at(focal_px)).is_ok(),
                    has_a_ray
                );
            }
        }
        let unfolded = FocalCurve {
            k2_per_k1_squared: FocalCurve::WITHOUT_FOLD,
            ..FocalCurve::constant(-0.2)
        };
        // A lens of another program that bends outwards first, and back farther out.
        let pincushion = FocalCurve {
            k2_per_k1_squared: -2.0,
            ..FocalCurve::constant(0.3)
        };
        let found: Vec<f64> = pincushion.fold_focals(1100.0).collect();
        assert_eq!(found.len(), 1, "{found:?}");
        for (share, has_a_ray) in [(1.0 + 1e-9, true), (1.0 - 1e-9, false)] {
            let focal_px = found[0] * share;
            assert_eq!(
                undistort(
                    Vec2::new(1100.0 / focal_px, 0.0),
                    pincushion.radial_at(focal_px)
                )
                .is_ok(),
                has_a_ray
            );
        }
        assert_eq!(unfolded.fold_focals(1100.0).count(), 0);
        assert_eq!(FocalCurve::constant(0.1).fold_focals(1100.0).count(), 0);
    }

    #[test]
    fn no_slope_up_to_a_radius_exceeds_the_greatest() {
        for (k1, k2) in [
            (0.3, -0.2),
            (0.3, 0.2),
            (-0.3, 0.2),
            (-0.3, -0.2),
            (0.3, 0.0),
        ] {
            let lens = Radial {
                k1,
                k2,
                ..Radial::default()
            };
            for end in [0.1, 0.4, 0.45, 1.0] {
                let slopes = (0..=1000).map(|step| lens.slope(end * f64::from(step) / 1000.0));
                let sampled = slopes.fold(0.0, f64::max);
                let greatest = lens.greatest_slope(end);
                assert!(
                    sampled <= greatest + 1e-12 && greatest < sampled + 1e-5,
                    "{lens:?} {end}: {sampled} {greatest}"
                );
            }
        }
    }

    #[test]
    fn a_curve_is_linear_in_the_focal_length() {
        let curve = FocalCurve {
            at_focal_px: 2000.0,
            value: -0.02,
            per_1000_px: 0.21,
            ..FocalCurve::NONE
        };
        assert!((curve.at(2410.0) - 0.0661).abs() < 1e-12);
        assert!((FocalCurve::constant(-0.1).at(9000.0) + 0.1).abs() < 1e-15);
    }
}
