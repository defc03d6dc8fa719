//! Where a camera stands by a few clicks: tied frames are turned to each other already, so that two
//! landmarks, in one frame or in two, leave only its place and heading open, and determine them.

use super::pose::PanoramaPose;
use touchline_core::field::{FieldModel, LandmarkId};
use touchline_core::geometry::{Angle, ImagePoint, Vec2, Vec3};
use touchline_documents::document::{Click, Frames, Target};
use touchline_vision::track::Turns;

/// Landmarks higher than this above the ground are left out, m.
const ON_GROUND_M: f64 = 0.01;
/// Landmarks nearer to each other hardly say anything, m.
const LEAST_APART_M: f64 = 5.0;
/// A camera stands this high above the field, m.
const HEIGHTS_M: std::ops::RangeInclusive<f64> = 2.0..=100.0;
/// A ray that falls by less than this is not one of ground, as a share of its length.
const LEAST_FALL: f64 = 0.01;

/// A click on a landmark of the ground in a frame that was looked at.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct GroundClick {
    /// The frame's place: in the document, or in a group.
    pub frame: usize,
    pub landmark: LandmarkId,
    pub image: ImagePoint,
}

impl GroundClick {
    /// Those of some frames, by the places of these in the document; held-out clicks are none.
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

/// The places that pairs of clicks name on a field, in a group's frames turned as stated; the pair
/// farthest apart first.
pub(super) fn poses(
    turns: &Turns,
    clicks: &[GroundClick],
    field: &FieldModel,
) -> Vec<PanoramaPose> {
    let sight = |click: &GroundClick| {
        let ray = turns
            .camera(click.frame)
            .world_direction_from_image(click.image)
            .ok()?
            .try_normalize(0.0)?;
        let at_m = field.landmark_in_world(field.landmark(click.landmark.as_str())?);
        (ray.z < -LEAST_FALL).then(|| (ray.xy() / -ray.z, at_m.xy()))
    };
    let sights: Vec<(Vec2, Vec2)> = clicks.iter().filter_map(sight).collect();
    let mut found: Vec<(f64, PanoramaPose)> = Vec::new();
    for (index, one) in sights.iter().enumerate() {
        for other in &sights[index + 1..] {
            found.extend(pose_of(one, other).map(|pose| ((other.1 - one.1).norm(), pose)));
        }
    }
    found.sort_by(|a, b| b.0.total_cmp(&a.0));
    found.into_iter().map(|(_, pose)| pose).collect()
}

/// The place from which two rays of an upright rig meet the ground at two points; rays as where
/// they come to 1 m below.
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
        let turns = Turns {
            ptz: vec![
                Ptz::from_degrees(-25.0, -12.0, 2100.0),
                Ptz::from_degrees(18.0, -9.0, 2600.0),
            ],
            lens: FocalCurve::NONE,
            image_size: ImageSize::new(1920, 1080),
            residual_px: 0.5,
        };
        let truth = PanoramaPose::upright(Vec3::new(12.0, -58.0, 9.0), Angle::from_degrees(-7.0));
        // Landmarks lie where the rays of clicks meet the ground.
        let mut field = builtin("soccer")
            .unwrap()
            .model(&BTreeMap::new(), 0.0)
            .unwrap();
        let mut clicked = |place: usize, frame: usize, x: f64, y: f64| {
            let image = ImagePoint::new(x, y);
            let ray = turns
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
        let found = poses(&turns, &[one.clone(), other], &field);
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
        // One point twice says nothing, nor does a point above the horizon.
        let sky = GroundClick {
            image: ImagePoint::new(900.0, -4000.0),
            ..one.clone()
        };
        assert_eq!(poses(&turns, &[one.clone(), one, sky], &field), []);
    }
}
