//! The place that individually calibrated cameras have in common.
//!
//! # Problem
//!
//! Programs that calibrate each frame by itself give each frame a position of its own: 0.3 to 0.6 m
//! apart where the view is wide, 20 m along the viewing direction where it is narrow, and absurd in
//! some frames. The broadcast camera stood still. Given the cameras of many frames, find the
//! position, the base rotation and the lens that they share, and which frames share it.
//!
//! # Method
//!
//! 1. The mode of the positions: the position with the most others within [`NEAR_M`]. A mean would
//!    follow the absurd ones.
//! 2. From there the median along each axis, and the scatter along each axis from the median
//!    absolute deviation, of the positions within reach; repeated until they are the same.
//! 3. The pan axis. A camera without roll keeps its x axis perpendicular to the pan axis, so the
//!    axis `a` minimises the sum of `(x · a)²`. With `a = (u, v, 1)` this is linear in `u` and `v`.
//!    Cauchy weights reduce the effect of wrong frames, and a prior that the head is levelled
//!    within [`LEVEL_DEG`] decides where the frames look almost the same way.
//! 4. The lens: a line through k₁ over the focal length by the median of slopes, weighed against a
//!    prior; the median of the principal point.
//! 5. The σ: that of the median, and an error that all cameras have in common ([`COMMON_M`],
//!    [`LEVEL_DEG`]).
//! 6. Frames that do not belong to it are searched for a further place in the same way.
//!
//! The result is a start: an adjustment to painted lines or clicks follows (`adjust.rs`).

use crate::camera::{BaseSigma, CameraBase, FocalCurve, PtzCamera};
use crate::geometry::{Angle, ImagePoint, Vec3, median, pluralise, subsample};
use nalgebra::{Matrix2, Vector2};
use std::fmt;

/// Positions within this distance of each other are near, m. Programs that calibrate frames one by
/// one scatter by up to 0.6 m along each axis; two cameras of one broadcast are at least 5 m apart.
const NEAR_M: f64 = 3.0;

/// Cameras belong to a place within this many σ of the scatter along each axis.
const MEMBER_SIGMAS: f64 = 4.0;

/// The least and the largest σ of the scatter along an axis, m. The least is that of positions that
/// are all alike but for their digits; the largest keeps places of two cameras apart.
const SCATTER_M: [f64; 2] = [0.02, 3.0];

/// Rounds in which median, scatter and members, or the pan axis, are determined.
const ROUNDS: usize = 10;

/// The least number of cameras that make a place, and their least share of all.
const MIN_CAMERAS: usize = 3;
const LEAST_SHARE: f64 = 0.02;

/// 1-σ of the roll and the pitch of a levelled head, degrees.
const LEVEL_DEG: f64 = 0.5;

/// Candidates for the mode; more positions than this are subsampled.
const MOST_CANDIDATES: usize = 1000;

/// The least 1-σ of a shared position along each axis, m. The cameras of one program have errors in
/// common, of the field's size and of the lens above all, which no number of frames averages out.
const COMMON_M: f64 = 0.5;

/// What is known of a lens beforehand: 1-σ of k₁, of its change with the logarithm of the focal
/// length (0.1 per 1000 px at 2500 px), and of k₂ / k₁².
const K1_SIGMA: f64 = 0.2;
const SLOPE_BY_LOG_FOCAL: f64 = 0.25;
const K2_RATIO_SIGMA: f64 = 5.0;

/// The least 1-σ of a given k₁: the digits of a file.
const K1_DIGITS: f64 = 1e-8;

/// σ of normally distributed errors as a multiple of their median absolute deviation.
const SIGMA_OVER_MAD: f64 = 1.4826;

/// A base that several cameras share, as a start for an adjustment.
#[derive(Clone, Debug, PartialEq)]
pub struct SharedPlace {
    /// Position, rotation and lens. Its 1-σ contains the errors that the members have in common.
    pub base: CameraBase,
    /// The cameras that share it, by their indices, ascending.
    pub members: Vec<usize>,
    /// 1-σ of the members' positions along each axis (`world`), m.
    pub scatter_m: Vec3,
}

impl SharedPlace {
    /// Whether a position lies within the scatter of the members' positions.
    pub fn contains(&self, position_m: Vec3) -> bool {
        is_within(position_m, self.base.position_m, self.scatter_m)
    }
}

/// Position, scatter and number of members, in one line.
impl fmt::Display for SharedPlace {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let [x, y, z] = <[f64; 3]>::from(self.base.position_m);
        let [dx, dy, dz] = <[f64; 3]>::from(self.scatter_m);
        let frames = pluralise(self.members.len(), "frame");
        write!(
            f,
            "({x:.2}, {y:.2}, {z:.2}) m, scattered by ({dx:.2}, {dy:.2}, {dz:.2}) m, in {frames}"
        )
    }
}

/// The places that cameras share, the one with the most cameras first. Empty if no
/// three positions lie near each other.
pub fn shared_places(cameras: &[PtzCamera]) -> Vec<SharedPlace> {
    let fewest = MIN_CAMERAS.max((LEAST_SHARE * cameras.len() as f64).ceil() as usize);
    let mut open: Vec<usize> = (0..cameras.len()).collect();
    let mut places = Vec::new();
    while open.len() >= fewest {
        let Some(place) = most_shared_place(cameras, &open, fewest) else {
            break;
        };
        open.retain(|index| place.members.binary_search(index).is_err());
        places.push(place);
    }
    places
}

/// The place that most of the open cameras share; none if fewer than `fewest` do.
fn most_shared_place(cameras: &[PtzCamera], open: &[usize], fewest: usize) -> Option<SharedPlace> {
    let position = |index: &usize| cameras[*index].base().position_m;
    // The mode of the positions, by counting the neighbours of a subsample among all of them:
    // without the limit on candidates the time would grow with the square.
    let candidates = subsample(open, MOST_CANDIDATES).map(position);
    let mut middle = candidates.max_by_key(|candidate| {
        let near = open
            .iter()
            .filter(|index| (position(index) - *candidate).norm() <= NEAR_M);
        near.count()
    })?;
    // From there, members and their median and scatter in turn, until the members stay the same.
    let mut scatter_m = Vec3::repeat(NEAR_M / MEMBER_SIGMAS);
    let mut members = Vec::new();
    for _ in 0..ROUNDS {
        let mut of_place = open.to_vec();
        of_place.retain(|index| is_within(position(index), middle, scatter_m));
        if of_place.len() < fewest {
            return None;
        }
        for axis in 0..3 {
            let mut at: Vec<f64> = of_place.iter().map(|index| position(index)[axis]).collect();
            let (middle_m, sigma_m) = middle_and_sigma(&mut at)?;
            middle[axis] = middle_m;
            scatter_m[axis] = sigma_m.clamp(SCATTER_M[0], SCATTER_M[1]);
        }
        if of_place == members {
            break;
        }
        members = of_place;
    }
    let of_place: Vec<&PtzCamera> = members.iter().map(|index| &cameras[*index]).collect();
    let lens = SharedLens::from_cameras(&of_place)?;
    // The median of n positions is less exact than their mean by a factor of about 1.25.
    let of_median_m = scatter_m * (1.25 / (members.len() as f64).sqrt());
    let level = Angle::from_degrees(LEVEL_DEG).radians();
    let base = CameraBase {
        distortion: lens.curve,
        sigma: BaseSigma {
            position_m: of_median_m.map(|sigma_m| sigma_m.hypot(COMMON_M)),
            // Each camera is levelled to its own position, so that their rotations err alike, too.
            rotation: Vec3::new(level, level, 0.0),
            ..lens.sigma()
        },
        ..CameraBase::new(
            middle,
            CameraBase::rotation_about(&pan_axis(&of_place)?),
            ImagePoint::new(
                median_of(&of_place, |camera| camera.base().principal_point.x)?,
                median_of(&of_place, |camera| camera.base().principal_point.y)?,
            ),
        )
    };
    Some(SharedPlace {
        base,
        members,
        scatter_m,
    })
}

fn is_within(position_m: Vec3, middle: Vec3, sigma_m: Vec3) -> bool {
    let off = (position_m - middle).component_div(&sigma_m);
    off.amax() <= MEMBER_SIGMAS
}

/// The median of numbers, and their σ from the median absolute deviation.
fn middle_and_sigma(values: &mut [f64]) -> Option<(f64, f64)> {
    let middle = median(values)?;
    for value in values.iter_mut() {
        *value = (*value - middle).abs();
    }
    Some((middle, SIGMA_OVER_MAD * median(values)?))
}

fn median_of(cameras: &[&PtzCamera], number: impl Fn(&PtzCamera) -> f64) -> Option<f64> {
    let mut numbers: Vec<f64> = cameras.iter().map(|camera| number(camera)).collect();
    median(&mut numbers)
}

/// A lens with the 1-σ of its value and of its slope.
struct SharedLens {
    curve: FocalCurve,
    k1_sigma: f64,
    per_1000_px_sigma: f64,
}

impl SharedLens {
    /// The lens: k₁ linear in the focal length, by the median of the slopes between cameras of
    /// short and of long focal length (Theil and Sen), and k₂ as a multiple of k₁².
    ///
    /// Each of the three is a quotient. Where the focal length rests, or k₁ is near zero, its
    /// denominator vanishes, and the quotient is noise of any size. So each is weighed by its own σ
    /// against a prior ([`shrink`]).
    fn from_cameras(cameras: &[&PtzCamera]) -> Option<Self> {
        let mut by_focal: Vec<[f64; 2]> = cameras
            .iter()
            .map(|camera| [camera.ptz().focal_px, camera.k1()])
            .collect();
        by_focal.sort_by(|one, other| one[0].total_cmp(&other[0]));
        // Each camera is paired with the one half of all cameras further on, so that focal lengths
        // differ as much as they do in the clip.
        let (short, long) = by_focal.split_at(by_focal.len() / 2);
        let pairs = short.iter().zip(long);
        let (mut apart_px, mut slopes): (Vec<f64>, Vec<f64>) = pairs
            .map(|([short_px, short_k1], [long_px, long_k1])| {
                let apart_px = long_px - short_px;
                (apart_px, (long_k1 - short_k1) / apart_px)
            })
            .unzip();
        slopes.retain(|per_px| per_px.is_finite());
        let steepest = median(&mut slopes).unwrap_or(0.0);
        let at_focal_px = median_of(cameras, |camera| camera.ptz().focal_px)?;
        // The scatter of k₁ about that line, and the spread of the focal lengths, give the σ of the
        // slope as in a linear regression. The spread is half of how far apart pairs are: one
        // camera of another focal length does not determine a slope.
        let root = (cameras.len() as f64).sqrt();
        let mut beside: Vec<f64> = by_focal
            .iter()
            .map(|[focal_px, k1]| k1 - steepest * (focal_px - at_focal_px))
            .collect();
        let (_, scatter) = middle_and_sigma(&mut beside)?;
        let k1_sigma = scatter.max(K1_DIGITS) * 1.25 / root;
        let spread_px = median(&mut apart_px)? / 2.0;
        let prior = SLOPE_BY_LOG_FOCAL / at_focal_px;
        let (per_px, per_px_sigma) = shrink(steepest, k1_sigma / spread_px, prior);
        // The value at the median focal length, by the median of all k₁ moved there along the
        // slope.
        let value = median_of(cameras, |camera| {
            camera.k1() - per_px * (camera.ptz().focal_px - at_focal_px)
        })?;
        let (value, k1_sigma) = shrink(value, k1_sigma, K1_SIGMA);
        Some(Self {
            curve: FocalCurve {
                at_focal_px,
                value,
                per_1000_px: 1000.0 * per_px,
                k2_per_k1_squared: k2_per_k1_squared(cameras),
                pixel_aspect: median_of(cameras, |camera| camera.lens().pixel_aspect)?,
            },
            k1_sigma,
            per_1000_px_sigma: 1000.0 * per_px_sigma,
        })
    }

    /// The 1-σ of a base's lens. Cameras that state none are those of a lens without distortion.
    fn sigma(&self) -> BaseSigma {
        if self.curve.value == 0.0 && self.curve.per_1000_px == 0.0 {
            return BaseSigma::default();
        }
        BaseSigma {
            k1: self.k1_sigma,
            k1_per_1000_px: self.per_1000_px_sigma,
            ..BaseSigma::default()
        }
    }
}

/// A measured number and its σ, given that it is 0 ± `prior`. A number of infinite σ, or none, is
/// that of the prior.
fn shrink(measured: f64, sigma: f64, prior: f64) -> (f64, f64) {
    if !(sigma.is_finite() && measured.is_finite()) {
        return (0.0, prior);
    }
    let share = prior.powi(2) / (prior.powi(2) + sigma.powi(2));
    (share * measured, share.sqrt() * sigma)
}

/// The ratio of k₂ to k₁²: the slope of the line through the origin with the least sum of absolute
/// deviations, which is the median of the ratios weighted by k₁².
fn k2_per_k1_squared(cameras: &[&PtzCamera]) -> f64 {
    let mut ratios: Vec<[f64; 2]> = cameras
        .iter()
        .map(|camera| [camera.lens().k2 / camera.k1().powi(2), camera.k1().powi(2)])
        .filter(|[ratio, _]| ratio.is_finite())
        .collect();
    ratios.sort_by(|one, other| one[0].total_cmp(&other[0]));
    let half = ratios.iter().map(|[_, weight]| weight).sum::<f64>() / 2.0;
    let mut below = 0.0;
    let middle = ratios.iter().find(|[_, weight]| {
        below += weight;
        below >= half
    });
    let Some([ratio, _]) = middle else {
        return 0.0;
    };
    let mut beside: Vec<f64> = cameras
        .iter()
        .map(|camera| (camera.lens().k2 - ratio * camera.k1().powi(2)).abs())
        .collect();
    let scatter = SIGMA_OVER_MAD * median(&mut beside).unwrap_or(0.0);
    let squares = cameras.iter().map(|camera| camera.k1().powi(4));
    let sigma = scatter.max(K1_DIGITS) / squares.sum::<f64>().sqrt();
    shrink(*ratio, sigma, K2_RATIO_SIGMA).0
}

/// The direction upwards (`world`, of unit length) that is most nearly perpendicular to the x axes
/// of all cameras, by iteratively reweighted least squares.
fn pan_axis(cameras: &[&PtzCamera]) -> Option<Vec3> {
    let rights: Vec<Vec3> = cameras
        .iter()
        .map(|camera| camera.cam_from_world().row(0).transpose())
        .collect();
    let level = Angle::from_degrees(LEVEL_DEG).radians();
    let mut axis = Vec3::z();
    for _ in 0..ROUNDS {
        let mut off: Vec<f64> = rights.iter().map(|right| right.dot(&axis).abs()).collect();
        // Rotations that agree to the last digit would have no scale.
        let sigma = (SIGMA_OVER_MAD * median(&mut off)?).max(1e-6);
        // Normal equations of x · (u, v, 1) = 0 with Cauchy weights, and of u = v = 0 ± `level`.
        let mut normal = Matrix2::identity() / level.powi(2);
        let mut gradient = Vector2::zeros();
        for right in &rights {
            let weight = 1.0 / (sigma.powi(2) + right.dot(&axis).powi(2));
            let across = Vector2::new(right.x, right.y);
            normal += across * across.transpose() * weight;
            gradient -= across * (right.z * weight);
        }
        let tilted = normal.cholesky()?.solve(&gradient);
        axis = Vec3::new(tilted.x, tilted.y, 1.0).normalize();
    }
    Some(axis)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::camera::{BaseAngles, Ptz};
    use crate::testing::{SIZE, TestBase, base_at, turned_base};
    use rand::{RngExt as _, SeedableRng as _};
    use rand_distr::StandardNormal;
    use rand_pcg::Pcg64Mcg;

    const PLACE: Vec3 = Vec3::new(1.56, -74.03, 17.67);

    /// `count` cameras of a base at `place_m` that leans by 0.8°, each with errors of its own.
    fn scattered(place_m: Vec3, count: usize, noise: &mut Pcg64Mcg) -> Vec<PtzCamera> {
        let lean = BaseAngles {
            roll: Angle::from_degrees(0.8),
            ..BaseAngles::default()
        };
        let mut normal = || noise.sample::<f64, _>(StandardNormal);
        let mut one = |index: usize| {
            let step = index as f64 / count as f64;
            let ptz = Ptz::from_degrees(
                60.0 * step - 30.0 + 0.5 * normal(),
                -12.0 + 0.5 * normal(),
                3000.0 * (1.0 + 0.02 * normal()),
            );
            let off_m = Vec3::new(0.3 * normal(), 0.6 * normal(), 0.3 * normal());
            let roll = BaseAngles {
                roll: lean.roll + Angle::from_degrees(0.5 * normal()),
                ..lean
            };
            let base = CameraBase::new(
                place_m + off_m,
                roll.base_from_world(),
                ImagePoint::new(960.0, 540.0),
            );
            PtzCamera::new(base, ptz)
        };
        (0..count).map(&mut one).collect()
    }

    /// A camera under the ground, or a kilometre away.
    fn absurd(index: usize) -> PtzCamera {
        let far = 150.0 * (index as f64 + 1.0);
        base_at([far, -far, -3.0], SIZE).aim(0.0, -10.0, 3e6)
    }

    #[test]
    fn one_place_is_found_among_absurd_cameras() {
        let mut noise = Pcg64Mcg::seed_from_u64(3);
        let mut cameras = scattered(PLACE, 200, &mut noise);
        cameras.extend((0..20).map(absurd));
        let places = shared_places(&cameras);
        assert_eq!(places.len(), 1);
        let off_m = places[0].base.position_m - PLACE;
        assert!(off_m.norm() < 0.2, "{off_m}");
        assert!(places[0].members.len() > 190 && places[0].members.last() < Some(&200));
        // The roll of the base, known to 0.5° / √200 but for the prior.
        let roll = places[0].base.angles().roll.degrees();
        assert!((roll - 0.8).abs() < 0.3, "{roll}");
        let sigma_m = places[0].scatter_m;
        assert!(
            (sigma_m - Vec3::new(0.3, 0.6, 0.3)).amax() < 0.15,
            "{sigma_m}"
        );
    }

    #[test]
    fn two_cameras_of_one_video_are_two_places_the_more_frequent_first() {
        let mut noise = Pcg64Mcg::seed_from_u64(4);
        let beside = PLACE + Vec3::new(-36.0, 4.0, 1.0);
        let mut cameras = scattered(beside, 60, &mut noise);
        cameras.extend(scattered(PLACE, 140, &mut noise));
        let places = shared_places(&cameras);
        let at: Vec<f64> = places.iter().map(|place| place.base.position_m.x).collect();
        assert_eq!(at.len(), 2, "{at:?}");
        assert!(
            (at[0] - 1.56).abs() < 0.2 && (at[1] + 34.44).abs() < 0.2,
            "{at:?}"
        );
    }

    #[test]
    fn exact_cameras_give_their_exact_base() {
        let base = turned_base(PLACE, [0.0, -0.3, 0.2], SIZE);
        let at = |pan| base.aim(pan, -11.0, 2800.0);
        let cameras: Vec<PtzCamera> = (-20..=20).map(|pan| at(f64::from(pan))).collect();
        let places = shared_places(&cameras);
        let found = &places[0].base;
        assert!((found.position_m - PLACE).amax() < 1e-12);
        // The pan axis is the y axis of the base; about it the gauge decides.
        let [axis, exact] = [found, &base].map(|base| base.base_from_world.row(1).into_owned());
        assert!((axis - exact).amax() < 1e-9, "{axis} {exact}");
    }

    #[test]
    fn a_lens_that_follows_the_focal_length_is_shared_too() {
        let lens = FocalCurve {
            at_focal_px: 2000.0,
            value: -0.02,
            per_1000_px: 0.2,
            k2_per_k1_squared: 2.0,
            ..FocalCurve::NONE
        };
        let base = CameraBase {
            distortion: lens,
            ..base_at(PLACE, SIZE)
        };
        let at = |step: i32| {
            let ptz = Ptz::from_degrees(f64::from(step), -11.0, 2500.0 + 40.0 * f64::from(step));
            PtzCamera::new(base, ptz)
        };
        let mut cameras: Vec<PtzCamera> = (-20..=20).map(at).collect();
        cameras.push(absurd(3));
        let found = shared_places(&cameras)[0].base.distortion;
        for focal_px in [1700.0, 2500.0, 3300.0] {
            let (found, exact) = (found.radial_at(focal_px), lens.radial_at(focal_px));
            assert!((found.k1 - exact.k1).abs() < 1e-12, "{found:?} {exact:?}");
            assert!((found.k2 - exact.k2).abs() < 1e-12, "{found:?} {exact:?}");
        }
    }

    #[test]
    fn noise_of_k1_gives_no_lens_that_follows_a_resting_focal_length() {
        for seed in 1..=4 {
            for focal_noise_px in [0.0, 0.3, 3.0, 30.0] {
                let mut noise = Pcg64Mcg::seed_from_u64(seed);
                let mut normal = || noise.sample::<f64, _>(StandardNormal);
                let mut one = |step: i32| {
                    let lens = FocalCurve {
                        k2_per_k1_squared: 0.01 * normal() / 0.1f64.powi(2),
                        ..FocalCurve::constant(0.1 + 0.01 * normal())
                    };
                    let base = CameraBase {
                        distortion: lens,
                        ..base_at(PLACE, SIZE)
                    };
                    let focal_px = 3000.0 + focal_noise_px * normal();
                    base.aim(f64::from(step) / 5.0, -11.0, focal_px)
                };
                let mut cameras: Vec<PtzCamera> = (-50..50).map(&mut one).collect();
                // One camera of another focal length is no line.
                let mut far = one(3);
                far = far.base().aim(0.0, -11.0, 5000.0);
                cameras.push(far);
                let base = shared_places(&cameras)[0].base;
                let lens = base.distortion;
                let context = format!("seed {seed}, f ± {focal_noise_px} px: {lens:?}");
                assert!(lens.per_1000_px.abs() < 0.1, "{context}");
                assert!((lens.value - 0.1).abs() < 0.005, "{context}");
                assert!(lens.k2_per_k1_squared.abs() < 1.0, "{context}");
                // What is not known of the slope is stated.
                let sigma = base.sigma.k1_per_1000_px;
                assert!(lens.per_1000_px.abs() < 3.0 * sigma, "{context} ± {sigma}");
                assert!(
                    (0.01..0.1).contains(&sigma) || focal_noise_px > 3.0,
                    "{context} ± {sigma}"
                );
            }
        }
    }

    #[test]
    fn an_error_in_common_is_in_the_sigma_of_a_place_however_many_cameras_share_it() {
        let mut noise = Pcg64Mcg::seed_from_u64(6);
        let sigma = shared_places(&scattered(PLACE, 400, &mut noise))[0]
            .base
            .sigma;
        assert!(sigma.position_m.min() >= 0.5, "{sigma:?}");
        assert!(sigma.position_m.max() < 0.6, "{sigma:?}");
        let lean_deg = sigma.rotation.map(f64::to_degrees);
        assert!(lean_deg.xy().min() >= 0.499, "{lean_deg}");
        assert_eq!(lean_deg.z, 0.0, "about the pan axis the gauge decides");
    }

    #[test]
    fn cameras_that_agree_on_nothing_share_no_place() {
        let cameras: Vec<PtzCamera> = (0..20).map(absurd).collect();
        assert!(shared_places(&cameras).is_empty());
        assert!(shared_places(&[]).is_empty());
        assert!(shared_places(&cameras[..2]).is_empty());
    }
}
