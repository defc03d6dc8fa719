//! Rotations as 3×3 matrices, and their derivatives.

use super::{Angle, Mat3, Vec3};

/// The maximum distance of a matrix from a rotation ([`distance_from_rotation`]) at which it is
/// orthogonalised instead of rejected.
#[doc(hidden)]
pub const ROTATION_TOLERANCE: f64 = 1e-3;

/// The cross-product matrix: `skew(a) * b = a × b`.
#[doc(hidden)]
pub fn skew(a: Vec3) -> Mat3 {
    Mat3::new(0.0, -a.z, a.y, a.z, 0.0, -a.x, -a.y, a.x, 0.0)
}

/// The rotation by `|w|` radians about `w` (Rodrigues).
#[doc(hidden)]
pub fn from_rotation_vector(w: Vec3) -> Mat3 {
    *nalgebra::Rotation3::from_scaled_axis(w).matrix()
}

/// The rotation vector of a rotation matrix, radians. Accurate for all angles: at 0 (where the arc
/// cosine of the trace may be NaN by rounding) and at π (where the sine vanishes and the axis is
/// taken from the symmetric part).
#[doc(hidden)]
pub fn rotation_vector(rotation: &Mat3) -> Vec3 {
    let r = rotation;
    // R − Rᵀ = 2 sin θ [a]ₓ and tr R = 1 + 2 cos θ.
    let sine_axis = Vec3::new(
        r[(2, 1)] - r[(1, 2)],
        r[(0, 2)] - r[(2, 0)],
        r[(1, 0)] - r[(0, 1)],
    ) * 0.5;
    let sine = sine_axis.norm();
    let cosine = 0.5 * (r.trace() - 1.0);
    let angle = sine.atan2(cosine);
    if cosine > -0.9 {
        return if sine > 0.0 {
            sine_axis * (angle / sine)
        } else {
            Vec3::zeros()
        };
    }
    // R + Rᵀ = 2 cos θ + 2 (1 − cos θ) a aᵀ: its longest column is along the axis.
    let outer = (r + r.transpose()) * 0.5 - Mat3::identity() * cosine;
    let longest =
        (0..3)
            .map(|i| Vec3::from(outer.column(i)))
            .fold(Vec3::zeros(), |longest, column| {
                if column.norm_squared() > longest.norm_squared() {
                    column
                } else {
                    longest
                }
            });
    let axis = longest.normalize();
    axis * if axis.dot(&sine_axis) < 0.0 {
        -angle
    } else {
        angle
    }
}

/// The angle between two rotations.
#[doc(hidden)]
pub fn angle_between(a: &Mat3, b: &Mat3) -> Angle {
    // Twice the sine and twice the cosine of the angle of a bᵀ, as in `rotation_vector`; the factor
    // cancels in the arc tangent.
    let difference = a * b.transpose();
    let sine = Vec3::new(
        difference[(2, 1)] - difference[(1, 2)],
        difference[(0, 2)] - difference[(2, 0)],
        difference[(1, 0)] - difference[(0, 1)],
    )
    .norm();
    Angle::from_radians(sine.atan2(difference.trace() - 1.0))
}

/// The angle between two directions of any length but zero; exact for small angles, where an arc
/// cosine is not.
pub(crate) fn angle_between_directions(a: &Vec3, b: &Vec3) -> Angle {
    Angle::from_radians(a.cross(b).norm().atan2(a.dot(b)))
}

/// The distance of a matrix from a rotation: the largest absolute entry of `RᵀR` − I, or infinity
/// for a reflection or NaN.
#[doc(hidden)]
pub fn distance_from_rotation(matrix: &Mat3) -> f64 {
    if !matrix.iter().all(|x| x.is_finite()) || matrix.determinant() <= 0.0 {
        return f64::INFINITY;
    }
    (matrix.transpose() * matrix - Mat3::identity()).amax()
}

/// The rotation nearest to a matrix (orthogonal Procrustes).
#[doc(hidden)]
pub fn nearest_rotation(matrix: &Mat3) -> Mat3 {
    // Both factors are there because both are requested.
    let svd = matrix.svd(true, true);
    let (Some(u), Some(v_t)) = (svd.u, svd.v_t) else {
        return Mat3::identity();
    };
    // Of the orthogonal matrices U D Vᵀ nearest to the matrix, the one with determinant +1 flips
    // the direction of the smallest singular value (Kabsch 1976), which nalgebra sorts last.
    let sign = (u * v_t).determinant().signum();
    u * Mat3::from_diagonal(&Vec3::new(1.0, 1.0, sign)) * v_t
}

/// `Q_pan(θ)` of the conventions: from `base` to the panned frame (about the base's y axis).
#[doc(hidden)]
pub fn q_pan(pan: Angle) -> Mat3 {
    let (s, c) = pan.sin_cos();
    Mat3::new(c, 0.0, -s, 0.0, 1.0, 0.0, s, 0.0, c)
}

/// `Q_tilt(φ)` of the conventions: from the panned frame to `cam` (about the camera's x axis).
#[doc(hidden)]
pub fn q_tilt(tilt: Angle) -> Mat3 {
    let (s, c) = tilt.sin_cos();
    Mat3::new(1.0, 0.0, 0.0, 0.0, c, s, 0.0, -s, c)
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::f64::consts::PI;

    #[test]
    fn a_rotation_vector_survives_the_round_trip() {
        let w = Vec3::new(0.3, -1.1, 0.7);
        assert!((rotation_vector(&from_rotation_vector(w)) - w).norm() < 1e-12);
        for angle in [0.0, 1e-12, 1e-6, 0.3, 2.0, 3.0, PI - 1e-6, PI] {
            for axis in [
                Vec3::x(),
                -Vec3::y(),
                w.normalize(),
                Vec3::new(-1.0, 1e-3, 0.0).normalize(),
            ] {
                let again = rotation_vector(&from_rotation_vector(axis * angle));
                // A rotation by π about an axis equals that about the opposite axis.
                let opposite = if angle > PI - 1e-5 {
                    (again + axis * angle).norm()
                } else {
                    f64::INFINITY
                };
                let error = (again - axis * angle).norm().min(opposite);
                assert!(error < 1e-7, "{angle} about {axis:?}: {again:?}");
            }
        }
        assert_eq!(
            rotation_vector(&(Mat3::identity() * (1.0 + 4.0 * f64::EPSILON))),
            Vec3::zeros()
        );
        assert!((skew(w) * Vec3::x() - w.cross(&Vec3::x())).norm() < 1e-15);
    }

    #[test]
    fn the_nearest_rotation_repairs_rounding_and_refuses_nothing_silently() {
        let rotation = q_tilt(Angle::from_degrees(-11.0)) * q_pan(Angle::from_degrees(40.0));
        let rounded = rotation.map(|x| (x * 1e4).round() / 1e4);
        assert!(distance_from_rotation(&rounded) < ROTATION_TOLERANCE);
        assert!(angle_between(&nearest_rotation(&rounded), &rotation).degrees() < 0.01);
        assert!(distance_from_rotation(&-rotation).is_infinite());
        assert!(distance_from_rotation(&(rotation * f64::NAN)).is_infinite());
    }

    #[test]
    fn positive_pan_looks_right_and_positive_tilt_looks_up() {
        let ahead = Vec3::z();
        let looking_right = q_pan(Angle::from_degrees(10.0)).transpose() * ahead;
        assert!(looking_right.x > 0.0, "base x is right");
        let looking_up = q_tilt(Angle::from_degrees(10.0)).transpose() * ahead;
        assert!(looking_up.y < 0.0, "base y is down");
    }
}
