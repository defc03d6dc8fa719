//! The estimators that are compared, and the Cramér–Rao bound.

use super::collected::Errors;
use crate::setting::Correspondence;
use touchline::camera::{CameraBase, PanTilt, Ptz, PtzCamera};
use touchline::geometry::{Angle, Mat3, Vec2, Vec3};
use touchline::solve::{Loss, Observation, refine, solve_two_points};

/// Number of points that the authors' program refines with, and of its iterations.
pub const AUTHORS_POINTS: usize = 32;
const AUTHORS_ROUNDS: usize = 10;

/// The two points that are farthest apart in the picture.
pub fn farthest_pair(seen: &[Correspondence]) -> [Correspondence; 2] {
    let mut best = (0.0, [0, 0]);
    for (i, one) in seen.iter().enumerate() {
        // All pairs: 200 points have 19 900.
        for (j, two) in seen.iter().enumerate().skip(i + 1) {
            let distance = one.image.distance_px(two.image);
            if distance > best.0 {
                best = (distance, [i, j]);
            }
        }
    }
    best.1.map(|index| seen[index])
}

/// About the geometric mean of the setting's range of focal lengths. Where two points allow two
/// focal lengths, the one nearer to it is taken.
const USUAL_FOCAL_PX: f64 = 2700.0;

/// How far a focal length is from the usual one, as a logarithm.
fn distance_from_usual(focal_px: f64) -> f64 {
    (focal_px / USUAL_FOCAL_PX).ln().abs()
}

/// This program's closed-form solution.
pub fn solve_pair_exactly(base: &CameraBase, [one, two]: [Correspondence; 2]) -> Option<Ptz> {
    let found = solve_two_points(base, [one.world, two.world], [one.image, two.image]).ok()?;
    let distance = |ptz: &Ptz| distance_from_usual(ptz.focal_px);
    found
        .iter()
        .min_by(|a, b| distance(a).total_cmp(&distance(b)))
}

/// The ray of a correspondence's world point, as pan and tilt in `base`.
fn ray_in_base(base: &CameraBase, seen: &Correspondence) -> PanTilt {
    PanTilt::from_direction(base.base_from_world_point(seen.world))
}

/// Where the paper's eq. 2 projects a ray, as an offset from the principal point, px:
/// x = f tan Δpan, y = −f tan Δtilt. The exact projection has x depend on tilt and y on pan as
/// well.
fn project_by_eq_2(ray: PanTilt, ptz: &Ptz) -> Vec2 {
    let (pan, tilt) = (ray.pan - ptz.pan, ray.tilt - ptz.tilt);
    Vec2::new(pan.radians().tan(), -tilt.radians().tan()) * ptz.focal_px
}

/// Moves pixels from where the exact projection has them to where eq. 2 has them, and keeps their
/// noise, so that both models are compared with the same rays and the same noise.
pub fn reproject_by_eq_2(
    camera: &PtzCamera,
    seen: &[Correspondence],
    noisy: &[Correspondence],
) -> Vec<Correspondence> {
    let (base, ptz) = (camera.base(), camera.ptz());
    let reproject = |(seen, noisy): (&Correspondence, &Correspondence)| {
        let noise = noisy.image.offset_from(seen.image);
        let offset = project_by_eq_2(ray_in_base(base, seen), &ptz);
        Correspondence {
            image: base.principal_point.translate(offset + noise),
            ..*seen
        }
    };
    seen.iter().zip(noisy).map(reproject).collect()
}

/// The closed form of the authors' program, with its two approximations: the cosine of the angle
/// between two rays is taken as cos Δpan · cos Δtilt, and x depends on pan alone, y on tilt alone
/// (eq. 2 of the paper).
pub fn solve_pair_by_eq_2(base: &CameraBase, correspondences: [Correspondence; 2]) -> Option<Ptz> {
    let rays = correspondences.map(|correspondence| ray_in_base(base, &correspondence));
    let pixels = correspondences
        .map(|correspondence| correspondence.image.offset_from(base.principal_point));
    let cosine =
        (rays[0].pan - rays[1].pan).radians().cos() * (rays[0].tilt - rays[1].tilt).radians().cos();
    // The squared lengths of both pixels from the principal point, and their product. With s = f²
    // the angle between the two directions has the cosine (c + s) / √((a + s)(b + s)).
    let (a, b, c) = (
        pixels[0].norm_squared(),
        pixels[1].norm_squared(),
        pixels[0].dot(&pixels[1]),
    );
    // (c + s)² = d² (a + s)(b + s) with s = f².
    let d2 = cosine * cosine;
    let (q2, q1, q0) = (1.0 - d2, 2.0 * c - d2 * (a + b), c * c - d2 * a * b);
    // Noise may make the discriminant slightly negative where both roots coincide.
    let root = (q1 * q1 - 4.0 * q2 * q0).max(0.0).sqrt();
    let roots = [(-q1 + root) / (2.0 * q2), (-q1 - root) / (2.0 * q2)];
    let valid = roots
        .into_iter()
        // Squaring has added roots with the opposite sign of the cosine.
        .filter(|s| *s > 0.0 && (c + s) * cosine > 0.0)
        .map(f64::sqrt);
    let focal_px =
        valid.min_by(|a, b| distance_from_usual(*a).total_cmp(&distance_from_usual(*b)))?;
    // From the first point alone, by eq. 2 with the known focal length.
    let pan = rays[0].pan - Angle::from_radians((pixels[0].x / focal_px).atan());
    let tilt = rays[0].tilt + Angle::from_radians((pixels[0].y / focal_px).atan());
    Some(Ptz {
        pan,
        tilt,
        focal_px,
    })
}

/// Least-squares refinement over all points with the exact projection.
pub fn refine_exactly(base: &CameraBase, start: Ptz, seen: &[Correspondence]) -> Ptz {
    let observations: Vec<Observation> = seen
        .iter()
        .enumerate()
        .map(|(click, correspondence)| {
            // All pixels have the same noise, so that its size does not matter to the least
            // squares.
            Observation::from_point(correspondence.world, correspondence.image, 1.0, click)
        })
        .collect();
    refine(base, start, &observations, Loss::Squared, None).ptz
}

/// The refinement of the authors' program: Gauss–Newton over `points` of the points, evenly spaced
/// in their order, with the projection of eq. 2.
pub fn refine_by_eq_2(
    base: &CameraBase,
    start: Ptz,
    seen: &[Correspondence],
    points: usize,
) -> Ptz {
    // Evenly over the list of points.
    let stride = (seen.len() / points).max(1);
    let points: Vec<(PanTilt, Vec2)> = seen
        .iter()
        .step_by(stride)
        .take(points)
        .map(|correspondence| {
            let pixel = correspondence.image.offset_from(base.principal_point);
            (ray_in_base(base, correspondence), pixel)
        })
        .collect();
    let mut ptz = start;
    for _ in 0..AUTHORS_ROUNDS {
        let (mut information, mut towards) = (Mat3::zeros(), Vec3::zeros());
        for (ray, pixel) in &points {
            let (pan, tilt) = (
                (ray.pan - ptz.pan).radians().tan(),
                (ray.tilt - ptz.tilt).radians().tan(),
            );
            let focal_px = ptz.focal_px;
            // Projection: x = f tan Δpan, y = −f tan Δtilt.
            // The derivatives of x and y by pan, tilt and f: d tan u = (1 + tan² u) du.
            let by_x = Vec3::new(-focal_px * (1.0 + pan * pan), 0.0, pan);
            let by_y = Vec3::new(0.0, focal_px * (1.0 + tilt * tilt), -tilt);
            information += by_x * by_x.transpose() + by_y * by_y.transpose();
            towards += by_x * (pixel.x - focal_px * pan) + by_y * (pixel.y + focal_px * tilt);
        }
        // Too few points for three unknowns, or a step to no focal length: the last good camera
        // stays.
        let Some(step) = information.try_inverse().map(|inverse| inverse * towards) else {
            return ptz;
        };
        let next = Ptz {
            pan: ptz.pan + Angle::from_radians(step.x),
            tilt: ptz.tilt + Angle::from_radians(step.y),
            focal_px: ptz.focal_px + step.z,
        };
        if !(next.focal_px > 0.0) {
            return ptz;
        }
        ptz = next;
    }
    ptz
}

/// The Cramér–Rao bound: the smallest mean errors of an unbiased estimate with normal noise. The
/// covariance is σ² (JᵀJ)⁻¹ at the true camera. None where the points do not determine the camera.
pub fn cramer_rao_bound(
    camera: &PtzCamera,
    seen: &[Correspondence],
    sigma_px: f64,
) -> Option<Errors> {
    // A point behind the camera adds no information.
    let jacobians = seen
        .iter()
        .filter_map(|correspondence| camera.image_from_world_jacobian(correspondence.world).ok());
    let information: Mat3 = jacobians
        .map(|here| here.by_ptz.transpose() * here.by_ptz)
        .sum();
    let covariance = information.try_inverse()? * (sigma_px * sigma_px);
    // With the true base, the rotation error consists of pan and tilt alone, about axes at a right
    // angle. As numbers, pan is multiplied by the cosine of the tilt (`Errors`).
    Some(Errors {
        rotation_deg: mean_turn_deg(&covariance, 1.0),
        pan_tilt_deg: mean_turn_deg(&covariance, camera.ptz().tilt.radians().cos()),
        focal_px: (covariance[(2, 2)] * std::f64::consts::FRAC_2_PI).sqrt(),
    })
}

/// The mean length of the error of pan, times `pan_by`, and tilt, degrees: of a normal vector with
/// this covariance, radians.
fn mean_turn_deg(covariance: &Mat3, pan_by: f64) -> f64 {
    // The mean length of a normal vector of two components is √(π/2) times the mean of √(uᵀ Σ u)
    // over all directions u.
    // The mean over half a circle, for opposite directions have the same length. The function is
    // smooth and periodic, so that 64 samples give it to many digits.
    let directions = 64;
    let mean_length: f64 = (0..directions)
        .map(|i| {
            let (sin, cos) =
                (std::f64::consts::PI * f64::from(i) / f64::from(directions)).sin_cos();
            let by_pan = pan_by * cos;
            let along = covariance[(0, 0)] * by_pan * by_pan
                + 2.0 * covariance[(0, 1)] * sin * by_pan
                + covariance[(1, 1)] * sin * sin;
            along.sqrt()
        })
        .sum::<f64>()
        / f64::from(directions);
    (std::f64::consts::FRAC_PI_2.sqrt() * mean_length).to_degrees()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::setting::{base, correspondences, random_ptz, rng};

    #[test]
    fn without_noise_each_model_is_exact_on_its_own_points_only() {
        let mut worst = [0.0f64; 4];
        for index in 0..8 {
            let mut rng = rng(5, [1, index]);
            let camera = PtzCamera::new(base(), random_ptz(&mut rng));
            let seen = correspondences(&camera, &mut rng);
            let pair = farthest_pair(&seen);
            let base = camera.base();
            let focal_error =
                |ptz: Ptz| Errors::between(&camera, &PtzCamera::new(*base, ptz)).focal_px;
            let exact = solve_pair_exactly(base, pair).unwrap();
            let start = solve_pair_by_eq_2(base, pair).unwrap();
            let mixed = refine_by_eq_2(base, start, &seen, AUTHORS_POINTS);
            let moved = reproject_by_eq_2(&camera, &seen, &seen);
            let start_of_moved = solve_pair_by_eq_2(base, farthest_pair(&moved)).unwrap();
            let by_eq_2 = refine_by_eq_2(base, start_of_moved, &moved, AUTHORS_POINTS);
            for (worst, ptz) in worst.iter_mut().zip([exact, by_eq_2, start, mixed]) {
                *worst = worst.max(focal_error(ptz));
            }
        }
        assert!(worst[0] < 1e-6 && worst[1] < 1e-6, "{worst:?}");
        assert!(worst[2] > 5.0 && worst[3] > 1.0, "{worst:?}");
    }

    #[test]
    fn points_that_determine_no_camera_have_no_bound() {
        let camera = PtzCamera::new(base(), Ptz::from_degrees(40.0, -9.0, 2500.0));
        assert!(cramer_rao_bound(&camera, &[], 1.0).is_none());
    }

    /// On the horizon x depends on pan alone, and in the middle column y on tilt alone.
    const CROSS: [(f64, f64); 5] = [
        (-400.0, 0.0),
        (300.0, 0.0),
        (0.0, -200.0),
        (0.0, 250.0),
        (150.0, 0.0),
    ];

    /// What the camera shows at these offsets from the principal point, px.
    fn seen_at(camera: &PtzCamera, offsets: &[(f64, f64)]) -> Vec<Correspondence> {
        offsets
            .iter()
            .map(|(x, y)| {
                let image = camera.base().principal_point.translate(Vec2::new(*x, *y));
                let world = camera.base().position_m
                    + camera.world_direction_from_image(image).unwrap() * 80.0;
                Correspondence {
                    image,
                    world,
                    on_field: false,
                }
            })
            .collect()
    }

    #[test]
    fn in_the_bound_a_turn_of_pan_counts_less_where_the_camera_looks_down() {
        let [level, steep] = [0.0, -60.0].map(|tilt_deg| {
            let camera = PtzCamera::new(base(), Ptz::from_degrees(40.0, tilt_deg, 2500.0));
            cramer_rao_bound(&camera, &seen_at(&camera, &CROSS), 1.0).unwrap()
        });
        assert!((level.pan_tilt_deg / level.rotation_deg - 1.0).abs() < 1e-12);
        // The picture determines pan times its cosine, here 0.5, about as well as tilt.
        assert!(steep.pan_tilt_deg < 0.8 * steep.rotation_deg, "{steep:?}");
    }

    #[test]
    fn the_authors_refinement_is_exact_where_their_model_is() {
        let camera = PtzCamera::new(base(), Ptz::from_degrees(40.0, 0.0, 2500.0));
        let seen = seen_at(&camera, &CROSS);
        let start = Ptz::from_degrees(40.5, -0.4, 2400.0);
        let found = refine_by_eq_2(camera.base(), start, &seen, AUTHORS_POINTS);
        let errors = Errors::between(&camera, &PtzCamera::new(*camera.base(), found));
        assert!(
            errors.rotation_deg < 1e-9 && errors.focal_px < 1e-6,
            "{errors:?}"
        );
    }
}
