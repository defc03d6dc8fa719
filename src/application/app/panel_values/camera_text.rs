//! A frame's camera as text for use in other programs: JSON with all digits. Pixels follow the
//! document's convention: (0, 0) is the top-left corner of the top-left pixel. OpenCV has (0, 0) at
//! the centre of that pixel, so its coordinates are smaller by 0.5.

use serde_json::{Value, json};
use touchline_core::camera::PtzCamera;
use touchline_core::geometry::{Mat3, Vec3};

/// What can be copied of a camera.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum CameraText {
    /// Pan, tilt and focal length.
    Ptz,
    /// Intrinsics, rotation and translation.
    KRt,
    /// Homography from the ground plane (m) to the picture (px), without lens distortion.
    Homography,
    /// Projection matrix, 3 × 4, without lens distortion.
    Projection,
}

impl CameraText {
    /// All texts, in the order of the buttons.
    pub const ALL: [Self; 4] = [Self::Ptz, Self::KRt, Self::Homography, Self::Projection];

    /// The label of the button.
    pub const fn label(self) -> &'static str {
        match self {
            Self::Ptz => "Pan, tilt, focal",
            Self::KRt => "K, R, t",
            Self::Homography => "Homography",
            Self::Projection => "3 × 4 matrix",
        }
    }

    /// The tooltip, with frame and unit.
    pub const fn about(self) -> &'static str {
        match self {
            Self::Ptz => "Copy pan and tilt in degrees and the focal length in px, as JSON.",
            Self::KRt => {
                "Copy K (px), R = cam_from_world (rows) and t (m) as JSON: x_cam = R x_world + t. The world's origin is the field's \
                 centre, x along its length, y away from the main camera, z up; the camera looks along z, y down."
            }
            Self::Homography => {
                "Copy image_from_field (rows) as JSON: pixels from metres on the ground plane, without the lens's distortion. Without \
                 the field's crown."
            }
            Self::Projection => {
                "Copy K [R t] (rows) as JSON: pixels from metres in the world, without the lens's distortion."
            }
        }
    }

    /// The text for a camera.
    pub fn format(self, camera: &PtzCamera) -> String {
        let ptz = camera.ptz();
        // x_cam = R (x_world − C): the image of the origin is t = −R C.
        let translation_m = camera.cam_from_world_point(Vec3::zeros());
        let axis = |unit: Vec3| camera.cam_from_world_point(unit) - translation_m;
        // The columns of the rotation are the axes of the world in the camera's frame.
        let rotation = Mat3::from_columns(&[axis(Vec3::x()), axis(Vec3::y()), axis(Vec3::z())]);
        let k = camera.calibration_matrix();
        let value = match self {
            Self::Ptz => json!({
                "pan_deg": ptz.pan.degrees(), "tilt_deg": ptz.tilt.degrees(), "focal_px": ptz.focal_px,
            }),
            Self::KRt => json!({
                "K": rows(&k), "R": rows(&rotation), "t_m": [translation_m.x, translation_m.y, translation_m.z],
                "k1": camera.lens().k1, "k2": camera.lens().k2,
            }),
            Self::Homography => {
                // Points on the ground have z = 0, so K [r₁ r₂ t] maps (x, y, 1) to the picture.
                let plane = Mat3::from_columns(&[
                    rotation.column(0).into(),
                    rotation.column(1).into(),
                    translation_m,
                ]);
                rows(&(k * plane))
            }
            Self::Projection => {
                let (turned, moved) = (k * rotation, k * translation_m);
                let rows = [0, 1, 2].map(|row: usize| {
                    [
                        turned[(row, 0)],
                        turned[(row, 1)],
                        turned[(row, 2)],
                        moved[row],
                    ]
                });
                json!(rows)
            }
        };
        value.to_string()
    }
}

fn rows(matrix: &Mat3) -> Value {
    matrix
        .row_iter()
        .map(|row| json!([row[0], row[1], row[2]]))
        .collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use touchline_core::testing::{HD, TestBase, turned_base};

    fn camera() -> PtzCamera {
        turned_base([1.0, -60.0, 18.0], [0.0, -2.0, 0.0], HD).aim(7.0, -9.5, 2100.0)
    }

    #[test]
    fn what_is_copied_projects_as_the_camera_does() {
        let camera = camera();
        let homography: [[f64; 3]; 3] =
            serde_json::from_str(&CameraText::Homography.format(&camera)).unwrap();
        let matrix: [[f64; 4]; 3] =
            serde_json::from_str(&CameraText::Projection.format(&camera)).unwrap();
        for point in [Vec3::new(3.0, 4.0, 0.0), Vec3::new(11.0, -20.0, 0.0)] {
            let there = camera.image_from_world(point).unwrap();
            let from_plane = homography.map(|row| row[0] * point.x + row[1] * point.y + row[2]);
            let from_world =
                matrix.map(|row| row[0] * point.x + row[1] * point.y + row[2] * point.z + row[3]);
            for [x, y, w] in [from_plane, from_world] {
                assert!(
                    (x / w - there.x).abs() < 1e-6 && (y / w - there.y).abs() < 1e-6,
                    "{x} {y} {w} {there:?}"
                );
            }
        }
        let ptz: Value = serde_json::from_str(&CameraText::Ptz.format(&camera)).unwrap();
        assert!((ptz["pan_deg"].as_f64().unwrap() - 7.0).abs() < 1e-9);
        let parts: Value = serde_json::from_str(&CameraText::KRt.format(&camera)).unwrap();
        assert_eq!(
            (parts["K"][0][0].as_f64(), parts["K"][1][2].as_f64()),
            (Some(2100.0), Some(360.0))
        );
    }
}
