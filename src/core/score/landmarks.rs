//! Errors at the landmarks that are visible in the true camera.

use super::FieldView;
use super::view::same_names;
use crate::camera::PtzCamera;
use crate::geometry::{ImagePoint, ImageSize, Vec3};
use crate::markings::project_landmarks;

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

#[cfg(test)]
mod tests {
    use super::*;
    use crate::camera::{BaseAngles, CameraBase};
    use crate::geometry::Angle;
    use crate::testing::{HD, TestBase, base_at, soccer};

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
