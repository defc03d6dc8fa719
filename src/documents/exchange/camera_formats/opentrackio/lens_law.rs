//! The distortion of a lens in `OpenTrackIO`, and the one of a document that is nearest to it.
//!
//! The law of Brown and Conrady acts on ε, mm from the centre of distortion:
//!
//! ε' = ε (1 + l1 r² + l3 r⁴ + l5 r⁶) / (1 + l2 r² + l4 r⁴ + l6 r⁶) + tangential terms q1, q2
//!
//! It leads from undistorted to distorted points (`U-D`), as ours does, or back (`D-U`, which is
//! meant where no model is named). Ours has k1 and k2 about the principal point. Any other law is
//! fitted: points of the picture on a grid give pairs of an undistorted and a distorted point, in
//! which k1 and k2 are linear.

use crate::exchange::syntax::values::coefficient;
use nalgebra::Matrix2;
use touchline_core::camera::Radial;
use touchline_core::geometry::{ImagePoint, ImageSize, Vec2};

/// The grid of the picture on which another law is fitted, columns and rows; edges are included.
const GRID: [u32; 2] = [24, 16];
/// Rounds of Newton's method for the inverse of a law; lenses of cameras need four.
const ROUNDS: usize = 30;
/// The inverse is found when it changes by less than this, mm.
const FOUND_MM: f64 = 1e-10;
/// The step of the derivatives of a law, mm.
const STEP_MM: f64 = 1e-5;

/// Distortion as a sample states it.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct BrownConrady {
    /// l1, l2, …: numerator and denominator alternate.
    pub(super) radial: Vec<f64>,
    /// q1 and q2.
    pub(super) tangential: Vec<f64>,
    /// From the principal point to the centre of distortion, mm.
    pub(super) centre_mm: Vec2,
    /// Whether it leads from distorted points to undistorted ones.
    pub(super) is_inverse: bool,
}

/// The picture behind a lens.
#[derive(Clone, Copy)]
pub(super) struct Screen {
    pub(super) size: ImageSize,
    pub(super) principal_point: ImagePoint,
    pub(super) mm_per_px: f64,
    pub(super) focal_mm: f64,
    /// How much wider the lens sees than the sensor has pixels for.
    pub(super) squeeze: f64,
}

/// The lens of a document nearest to another law.
pub(super) struct FittedLens {
    pub(super) radial: Radial,
    /// How far a point of the picture is off at most, px; infinite if the law leaves the picture
    /// without undistorted points.
    pub(super) off_px: f64,
}

impl BrownConrady {
    /// Whether it changes anything.
    pub(super) fn bends(&self) -> bool {
        self.radial
            .iter()
            .chain(&self.tangential)
            .any(|term| *term != 0.0)
    }

    /// Where it leads a point, mm from the principal point.
    fn apply(&self, point_mm: Vec2) -> Vec2 {
        let at = point_mm - self.centre_mm;
        let r2 = at.norm_squared();
        let l = |index| coefficient(&self.radial, index);
        let numerator = 1.0 + r2 * (l(0) + r2 * (l(2) + r2 * l(4)));
        let denominator = 1.0 + r2 * (l(1) + r2 * (l(3) + r2 * l(5)));
        let [q1, q2] = [0, 1].map(|index| coefficient(&self.tangential, index));
        let tangential = Vec2::new(
            2.0 * q1 * at.x * at.y + q2 * (r2 + 2.0 * at.x * at.x),
            2.0 * q2 * at.x * at.y + q1 * (r2 + 2.0 * at.y * at.y),
        );
        self.centre_mm + at * (numerator / denominator) + tangential
    }

    /// The undistorted point of a distorted one, mm; none if the law has none there.
    fn undistort(&self, distorted_mm: Vec2) -> Option<Vec2> {
        if self.is_inverse {
            return Some(self.apply(distorted_mm))
                .filter(|point| point.iter().all(|x| x.is_finite()));
        }
        // Newton's method with central differences, from the point itself.
        let mut point = distorted_mm;
        for _ in 0..ROUNDS {
            let off = self.apply(point) - distorted_mm;
            let columns = [Vec2::x(), Vec2::y()].map(|axis| {
                let step = axis * STEP_MM;
                (self.apply(point + step) - self.apply(point - step)) / (2.0 * STEP_MM)
            });
            let change = Matrix2::from_columns(&columns).try_inverse()? * off;
            point -= change;
            if change.norm() < FOUND_MM {
                return Some(point);
            }
        }
        None
    }

    /// The lens of a document: the same where the law is ours, else the nearest.
    pub(super) fn fit(&self, screen: &Screen) -> FittedLens {
        let further = self.radial.iter().enumerate();
        let mut further = further.filter(|(index, _)| !matches!(index, 0 | 2));
        let is_ours = !self.is_inverse
            && further.all(|(_, term)| *term == 0.0)
            && self.tangential.iter().all(|term| *term == 0.0)
            && self.centre_mm == Vec2::zeros();
        if is_ours {
            // k1 r² = (k1 / F²) (F r)².
            return FittedLens {
                radial: Radial {
                    k1: coefficient(&self.radial, 0) * screen.focal_mm.powi(2),
                    k2: coefficient(&self.radial, 2) * screen.focal_mm.powi(4),
                    ..Radial::default()
                },
                off_px: 0.0,
            };
        }
        self.fit_nearest(screen).unwrap_or(FittedLens {
            radial: Radial::default(),
            off_px: f64::INFINITY,
        })
    }

    /// The nearest k1 and k2 by least squares over the picture; none if the law has no undistorted
    /// points for all of it.
    fn fit_nearest(&self, screen: &Screen) -> Option<FittedLens> {
        let mut pairs = Vec::new();
        for place in 0..(GRID[0] + 1) * (GRID[1] + 1) {
            let [column, row] = [place % (GRID[0] + 1), place / (GRID[0] + 1)];
            let pixel = Vec2::new(
                f64::from(screen.size.width) * f64::from(column) / f64::from(GRID[0]),
                f64::from(screen.size.height) * f64::from(row) / f64::from(GRID[1]),
            );
            let from_centre = pixel - Vec2::new(screen.principal_point.x, screen.principal_point.y);
            let wide = Vec2::new(from_centre.x * screen.squeeze, from_centre.y);
            let distorted = wide * screen.mm_per_px;
            // On normalised coordinates, as ours acts.
            pairs.push((
                self.undistort(distorted)? / screen.focal_mm,
                distorted / screen.focal_mm,
            ));
        }
        // distorted − u = k1 u r² + k2 u r⁴.
        let (mut matrix, mut right) = (Matrix2::zeros(), Vec2::zeros());
        for (u, distorted) in &pairs {
            let r2 = u.norm_squared();
            let terms = [u * r2, u * (r2 * r2)];
            for (row, term) in terms.iter().enumerate() {
                right[row] += term.dot(&(distorted - u));
                for (column, other) in terms.iter().enumerate() {
                    matrix[(row, column)] += term.dot(other);
                }
            }
        }
        let k = matrix.try_inverse()? * right;
        let radial = Radial {
            k1: k.x,
            k2: k.y,
            ..Radial::default()
        };
        let off = pairs.iter().map(|(u, distorted)| {
            let r2 = u.norm_squared();
            (u * (1.0 + r2 * (radial.k1 + r2 * radial.k2)) - distorted).norm()
        });
        let off_px = off.fold(0.0, f64::max) * screen.focal_mm / screen.mm_per_px;
        Some(FittedLens { radial, off_px }).filter(|fitted| fitted.off_px.is_finite())
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const SCREEN: Screen = Screen {
        size: ImageSize::new(1920, 1080),
        principal_point: ImagePoint::new(960.0, 540.0),
        mm_per_px: 9.6 / 1920.0,
        squeeze: 1.0,
        focal_mm: 9.6,
    };

    fn law(radial: &[f64], is_inverse: bool) -> BrownConrady {
        BrownConrady {
            radial: radial.to_vec(),
            tangential: Vec::new(),
            centre_mm: Vec2::zeros(),
            is_inverse,
        }
    }

    #[test]
    fn a_law_to_undistorted_points_is_inverted() {
        // A mild barrel: 1 % at the corner.
        let back = law(&[4e-4], true);
        let fitted = back.fit(&SCREEN);
        assert!(
            fitted.off_px > 0.0 && fitted.off_px < 0.05,
            "{}",
            fitted.off_px
        );
        // By hand at a point: u = d (1 + l1 d²), and ours leads back to d.
        let d = 4.0_f64;
        let u = d * (1.0 + 4e-4 * d * d) / 9.6;
        let again = 9.6 * u * (1.0 + fitted.radial.k1 * u * u + fitted.radial.k2 * u.powi(4));
        assert!((again - d).abs() / SCREEN.mm_per_px < 0.05, "{again}");
    }

    #[test]
    fn further_coefficients_are_fitted_with_how_far_they_are_off() {
        let ours = law(&[-2e-3, 0.0, 1e-5, 0.0], false).fit(&SCREEN);
        assert_eq!(ours.off_px, 0.0);
        assert!((ours.radial.k1 + 2e-3 * 92.16).abs() < 1e-12);
        // A small third term and denominator are near ours, a large one is not.
        let near = law(&[-1e-3, 1e-5, 0.0, 0.0, 1e-9], false).fit(&SCREEN);
        assert!(near.off_px > 0.0 && near.off_px < 0.05, "{}", near.off_px);
        let far = law(&[-2e-2, 0.0, 0.0, 0.0, 1e-5], false).fit(&SCREEN);
        assert!(far.off_px > 0.05, "{}", far.off_px);
        // The tangential terms of a real lens are not radial.
        let tilted = BrownConrady {
            tangential: vec![1e-4, 0.0],
            ..law(&[-1e-3], false)
        };
        assert!(tilted.fit(&SCREEN).off_px > 0.05);
        let absurd = law(&[1.0, 2.0, 3.0], true).fit(&SCREEN);
        assert!(absurd.off_px > 100.0);
    }
}
