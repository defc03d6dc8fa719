//! The focal length from two points, and with it pan and tilt (appendix 6.1 of the paper, made stable).
//!
//! x₁, x₂: ideal pixels minus the principal point; r₁, r₂: unit rays to the two world points. The angle between the pixels'
//! directions must be that between the rays. With s = f²:
//!
//! S = |r₁ × r₂|²,  D = |x₁ − x₂|²,  a = |x₁|²,  b = |x₂|²,  X = x₁ × x₂ (scalar)
//! S s² + (S (a + b) − D) s + (S a b − X²) = 0
//!
//! This is the paper's quadratic with the cancellation taken out (1 − d² = S, ab − c² = X²). A root s > 0 counts if
//! x₁·x₂ + s has the sign of r₁·r₂. Usually one does; in about 1 pair of 40 two do, and both are kept.

use super::one_point::pan_tilt_from_one_ray;
use crate::camera::{CameraBase, Ptz, PtzCamera};
use crate::geometry::{Angle, ImagePoint, Vec2, Vec3};
use thiserror::Error;

/// Clicks nearer to each other than this say nothing about the focal length, px.
pub const MIN_SEPARATION_PX: f64 = 2.0;

/// Rays nearer to each other than this cannot be told apart, degrees.
pub const MIN_RAY_ANGLE_DEG: f64 = 1e-3;

/// Why two points give no focal length.
#[derive(Clone, Copy, Debug, PartialEq, Error)]
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
            (None, Some(first)) => Some(Self { first, second: None }),
            (None, None) => None,
        }
    }

    /// The values, in ascending order of focal length.
    pub fn iter(&self) -> impl Iterator<Item = T> + use<T> {
        std::iter::once(self.first).chain(self.second)
    }

    /// Whether there are two.
    #[must_use]
    pub const fn is_two(&self) -> bool {
        self.second.is_some()
    }
}

/// The focal lengths (px) at which two ideal pixels (px from the principal point) are as far apart as two unit rays.
///
/// # Errors
/// Coinciding pixels or rays (NaN counts as coinciding), or no valid root.
pub fn focal_from_two_rays(pixels: [Vec2; 2], rays: [Vec3; 2]) -> Result<OneOrTwo<f64>, TwoPointError> {
    let ([x1, x2], [r1, r2]) = (pixels, rays);
    let separation_px = (x1 - x2).norm();
    if !(separation_px >= MIN_SEPARATION_PX) {
        return Err(TwoPointError::PointsTooClose { separation_px });
    }
    let sine_squared = r1.cross(&r2).norm_squared();
    let cosine = r1.dot(&r2);
    let angle_deg = sine_squared.sqrt().atan2(cosine).to_degrees();
    if !(angle_deg >= MIN_RAY_ANGLE_DEG && angle_deg <= 180.0 - MIN_RAY_ANGLE_DEG) {
        return Err(TwoPointError::SameRay { angle_deg });
    }
    let (a, b, cross) = (x1.norm_squared(), x2.norm_squared(), x1.perp(&x2));
    let roots = quadratic_roots(
        sine_squared,
        sine_squared * (a + b) - separation_px * separation_px,
        sine_squared * a * b - cross * cross,
    );
    let valid = |s: f64| (s > 0.0 && (x1.dot(&x2) + s) * cosine >= 0.0).then(|| s.sqrt());
    roots
        .and_then(|roots| OneOrTwo::from_pair(roots.map(valid)))
        .ok_or(TwoPointError::NoRealRoot { separation_px, angle_deg })
}

/// The real roots of q₂ s² + q₁ s + q₀ (q₂ > 0) in ascending order, without cancellation; a discriminant that is negative
/// by rounding alone counts as zero.
fn quadratic_roots(q2: f64, q1: f64, q0: f64) -> Option<[f64; 2]> {
    let discriminant = q1 * q1 - 4.0 * q2 * q0;
    if !(discriminant >= -8.0 * f64::EPSILON * q1 * q1) {
        return None;
    }
    let q = -0.5 * (q1 + discriminant.max(0.0).sqrt().copysign(q1));
    if q == 0.0 {
        return Some([0.0, 0.0]);
    }
    let (one, other) = (q / q2, q0 / q);
    Some([one.min(other), one.max(other)])
}

/// Every (pan, tilt, focal length) for which two world points appear at two pixels, as far as the closed forms go: the
/// focal length from both points, pan and tilt from the first. Distortion is undone at the focal length found, repeatedly.
///
/// # Errors
/// Coinciding pixels or rays, no valid root, or a root at which the lens has no such pixel.
pub fn solve_two_points(
    base: &CameraBase,
    points_in_world: [Vec3; 2],
    pixels: [ImagePoint; 2],
) -> Result<OneOrTwo<Ptz>, TwoPointError> {
    let directions = points_in_world.map(|point| base.base_from_world_point(point));
    let rays = directions.map(|direction| direction.normalize());
    let clicked = pixels.map(|pixel| pixel.offset_from(base.principal_point));
    let focals = focal_from_two_rays(clicked, rays)?;
    let pinhole = base.distortion == crate::camera::FocalCurve::NONE;
    let candidate = |focal_px: f64| {
        let (focal_px, ideal) = if pinhole {
            (focal_px, clicked.map(|offset| offset / focal_px))
        } else {
            with_distortion(base, pixels, rays, focal_px)?
        };
        let (pan, tilt) = pan_tilt_from_one_ray(directions[0], ideal[0])
            .or_else(|_| pan_tilt_from_one_ray(directions[1], ideal[1]))
            .ok()?;
        Some(Ptz { pan, tilt, focal_px })
    };
    let mut found = [None, None];
    for (slot, focal_px) in found.iter_mut().zip(focals.iter()) {
        *slot = candidate(focal_px);
    }
    OneOrTwo::from_pair(found).ok_or_else(|| TwoPointError::NoRealRoot {
        separation_px: pixels[0].distance_px(pixels[1]),
        angle_deg: Angle::from_radians(rays[0].cross(&rays[1]).norm().atan2(rays[0].dot(&rays[1]))).degrees(),
    })
}

/// Follows one root from the pinhole to the lens: undistort at the focal length found, solve again, keep the nearest root.
/// Gives the focal length and the ideal points on the plane z = 1.
fn with_distortion(
    base: &CameraBase,
    pixels: [ImagePoint; 2],
    rays: [Vec3; 2],
    start_focal_px: f64,
) -> Option<(f64, [Vec2; 2])> {
    const ROUNDS: usize = 30;
    let mut focal_px = start_focal_px;
    let ideal_at = |focal_px: f64| {
        let lens = PtzCamera::new(*base, Ptz { pan: Angle::ZERO, tilt: Angle::ZERO, focal_px });
        Some([lens.cam_plane_from_image(pixels[0]).ok()?, lens.cam_plane_from_image(pixels[1]).ok()?])
    };
    for _ in 0..ROUNDS {
        let ideal = ideal_at(focal_px)?;
        let roots = focal_from_two_rays(ideal.map(|point| point * focal_px), rays).ok()?;
        let distance = |root: f64| (root / focal_px).ln().abs();
        let next = roots.iter().min_by(|a, b| distance(*a).total_cmp(&distance(*b)))?;
        let moved = distance(next);
        focal_px = next;
        if moved < 1e-13 {
            break;
        }
    }
    Some((focal_px, ideal_at(focal_px)?))
}
