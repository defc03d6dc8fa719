//! The covariance of a frame's camera from the frame's own evidence.
//!
//! Whoever propagates a camera (to a clip, to a forest's training set) adds the uncertainty of the
//! base once, for all frames together. This needs each frame's own part, which documents store as
//! `own_covariance`. It is never computed by subtracting the base's part from the total: the
//! difference of two nearly equal matrices is seldom positive definite, and with the total in its
//! place a frame that is on its lines within half a pixel would seem to be known to 100 px.

use crate::calibrate::observations;
use touchline_core::camera::PtzCamera;
use touchline_core::field::FieldModel;
use touchline_core::geometry::{ImageSize, Mat3};
use touchline_core::solve::{
    Observation, UNSTATED_PX, Uncertainty, covariance_in_radians, covariance_of_four_points,
};
use touchline_documents::document::{Frame, SolutionSource};

/// Assumed accuracy of a camera that was aligned to paint and has no covariance: that of four
/// points with this σ, px at 1920 px width. Cameras that were aligned to paint state 0.2 to 0.6 px.
const PAINT_PX: f64 = 1.0;

/// The covariance of (pan rad, tilt rad, focal length px) from the frame's own evidence, with the
/// base taken as exact. In this order: the stored one; in documents without it, the one that
/// follows from the clicks; else an assumed one that depends on what the camera was solved from.
pub(crate) fn own_covariance(
    frame: &Frame,
    camera: &PtzCamera,
    field: Option<&FieldModel>,
) -> Mat3 {
    let stored = frame
        .solution
        .as_ref()
        .and_then(|solution| solution.own_covariance);
    // A document of this program states it; one of another program may have clicks at least.
    stored
        .map(|stored| covariance_in_radians(&stored))
        .or_else(|| covariance_by_clicks(frame, camera, field?))
        .unwrap_or_else(|| floor(frame, camera))
}

/// The covariance from the clicks that took part; none if they do not determine the camera.
fn covariance_by_clicks(frame: &Frame, camera: &PtzCamera, field: &FieldModel) -> Option<Mat3> {
    let used: Vec<Observation> = observations(frame, field)
        .ok()?
        .into_iter()
        .filter(|observation| !observation.check)
        .collect();
    Some(
        Uncertainty::from_observations(camera, &used, None)
            .ok()?
            .clicks,
    )
}

/// The assumed covariance of a camera that states none.
fn floor(frame: &Frame, camera: &PtzCamera) -> Mat3 {
    // Without a covariance all that is known is the kind of the source.
    let source = frame.source();
    if source == Some(SolutionSource::Markings) {
        return covariance_on_paint(camera, frame.image_size);
    }
    covariance_of_four_points(
        camera,
        frame.image_size,
        UNSTATED_PX * frame.image_size.scale_from_1920(),
    )
}

/// The assumed covariance of (pan rad, tilt rad, focal length px) of a camera that was aligned to
/// painted lines.
pub(crate) fn covariance_on_paint(camera: &PtzCamera, size: ImageSize) -> Mat3 {
    covariance_of_four_points(camera, size, PAINT_PX * size.scale_from_1920())
}

#[cfg(test)]
mod tests {
    use super::*;
    use touchline_core::camera::{BaseSigma, CameraBase, Ptz};
    use touchline_core::geometry::Vec3;
    use touchline_core::testing::{SIZE, base_at, soccer};
    use touchline_documents::document::Click;
    use touchline_documents::testing::{new_frame, solved_by};

    fn camera() -> PtzCamera {
        let sigma = BaseSigma {
            position_m: Vec3::new(0.3, 0.8, 0.3),
            ..BaseSigma::default()
        };
        let position_m = Vec3::new(0.0, -62.0, 17.0);
        let base = base_at(position_m, SIZE);
        PtzCamera::new(
            CameraBase { sigma, ..base },
            Ptz::from_degrees(3.0, -12.0, 2600.0),
        )
    }

    fn frame(source: SolutionSource) -> Frame {
        let mut frame = new_frame("1.jpg", SIZE);
        frame.solution = solved_by(source);
        frame
    }

    /// 1-σ of the pan in px in the middle of the picture.
    fn pan_px(covariance: &Mat3) -> f64 {
        covariance[(0, 0)].sqrt() * camera().ptz().focal_px
    }

    #[test]
    fn what_is_stored_comes_back_however_uncertain_the_base_is() {
        let own = covariance_of_four_points(&camera(), SIZE, 0.4);
        let uncertainty = Uncertainty::from_covariance(&camera(), own, SIZE).unwrap();
        let mut frame = frame(SolutionSource::Markings);
        let solution = frame.solution.as_mut().unwrap();
        solution.covariance = Some(uncertainty.ptz_covariance_deg());
        solution.own_covariance = Some(uncertainty.own_covariance_deg());
        let found = own_covariance(&frame, &camera(), None);
        assert!((found - own).amax() < 1e-12 * own.amax(), "{found} {own}");
        assert!(
            pan_px(&covariance_in_radians(&uncertainty.ptz_covariance_deg()))
                > 20.0 * pan_px(&found)
        );
    }

    #[test]
    fn an_older_document_gives_what_its_clicks_say_else_a_floor_and_never_the_total() {
        let field = soccer();
        let mut clicked = frame(SolutionSource::Clicks);
        for landmark in ["centre_mark", "halfway_far", "centre_circle_right"] {
            let at = field.landmark_in_world(field.landmark(landmark).unwrap());
            clicked.clicks.push(Click::landmark(
                landmark.into(),
                camera().image_from_world(at).unwrap(),
            ));
        }
        let total = Mat3::from_diagonal(&Vec3::new(1.0, 1.0, 1e4));
        let mut painted = frame(SolutionSource::Markings);
        for frame in [&mut clicked, &mut painted] {
            frame.solution.as_mut().unwrap().covariance = Some(total);
        }
        let by_clicks = pan_px(&own_covariance(&clicked, &camera(), Some(&field)));
        assert!((0.5..4.0).contains(&by_clicks), "{by_clicks}");
        let by_paint = pan_px(&own_covariance(&painted, &camera(), Some(&field)));
        assert!((0.3..1.0).contains(&by_paint), "{by_paint}");
        let imported = pan_px(&own_covariance(
            &frame(SolutionSource::Import),
            &camera(),
            None,
        ));
        assert!(
            (imported / by_paint - UNSTATED_PX / PAINT_PX).abs() < 1e-9,
            "{imported} {by_paint}"
        );
    }
}
