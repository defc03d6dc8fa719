//! The uncertainty that the labels of references leave in an answer.
//!
//! The rays of a forest were computed from references whose cameras are known by clicks. An error
//! of a reference's camera affects all its rays alike: an answer repeats it, however many features
//! agree. An error δ of a reference's (pan, tilt, focal length) moves the camera estimated from its
//! rays by T δ; T also adds to pan and tilt the effect of a wrong focal length away from the
//! reference's centre.
//!
//! Where several references show a feature, its ray may be from any of them: a consensus is where
//! rays cluster, not their mean, and labels that were adjusted to each other (see
//! [`super::adjust_labels`]) have correlated errors. So nothing averages out: the covariance is that of
//! one reference, averaged over those that show the features. An error of the base, which all
//! references share, is added by [`Uncertainty::from_covariance`].
//!
//! Treating labels as independent, each with its share of the information, was tried: 17 % and 19 %
//! of the answers about two drawn matches were then within the stated 68 % region (16 references of
//! four clicks; `cargo bench --bench relocalize clicked`), with errors of 2.2 to 2.5 times the
//! stated ones.

use super::nearest_references::nearest;
use super::{RayMatches, SeenRange};
use touchline_core::camera::{CameraBase, Ptz, PtzCamera};
use touchline_core::geometry::{ImageSize, Mat3, subsample};
use touchline_core::solve::covariance_of_four_points;

/// Number of references that an answer may rest on: the nearest ones.
const NEAREST: usize = 12;

/// Number of features from which the shares of the references are computed.
const FEATURES: usize = 64;

/// 1-σ of a click, px at 1920 px width, for references without a stored covariance.
const CLICK_PX: f64 = 2.0;

/// The covariance of (pan rad, tilt rad, focal px) that the labels of the references leave in an
/// answer with these inliers; zero without references.
pub(super) fn label_covariance(
    (ptz, inliers): (&Ptz, &[usize]),
    matches: &RayMatches,
    base: &CameraBase,
    image_size: ImageSize,
    seen: &SeenRange,
) -> Mat3 {
    // With the base at the origin a ray is its own world point, so that references project rays.
    let at_base = base.at_origin();
    let camera = PtzCamera::new(at_base, *ptz);
    let near = nearest(ptz, &seen.cameras, NEAREST);
    let references: Vec<PtzCamera> = near
        .iter()
        .map(|&number| PtzCamera::new(at_base, seen.cameras[number]))
        .collect();
    // Each feature divides one vote among the references whose picture contains its ray; if none
    // does, the nearest reference gets it.
    let mut shares = vec![0.0; references.len()];
    for &feature in subsample(inliers, FEATURES) {
        let Some((_, ray)) = matches.nearest(&camera, feature) else {
            continue;
        };
        let showing: Vec<usize> = (0..references.len())
            .filter(|&number| {
                references[number]
                    .image_from_world(ray)
                    .is_ok_and(|image| image_size.contains(image))
            })
            .collect();
        for &number in &showing {
            shares[number] += 1.0 / showing.len() as f64;
        }
        if showing.is_empty()
            && let Some(of_nearest) = shares.first_mut()
        {
            *of_nearest += 1.0;
        }
    }
    // Average T Λ Tᵀ over the references by their shares. Without a vote there is no share to
    // divide by, and the covariance stays zero.
    let all: f64 = shares.iter().sum();
    let mut covariance = Mat3::zeros();
    for ((&number, reference), share) in near
        .iter()
        .zip(&references)
        .zip(shares)
        .filter(|(_, share)| *share > 0.0)
    {
        // A reference without a covariance counts as known by four clicks, well apart.
        let label = seen.labels.get(number).copied().unwrap_or_else(|| {
            covariance_of_four_points(
                reference,
                image_size,
                CLICK_PX * image_size.scale_from_1920(),
            )
        });
        let moved = jacobian_by_reference(ptz, &reference.ptz());
        covariance += moved * label * moved.transpose() * (share / all);
    }
    // Symmetric but for rounding; made exactly so.
    (covariance + covariance.transpose()) * 0.5
}

/// T: the derivative of an answer's (pan, tilt, focal length) by those of the reference that all
/// its rays come from.
///
/// Pan and tilt errors carry over. With a focal length too long by δf, rays at a pan offset p from
/// the reference's centre are computed at p (1 − δf/f); so the answer, p away, moves by −p δf/f,
/// and its focal length scales by the same factor as the reference's. First order in the offsets.
pub(super) fn jacobian_by_reference(answer: &Ptz, reference: &Ptz) -> Mat3 {
    let (pan, tilt) = (
        answer.pan.turn_from(reference.pan).radians(),
        (answer.tilt - reference.tilt).radians(),
    );
    let focal_px = reference.focal_px;
    Mat3::new(
        1.0,
        0.0,
        -pan / focal_px,
        0.0,
        1.0,
        -tilt / focal_px,
        0.0,
        0.0,
        answer.focal_px / focal_px,
    )
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::relocalize::{Pose, PoseOptions, RayCandidate, pose_from_candidates};
    use touchline_core::camera::PanTilt;
    use touchline_core::geometry::{ImagePoint, Vec3};
    use touchline_core::testing::{SIZE, TestBase};

    fn base() -> CameraBase {
        CameraBase::new(Vec3::new(0.0, -60.0, 18.0), Mat3::identity(), SIZE.centre())
    }

    /// The answer to a picture all over which features show exact rays.
    fn answer(ptz: Ptz) -> (Pose, RayMatches) {
        let camera = PtzCamera::new(base(), ptz);
        let mut matches = RayMatches::new();
        for at in (0..200).map(|i| {
            ImagePoint::new(
                f64::from(i % 20) * 96.0 + 40.0,
                f64::from(i / 20) * 108.0 + 50.0,
            )
        }) {
            let ray = camera.ray_from_image(at).unwrap();
            let ray = PanTilt {
                pan: ray.pan,
                tilt: ray.tilt,
            };
            matches.push(
                at,
                &[RayCandidate {
                    ray,
                    squared_distance: 0.01,
                }],
            );
        }
        (
            pose_from_candidates(&matches, &base(), SIZE, &PoseOptions::default()).unwrap(),
            matches,
        )
    }

    fn left_open(answer_deg: f64, references_deg: &[f64]) -> (Mat3, Mat3) {
        let (pose, matches) = answer(Ptz::from_degrees(answer_deg, -12.0, 2200.0));
        let cameras: Vec<Ptz> = references_deg
            .iter()
            .map(|pan| Ptz::from_degrees(*pan, -12.0, 2200.0))
            .collect();
        let label = Mat3::from_diagonal(&Vec3::new(4e-7, 4e-7, 100.0));
        let seen = SeenRange::from_cameras(&cameras)
            .unwrap()
            .with_labels(vec![label; cameras.len()]);
        (
            label_covariance((&pose.ptz, &pose.inliers), &matches, &base(), SIZE, &seen),
            label,
        )
    }

    #[test]
    fn an_answer_repeats_the_error_of_one_reference_however_many_show_it() {
        let (one, label) = left_open(5.0, &[5.0]);
        assert!((one - label).norm() < 1e-6 * label.norm(), "{one}");
        let (two, _) = left_open(5.0, &[5.0, 5.0]);
        assert!((two - label).norm() < 1e-6 * label.norm(), "{two}");
    }

    #[test]
    fn far_from_its_reference_a_wrong_focal_length_turns_an_answer() {
        let (far, label) = left_open(15.0, &[5.0]);
        let turned = 10f64.to_radians() / 2200.0 * 10.0;
        assert!(
            (far[(0, 0)] - label[(0, 0)] - turned * turned).abs() < 1e-12,
            "{far}"
        );
        assert!((far[(2, 2)] - label[(2, 2)]).abs() < 1e-3, "{far}");
    }

    #[test]
    fn an_answer_with_an_unknown_overlay_is_not_believed() {
        let ptz = Ptz::from_degrees(5.0, -12.0, 2200.0);
        let (pose, matches) = answer(ptz);
        let seen = SeenRange::from_cameras(&[ptz]).unwrap();
        // A lens that gives no pixel of the picture a ray.
        let folded = base().bent(-1e4);
        let [known, unknown] = [base(), folded]
            .map(|base| pose.clone().with_uncertainty(&matches, &base, SIZE, &seen));
        assert!(known.confidence > 0.0 && known.worst_corner_sigma_px.is_finite());
        assert_eq!(
            (unknown.confidence, unknown.worst_corner_sigma_px),
            (0.0, f64::INFINITY)
        );
    }

    #[test]
    fn the_error_of_a_real_reference_comes_back_in_the_answer() {
        // A reference whose label is off, and a picture 8° beside it that shows its features.
        let (truth, query) = (
            Ptz::from_degrees(5.0, -12.0, 2200.0),
            Ptz::from_degrees(13.0, -12.0, 2200.0),
        );
        let wrong = Ptz {
            focal_px: truth.focal_px + 20.0,
            ..truth
        };
        let (seen, labelled, camera) = (
            PtzCamera::new(base(), truth),
            PtzCamera::new(base(), wrong),
            PtzCamera::new(base(), query),
        );
        let mut matches = RayMatches::new();
        for at in (0..400).map(|i| {
            ImagePoint::new(
                f64::from(i % 20) * 96.0 + 40.0,
                f64::from(i / 20) * 54.0 + 25.0,
            )
        }) {
            let in_reference = seen
                .image_from_ray(camera.ray_from_image(at).unwrap())
                .unwrap();
            if SIZE.contains(in_reference) {
                let ray = labelled.ray_from_image(in_reference).unwrap();
                matches.push(
                    at,
                    &[RayCandidate {
                        ray,
                        squared_distance: 0.01,
                    }],
                );
            }
        }
        let pose = pose_from_candidates(&matches, &base(), SIZE, &PoseOptions::default()).unwrap();
        let moved = jacobian_by_reference(&query, &truth) * Vec3::new(0.0, 0.0, 20.0);
        let pan = pose.ptz.pan.turn_from(query.pan).radians();
        assert!(
            (pan - moved.x).abs() < 0.15 * moved.x.abs(),
            "{pan} {}",
            moved.x
        );
        assert!(
            (pose.ptz.focal_px - query.focal_px - moved.z).abs() < 3.0,
            "{}",
            pose.ptz.focal_px
        );
    }
}
