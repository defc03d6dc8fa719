//! Rejects answers that rest on burnt-in graphics.
//!
//! A forest learns rays from a score bug as well as from the stadium. In another picture the score
//! bug lies at the same pixels, and all its features agree that the camera is exactly that of the
//! reference. An answer that repeats a reference is therefore accepted only if the picture as a
//! whole repeats it, as when the camera did not move; otherwise the features that stand still are
//! excluded and the pose is estimated again.

use super::nearest_references::nearest;
use super::{NotFound, Pose, PoseOptions, RayMatches, pose_from_candidates};
use crate::features::{Features, STANDING_PX, WHOLE_PICTURE, place_share};
use touchline_core::camera::{CameraBase, Ptz, PtzCamera};

/// Maximum number of rounds of excluding the features that stand still.
const MOST_REPEATED: usize = 6;

/// Number of nearest references that an answer is compared with.
const NEAREST: usize = 12;

/// An answer repeats a reference if at least this share of its inliers lies at the same pixels in
/// both.
const REPEATED_SHARE: f64 = 0.6;

/// The camera that most features agree on, without features that stand still on the screen while
/// the rest of the picture moves. If some were excluded, the second value is the reason to state
/// should the rest not suffice.
///
/// `features` are all features of the picture; `references` are the cameras of the training frames.
///
/// # Errors
/// A [`NotFound`] that names the reason.
pub fn pose_of_moving(
    matches: &RayMatches,
    features: &Features,
    base: &CameraBase,
    references: &[Ptz],
    options: &PoseOptions,
) -> Result<(Pose, Option<NotFound>), NotFound> {
    let size = features.image_size;
    let standing_px = STANDING_PX * size.scale_from_1920();
    let mut left_out = vec![false; matches.len()];
    let mut stands_still = None;
    for _ in 0..MOST_REPEATED {
        // Estimate without the excluded features, and restore the original indices.
        let (rest, numbers) = matches.without(&left_out);
        let mut pose = match pose_from_candidates(&rest, base, size, options) {
            Ok(pose) => pose,
            Err(reason) => return Err(stands_still.unwrap_or(reason)),
        };
        for inlier in &mut pose.inliers {
            *inlier = numbers[*inlier];
        }
        // Inliers in many cells of the picture are the stadium, whether they stand still or not.
        let points = pose.inliers.iter().map(|&inlier| matches.point(inlier));
        let all = features.keypoints.iter().map(|keypoint| keypoint.point);
        if place_share(points, all, size) >= WHOLE_PICTURE {
            return Ok((pose, stands_still));
        }
        let Some(reference) =
            find_repeated_reference(&pose, matches, base, references, standing_px)
        else {
            return Ok((pose, stands_still));
        };
        // Exclude all features that stand still relative to this reference, and try again.
        stands_still = Some(NotFound::StandsStill {
            inliers: pose.inliers.len(),
        });
        for (feature, left_out) in left_out.iter_mut().enumerate() {
            *left_out |= stands(matches, feature, &reference, standing_px);
        }
    }
    // Each round excluded at least the standing inliers, and another answer still repeats some
    // reference. `stands_still` is set by then; the alternative only completes the type.
    Err(stands_still.unwrap_or(NotFound::NoAgreement {
        matched: matches.len(),
        agreeing: 0,
        needed: 0,
    }))
}

/// The reference that an answer repeats, if any: most of its inliers lie where they lay in that
/// reference.
fn find_repeated_reference(
    pose: &Pose,
    matches: &RayMatches,
    base: &CameraBase,
    references: &[Ptz],
    standing_px: f64,
) -> Option<PtzCamera> {
    let needed = REPEATED_SHARE * pose.inliers.len() as f64;
    // Only references near the answer can be repeated by it, and `stands` projects every candidate
    // of every inlier, so that few references are tried.
    let near = nearest(&pose.ptz, references, NEAREST).into_iter();
    near.map(|number| PtzCamera::new(*base, references[number]))
        .find(|reference| {
            let standing = pose
                .inliers
                .iter()
                .filter(|&&inlier| stands(matches, inlier, reference, standing_px));
            standing.count() as f64 >= needed
        })
}

/// Whether a feature lies at the pixel at which a reference saw one of its rays.
fn stands(matches: &RayMatches, feature: usize, reference: &PtzCamera, standing_px: f64) -> bool {
    let point = matches.point(feature);
    matches.rays(feature).iter().any(|&ray| {
        let in_cam = reference.cam_from_base() * ray;
        reference
            .image_from_cam(in_cam)
            .is_ok_and(|image| image.distance_px(point) <= standing_px)
    })
}
