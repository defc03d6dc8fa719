//! The pan axis of a camera, from the x axes of its frames: it is perpendicular to all of them.

use nalgebra::SymmetricEigen;
use touchline_core::geometry::{Angle, Mat3, Vec3};

/// Typical tilt of cameras at a field; used where the frames leave it undetermined.
pub(super) const USUAL_TILT: Angle = Angle::from_degrees(-12.0);

/// Weight of the typical tilt, as the mean square of sin(pan): frames whose pans spread by more
/// than its root, 0.6°, determine the axis themselves.
const WEIGHT: f64 = 1e-4;

/// The rotation from the common frame to the one whose y axis is the pan axis, pointing down, and
/// whose z axis is the horizontal part of the mean viewing direction; `None` without frames.
pub(super) fn upright_from_common(cams_from_common: &[Mat3]) -> Option<Mat3> {
    // The sums of the frames' axes, in the common frame: their mean right, down and forward.
    let (right, down, forward) = (
        axis_sum(cams_from_common, 0).try_normalize(1e-9)?,
        axis_sum(cams_from_common, 1).try_normalize(1e-9)?,
        axis_sum(cams_from_common, 2),
    );
    // The axis minimises Σ (a · xᵢ)², where xᵢ is the x axis of frame i: the eigenvector of the
    // smallest eigenvalue of the mean of xᵢ xᵢᵀ.
    let mut scatter = Mat3::zeros();
    for turn in cams_from_common {
        let sideways = turn.row(0).transpose();
        scatter += sideways * sideways.transpose() / cams_from_common.len() as f64;
    }
    // If all frames have the same pan, every vector perpendicular to their x axis would do. A weak
    // term makes the axis perpendicular to the mean viewing direction levelled by the typical tilt.
    let (sin, cos) = USUAL_TILT.sin_cos();
    let level_forward = (right.cross(&down) * cos + down * sin).try_normalize(1e-9)?;
    scatter += level_forward * level_forward.transpose() * WEIGHT;
    let eigen = SymmetricEigen::new(scatter);
    let axis: Vec3 = eigen
        .eigenvectors
        .column(eigen.eigenvalues.imin())
        .into_owned();
    // An eigenvector has no sign; y points down.
    let axis = if axis.dot(&down) < 0.0 { -axis } else { axis };
    let ahead = (forward - axis * forward.dot(&axis)).try_normalize(1e-9)?;
    let sideways = axis.cross(&ahead);
    Some(Mat3::from_rows(&[
        sideways.transpose(),
        axis.transpose(),
        ahead.transpose(),
    ]))
}

/// The sum over all frames of one axis of the camera (0: x, 1: y, 2: z), in the common frame.
fn axis_sum(cams_from_common: &[Mat3], axis: usize) -> Vec3 {
    cams_from_common
        .iter()
        .map(|turn| turn.row(axis).transpose())
        .sum()
}

#[cfg(test)]
mod tests {
    use super::*;
    use touchline_core::geometry::rotation::{angle_between, from_rotation_vector, q_pan, q_tilt};

    fn cams(pans_deg: &[f64], common_from_upright: &Mat3) -> Vec<Mat3> {
        let tilts_deg = [-8.0, -14.0, -11.0, -16.0];
        let turn = |(pan, tilt): (&f64, &f64)| {
            q_tilt(Angle::from_degrees(*tilt))
                * q_pan(Angle::from_degrees(*pan))
                * common_from_upright.transpose()
        };
        pans_deg.iter().zip(&tilts_deg).map(turn).collect()
    }

    #[test]
    fn the_axis_is_found_whatever_frame_the_rotations_are_given_in() {
        let common_from_upright = from_rotation_vector(Vec3::new(0.4, -0.7, 0.2));
        let found =
            upright_from_common(&cams(&[-30.0, 12.0, 1.0, 25.0], &common_from_upright)).unwrap();
        let axis = found.row(1).transpose();
        assert!(axis.dot(&common_from_upright.column(1)) > 1.0 - 1e-7);
        assert!((found.determinant() - 1.0).abs() < 1e-12);
    }

    #[test]
    fn a_camera_that_does_not_pan_is_taken_to_look_down_as_usual() {
        let found = upright_from_common(&cams(&[5.0, 5.0, 5.0, 5.0], &Mat3::identity())).unwrap();
        // The tilts average 12.25 degrees down.
        assert!(
            angle_between(&found, &q_pan(Angle::from_degrees(5.0))).degrees() < 1.0,
            "{found}"
        );
        assert!(upright_from_common(&[]).is_none());
    }
}
