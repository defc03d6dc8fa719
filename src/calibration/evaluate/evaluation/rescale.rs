//! An estimate for pictures of another size, with the truth's proportions, in the truth's px.

use touchline_core::camera::{CameraBase, FocalCurve, Ptz, PtzCamera};
use touchline_core::geometry::{ImagePoint, ImageSize, Mat3, Vec3};
use touchline_documents::document::Frame;

/// The camera of a frame, and the frame with its covariance, in px of a picture of another size.
/// None where the two sizes have other proportions.
pub(super) fn rescale(
    camera: &PtzCamera,
    frame: &Frame,
    size: ImageSize,
) -> Option<(PtzCamera, Frame)> {
    let factor = frame.image_size.factor_to(size)?;
    let (base, ptz) = (camera.base(), camera.ptz());
    let at = base.principal_point;
    // The lens is on normalised coordinates; its curve is by the focal length in the old px.
    let base = CameraBase {
        principal_point: ImagePoint::new(at.x * factor, at.y * factor),
        distortion: FocalCurve::through(camera.lens())?,
        ..*base
    };
    let ptz = Ptz {
        focal_px: ptz.focal_px * factor,
        ..ptz
    };
    let mut frame = frame.clone();
    if let Some(solution) = &mut frame.solution {
        let scale = Mat3::from_diagonal(&Vec3::new(1.0, 1.0, factor));
        for covariance in [&mut solution.covariance, &mut solution.own_covariance] {
            *covariance = covariance.map(|of| scale * of * scale);
        }
    }
    Some((PtzCamera::new(base, ptz), frame))
}

#[cfg(test)]
mod tests {
    use super::*;
    use touchline_core::testing::{TestBase, base_at};
    use touchline_documents::testing::new_frame;

    #[test]
    fn a_camera_shows_the_same_in_a_picture_of_another_size() {
        let (size, half) = (ImageSize::new(1280, 720), ImageSize::new(640, 360));
        let base = CameraBase {
            distortion: FocalCurve::constant(-0.1),
            ..base_at([0.0, -66.0, 18.0], size)
        };
        let camera = base.aim(3.0, -12.0, 1500.0);
        let frame = new_frame("a.jpg", size);
        let (smaller, _) = rescale(&camera, &frame, half).unwrap();
        let point = Vec3::new(4.0, 7.0, 0.0);
        let [at, there] = [&camera, &smaller].map(|camera| camera.image_from_world(point).unwrap());
        let expected = ImagePoint::new(0.5 * at.x, 0.5 * at.y);
        assert!(there.distance_px(expected) < 1e-9, "{there:?} {expected:?}");
        assert!(rescale(&camera, &frame, ImageSize::new(640, 480)).is_none());
    }
}
