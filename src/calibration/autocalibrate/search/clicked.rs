//! Poses of the panorama from clicks on two landmarks.
//!
//! The relative rotations of the frames are known, so clicks in different frames are directions in
//! one frame, `panorama`. With the pan axis known, four parameters are open: the position and the
//! heading. Two landmarks of the ground, in one frame or in two, determine them in closed form.
//!
//! The pan axis of a tripod leans by a few degrees. A high camera hardly notices; from a mast 4 m
//! high the middle of the field lies 4° below the horizon, and a lean of 2° halves or doubles its
//! distance. So each pair gives a pose for each of several leans, and the paint decides.

use super::places::relative_size;
use super::pose::PanoramaPose;
use touchline_core::field::{FieldModel, LandmarkId};
use touchline_core::geometry::rotation::from_rotation_vector;
use touchline_core::geometry::{Angle, ImagePoint, Mat3, Vec2, Vec3};
use touchline_documents::document::{Click, Frames, Target};
use touchline_vision::track::RelativeRotations;

/// Landmarks closer together than this do not determine a pose well, on a soccer pitch, m.
const LEAST_APART_M: f64 = 5.0;
/// The camera is this high above the field, on a soccer pitch, m.
const HEIGHTS_M: std::ops::RangeInclusive<f64> = 2.0..=100.0;
/// A ray that descends by less than this share of its length is too flat to locate a ground point.
const LEAST_FALL: f64 = 0.01;
/// Leans of the pan axis that are tried, degrees. Half a step is what the search improves.
const MAX_LEAN_DEG: f64 = 4.0;
const LEAN_STEP_DEG: f64 = 2.0;

/// A click on a landmark of the ground in a sampled frame.
#[derive(Clone, Debug, PartialEq)]
pub struct GroundClick {
    /// Index of the frame, in the document or in the group of matched frames.
    pub frame: usize,
    pub landmark: LandmarkId,
    pub image: ImagePoint,
}

impl GroundClick {
    /// The clicks of some frames of a document, given by their indices; clicks held out for checks
    /// are left out.
    pub fn from_frames(frames: &Frames, places: &[usize], field: &FieldModel) -> Vec<Self> {
        places
            .iter()
            .flat_map(|&frame| {
                let clicks = frames[frame].clicks.iter();
                clicks.filter_map(move |click| Self::from_click(frame, click, field))
            })
            .collect()
    }

    /// A click that is not held out, if it shows a landmark of the ground.
    fn from_click(frame: usize, click: &Click, field: &FieldModel) -> Option<Self> {
        let Some(Target::Landmark(id)) = click.target.as_ref().filter(|_| !click.check) else {
            return None;
        };
        let landmark = field.landmark(id.as_str())?;
        landmark.is_on_ground().then(|| Self {
            frame,
            landmark: id.clone(),
            image: click.image,
        })
    }
}

/// The ray of a click, with the landmark that it meets.
struct LandmarkRay {
    ray_in_panorama: Vec3,
    /// Horizontal position of the landmark, m.
    at_m: Vec2,
}

impl LandmarkRay {
    /// The ray of a click at the given rotations; none beyond the fold of the lens, or if the field
    /// has no such landmark.
    fn from_click(
        click: &GroundClick,
        rotations: &RelativeRotations,
        field: &FieldModel,
    ) -> Option<Self> {
        let camera = rotations.camera(click.frame);
        let ray = camera.world_direction_from_image(click.image).ok()?;
        let landmark = field.landmark(click.landmark.as_str())?;
        Some(Self {
            ray_in_panorama: ray.try_normalize(0.0)?,
            at_m: field.landmark_in_world(landmark).xy(),
        })
    }

    /// The horizontal offset of the ray per metre of descent, with the pan axis leaning by a
    /// rotation; none if the ray is too flat ([`LEAST_FALL`]).
    fn offset_per_m(&self, lean: &Mat3) -> Option<Vec2> {
        let ray = lean * self.ray_in_panorama;
        (ray.z < -LEAST_FALL).then(|| ray.xy() / -ray.z)
    }
}

/// The poses that pairs of clicks determine on a field, at the given rotations: one for each lean
/// of the pan axis that allows one. The pair of landmarks that are farthest apart comes first: its
/// poses are the most precise. Pairs without any pose are left out of the `most`.
pub fn poses_of_pairs(
    rotations: &RelativeRotations,
    clicks: &[GroundClick],
    field: &FieldModel,
    most: usize,
) -> Vec<Vec<PanoramaPose>> {
    let rays: Vec<LandmarkRay> = clicks
        .iter()
        .filter_map(|click| LandmarkRay::from_click(click, rotations, field))
        .collect();
    let (leans, relative_size) = (leans(), relative_size(field));
    // All pairs of clicks, by the distance of their landmarks. Hundreds of clicks have a hundred
    // thousand pairs, so only the first ones get their poses.
    let mut pairs: Vec<(f64, &LandmarkRay, &LandmarkRay)> = Vec::new();
    for (index, one) in rays.iter().enumerate() {
        let others = rays[index + 1..].iter();
        pairs.extend(others.map(|other| ((other.at_m - one.at_m).norm(), one, other)));
    }
    pairs.sort_by(|a, b| b.0.total_cmp(&a.0));
    let poses_by_pair = pairs.iter().map(|(_, one, other)| {
        let poses = leans
            .iter()
            .filter_map(|lean| pose_of(one, other, lean, relative_size));
        poses.collect::<Vec<PanoramaPose>>()
    });
    poses_by_pair
        .filter(|poses| !poses.is_empty())
        .take(most)
        .collect()
}

/// Rotations that lean the pan axis: none, and up to [`MAX_LEAN_DEG`] in every direction.
fn leans() -> Vec<Mat3> {
    let steps = (MAX_LEAN_DEG / LEAN_STEP_DEG) as i32;
    let mut leans = vec![Mat3::identity()];
    for x in -steps..=steps {
        for y in -steps..=steps {
            let lean_deg = LEAN_STEP_DEG * Vec2::new(f64::from(x), f64::from(y));
            if (x, y) != (0, 0) && lean_deg.norm() < MAX_LEAN_DEG + 0.5 * LEAN_STEP_DEG {
                let turn = lean_deg.map(f64::to_radians).push(0.0);
                leans.push(from_rotation_vector(turn));
            }
        }
    }
    leans
}

/// The pose in which two rays of a panorama meet the ground (z = 0) at two points, with the pan
/// axis leaning by a rotation.
///
/// Where rays are given by their horizontal offsets r at 1 m below the camera, on a plane at depth
/// h they are h times as far apart: h = |P₂ − P₁| / |r₂ − r₁|. The heading is the rotation between
/// the two difference vectors, and the position follows from one of the points.
fn pose_of(
    one: &LandmarkRay,
    other: &LandmarkRay,
    lean: &Mat3,
    relative_size: f64,
) -> Option<PanoramaPose> {
    let (ray, other_ray) = (one.offset_per_m(lean)?, other.offset_per_m(lean)?);
    let (between_rays, between) = (other_ray - ray, other.at_m - one.at_m);
    if between.norm() < LEAST_APART_M * relative_size {
        return None;
    }
    let height_m = between.norm() / between_rays.norm();
    if !HEIGHTS_M.contains(&(height_m / relative_size)) {
        return None;
    }
    let heading =
        Angle::from_radians(between_rays.y.atan2(between_rays.x) - between.y.atan2(between.x));
    // The ray to the first landmark in `world`, scaled to 1 m of descent. The camera is `height_m`
    // times this vector away from the landmark.
    let upright = PanoramaPose::upright(Vec3::zeros(), heading).world_from_panorama;
    let descent = upright * ray.push(-1.0);
    Some(PanoramaPose {
        position_m: one.at_m.push(0.0) - height_m * descent,
        world_from_panorama: upright * lean,
    })
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
            principal_point: ImageSize::new(1920, 1080).centre(),
            residual_px: 0.5,
        };
        let upright = PanoramaPose::upright(Vec3::new(12.0, -58.0, 9.0), Angle::from_degrees(-7.0));
        let lean = from_rotation_vector(Vec3::new(2.0, -2.0, 0.0).map(f64::to_radians));
        let truth = PanoramaPose {
            world_from_panorama: upright.world_from_panorama * lean,
            ..upright
        };
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
        let third = clicked(2, 0, 800.0, 620.0);
        let (one, other) = (clicked(0, 0, 500.0, 700.0), clicked(1, 1, 1300.0, 600.0));
        let found = poses_of_pairs(&rotations, &[one.clone(), other.clone()], &field, 6);
        let [poses] = found.as_slice() else {
            panic!("{found:?}")
        };
        let is_truth = |pose: &PanoramaPose| {
            (pose.position_m - truth.position_m).norm() < 1e-9
                && (pose.world_from_panorama - truth.world_from_panorama).norm() < 1e-9
        };
        assert!(poses.iter().any(is_truth), "{poses:?}");
        let three = [one.clone(), other, third];
        let all = poses_of_pairs(&rotations, &three, &field, 6);
        assert_eq!(poses_of_pairs(&rotations, &three, &field, 1), all[..1]);
        // A single point, clicked twice, gives no pose, nor does a point above the horizon.
        let sky = GroundClick {
            image: ImagePoint::new(900.0, -4000.0),
            ..one.clone()
        };
        assert!(poses_of_pairs(&rotations, &[one.clone(), one, sky], &field, 6).is_empty());
    }
}
