//! What a solve knows from a camera that the program proposed.

use crate::document::{ENOUGH_EQUATIONS, Proposed};
use crate::geometry::Angle;
use crate::solve::{Observation, PtzPrior, SolveContext};

/// One click on a proposal moves it: pan and tilt follow the click, within this 1-σ.
const FREE: Angle = Angle::from_degrees(3.0);
/// And the focal length stays as it was proposed, within this share.
const FOCAL_SHARE: f64 = 0.02;

/// What a solve knows from a proposal: where to start, and with too few clicks to decide by themselves, what they move.
pub(super) fn inform(context: &mut SolveContext, proposed: &Proposed, observations: &[Observation]) {
    let ptz = proposed.ptz.ptz();
    context.start = Some(ptz);
    let used = observations.iter().filter(|observation| !observation.check);
    if used.map(Observation::equations).sum::<usize>() < ENOUGH_EQUATIONS {
        context.prior = Some(PtzPrior { ptz, sigma_pan: FREE, sigma_tilt: FREE, sigma_focal_share: FOCAL_SHARE });
    }
}

#[cfg(test)]
mod tests {
    use crate::calibrate::{FrameLookup, calibrate};
    use crate::camera::{BaseAngles, CameraBase, Ptz, PtzCamera};
    use crate::document::{Camera, Click, Document, FieldSpec, Frame, FramePtz, FrameStatus, Solution, SolutionSource};
    use crate::field::builtin;
    use crate::geometry::{ImageSize, Vec3};

    const SIZE: ImageSize = ImageSize::new(1920, 1080);

    /// A frame whose proposal looks 2° too far right, and the camera that it should have been.
    fn slightly_wrong() -> (Document, PtzCamera) {
        let base = CameraBase::new(Vec3::new(0.0, -62.0, 17.0), BaseAngles::default().base_from_world(), SIZE.centre());
        let truth = PtzCamera::new(base, Ptz::from_degrees(-4.0, -14.0, 2300.0));
        let mut document = Document::new(FieldSpec::new("soccer"));
        let mut camera = Camera::new("main".into(), SIZE);
        camera.set_base(&base);
        document.cameras.push(camera.into());
        let mut frame = Frame::from_image("1.jpg", "main".into(), SIZE);
        frame.ptz = Some(FramePtz::new(Ptz::from_degrees(-2.0, -13.5, 2310.0), None));
        let source = Some(SolutionSource::Forest);
        frame.solution = Some(Solution { source, confidence: Some(0.8), ..Solution::default() });
        frame.status = FrameStatus::Suggested;
        document.frames.push(frame.into());
        (document, truth)
    }

    #[test]
    fn one_click_moves_a_proposal_two_decide_without_it_and_none_brings_it_back() {
        let field = builtin("soccer").unwrap().default_model().unwrap();
        let (mut document, truth) = slightly_wrong();
        let before = document.frames[0].proposed().unwrap();
        let seen = |landmark: &str| {
            let world = field.landmark_in_world(field.landmark(landmark).unwrap());
            Click::landmark(landmark.into(), truth.image_from_world(world).unwrap())
        };
        document.frames[0].clicks.push(seen("centre_mark"));
        let one = calibrate(&document, &FrameLookup::of(&document), &document.frames[0], &field, 0).unwrap();
        document.frames[0].record(&one);
        let corrected = document.pointed(&document.frames[0]).unwrap().ptz();
        assert!((corrected.pan - truth.ptz().pan).abs().degrees() < 0.05, "{corrected:?}");
        assert!((corrected.focal_px - 2310.0).abs() < 5.0, "the focal length is the proposal's: {corrected:?}");
        assert!(document.frames[0].is_suggestion(), "one click does not make it the annotator's own");
        assert_eq!(document.frames[0].proposed(), Some(before.clone()));
        document.frames[0].clicks.push(seen("halfway_far"));
        let two = calibrate(&document, &FrameLookup::of(&document), &document.frames[0], &field, 0).unwrap();
        document.frames[0].record(&two);
        let solved = document.pointed(&document.frames[0]).unwrap().ptz();
        assert!((solved.focal_px - 2300.0).abs() < 1e-6 && document.frames[0].is_solved_by_clicks());
        document.frames[0].clicks.clear();
        assert!(document.frames[0].restore_proposed());
        assert_eq!(document.frames[0].proposed(), Some(before));
        assert!(!document.frames[0].restore_proposed());
    }

    #[test]
    fn a_proposal_that_was_corrected_survives_the_file() {
        let (mut document, _) = slightly_wrong();
        let proposed = document.frames[0].proposed();
        let source = Some(SolutionSource::Clicks);
        document.frames[0].solution = Some(Solution { source, proposed, ..Solution::default() });
        let text = serde_json::to_string(&*document.frames[0]).unwrap();
        assert!(
            text.contains(
                r#""proposed":{"pan_deg":-2.0,"tilt_deg":-13.5,"focal_px":2310.0,"source":"forest","confidence":0.8}"#
            ),
            "{text}"
        );
        assert_eq!(serde_json::from_str::<Frame>(&text).unwrap(), *document.frames[0]);
    }
}
