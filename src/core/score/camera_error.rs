//! Errors of a camera's parameters.

use crate::camera::{PanTilt, PtzCamera};
use crate::field::FieldModel;
use crate::geometry::rotation::angle_between;
use crate::geometry::{Angle, ImagePoint, ImageSize, Vec3};
use crate::markings::project_landmarks;
use serde::Serialize;

/// The errors of an estimated camera's parameters: estimate minus truth.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct CameraError {
    /// Angle between the two rotations from `world` to `cam`, never negative. It includes roll.
    #[serde(rename = "rotation_deg")]
    pub rotation: Angle,
    /// Error of the optical axis's pan. Both axes are expressed in the true camera's base, because
    /// the bases may differ.
    #[serde(rename = "pan_deg")]
    pub pan: Angle,
    /// Error of the optical axis's tilt, in the true camera's base.
    #[serde(rename = "tilt_deg")]
    pub tilt: Angle,
    /// Error of the focal length, px.
    pub focal_px: f64,
    /// Error of the focal length, per cent of the true one.
    pub focal_percent: f64,
    /// Distance between the centres of projection, m.
    pub position_m: f64,
}

/// Compares an estimated camera with the true one. Both must refer to pictures of the same size.
pub fn camera_error(truth: &PtzCamera, estimate: &PtzCamera) -> CameraError {
    // The optical axis of a camera in `world` is Rᵀ e_z. Both axes are expressed in the truth's
    // base.
    let axis = PanTilt::from_direction(
        truth.base().base_from_world
            * (estimate.cam_from_world().transpose() * Vec3::new(0.0, 0.0, 1.0)),
    );
    let true_axis =
        PanTilt::from_direction(truth.cam_from_base().transpose() * Vec3::new(0.0, 0.0, 1.0));
    let focal_px = estimate.ptz().focal_px - truth.ptz().focal_px;
    CameraError {
        rotation: angle_between(&truth.cam_from_world(), &estimate.cam_from_world()),
        pan: axis.pan.turn_from(true_axis.pan),
        tilt: axis.tilt - true_axis.tilt,
        focal_px,
        focal_percent: 100.0 * focal_px / truth.ptz().focal_px,
        position_m: (estimate.base().position_m - truth.base().position_m).norm(),
    }
}

/// The horizontal field of view of a picture, for a pinhole camera with the principal point in the
/// middle.
pub fn horizontal_view(focal_px: f64, image_size: ImageSize) -> Angle {
    Angle::from_radians(2.0 * (0.5 * f64::from(image_size.width)).atan2(focal_px))
}

/// The error of one visible landmark.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct LandmarkError {
    /// Index of the landmark in the true field.
    pub landmark: usize,
    /// Distance between its images in both cameras, px; none if the estimated camera does not see
    /// it.
    pub image_px: Option<f64>,
    /// Distance on the ground, m, between the landmark and the point that the estimated camera sees
    /// at its pixel; infinite if the estimated camera sees no ground there. None for landmarks
    /// above the ground.
    pub ground_m: Option<f64>,
}

/// The errors of all landmarks that the true camera sees and that both fields have, in the true
/// field's order.
pub fn landmark_errors(
    truth: FieldView,
    estimate: FieldView,
    size: ImageSize,
) -> Vec<LandmarkError> {
    let twins = same_names(
        &truth.field.landmarks,
        &estimate.field.landmarks,
        |landmark| landmark.id.as_str(),
    );
    project_landmarks(truth.field, truth.camera, size, 0.0)
        .into_iter()
        .filter_map(|shown| {
            // The estimate is measured by its own field: size and crown are part of what it states.
            let landmark = &estimate.field.landmarks[twins[shown.landmark]?];
            let at = estimate.field.landmark_in_world(landmark);
            // A camera that looks into the sky must not score by the few landmarks that are left.
            let ground_m = landmark
                .is_on_ground()
                .then(|| ground_error_m(estimate.camera, shown.image, at).unwrap_or(f64::INFINITY));
            Some(LandmarkError {
                landmark: shown.landmark,
                image_px: estimate
                    .camera
                    .image_from_world(at)
                    .ok()
                    .map(|image| image.distance_px(shown.image)),
                ground_m,
            })
        })
        .collect()
}

/// Distance, m, between a ground point and the point of the same height that a camera sees at
/// `image`. None if the camera sees no ground there.
pub fn ground_error_m(camera: &PtzCamera, image: ImagePoint, at: Vec3) -> Option<f64> {
    camera
        .plane_from_image(image, at.z)
        .map(|ground| (ground - at).norm())
}

/// A camera and the field that is drawn with it. The true and the estimated view may differ in
/// both: for example, a crown in only one of the fields moves its lines.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct FieldView<'a> {
    /// The field.
    pub field: &'a FieldModel,
    /// The camera.
    pub camera: &'a PtzCamera,
}

/// For each name in `from`, its index in `to`; none if it is missing there. In lists of one
/// template the indices agree, so that index is tried first.
pub(super) fn same_names<'a, T>(
    from: &[T],
    to: &[T],
    name: impl Fn(&T) -> &str + 'a,
) -> Vec<Option<usize>> {
    from.iter()
        .enumerate()
        .map(|(index, item)| {
            let wanted = name(item);
            if to.get(index).is_some_and(|other| name(other) == wanted) {
                Some(index)
            } else {
                to.iter().position(|other| name(other) == wanted)
            }
        })
        .collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::camera::{BaseAngles, CameraBase};
    use crate::geometry::Angle;
    use crate::testing::{HD, TestBase, base_at, soccer, turned_base};

    fn base(heading_deg: f64) -> CameraBase {
        turned_base([0.0, -60.0, 15.0], [heading_deg, 0.0, 0.0], HD)
    }

    #[test]
    fn errors_of_one_base_are_differences() {
        let truth = base(0.0).aim(10.0, -8.0, 2000.0);
        let estimate = base(0.0).aim(10.5, -8.25, 2100.0);
        let error = camera_error(&truth, &estimate);
        assert!((error.pan.degrees() - 0.5).abs() < 1e-12);
        assert!((error.tilt.degrees() + 0.25).abs() < 1e-12);
        assert!(
            (error.focal_px - 100.0).abs() < 1e-12 && (error.focal_percent - 5.0).abs() < 1e-12
        );
        assert!(error.position_m == 0.0);
        // A rotation of 0.5° about the vertical axis at tilt −8° moves the optical axis by 0.495°
        // and adds some roll. All of the 0.5° and the error of tilt count.
        assert!(
            (error.rotation.degrees() - 0.5f64.hypot(0.25)).abs() < 1e-3,
            "{}",
            error.rotation.degrees()
        );
    }

    #[test]
    fn another_pan_zero_is_no_error() {
        let truth = base(0.0).aim(10.0, -8.0, 2000.0);
        let estimate = base(4.0).aim(6.0, -8.0, 2000.0);
        let error = camera_error(&truth, &estimate);
        assert!(error.rotation.degrees() < 1e-9 && error.pan.degrees().abs() < 1e-9);
    }

    #[test]
    fn pans_on_both_sides_of_half_a_turn_are_near_each_other() {
        let at = |pan: f64| base(0.0).aim(pan, 0.0, 2000.0);
        assert!((camera_error(&at(179.5), &at(-179.5)).pan.degrees() - 1.0).abs() < 1e-9);
    }

    #[test]
    fn the_view_is_a_right_angle_where_the_focal_length_is_half_the_width() {
        assert!((horizontal_view(640.0, ImageSize::new(1280, 720)).degrees() - 90.0).abs() < 1e-12);
    }

    #[test]
    fn a_view_from_above_that_is_a_metre_off() {
        let size = ImageSize::new(1280, 720);
        let field = soccer();
        let down = BaseAngles {
            pitch: Angle::from_degrees(-90.0),
            ..BaseAngles::default()
        }
        .base_from_world();
        let at = |x_m: f64| {
            let base = CameraBase::new(
                Vec3::new(x_m, 0.0, 100.0),
                down,
                ImagePoint::new(640.0, 360.0),
            );
            base.aim(0.0, 0.0, 2000.0)
        };
        let errors = landmark_errors(
            FieldView {
                field: &field,
                camera: &at(0.0),
            },
            FieldView {
                field: &field,
                camera: &at(1.0),
            },
            size,
        );
        // 64 m × 36 m around the centre mark: it, and the four marks of the circle.
        assert_eq!(errors.len(), 5);
        for error in errors {
            assert!((error.image_px.unwrap() - 20.0).abs() < 1e-9);
            assert!((error.ground_m.unwrap() - 1.0).abs() < 1e-9);
        }
    }

    #[test]
    fn what_the_estimate_does_not_see_has_no_number() {
        let field = soccer();
        let [truth, away] =
            [0.0, 180.0].map(|pan| base_at([0.0, -60.0, 15.0], HD).aim(pan, -10.0, 1500.0));
        let errors = landmark_errors(
            FieldView {
                field: &field,
                camera: &truth,
            },
            FieldView {
                field: &field,
                camera: &away,
            },
            ImageSize::new(1280, 720),
        );
        assert!(!errors.is_empty() && errors.iter().all(|error| error.image_px.is_none()));
    }

    #[test]
    fn where_the_estimate_sees_no_ground_the_error_is_infinite() {
        let middle = ImagePoint::new(640.0, 360.0);
        let field = soccer();
        let [truth, sky] =
            [-10.0, 60.0].map(|tilt| base_at([0.0, -60.0, 15.0], middle).aim(0.0, tilt, 1500.0));
        let [truth, sky] = [&truth, &sky].map(|camera| FieldView {
            field: &field,
            camera,
        });
        let errors = landmark_errors(truth, sky, ImageSize::new(1280, 720));
        assert!(!errors.is_empty());
        for error in errors {
            let is_on_ground = field.landmarks[error.landmark].is_on_ground();
            assert_eq!(error.ground_m, is_on_ground.then_some(f64::INFINITY));
        }
    }
}
