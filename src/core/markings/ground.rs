//! The ground that a picture shows.

use crate::camera::PtzCamera;
use crate::field::FieldModel;
use crate::geometry::{ImagePoint, ImageSize, Vec3};

/// Number of points on each edge of the picture. Distortion makes the edges curved.
const POINTS_PER_EDGE: u32 = 24;

/// The border of the ground that a picture shows, as points of `world` (m) in the order of the
/// picture's corners, from the top left clockwise.
///
/// Where the picture shows the horizon or the sky, the border runs at the distance `reach_m` from
/// the camera. Empty if no point of the picture's border shows ground within that distance.
pub fn visible_ground(
    field: &FieldModel,
    camera: &PtzCamera,
    size: ImageSize,
    reach_m: f64,
) -> Vec<Vec3> {
    let mut border = Vec::with_capacity(4 * POINTS_PER_EDGE as usize);
    let mut sees_ground = false;
    let corners = size.corners();
    for (i, from) in corners.iter().enumerate() {
        let to = corners[(i + 1) % corners.len()];
        for step in 0..POINTS_PER_EDGE {
            let along = f64::from(step) / f64::from(POINTS_PER_EDGE);
            let point = from.translate(to.offset_from(*from) * along);
            if let Some(ground) = ground_from_image(field, camera, point, reach_m) {
                sees_ground = true;
                border.push(ground);
            } else if let Some(far) = far_away(camera, point, reach_m) {
                border.push(far);
            }
        }
    }
    if sees_ground { border } else { Vec::new() }
}

/// The intersection of a pixel's ray with the crowned ground, `world`, m. None if it is farther
/// than `reach_m` from the camera.
fn ground_from_image(
    field: &FieldModel,
    camera: &PtzCamera,
    point: ImagePoint,
    reach_m: f64,
) -> Option<Vec3> {
    let mut ground = camera.plane_from_image(point, 0.0)?;
    // Fixed-point iteration: intersect with the plane at the ground's height at the last point. The
    // crown is a few centimetres over tens of metres, so each step reduces the error about tenfold,
    // at grazing angles less.
    for _ in 0..12 {
        ground = camera.plane_from_image(point, field.ground_z(ground.y))?;
    }
    let away = ground - camera.base().position_m;
    (away.x.hypot(away.y) <= reach_m).then_some(ground)
}

/// The ground `reach_m` away from the camera, in the direction of an image point; none straight up
/// or down.
fn far_away(camera: &PtzCamera, point: ImagePoint, reach_m: f64) -> Option<Vec3> {
    let direction = camera.world_direction_from_image(point).ok()?;
    let horizontal = direction.x.hypot(direction.y);
    let position = camera.base().position_m;
    let scale = reach_m / horizontal;
    scale.is_finite().then(|| {
        Vec3::new(
            position.x + direction.x * scale,
            position.y + direction.y * scale,
            0.0,
        )
    })
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::field::builtin;
    use crate::testing::{TestBase, base_at};
    use std::collections::BTreeMap;

    const SIZE: ImageSize = ImageSize::new(1280, 720);

    fn camera(tilt_deg: f64, focal_px: f64) -> PtzCamera {
        base_at([3.0, -60.0, 18.0], SIZE).aim(-10.0, tilt_deg, focal_px)
    }

    fn field(crown_m: f64) -> FieldModel {
        builtin("soccer")
            .unwrap()
            .model(&BTreeMap::new(), crown_m)
            .unwrap()
    }

    #[test]
    fn the_border_projects_back_onto_the_pictures_border() {
        let (field, camera) = (field(0.2), camera(-14.0, 2200.0));
        let border = visible_ground(&field, &camera, SIZE, 400.0);
        assert_eq!(border.len(), 96);
        for point in border {
            assert!((point.z - field.ground_z(point.y)).abs() < 1e-6);
            let image = camera.image_from_world(point).unwrap();
            let inside = image
                .x
                .min(image.y)
                .min(1280.0 - image.x)
                .min(720.0 - image.y);
            assert!(inside.abs() < 1e-6, "{image:?} is {inside} px inside");
        }
    }

    #[test]
    fn beyond_the_horizon_the_border_keeps_its_distance_and_the_sky_shows_no_ground() {
        let (field, level) = (field(0.0), camera(-2.0, 1500.0));
        let border = visible_ground(&field, &level, SIZE, 300.0);
        let distances = border
            .iter()
            .map(|p| (p - level.base().position_m).xy().norm());
        assert!(border.len() == 96 && distances.clone().all(|distance| distance <= 300.0 + 1e-9));
        assert!(
            distances
                .filter(|distance| (distance - 300.0).abs() < 1e-9)
                .count()
                > 24
        );
        assert!(visible_ground(&field, &camera(60.0, 1500.0), SIZE, 300.0).is_empty());
    }
}
