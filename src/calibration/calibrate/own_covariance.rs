//! How well a frame's camera is known by the frame's own evidence.
//!
//! Whoever carries a camera on (a clip, a forest's training set) adds the base's uncertainty once,
//! for all frames together. So it needs each frame's own part, which documents keep as
//! `own_covariance`. It is never got by subtracting the base's part from the total: that difference
//! of two nearly equal matrices is seldom positive definite, and the total in its place says that a
//! frame on its lines to half a pixel is known to 100 px.

use super::observations;
use touchline_core::camera::PtzCamera;
use touchline_core::field::FieldModel;
use touchline_core::geometry::{ImageSize, Mat3};
use touchline_core::solve::{
    Observation, Uncertainty, covariance_in_radians, covariance_of_four_points,
};
use touchline_documents::document::{Frame, SolutionSource};

/// What painted lines tell of a camera that states nothing itself: four points this well known, px
/// at 1920 px width. Cameras that were aligned to paint state 0.2 to 0.6 px.
const PAINT_PX: f64 = 1.0;

/// What a camera that states nothing is taken for otherwise: four points this well known, px at
/// 1920 px width. Cameras that trained programs give are typically off by this.
const UNSTATED_PX: f64 = 4.0;

/// The covariance of (pan rad, tilt rad, focal length px) by the frame's own evidence, the base
/// taken as exact: as it is stored; in documents that lack it as the clicks have it; else a stated
/// floor by what the camera was solved from.
pub(crate) fn own_covariance(
    frame: &Frame,
    camera: &PtzCamera,
    field: Option<&FieldModel>,
) -> Mat3 {
    let stored = frame
        .solution
        .as_ref()
        .and_then(|solution| solution.own_covariance);
    stored
        .map(|stored| covariance_in_radians(&stored))
        .or_else(|| covariance_by_clicks(frame, camera, field?))
        .unwrap_or_else(|| floor(frame, camera))
}

/// What the clicks that took part say; none where they do not determine the camera.
fn covariance_by_clicks(frame: &Frame, camera: &PtzCamera, field: &FieldModel) -> Option<Mat3> {
    let used: Vec<Observation> = observations(frame, field)
        .ok()?
        .into_iter()
        .filter(|observation| !observation.check)
        .collect();
    Some(Uncertainty::of(camera, &used, None).ok()?.clicks)
}

fn floor(frame: &Frame, camera: &PtzCamera) -> Mat3 {
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

/// What painted lines tell of a camera that was aligned to them and states nothing itself, of (pan
/// rad, tilt rad, focal length px).
pub(crate) fn covariance_on_paint(camera: &PtzCamera, size: ImageSize) -> Mat3 {
    covariance_of_four_points(camera, size, PAINT_PX * size.scale_from_1920())
}

#[cfg(test)]
mod tests {
    use super::*;
    use touchline_core::camera::{BaseAngles, BaseSigma, CameraBase, Ptz};
    use touchline_core::field::builtin;
    use touchline_core::geometry::Vec3;
    use touchline_documents::document::{Click, Solution};

    const SIZE: ImageSize = ImageSize::new(1920, 1080);

    fn camera() -> PtzCamera {
        let sigma = BaseSigma {
            position_m: Vec3::new(0.3, 0.8, 0.3),
            ..BaseSigma::default()
        };
        let position_m = Vec3::new(0.0, -62.0, 17.0);
        let base = CameraBase::new(
            position_m,
            BaseAngles::default().base_from_world(),
            SIZE.centre(),
        );
        PtzCamera::new(
            CameraBase { sigma, ..base },
            Ptz::from_degrees(3.0, -12.0, 2600.0),
        )
    }

    fn frame(source: SolutionSource) -> Frame {
        let mut frame = Frame::from_image("1.jpg", "main".into(), SIZE);
        frame.solution = Some(Solution {
            source: Some(source),
            ..Solution::default()
        });
        frame
    }

    /// 1-σ of the pan in px in the middle of the picture.
    fn pan_px(covariance: &Mat3) -> f64 {
        covariance[(0, 0)].sqrt() * camera().ptz().focal_px
    }

    #[test]
    fn what_is_stored_comes_back_however_uncertain_the_base_is() {
        let own = covariance_of_four_points(&camera(), SIZE, 0.4);
        let uncertainty = Uncertainty::of_known(&camera(), own, SIZE).unwrap();
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
        let field = builtin("soccer").unwrap().default_model().unwrap();
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
