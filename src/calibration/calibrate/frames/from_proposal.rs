//! The prior of a solve from a camera that the program proposed.
//!
//! A proposal with its covariance is evidence just as clicks are: a click that agrees with it makes
//! the camera better known, never worse. A click that contradicts it shows that the covariance is
//! too small, and by how much.

use nalgebra::SMatrix;
use touchline_core::camera::{CameraBase, PtzCamera};
use touchline_core::geometry::{Angle, ImageSize};
use touchline_core::solve::{Observation, PtzPrior, SolveContext, Uncertainty};
use touchline_documents::document::{ENOUGH_EQUATIONS, Proposed};

/// 1-σ of pan and tilt where a proposal states no covariance, and upper limit of an inflated one:
/// one click that contradicts the proposal moves them this far.
const FREE: Angle = Angle::from_degrees(3.0);
/// The same for the focal length, as a fraction of it.
const FOCAL_SHARE: f64 = 0.02;

/// Adds a proposal to the context of a solve: as the start, and where the clicks do not determine
/// the camera by themselves, as a prior.
pub(super) fn inform(
    context: &mut SolveContext,
    base: &CameraBase,
    proposed: &Proposed,
    observations: &[Observation],
) {
    let ptz = proposed.ptz.ptz();
    context.start = Some(ptz);
    // With enough equations the clicks decide alone: a wrong proposal must not bias a frame that a
    // person has clicked.
    let used: Vec<&Observation> = observations
        .iter()
        .filter(|observation| !observation.check)
        .collect();
    if used
        .iter()
        .map(|observation| observation.equations())
        .sum::<usize>()
        < ENOUGH_EQUATIONS
    {
        let camera = PtzCamera::new(*base, ptz);
        let stated = stated_prior(&camera, proposed, &used, context.image_size);
        context.prior = Some(stated.unwrap_or(PtzPrior {
            ptz,
            sigma_pan: FREE,
            sigma_tilt: FREE,
            sigma_focal_share: FOCAL_SHARE,
            by_base: SMatrix::zeros(),
        }));
    }
}

/// The prior that a proposal's covariance states, inflated if the clicks are farther off than it
/// allows; none without a usable covariance.
///
/// If proposal and clicks were right, the sum of the squared residuals r of the clicks at the
/// proposed camera would have the expectation (px²)
///
/// ```text
/// E Σ|r|² = Σ n σ² + k² Σ trace(J C Jᵀ),   k = 1
/// ```
///
/// with n equations of a click of noise σ, the covariance C of the overlay at the clicked place and
/// the Jacobian J of the residual by the image point. Solving for k gives the factor on the prior's
/// σ, which is never reduced below the stated one.
fn stated_prior(
    camera: &PtzCamera,
    proposed: &Proposed,
    used: &[&Observation],
    image_size: ImageSize,
) -> Option<PtzPrior> {
    let stated = Uncertainty::from_own(camera, &proposed.own_covariance?, image_size).ok()?;
    let (mut off, mut expected, mut noise) = (0.0, 0.0, 0.0);
    for observation in used {
        let here = observation.shape.jacobian(camera, observation.image)?;
        let overlay = stated.overlay_at_world(camera, here.nearest_in_world)?;
        off += here.value_px.norm_squared();
        expected += (here.by_image * overlay * here.by_image.transpose()).trace();
        noise += observation.sigma_px * observation.sigma_px * observation.equations() as f64;
    }
    // The factor k; at least 1, because few clicks may agree by chance.
    let wider = ((off - noise) / expected).max(1.0).sqrt();
    let sigma = stated.clicks.diagonal().map(f64::sqrt);
    // Inflated, but not beyond what a proposal without covariance gets; a larger stated σ stays.
    let angle = |own: f64| Angle::from_radians((own * wider).min(FREE.radians()).max(own));
    let focal_share = sigma.z / camera.ptz().focal_px;
    Some(PtzPrior {
        ptz: camera.ptz(),
        sigma_pan: angle(sigma.x),
        sigma_tilt: angle(sigma.y),
        // Even if the proposal is far off, one click can only correct pan and tilt; leave the focal
        // length to the proposal.
        sigma_focal_share: (focal_share * wider).min(FOCAL_SHARE).max(focal_share),
        by_base: stated.by_base,
    })
}

#[cfg(test)]
mod tests {
    use crate::calibrate::{CalibrationError, FrameLookup, calibrate};
    use touchline_core::camera::{BaseSigma, CameraBase, Ptz, PtzCamera};
    use touchline_core::field::FieldModel;
    use touchline_core::geometry::{ImagePoint, Mat3, Vec3};
    use touchline_core::solve::{FrameSolution, Uncertainty};
    use touchline_core::testing::{SIZE, TestBase, base_at, landmark_in, soccer};
    use touchline_documents::document::{
        Click, Document, Frame, FrameStatus, Solution, SolutionSource,
    };
    use touchline_documents::testing::match_from;
    use touchline_documents::testing::{new_frame, ptz_at};

    /// A frame whose proposal looks 2° too far right, and the camera that it should have been.
    fn slightly_wrong() -> (Document, PtzCamera) {
        let base = base_at([0.0, -62.0, 17.0], SIZE);
        let truth = base.aim(-4.0, -14.0, 2300.0);
        let mut document = match_from(&base, SIZE);
        let mut frame = new_frame("1.jpg", SIZE);
        frame.ptz = ptz_at(-2.0, -13.5, 2310.0);
        let source = Some(SolutionSource::Forest);
        frame.solution = Some(Solution {
            source,
            confidence: Some(0.8),
            ..Solution::default()
        });
        frame.status = FrameStatus::Suggested;
        document.frames.push(frame.into());
        (document, truth)
    }

    /// Solves the first frame.
    fn solve(document: &Document, field: &FieldModel) -> Result<FrameSolution, CalibrationError> {
        let lookup = FrameLookup::from_document(document);
        calibrate(document, &lookup, &document.frames[0], field, 0)
    }

    #[test]
    fn one_click_moves_a_proposal_two_decide_without_it_and_none_brings_it_back() {
        // Of the forest, or found by the painted lines.
        proposal_under_clicks(SolutionSource::Forest);
        proposal_under_clicks(SolutionSource::Markings);
    }

    fn proposal_under_clicks(source: SolutionSource) {
        let field = soccer();
        let (mut document, truth) = slightly_wrong();
        document.frames[0].solution.as_mut().unwrap().source = Some(source);
        let before = document.frames[0].proposed_camera().unwrap();
        let seen = |landmark: &str| {
            let world = field.landmark_in_world(field.landmark(landmark).unwrap());
            Click::landmark(landmark.into(), truth.image_from_world(world).unwrap())
        };
        document.frames[0].clicks.push(seen("centre_mark"));
        let one = solve(&document, &field).unwrap();
        document.frames[0].record(&one);
        let corrected = document.ptz_camera(&document.frames[0]).unwrap().ptz();
        assert!(
            (corrected.pan - truth.ptz().pan).abs().degrees() < 0.05,
            "{corrected:?}"
        );
        assert!(
            (corrected.focal_px - 2310.0).abs() < 5.0,
            "the focal length is the proposal's: {corrected:?}"
        );
        assert!(
            !document.frames[0].is_solved_by_clicks(),
            "one click does not make it the annotator's own"
        );
        assert_eq!(document.frames[0].proposed_camera(), Some(before.clone()));
        document.frames[0].clicks.push(seen("halfway_far"));
        let two = solve(&document, &field).unwrap();
        document.frames[0].record(&two);
        let solved = document.ptz_camera(&document.frames[0]).unwrap().ptz();
        assert!(
            (solved.focal_px - 2300.0).abs() < 1e-6 && document.frames[0].is_solved_by_clicks()
        );
        document.frames[0].clicks.clear();
        assert!(document.frames[0].restore_proposed());
        assert_eq!(document.frames[0].proposed_camera(), Some(before));
        assert!(!document.frames[0].restore_proposed());
    }

    #[test]
    fn an_imported_camera_is_a_prior_only_where_it_was_kept_as_one() {
        let field = soccer();
        let (mut document, truth) = slightly_wrong();
        let frame = &mut document.frames[0];
        frame.solution.as_mut().unwrap().source = Some(SolutionSource::Import);
        let world = field.landmark_in_world(field.landmark("centre_mark").unwrap());
        let at = truth.image_from_world(world).unwrap();
        frame.clicks.push(Click::landmark("centre_mark".into(), at));
        assert!(solve(&document, &field).is_err(), "one click is too few");
        document.frames[0].keep_camera_as_prior();
        let solved = solve(&document, &field).unwrap();
        let camera = PtzCamera::new(*truth.base(), solved.ptz);
        let off_px = camera.image_from_world(world).unwrap().distance_px(at);
        assert!(off_px < 1.0, "{off_px} px off");
        assert!((solved.ptz.focal_px / 2310.0 - 1.0).abs() < 0.005);
        document.frames[0].record(&solved);
        assert_eq!(document.frames[0].source(), Some(SolutionSource::Import));
        let before = document.frames[0].clone();
        document.frames[0].keep_camera_as_prior();
        assert_eq!(*document.frames[0], *before, "the first one is kept");
    }

    /// What is stated of the worst corner after one click on the centre mark that is off from where
    /// the proposal has it.
    fn after_one_click(off_px: f64) -> (f64, f64, Ptz) {
        let field = soccer();
        let (mut document, _) = slightly_wrong();
        let camera = document.cameras[0].id.clone();
        let sigma = BaseSigma {
            position_m: Vec3::new(0.1, 0.2, 0.1),
            rotation: Vec3::new(5e-4, 5e-4, 0.0),
            ..BaseSigma::default()
        };
        let base = CameraBase {
            sigma,
            ..document.camera(&camera).unwrap().base().unwrap()
        };
        document.camera_mut(&camera).unwrap().set_base(&base);
        let proposed = document.ptz_camera(&document.frames[0]).unwrap();
        let known = Mat3::from_diagonal(&Vec3::new(4e-4_f64.powi(2), 4e-4_f64.powi(2), 4.0));
        let stated = Uncertainty::from_covariance(&proposed, known, SIZE).unwrap();
        let before_px = stated.worst_corner_sigma_px(&proposed, SIZE);
        let solution = document.frames[0].solution.as_mut().unwrap();
        solution.covariance = Some(stated.ptz_covariance_deg());
        solution.own_covariance = Some(stated.own_covariance_deg());
        let at = landmark_in(&proposed, &field, "centre_mark");
        document.frames[0].clicks.push(Click::landmark(
            "centre_mark".into(),
            ImagePoint::new(at.x + off_px, at.y),
        ));
        let one = solve(&document, &field).unwrap();
        (before_px, one.worst_corner_sigma_px, one.ptz)
    }

    #[test]
    fn a_click_that_agrees_with_a_proposal_makes_it_no_less_certain() {
        let (before_px, after_px, _) = after_one_click(1.0);
        assert!(
            after_px < before_px && after_px > 0.5 * before_px,
            "{before_px} {after_px}"
        );
    }

    #[test]
    fn a_click_that_contradicts_a_proposal_moves_it_and_says_how_far_it_was_off() {
        let (before_px, after_px, ptz) = after_one_click(40.0);
        assert!(
            after_px > 2.0 * before_px && after_px < 40.0,
            "{before_px} {after_px}"
        );
        // 40 px at a focal length of 2310 px.
        let turned = (ptz.pan.degrees() + 2.0) / 40f64.atan2(2310.0).to_degrees();
        assert!((-1.1..-0.9).contains(&turned), "{turned}");
    }

    #[test]
    fn a_proposal_that_was_corrected_survives_the_file() {
        let (mut document, _) = slightly_wrong();
        let proposed = document.frames[0].proposed_camera();
        let source = Some(SolutionSource::Clicks);
        document.frames[0].solution = Some(Solution {
            source,
            proposed,
            ..Solution::default()
        });
        let text = serde_json::to_string(&*document.frames[0]).unwrap();
        assert!(
            text.contains(
                r#""proposed":{"pan_deg":-2.0,"tilt_deg":-13.5,"focal_px":2310.0,"source":"forest","confidence":0.8}"#
            ),
            "{text}"
        );
        assert_eq!(
            serde_json::from_str::<Frame>(&text).unwrap(),
            *document.frames[0]
        );
    }
}
