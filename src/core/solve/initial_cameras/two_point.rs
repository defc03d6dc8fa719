//! The two-point solve: pan, tilt and focal length of a camera with a known base, in closed form.
//!
//! After J. Chen, F. Zhu, J. J. Little: "A Two-point Method for PTZ Camera Calibration in Sports",
//! WACV 2018, section 3.1 and appendix 6. Equation numbers are the paper's.
//!
//! # Derivation
//!
//! Position and base rotation are known, so every world point has a known unit ray r in `base`. Pan
//! and tilt rotate the rays, and a rotation keeps the angle α between them. The focal length is the
//! f at which the two pixels subtend that angle (Eq. 3); x₁, x₂ are the pixels relative to the
//! principal point:
//!
//! ```text
//! cos α = r₁·r₂ = (x₁·x₂ + f²) / √((|x₁|² + f²) (|x₂|² + f²))
//! ```
//!
//! Squared, with s = f², a = |x₁|², b = |x₂|², c = x₁·x₂ and d = cos α, this is the quadratic that
//! Eq. 9 solves:
//!
//! ```text
//! (1 − d²) s² + (2c − d² (a + b)) s + (c² − d² a b) = 0
//! ```
//!
//! A telephoto lens sees rays a degree or less apart. Then d is nearly 1, and in 1 − d² the leading
//! digits cancel: six of sixteen for pixels 3 px apart at f = 6000 px. By Lagrange's identity the
//! differences are products, and this is the form that is evaluated:
//!
//! ```text
//! S = |r₁ × r₂|² = 1 − d²        X = x₁ × x₂, X² = a b − c²        D = |x₁ − x₂|² = a + b − 2c
//!
//! S s² + (S (a + b) − D) s + (S a b − X²) = 0
//! ```
//!
//! With f known, one point gives pan and tilt ([`pan_tilt_from_one_ray`], Eq. 15).
//!
//! # Number of solutions
//!
//! While f grows from 0 to ∞, the angle that the pixels subtend goes from β, their angle at the
//! principal point, to 0. If α < β, exactly one f subtends α; if α > β, none or two do. Two are
//! found for about one pair in 40: both pixels then lie in nearly the same direction from the
//! principal point. The shorter one is nearly always a fish-eye lens, but two points alone cannot
//! rule it out: both are returned, in ascending order.
//!
//! # Distortion
//!
//! With a lens, x₁ and x₂ are the *undistorted* pixels and depend on f, so that the equation is no
//! longer quadratic. Each root of the pinhole is followed by fixed-point iteration: undistort at f,
//! solve the quadratic, repeat. Where that finds nothing, the excess angle (subtended minus α) is
//! sampled over log f and its zeros are bracketed. This is slower, but it also finds the roots near
//! the fold of the lens model, to which no pinhole leads.

use super::one_point::pan_tilt_from_one_ray;
use crate::camera::{CameraBase, Ptz, undistort};
use crate::geometry::rotation::angle_between_directions;
use crate::geometry::{ImagePoint, Vec2, Vec3};
use thiserror::Error;

/// Minimum distance of two clicks that determine a focal length, px.
pub const MIN_SEPARATION_PX: f64 = 2.0;

/// Minimum angle of two rays that count as distinct, degrees.
pub const MIN_RAY_ANGLE_DEG: f64 = 1e-3;

/// Why two points give no focal length.
#[derive(Clone, Copy, Debug, PartialEq, Error)]
#[non_exhaustive]
pub enum TwoPointError {
    /// The pixels coincide.
    #[error("the pixels are {separation_px} px apart, {MIN_SEPARATION_PX} px are needed")]
    PointsTooClose {
        /// Their distance, px.
        separation_px: f64,
    },
    /// The rays coincide, or are opposite.
    #[error("the rays are {angle_deg}° apart, {MIN_RAY_ANGLE_DEG}° are needed")]
    SameRay {
        /// Their angle, degrees.
        angle_deg: f64,
    },
    /// No focal length brings these rays to these pixels.
    #[error("no focal length brings rays {angle_deg}° apart to pixels {separation_px} px apart")]
    NoRealRoot {
        /// Distance of the pixels, px.
        separation_px: f64,
        /// Angle of the rays, degrees.
        angle_deg: f64,
    },
}

/// One or two values, the most that a quadratic gives, without allocating.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct OneOrTwo<T> {
    first: T,
    second: Option<T>,
}

impl<T: Copy> OneOrTwo<T> {
    fn from_pair([first, second]: [Option<T>; 2]) -> Option<Self> {
        match (first, second) {
            (Some(first), second) => Some(Self { first, second }),
            (None, second) => second.map(|first| Self {
                first,
                second: None,
            }),
        }
    }

    fn filter_map<U: Copy>(self, convert: impl Fn(T) -> Option<U>) -> Option<OneOrTwo<U>> {
        OneOrTwo::from_pair([convert(self.first), self.second.and_then(convert)])
    }

    /// The values, in ascending order of focal length.
    pub fn iter(&self) -> impl Iterator<Item = T> + use<T> {
        std::iter::once(self.first).chain(self.second)
    }
}

/// Every (pan, tilt, focal length) for which two world points appear at two pixels, in ascending
/// order of focal length.
///
/// The focal length comes from both points, pan and tilt from the first one; from the second one
/// where the first is so steeply above or below the camera that no pan reaches its pixel. With
/// exact points the other point then fits too. With noisy ones it is off by the noise, which is
/// what the least-squares refinement ([`crate::solve::refine()`]) starts from.
///
/// # Errors
/// Coinciding pixels or rays, no valid root, or a root at which the lens has no such pixel.
pub fn solve_two_points(
    base: &CameraBase,
    points_in_world: [Vec3; 2],
    pixels: [ImagePoint; 2],
) -> Result<OneOrTwo<Ptz>, TwoPointError> {
    let pair = PointPair::new(base, points_in_world, pixels);
    let is_pinhole = base.distortion.is_pinhole();

    // Closed form: the roots of the pinhole, each followed to the root of the lens.
    let pinhole_focals = match focal_from_two_rays(pair.offsets_px(), pair.rays_in_base) {
        Ok(focals) => Some(focals),
        // Undistorted, the pixels may still have a root.
        Err(TwoPointError::NoRealRoot { .. }) if !is_pinhole => None,
        Err(error) => return Err(error),
    };
    let from_pinhole = pinhole_focals.and_then(|focals| {
        focals.filter_map(|focal_px| {
            let root = if is_pinhole {
                pair.pinhole_root(focal_px)
            } else {
                pair.follow_root(focal_px)?
            };
            pair.ptz_from_either_point(&root)
        })
    });
    if let Some(found) = from_pinhole {
        return Ok(found);
    }

    // With a lens, and only if the closed form leads nowhere: scan all focal lengths. The scan may
    // find more than two roots; the two shortest focal lengths are returned.
    let mut scanned = if is_pinhole {
        Vec::new()
    } else {
        pair.scan_roots()
    }
    .into_iter()
    .filter_map(|root| pair.ptz_from_either_point(&root));
    OneOrTwo::from_pair([scanned.next(), scanned.next()]).ok_or_else(|| pair.no_real_root())
}

/// Every camera for which two world points appear at two pixels, found by scanning all focal
/// lengths. Slow, but it also finds those near the fold of the lens, to which no pinhole leads.
pub(super) fn scan_two_points(
    base: &CameraBase,
    points_in_world: [Vec3; 2],
    pixels: [ImagePoint; 2],
) -> Vec<Ptz> {
    let pair = PointPair::new(base, points_in_world, pixels);
    pair.scan_roots()
        .iter()
        .filter_map(|root| pair.ptz_from_point(0, root))
        .collect()
}

/// The focal lengths (px) at which two ideal pixels (px from the principal point) subtend the angle
/// between two unit rays, in ascending order. A double root is returned twice.
///
/// # Errors
/// Coinciding pixels or rays (NaN counts as coinciding), or no valid root.
pub fn focal_from_two_rays(
    pixels: [Vec2; 2],
    rays: [Vec3; 2],
) -> Result<OneOrTwo<f64>, TwoPointError> {
    let ([x1, x2], [r1, r2]) = (pixels, rays);

    // Degenerate input; written so that NaN is caught as well.
    let separation_px = (x1 - x2).norm();
    if !(separation_px >= MIN_SEPARATION_PX) {
        return Err(TwoPointError::PointsTooClose { separation_px });
    }
    let sine_squared = r1.cross(&r2).norm_squared();
    let cosine = r1.dot(&r2);
    let angle_deg = sine_squared.sqrt().atan2(cosine).to_degrees();
    if !(MIN_RAY_ANGLE_DEG..=180.0 - MIN_RAY_ANGLE_DEG).contains(&angle_deg) {
        return Err(TwoPointError::SameRay { angle_deg });
    }

    // The quadratic in s = f², in the form without cancellation.
    let (a, b, cross) = (x1.norm_squared(), x2.norm_squared(), x1.perp(&x2));
    let roots = solve_quadratic(
        sine_squared * a * b - cross * cross,
        sine_squared * (a + b) - separation_px * separation_px,
        sine_squared,
    );

    // Squaring Eq. 3 has added the roots that belong to −cos α: the numerator x₁·x₂ + s must have
    // the sign of cos α.
    let focals = roots.map(|roots| {
        roots.map(|s| (s > 0.0 && (x1.dot(&x2) + s) * cosine >= 0.0).then(|| s.sqrt()))
    });
    focals
        .and_then(OneOrTwo::from_pair)
        .ok_or(TwoPointError::NoRealRoot {
            separation_px,
            angle_deg,
        })
}

/// The real roots of q₀ + q₁ s + q₂ s² = 0 (q₂ > 0) in ascending order; a double root twice.
///
/// The root of larger magnitude is computed first, where q₁ and the square root add up without
/// cancellation; the other one follows from the product of the roots, q₀/q₂ (Press et al.,
/// Numerical Recipes, section 5.6). A discriminant that is negative by rounding alone counts as
/// zero.
fn solve_quadratic(q0: f64, q1: f64, q2: f64) -> Option<[f64; 2]> {
    // Negative by rounding alone: the relative error of q₁² − 4 q₂ q₀ near zero is a few ε of q₁².
    // Written so that NaN fails.
    let discriminant = q1 * q1 - 4.0 * q2 * q0;
    if !(discriminant >= -8.0 * f64::EPSILON * q1 * q1) {
        return None;
    }
    let q = -0.5 * (q1 + discriminant.max(0.0).sqrt().copysign(q1));
    if q == 0.0 {
        return Some([0.0, 0.0]);
    }
    let (larger, smaller) = (q / q2, q0 / q);
    Some([larger.min(smaller), larger.max(smaller)])
}

/// Two world points and the pixels at which a camera with a known base sees them.
struct PointPair<'a> {
    base: &'a CameraBase,
    pixels: [ImagePoint; 2],
    /// From the camera to the points, m.
    directions_in_base: [Vec3; 2],
    /// The same, unit: r₁ and r₂.
    rays_in_base: [Vec3; 2],
}

/// A focal length at which the pixels subtend the angle of the rays.
struct FocalRoot {
    focal_px: f64,
    /// The undistorted pixels there, on the plane z = 1.
    ideal_in_cam: [Vec2; 2],
}

/// The excess angle at one focal length.
#[derive(Clone, Copy)]
struct ExcessSample {
    log_focal: f64,
    /// The angle that the undistorted pixels subtend minus that of the rays.
    excess_rad: f64,
}

impl<'a> PointPair<'a> {
    fn new(base: &'a CameraBase, points_in_world: [Vec3; 2], pixels: [ImagePoint; 2]) -> Self {
        let directions_in_base = points_in_world.map(|point| base.base_from_world_point(point));
        let rays_in_base = directions_in_base.map(|direction| direction.normalize());
        Self {
            base,
            pixels,
            directions_in_base,
            rays_in_base,
        }
    }

    /// The pixels relative to the principal point as they are with square pixels, still distorted.
    fn offsets_px(&self) -> [Vec2; 2] {
        let (curve, centre) = (self.base.distortion, self.base.principal_point);
        self.pixels
            .map(|pixel| curve.square_point(pixel, centre).offset_from(centre))
    }

    fn no_real_root(&self) -> TwoPointError {
        let [r1, r2] = self.rays_in_base;
        TwoPointError::NoRealRoot {
            separation_px: self.pixels[0].distance_px(self.pixels[1]),
            angle_deg: angle_between_directions(&r1, &r2).degrees(),
        }
    }

    /// Pan and tilt from one of the points once the focal length is known; none if no pan reaches
    /// its pixel.
    fn ptz_from_point(&self, point: usize, root: &FocalRoot) -> Option<Ptz> {
        let (pan, tilt) =
            pan_tilt_from_one_ray(self.directions_in_base[point], root.ideal_in_cam[point]).ok()?;
        Some(Ptz {
            pan,
            tilt,
            focal_px: root.focal_px,
        })
    }

    fn ptz_from_either_point(&self, root: &FocalRoot) -> Option<Ptz> {
        self.ptz_from_point(0, root)
            .or_else(|| self.ptz_from_point(1, root))
    }

    fn pinhole_root(&self, focal_px: f64) -> FocalRoot {
        FocalRoot {
            focal_px,
            ideal_in_cam: self.offsets_px().map(|offset| offset / focal_px),
        }
    }

    /// The pixels undistorted at a focal length; none beyond the fold of the lens model.
    fn undistort_at(&self, focal_px: f64) -> Option<FocalRoot> {
        let square = self.base.distortion.with_pixel_aspect(1.0);
        let lens = square.radial_at(focal_px);
        let [x1, x2] = self.offsets_px();
        Some(FocalRoot {
            focal_px,
            ideal_in_cam: [
                undistort(x1 / focal_px, lens).ok()?,
                undistort(x2 / focal_px, lens).ok()?,
            ],
        })
    }

    /// Follows a root of the pinhole to the one of the lens by fixed-point iteration: undistorts
    /// the pixels at the current focal length, solves the quadratic for them and goes to the nearer
    /// of its roots.
    fn follow_root(&self, pinhole_focal_px: f64) -> Option<FocalRoot> {
        const MAX_ITERATIONS: usize = 30;
        const CONVERGED_LOG_FOCAL: f64 = 1e-13;
        // Distortion hardly changes from one focal length to the next, so that a few rounds are
        // enough. Beside a fold of the lens this may fail; then the caller scans.
        let mut focal_px = pinhole_focal_px;
        for _ in 0..MAX_ITERATIONS {
            let ideal_px = self
                .undistort_at(focal_px)?
                .ideal_in_cam
                .map(|point| point * focal_px);
            let focals = focal_from_two_rays(ideal_px, self.rays_in_base).ok()?;
            // Of two roots the nearer one continues the branch that is followed.
            let (log_change, next) = focals
                .iter()
                .map(|next| ((next / focal_px).ln().abs(), next))
                .min_by(|a, b| a.0.total_cmp(&b.0))?;
            focal_px = next;
            if log_change < CONVERGED_LOG_FOCAL {
                break;
            }
        }
        self.undistort_at(focal_px)
    }

    /// All roots of the excess angle over focal lengths from a fifth to fifty times the pixels'
    /// distance from the principal point, in ascending order.
    fn scan_roots(&self) -> Vec<FocalRoot> {
        let mut roots = Vec::new();
        for mut samples in self.sample_excess() {
            // Two roots between neighbouring samples change the sign twice, which no sample shows.
            // A sample from between them separates the two.
            let separating = self.sample_dips(&samples);
            samples.extend(separating);
            samples.sort_by(|a, b| a.log_focal.total_cmp(&b.log_focal));
            for bracket in samples.windows(2) {
                if bracket[0].excess_rad * bracket[1].excess_rad <= 0.0 {
                    roots.extend(self.bisect(bracket[0], bracket[1]));
                }
            }
        }
        roots
    }

    /// The excess angle at a focal length; none beyond the fold of the lens model.
    fn excess_at(&self, log_focal: f64) -> Option<ExcessSample> {
        let [one, two] = self
            .undistort_at(log_focal.exp())?
            .ideal_in_cam
            .map(|point| Vec3::new(point.x, point.y, 1.0));
        let [r1, r2] = &self.rays_in_base;
        let excess = angle_between_directions(&one, &two) - angle_between_directions(r1, r2);
        Some(ExcessSample {
            log_focal,
            excess_rad: excess.radians(),
        })
    }

    /// Samples the excess angle evenly in log f and on both sides of each fold of the lens, where
    /// it changes fastest. A fold ends the range of focal lengths at which both pixels have a ray:
    /// there is one list for each such range, ascending.
    fn sample_excess(&self) -> Vec<Vec<ExcessSample>> {
        const STEPS: u32 = 64;
        /// Distance of the samples beside a fold from it, in log f.
        const FOLD_MARGIN: f64 = 1e-9;
        let reach_px = self.offsets_px().map(|offset| offset.norm());
        let farthest_px = reach_px[0].max(reach_px[1]);
        let (from, upto) = ((0.2 * farthest_px).ln(), (50.0 * farthest_px).ln());

        let mut log_focals: Vec<f64> = (0..=STEPS)
            .map(|step| from + (upto - from) * f64::from(step) / f64::from(STEPS))
            .collect();
        for fold_px in reach_px
            .into_iter()
            .flat_map(|reach_px| self.base.distortion.fold_focals(reach_px))
        {
            // The excess angle has a vertical tangent at a fold; an even grid would miss a root
            // beside it.
            let beside_fold = [fold_px.ln() - FOLD_MARGIN, fold_px.ln() + FOLD_MARGIN];
            log_focals.extend(
                beside_fold
                    .into_iter()
                    .filter(|log_focal| (from..=upto).contains(log_focal)),
            );
        }
        log_focals.sort_by(f64::total_cmp);

        // Split at the samples without a ray, so that no bracket spans a fold.
        let mut ranges = Vec::new();
        let mut range = Vec::new();
        for log_focal in log_focals {
            match self.excess_at(log_focal) {
                Some(sample) => range.push(sample),
                None if range.is_empty() => {}
                None => ranges.push(std::mem::take(&mut range)),
            }
        }
        ranges.push(range);
        ranges
    }

    /// For each sample at which |excess| has a minimum without a change of sign: a sample of the
    /// other sign beside it, or the minimum itself where it does not cross zero.
    fn sample_dips(&self, samples: &[ExcessSample]) -> Vec<ExcessSample> {
        let mut found = Vec::new();
        for three in samples.windows(3) {
            let [before, here, after] = [0, 1, 2].map(|at| three[at].excess_rad);
            let is_dip = here.abs() <= before.abs() && here.abs() <= after.abs();
            if is_dip && before * here > 0.0 && here * after > 0.0 {
                found.extend(self.minimise_excess(three[0], three[2]));
            }
        }
        found
    }

    /// Golden-section search for the smallest |excess| between two samples of one sign; ends early
    /// at a sample of the other sign.
    fn minimise_excess(&self, from: ExcessSample, upto: ExcessSample) -> Option<ExcessSample> {
        const ITERATIONS: usize = 40;
        /// 1/φ, the golden section.
        const SHARE: f64 = 0.618_033_988_749_895;
        // Press et al., Numerical Recipes, 3rd ed., section 10.2, but with both inner samples
        // computed anew in each round: the search runs rarely.
        let (mut low, mut high) = (from.log_focal, upto.log_focal);
        for _ in 0..ITERATIONS {
            let left = self.excess_at(high - SHARE * (high - low))?;
            let right = self.excess_at(low + SHARE * (high - low))?;
            for inner in [left, right] {
                if inner.excess_rad * from.excess_rad < 0.0 {
                    return Some(inner);
                }
            }
            if left.excess_rad.abs() < right.excess_rad.abs() {
                high = right.log_focal;
            } else {
                low = left.log_focal;
            }
        }
        self.excess_at(f64::midpoint(low, high))
    }

    /// The root between two samples of opposite sign.
    fn bisect(&self, from: ExcessSample, upto: ExcessSample) -> Option<FocalRoot> {
        const ITERATIONS: usize = 60;
        // Bisection, because beside a fold the tangent is vertical, and a secant hardly converges.
        // 60 halvings reach the resolution of `f64`.
        let (mut low, mut high) = (from.log_focal, upto.log_focal);
        for _ in 0..ITERATIONS {
            let middle = self.excess_at(f64::midpoint(low, high))?;
            if middle.excess_rad * from.excess_rad > 0.0 {
                low = middle.log_focal;
            } else {
                high = middle.log_focal;
            }
        }
        self.undistort_at(f64::midpoint(low, high).exp())
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Two pixels and the unit rays that a pinhole of this focal length sees there.
    fn pixels_and_rays(focal_px: f64, pixels: [[f64; 2]; 2]) -> ([Vec2; 2], [Vec3; 2]) {
        let pixels = pixels.map(Vec2::from);
        (
            pixels,
            pixels.map(|pixel| Vec3::new(pixel.x, pixel.y, focal_px).normalize()),
        )
    }

    /// Eq. 9 of the paper as it is printed.
    fn focal_as_published([x1, x2]: [Vec2; 2], [r1, r2]: [Vec3; 2]) -> f64 {
        let (a, b, c, d) = (x1.dot(&x1), x2.dot(&x2), x1.dot(&x2), r1.dot(&r2));
        let q1 = 2.0 * c - d * d * (a + b);
        let discriminant = q1 * q1 - 4.0 * (d * d * a * b - c * c) * (d * d - 1.0);
        (2.0 * (d * d * a * b - c * c) / (q1 + discriminant.sqrt())).sqrt()
    }

    #[test]
    fn the_published_equation_gives_the_same_focal_length_with_fewer_digits() {
        for (focal_px, pixels, published_error_px) in [
            (3000.0, [[-400.0, 120.0], [350.0, -80.0]], 1e-12..1e-8),
            (6000.0, [[200.0, 100.0], [203.0, 101.0]], 1e-8..1e-4),
        ] {
            let (pixels, rays) = pixels_and_rays(focal_px, pixels);
            let found = focal_from_two_rays(pixels, rays)
                .unwrap()
                .iter()
                .last()
                .unwrap();
            assert!((found - focal_px).abs() < 1e-10, "{found}");
            let published = focal_as_published(pixels, rays);
            assert!(
                published_error_px.contains(&(published - focal_px).abs()),
                "{published}"
            );
        }
    }

    #[test]
    fn two_focal_lengths_come_in_ascending_order() {
        // Both pixels on one side of the principal point: α is 25°, β only 2°.
        let (pixels, rays) = pixels_and_rays(1000.0, [[300.0, 0.0], [900.0, 30.0]]);
        let found = focal_from_two_rays(pixels, rays).unwrap();
        let focals: Vec<f64> = found.iter().collect();
        assert!(focals.len() == 2 && focals[0] < focals[1], "{found:?}");
        for focal_px in focals {
            let [one, two] = pixels.map(|pixel| Vec3::new(pixel.x, pixel.y, focal_px));
            let subtended = angle_between_directions(&one, &two);
            let between_rays = angle_between_directions(&rays[0], &rays[1]);
            assert!((subtended - between_rays).abs().radians() < 1e-12);
        }
    }

    #[test]
    fn degenerate_pairs_are_named() {
        let (pixels, rays) = pixels_and_rays(2000.0, [[-300.0, 0.0], [300.0, 0.0]]);
        let same_pixel = focal_from_two_rays([pixels[0], pixels[0]], rays);
        assert!(
            matches!(same_pixel, Err(TwoPointError::PointsTooClose { .. })),
            "{same_pixel:?}"
        );
        let same_ray = focal_from_two_rays(pixels, [rays[0], rays[0]]);
        assert!(
            matches!(same_ray, Err(TwoPointError::SameRay { .. })),
            "{same_ray:?}"
        );
        let not_a_number = focal_from_two_rays([pixels[0], Vec2::new(f64::NAN, 0.0)], rays);
        assert!(
            matches!(not_a_number, Err(TwoPointError::PointsTooClose { .. })),
            "{not_a_number:?}"
        );
        // No focal length makes pixels 10 px apart on one side of the principal point subtend 90°.
        let beside = focal_from_two_rays(
            [Vec2::new(300.0, 0.0), Vec2::new(310.0, 0.0)],
            [Vec3::x(), Vec3::y()],
        );
        assert!(
            matches!(beside, Err(TwoPointError::NoRealRoot { .. })),
            "{beside:?}"
        );
    }
}
