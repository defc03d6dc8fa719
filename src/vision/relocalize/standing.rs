//! No answer from what stands still on the screen.
//!
//! The forest learns rays from a score bug as it does from the stadium. In another picture it lies
//! at the same pixels, and all its features agree that the camera is exactly the reference's. An
//! answer that repeats a reference is therefore believed only if the picture as a whole repeats it,
//! as when the camera did not move; else what stands still is left out, and the rest is asked.

use super::nearest_references::nearest;
use super::{NotFound, Pose, PoseOptions, RayMatches, pose_from_candidates};
use crate::features::{Features, STANDING_PX, WHOLE_PICTURE, place_share};
use touchline_core::camera::{CameraBase, Ptz, PtzCamera};

/// References whose answers are taken apart one after the other.
const MOST_REPEATED: usize = 6;

/// References that an answer may repeat: those nearest to it.
const NEAREST: usize = 12;

/// An answer repeats a reference if this share of its features stand where they stood there.
const REPEATED_SHARE: f64 = 0.6;

/// The camera that most features agree on, leaving out those that stand still on the screen while
/// the rest of the picture moves; with it what is to be said if the features that are left are not
/// sure of it, where some were left out. `features` are those of the picture, all that were asked
/// for; `references` the cameras of the training frames.
///
/// # Errors
/// By name, why there is none: see [`NotFound`].
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
        let (rest, numbers) = matches.without(&left_out);
        let mut pose = match pose_from_candidates(&rest, base, size, options) {
            Ok(pose) => pose,
            Err(reason) => return Err(stands_still.unwrap_or(reason)),
        };
        for inlier in &mut pose.inliers {
            *inlier = numbers[*inlier];
        }
        let points = pose.inliers.iter().map(|&inlier| matches.point(inlier));
        let all = features.keypoints.iter().map(|keypoint| keypoint.point);
        if place_share(points, all, size) >= WHOLE_PICTURE {
            return Ok((pose, stands_still));
        }
        let Some(reference) = repeated(&pose, matches, base, references, standing_px) else {
            return Ok((pose, stands_still));
        };
        stands_still = Some(NotFound::StandsStill {
            inliers: pose.inliers.len(),
        });
        for (feature, left_out) in left_out.iter_mut().enumerate() {
            *left_out |= stands(matches, feature, &reference, standing_px);
        }
    }
    Err(stands_still.unwrap_or(NotFound::NoAgreement {
        matched: matches.len(),
        agreeing: 0,
        needed: 0,
    }))
}

/// The reference that an answer repeats, if any: most of its features stand where they stood there.
fn repeated(
    pose: &Pose,
    matches: &RayMatches,
    base: &CameraBase,
    references: &[Ptz],
    standing_px: f64,
) -> Option<PtzCamera> {
    let needed = REPEATED_SHARE * pose.inliers.len() as f64;
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

/// Whether a feature lies where one of its rays lay in a reference.
fn stands(matches: &RayMatches, feature: usize, reference: &PtzCamera, standing_px: f64) -> bool {
    let point = matches.point(feature);
    matches.rays(feature).iter().any(|&ray| {
        let in_cam = reference.cam_from_base() * ray;
        reference
            .image_from_cam(in_cam)
            .is_ok_and(|image| image.distance_px(point) <= standing_px)
    })
}
