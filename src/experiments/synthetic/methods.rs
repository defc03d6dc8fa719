//! The estimators that are compared, and the Cramér–Rao bound.

use super::collected::Errors;
use crate::setting::Correspondence;
use touchline_core::camera::{CameraBase, PanTilt, Ptz, PtzCamera};
use touchline_core::geometry::{Angle, Mat3, Vec2, Vec3};
use touchline_core::solve::{Loss, Observation, refine, solve_two_points};

/// Number of points and of iterations of the authors' refinement.
const AUTHORS_POINTS: usize = 32;
const AUTHORS_ROUNDS: usize = 10;

/// The two points that are farthest apart in the picture.
pub fn farthest_pair(seen: &[Correspondence]) -> [Correspondence; 2] {
    let mut best = (0.0, [0, 0]);
    for (i, one) in seen.iter().enumerate() {
        for (j, two) in seen.iter().enumerate().skip(i + 1) {
            let distance = one.image.distance_px(two.image);
            if distance > best.0 {
                best = (distance, [i, j]);
            }
        }
    }
    best.1.map(|index| seen[index])
}

/// This program's closed-form solution. Of two focal lengths, the one nearer to 2700 px, about the
/// middle of the setting's range.
pub fn two_points(base: &CameraBase, [one, two]: [Correspondence; 2]) -> Option<Ptz> {
    let found = solve_two_points(base, [one.world, two.world], [one.image, two.image]).ok()?;
    let off = |ptz: &Ptz| (ptz.focal_px / 2700.0).ln().abs();
    found.iter().min_by(|a, b| off(a).total_cmp(&off(b)))
}

/// The closed form of the authors' program, with its two approximations: the cosine of the angle
/// between two rays is taken as cos Δpan · cos Δtilt, and x depends on pan alone, y on tilt alone
/// (eq. 2 of the paper).
pub fn two_points_approximate(
    base: &CameraBase,
    correspondences: [Correspondence; 2],
) -> Option<Ptz> {
    let rays = correspondences.map(|correspondence| {
        PanTilt::from_direction(base.base_from_world_point(correspondence.world))
    });
    let pixels = correspondences
        .map(|correspondence| correspondence.image.offset_from(base.principal_point));
    let cosine =
        (rays[0].pan - rays[1].pan).radians().cos() * (rays[0].tilt - rays[1].tilt).radians().cos();
    let (a, b, c) = (
        pixels[0].norm_squared(),
        pixels[1].norm_squared(),
        pixels[0].dot(&pixels[1]),
    );
    // (c + s)² = d² (a + s)(b + s) with s = f².
    let d2 = cosine * cosine;
    let (q2, q1, q0) = (1.0 - d2, 2.0 * c - d2 * (a + b), c * c - d2 * a * b);
    let root = (q1 * q1 - 4.0 * q2 * q0).max(0.0).sqrt();
    let roots = [(-q1 + root) / (2.0 * q2), (-q1 - root) / (2.0 * q2)];
    let valid = roots
        .into_iter()
        .filter(|s| *s > 0.0 && (c + s) * cosine > 0.0)
        .map(f64::sqrt);
    let off = |focal_px: &f64| (focal_px / 2700.0).ln().abs();
    let focal_px = valid.min_by(|a, b| off(a).total_cmp(&off(b)))?;
    let pan = rays[0].pan - Angle::from_radians((pixels[0].x / focal_px).atan());
    let tilt = rays[0].tilt + Angle::from_radians((pixels[0].y / focal_px).atan());
    Some(Ptz {
        pan,
        tilt,
        focal_px,
    })
}

/// Least-squares refinement over all points with the exact projection.
pub fn refined(base: &CameraBase, start: Ptz, seen: &[Correspondence]) -> Ptz {
    let observations: Vec<Observation> = seen
        .iter()
        .enumerate()
        .map(|(click, correspondence)| {
            Observation::of_point(correspondence.world, correspondence.image, 1.0, click)
        })
        .collect();
    refine(base, start, &observations, Loss::Squared, None).ptz
}

/// The refinement of the authors' program: Gauss–Newton over a sample of the points, with the
/// approximate projection in which x depends on pan alone and y on tilt alone (eq. 2 of the paper).
pub fn refined_approximate(base: &CameraBase, start: Ptz, seen: &[Correspondence]) -> Ptz {
    let stride = (seen.len() / AUTHORS_POINTS).max(1);
    let points: Vec<(PanTilt, Vec2)> = seen
        .iter()
        .step_by(stride)
        .take(AUTHORS_POINTS)
        .map(|correspondence| {
            let ray = PanTilt::from_direction(base.base_from_world_point(correspondence.world));
            (ray, correspondence.image.offset_from(base.principal_point))
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
            let by_x = Vec3::new(-focal_px * (1.0 + pan * pan), 0.0, pan);
            let by_y = Vec3::new(0.0, focal_px * (1.0 + tilt * tilt), -tilt);
            information += by_x * by_x.transpose() + by_y * by_y.transpose();
            towards += by_x * (pixel.x - focal_px * pan) + by_y * (pixel.y + focal_px * tilt);
        }
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
/// covariance is σ² (JᵀJ)⁻¹ at the true camera.
pub fn bound(camera: &PtzCamera, seen: &[Correspondence], sigma_px: f64) -> Errors {
    let jacobians = seen
        .iter()
        .filter_map(|correspondence| camera.image_from_world_jacobian(correspondence.world).ok());
    let information: Mat3 = jacobians
        .map(|here| here.by_ptz.transpose() * here.by_ptz)
        .sum();
    let covariance = information.try_inverse().unwrap_or_else(Mat3::zeros) * (sigma_px * sigma_px);
    // The rotation error is a normal vector of two components, pan and tilt. Its mean length is
    // √(π/2) times the mean of √(uᵀ Σ u) over all directions u.
    let directions = 64;
    let mean_length: f64 = (0..directions)
        .map(|i| {
            let (sin, cos) =
                (std::f64::consts::PI * f64::from(i) / f64::from(directions)).sin_cos();
            let along = covariance[(0, 0)] * cos * cos
                + 2.0 * covariance[(0, 1)] * sin * cos
                + covariance[(1, 1)] * sin * sin;
            along.sqrt()
        })
        .sum::<f64>()
        / f64::from(directions);
    Errors {
        // With the true base, the rotation error consists of pan and tilt alone.
        pan_tilt_deg: (std::f64::consts::FRAC_PI_2.sqrt() * mean_length).to_degrees(),
        rotation_deg: (std::f64::consts::FRAC_PI_2.sqrt() * mean_length).to_degrees(),
        focal_px: (covariance[(2, 2)] * std::f64::consts::FRAC_2_PI).sqrt(),
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::setting::{base, correspondences, drawn_ptz, rng};

    #[test]
    fn without_noise_the_exact_form_is_exact_and_the_authors_is_not() {
        let mut worst = [0.0f64; 3];
        for index in 0..8 {
            let mut rng = rng(5, [1, index]);
            let camera = PtzCamera::new(base(), drawn_ptz(&mut rng));
            let seen = correspondences(&camera, &mut rng);
            let pair = farthest_pair(&seen);
            let errors = |ptz: Ptz| Errors::of(&camera, &PtzCamera::new(*camera.base(), ptz));
            let authors = two_points_approximate(camera.base(), pair).unwrap();
            worst[0] = worst[0].max(errors(two_points(camera.base(), pair).unwrap()).focal_px);
            worst[1] = worst[1].max(errors(authors).focal_px);
            worst[2] =
                worst[2].max(errors(refined_approximate(camera.base(), authors, &seen)).focal_px);
        }
        assert!(worst[0] < 1e-6, "{worst:?}");
        assert!(worst[1] > 5.0 && worst[2] > 1.0, "{worst:?}");
    }

    #[test]
    fn the_authors_refinement_is_exact_where_their_model_is() {
        // On the horizon x depends on pan alone, and in the middle column y on tilt alone.
        let camera = PtzCamera::new(base(), Ptz::from_degrees(40.0, 0.0, 2500.0));
        let offsets = [
            (-400.0, 0.0),
            (300.0, 0.0),
            (0.0, -200.0),
            (0.0, 250.0),
            (150.0, 0.0),
        ];
        let seen: Vec<Correspondence> = offsets
            .iter()
            .map(|(x, y)| {
                let image = camera.base().principal_point.moved(Vec2::new(*x, *y));
                let world = camera.base().position_m
                    + camera.world_direction_from_image(image).unwrap() * 80.0;
                Correspondence {
                    image,
                    world,
                    on_field: false,
                }
            })
            .collect();
        let start = Ptz::from_degrees(40.5, -0.4, 2400.0);
        let found = refined_approximate(camera.base(), start, &seen);
        let errors = Errors::of(&camera, &PtzCamera::new(*camera.base(), found));
        assert!(
            errors.rotation_deg < 1e-9 && errors.focal_px < 1e-6,
            "{errors:?}"
        );
    }
}
