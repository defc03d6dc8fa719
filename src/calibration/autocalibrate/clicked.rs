//! Poses of the panorama from clicks on two landmarks.
//!
//! The relative rotations of the frames are known, so clicks in different frames are directions in
//! one frame, `panorama`. With a vertical pan axis, four parameters are open: the position and the
//! heading. Two landmarks of the ground, in one frame or in two, determine them in closed form.

use super::pose::PanoramaPose;
use touchline_core::field::{FieldModel, LandmarkId};
use touchline_core::geometry::{Angle, ImagePoint, Vec2, Vec3};
use touchline_documents::document::{Click, Frames, Target};
use touchline_vision::track::RelativeRotations;

/// Landmarks higher than this above the ground are left out, m.
const ON_GROUND_M: f64 = 0.01;
/// Landmarks closer together than this do not determine a pose well, m.
const LEAST_APART_M: f64 = 5.0;
/// The camera is this high above the field, m.
const HEIGHTS_M: std::ops::RangeInclusive<f64> = 2.0..=100.0;
/// A ray that descends by less than this share of its length is too flat to locate a ground point.
const LEAST_FALL: f64 = 0.01;

/// A click on a landmark of the ground in a sampled frame.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct GroundClick {
    /// Index of the frame, in the document or in the group of matched frames.
    pub frame: usize,
    pub landmark: LandmarkId,
    pub image: ImagePoint,
}

impl GroundClick {
    /// The clicks of some frames of a document, given by their indices; clicks held out for checks
    /// are left out.
    pub fn of(frames: &Frames, places: &[usize], field: &FieldModel) -> Vec<Self> {
        let of_click = |frame: usize, click: &Click| {
            let Some(Target::Landmark(id)) = click.target.as_ref().filter(|_| !click.check) else {
                return None;
            };
            let landmark = field.landmark(id.as_str())?;
            (landmark.nominal_m.z.abs() <= ON_GROUND_M).then(|| Self {
                frame,
                landmark: id.clone(),
                image: click.image,
            })
        };
        let of_frame = |&frame: &usize| {
            frames[frame]
                .clicks
                .iter()
                .filter_map(move |click| of_click(frame, click))
        };
        places.iter().flat_map(of_frame).collect()
    }
}

/// The poses that pairs of clicks determine on a field, at the given rotations. The pair of
/// landmarks that are farthest apart comes first: its pose is the most precise.
pub(super) fn poses(
    rotations: &RelativeRotations,
    clicks: &[GroundClick],
    field: &FieldModel,
) -> Vec<PanoramaPose> {
    // Each click as the horizontal offset of its ray at a depth of 1 m below the camera, in
    // `panorama`, with the horizontal position of its landmark.
    let sight = |click: &GroundClick| {
        let ray = rotations
            .camera(click.frame)
            .world_direction_from_image(click.image)
            .ok()?
            .try_normalize(0.0)?;
        let at_m = field.landmark_in_world(field.landmark(click.landmark.as_str())?);
        (ray.z < -LEAST_FALL).then(|| (ray.xy() / -ray.z, at_m.xy()))
    };
    let sights: Vec<(Vec2, Vec2)> = clicks.iter().filter_map(sight).collect();
    let mut found: Vec<(f64, PanoramaPose)> = Vec::new();
    // All pairs of clicks. The distance of the landmarks is the sort key.
    for (index, one) in sights.iter().enumerate() {
        for other in &sights[index + 1..] {
            found.extend(pose_of(one, other).map(|pose| ((other.1 - one.1).norm(), pose)));
        }
    }
    found.sort_by(|a, b| b.0.total_cmp(&a.0));
    found.into_iter().map(|(_, pose)| pose).collect()
}

/// The pose in which two rays of a panorama with a vertical pan axis meet the ground at two points.
/// Rays are given by their horizontal offsets at 1 m below the camera; ground is z = 0.
///
/// On a plane at depth h the rays are h times as far apart as at 1 m, so h = |P₂ − P₁| / |r₂ − r₁|.
/// The heading is the rotation between the two difference vectors, and the position follows from
/// one of the points.
fn pose_of((ray, at): &(Vec2, Vec2), (other_ray, other_at): &(Vec2, Vec2)) -> Option<PanoramaPose> {
    let (between_rays, between) = (other_ray - ray, other_at - at);
    if between.norm() < LEAST_APART_M {
        return None;
    }
    let height_m = between.norm() / between_rays.norm();
    if !HEIGHTS_M.contains(&height_m) {
        return None;
    }
    let angle = |of: Vec2| of.y.atan2(of.x);
    let heading = Angle::from_radians(angle(between_rays) - angle(between));
    // The ray to the first landmark in `world`, scaled to 1 m of descent. The camera is `height_m`
    // times this vector away from the landmark.
    let turned = PanoramaPose::upright(Vec3::zeros(), heading).world_from_panorama
        * Vec3::new(ray.x, ray.y, -1.0);
    Some(PanoramaPose::upright(
        Vec3::new(at.x, at.y, 0.0) - height_m * turned,
        heading,
    ))
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::collections::BTreeMap;
    use touchline_core::camera::{FocalCurve, Ptz};
    use touchline_core::field::builtin;
    use touchline_core::geometry::ImageSize;

    #[test]
    fn two_landmarks_in_two_frames_say_where_the_camera_stands() {
        let rotations = RelativeRotations {
            ptz: vec![
                Ptz::from_degrees(-25.0, -12.0, 2100.0),
                Ptz::from_degrees(18.0, -9.0, 2600.0),
            ],
            lens: FocalCurve::NONE,
            image_size: ImageSize::new(1920, 1080),
            residual_px: 0.5,
        };
        let truth = PanoramaPose::upright(Vec3::new(12.0, -58.0, 9.0), Angle::from_degrees(-7.0));
        // Landmarks are placed where the rays of the clicks meet the ground.
        let mut field = builtin("soccer")
            .unwrap()
            .model(&BTreeMap::new(), 0.0)
            .unwrap();
        let mut clicked = |place: usize, frame: usize, x: f64, y: f64| {
            let image = ImagePoint::new(x, y);
            let ray = rotations
                .camera(frame)
                .world_direction_from_image(image)
                .unwrap();
            let landmark = &mut field.landmarks[place];
            landmark.nominal_m = truth.at_height(ray, 0.0).unwrap();
            GroundClick {
                frame,
                landmark: landmark.id.clone(),
                image,
            }
        };
        let (one, other) = (clicked(0, 0, 500.0, 700.0), clicked(1, 1, 1300.0, 600.0));
        let found = poses(&rotations, &[one.clone(), other], &field);
        let [pose] = found.as_slice() else {
            panic!("{found:?}")
        };
        assert!(
            (pose.position_m - truth.position_m).norm() < 1e-9,
            "{pose:?}"
        );
        assert!(
            (pose.world_from_panorama - truth.world_from_panorama).norm() < 1e-9,
            "{pose:?}"
        );
        // A single point, clicked twice, gives no pose, nor does a point above the horizon.
        let sky = GroundClick {
            image: ImagePoint::new(900.0, -4000.0),
            ..one.clone()
        };
        assert_eq!(poses(&rotations, &[one.clone(), one, sky], &field), []);
    }
}
