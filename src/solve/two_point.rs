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
use crate::camera::{CameraBase, FocalCurve, Ptz, undistort};
use crate::geometry::{ImagePoint, Vec2, Vec3};
use thiserror::Error;

/// Clicks nearer to each other than this say nothing about the focal length, px.
pub const MIN_SEPARATION_PX: f64 = 2.0;

/// Rays nearer to each other than this cannot be told apart, degrees.
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
    if !(MIN_RAY_ANGLE_DEG..=180.0 - MIN_RAY_ANGLE_DEG).contains(&angle_deg) {
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
    let pointed = |(focal_px, ideal): (f64, [Vec2; 2])| {
        let (pan, tilt) = pan_tilt_from_one_ray(directions[0], ideal[0])
            .or_else(|_| pan_tilt_from_one_ray(directions[1], ideal[1]))
            .ok()?;
        Some(Ptz { pan, tilt, focal_px })
    };
    let pinhole = focal_from_two_rays(clicked, rays);
    if base.distortion == FocalCurve::NONE {
        let mut found = [None, None];
        for (slot, focal_px) in found.iter_mut().zip(pinhole?.iter()) {
            *slot = pointed((focal_px, clicked.map(|offset| offset / focal_px)));
        }
        return OneOrTwo::from_pair(found).ok_or_else(|| no_real_root(pixels, rays));
    }
    let lens = LensPair { base, pixels, rays };
    let followed = match pinhole {
        Ok(roots) => {
            let mut found = [None, None];
            for (slot, focal_px) in found.iter_mut().zip(roots.iter()) {
                *slot = lens.follow(focal_px).and_then(pointed);
            }
            OneOrTwo::from_pair(found)
        }
        Err(TwoPointError::NoRealRoot { .. }) => None,
        Err(error) => return Err(error),
    };
    let found = followed.or_else(|| {
        let mut roots = lens.scan().into_iter().filter_map(pointed);
        OneOrTwo::from_pair([roots.next(), roots.next()])
    });
    found.ok_or_else(|| no_real_root(pixels, rays))
}

/// Every camera for which two world points appear at two pixels, found by trying all focal lengths: slow, but it also finds
/// those beside the fold of the lens, to which no pinhole leads.
pub(super) fn scan_two_points(base: &CameraBase, points_in_world: [Vec3; 2], pixels: [ImagePoint; 2]) -> Vec<Ptz> {
    let directions = points_in_world.map(|point| base.base_from_world_point(point));
    let lens = LensPair { base, pixels, rays: directions.map(|direction| direction.normalize()) };
    let pointed = |(focal_px, ideal): (f64, [Vec2; 2])| {
        let (pan, tilt) = pan_tilt_from_one_ray(directions[0], ideal[0]).ok()?;
        Some(Ptz { pan, tilt, focal_px })
    };
    lens.scan().into_iter().filter_map(pointed).collect()
}

fn no_real_root(pixels: [ImagePoint; 2], [r1, r2]: [Vec3; 2]) -> TwoPointError {
    TwoPointError::NoRealRoot {
        separation_px: pixels[0].distance_px(pixels[1]),
        angle_deg: r1.cross(&r2).norm().atan2(r1.dot(&r2)).to_degrees(),
    }
}

/// Two pixels and their rays under a lens whose distortion follows the focal length.
struct LensPair<'a> {
    base: &'a CameraBase,
    pixels: [ImagePoint; 2],
    rays: [Vec3; 2],
}

impl LensPair<'_> {
    /// The pixels' ideal points on the plane z = 1 at a focal length; none beyond the fold of the lens model.
    fn ideal_at(&self, focal_px: f64) -> Option<[Vec2; 2]> {
        let lens = self.base.distortion.radial_at(focal_px);
        let ideal = |pixel: ImagePoint| undistort(pixel.offset_from(self.base.principal_point) / focal_px, lens).ok();
        Some([ideal(self.pixels[0])?, ideal(self.pixels[1])?])
    }

    /// Follows one root from the pinhole to the lens: undistort at the focal length found, solve again, keep the nearest
    /// root.
    fn follow(&self, pinhole_focal_px: f64) -> Option<(f64, [Vec2; 2])> {
        const ROUNDS: usize = 30;
        let mut focal_px = pinhole_focal_px;
        for _ in 0..ROUNDS {
            let ideal = self.ideal_at(focal_px)?;
            let roots = focal_from_two_rays(ideal.map(|point| point * focal_px), self.rays).ok()?;
            let distance = |root: f64| (root / focal_px).ln().abs();
            let next = roots.iter().min_by(|a, b| distance(*a).total_cmp(&distance(*b)))?;
            let moved = distance(next);
            focal_px = next;
            if moved < 1e-13 {
                break;
            }
        }
        Some((focal_px, self.ideal_at(focal_px)?))
    }

    /// The angle between the pixels' directions at a focal length, less that between the rays, rad.
    fn excess_angle(&self, log_focal: f64) -> Option<f64> {
        let [one, two] = self.ideal_at(log_focal.exp())?.map(|point| Vec3::new(point.x, point.y, 1.0));
        let between = |a: &Vec3, b: &Vec3| a.cross(b).norm().atan2(a.dot(b));
        Some(between(&one, &two) - between(&self.rays[0], &self.rays[1]))
    }

    /// The roots that the lens has and the pinhole has not: sign changes of the excess angle over focal lengths from a
    /// fifth to fifty times the pixels' reach. A dip that a coarse step jumps over is searched for its bottom first, and
    /// each stretch of focal lengths is sampled up to the fold of the lens, where the angle changes fastest.
    fn scan(&self) -> Vec<(f64, [Vec2; 2])> {
        let mut found = Vec::new();
        for mut samples in self.stretches() {
            let dips: Vec<usize> = (1..samples.len().saturating_sub(1))
                .filter(|&i| {
                    let [before, here, after] = [samples[i - 1].1, samples[i].1, samples[i + 1].1];
                    here.abs() <= before.abs() && here.abs() <= after.abs() && before * here > 0.0 && here * after > 0.0
                })
                .collect();
            let bottoms: Vec<(f64, f64)> =
                dips.into_iter().filter_map(|at| self.bottom(samples[at - 1], samples[at + 1].0)).collect();
            samples.extend(bottoms);
            samples.sort_by(|a, b| a.0.total_cmp(&b.0));
            found.extend(samples.windows(2).filter(|pair| pair[0].1 * pair[1].1 <= 0.0).filter_map(|pair| {
                let focal_px = self.bisect(pair[0], pair[1])?.exp();
                Some((focal_px, self.ideal_at(focal_px)?))
            }));
        }
        found
    }

    /// The excess angle over log focal lengths, in ascending stretches on which both pixels have a ray.
    fn stretches(&self) -> Vec<Vec<(f64, f64)>> {
        const STEPS: u32 = 64;
        /// So near to the fold, as a share of the focal length.
        const BESIDE: f64 = 1e-9;
        let reach = self.pixels.map(|pixel| pixel.distance_px(self.base.principal_point));
        let (from, upto) = ((0.2 * reach[0].max(reach[1])).ln(), (50.0 * reach[0].max(reach[1])).ln());
        let mut places: Vec<f64> =
            (0..=STEPS).map(|step| from + (upto - from) * f64::from(step) / f64::from(STEPS)).collect();
        let edges = reach.into_iter().flat_map(|reach| self.base.distortion.fold_focals(reach));
        let inside = |place: &f64| (from..=upto).contains(place);
        places.extend(edges.flat_map(|edge| [edge.ln() - BESIDE, edge.ln() + BESIDE]).filter(inside));
        places.sort_by(f64::total_cmp);
        let mut stretches = vec![Vec::new()];
        for place in places {
            match (self.excess_angle(place), stretches.last_mut()) {
                (Some(excess), Some(stretch)) => stretch.push((place, excess)),
                (None, Some(stretch)) if !stretch.is_empty() => stretches.push(Vec::new()),
                _ => {}
            }
        }
        stretches
    }

    /// The smallest |excess angle| between two log focal lengths at which it has one sign (golden section), or a place where
    /// it has the other.
    fn bottom(&self, (mut low, outside): (f64, f64), mut high: f64) -> Option<(f64, f64)> {
        const SHARE: f64 = 0.618_033_988_749_895;
        for _ in 0..40 {
            let (a, b) = (high - SHARE * (high - low), low + SHARE * (high - low));
            let (at_a, at_b) = (self.excess_angle(a)?, self.excess_angle(b)?);
            if let Some(across) = [(a, at_a), (b, at_b)].into_iter().find(|at| at.1 * outside < 0.0) {
                return Some(across);
            }
            if at_a.abs() < at_b.abs() { high = b } else { low = a }
        }
        let middle = f64::midpoint(low, high);
        Some((middle, self.excess_angle(middle)?))
    }

    /// The root between two samples of opposite sign.
    fn bisect(&self, (mut low, at_low): (f64, f64), (mut high, _): (f64, f64)) -> Option<f64> {
        for _ in 0..60 {
            let middle = f64::midpoint(low, high);
            if self.excess_angle(middle)? * at_low > 0.0 { low = middle } else { high = middle }
        }
        Some(f64::midpoint(low, high))
    }
}
