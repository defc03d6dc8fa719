//! The homography that approximates a picture which no homography describes exactly, because the
//! lens distorts or the ground is crowned.
//!
//! A homography maps a plane to a plane. It is fitted over the visible field to pairs of a pixel
//! and the *nominal* point (x, y) that the pixel shows, because a reader of the homography knows
//! the field's plan but not its heights.

use super::frame_camera::Pinhole;
use touchline_core::camera::PtzCamera;
use touchline_core::field::FieldModel;
use touchline_core::geometry::{ImagePoint, ImageSize, Mat3, Vec2, Vec3, homography};
use touchline_core::score::PlaneView;

/// The homography is fitted on a grid of this many pixels in each direction.
const GRID: u32 = 24;
/// Rounds of the fixed-point iteration for the intersection of a ray with the crowned ground; each
/// reduces the error to the slope of the crown, a few per cent.
const HEIGHT_ROUNDS: usize = 4;

/// The homography from the plan of the field (m) to the picture (px) that fits best over the
/// visible field, by the normalised direct linear transform. Exact for flat ground and a lens
/// without distortion.
pub fn fit_image_from_ground(
    pinhole: &Pinhole,
    size: ImageSize,
    field: &FieldModel,
) -> Option<Mat3> {
    let camera = pinhole.ptz_camera()?;
    let pixels = (0..GRID)
        .flat_map(|column| (0..GRID).map(move |row| size.cell_centre([column, row], [GRID; 2])));
    let half_m = [0.5 * field.length_m, 0.5 * field.width_m];

    // Only pixels that show the field itself: the grid would otherwise be dominated by distant
    // ground.
    let pairs: Vec<(Vec2, Vec2)> = pixels
        .filter_map(|pixel| {
            Some((
                place_from_image(&camera, pixel, field)?,
                Vec2::new(pixel.x, pixel.y),
            ))
        })
        .filter(|(place, _)| place.x.abs() <= half_m[0] && place.y.abs() <= half_m[1])
        .collect();
    let fitted = homography(&pairs).ok()?;
    // The direct linear transform leaves the sign open: choose the one with positive depths.
    // A homography of at least four pairs was found, so that there is a first one.
    let depth = fitted.row(2) * Vec3::new(pairs[0].0.x, pairs[0].0.y, 1.0);
    Some(fitted * depth[0].signum())
}

/// How far a camera shows the ground from where a homography does at most, px, over the field that
/// a picture of this size shows. None where it shows none of it.
pub fn misfit_px(
    image_from_ground: &Mat3,
    pinhole: &Pinhole,
    size: ImageSize,
    field: &FieldModel,
) -> Option<f64> {
    let view = PlaneView::new(image_from_ground, size)?;
    let camera = pinhole.ptz_camera()?;
    let half_m = [0.5 * field.length_m, 0.5 * field.width_m];
    let pixels = (0..GRID)
        .flat_map(|column| (0..GRID).map(move |row| size.cell_centre([column, row], [GRID; 2])));
    let shown = pixels.filter_map(|pixel| Some((view.ground_from_image(pixel)?, pixel)));
    let shown = shown.filter(|(at, _)| at.x.abs() <= half_m[0] && at.y.abs() <= half_m[1]);
    // Ground behind the camera is as far as can be.
    let off_px = shown.map(|(ground, pixel)| {
        let image = camera.image_from_world(Vec3::new(ground.x, ground.y, 0.0));
        image.map_or(f64::INFINITY, |image| image.distance_px(pixel))
    });
    off_px.reduce(f64::max)
}

/// The point (x, y) of the field's plan that a pixel shows, m.
fn place_from_image(camera: &PtzCamera, pixel: ImagePoint, field: &FieldModel) -> Option<Vec2> {
    // The ray meets the ground at a height that depends on where it meets it. From flat ground each
    // round uses the height at the place of the round before.
    let mut place = camera.plane_from_image(pixel, 0.0)?;
    if field.crown_m != 0.0 {
        for _ in 0..HEIGHT_ROUNDS {
            place = camera.plane_from_image(pixel, field.ground_z(place.y))?;
        }
    }
    Some(place.xy())
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::exchange::tests::{SIZE, reference};
    use std::collections::BTreeMap;
    use touchline_core::field::builtin;

    /// How far the homography shows points of the ground from where the camera does at most, px.
    fn worst_px(field: &FieldModel, fitted: &Mat3, pinhole: &Pinhole) -> f64 {
        let camera = pinhole.ptz_camera().unwrap();
        let ground = field
            .landmarks
            .iter()
            .filter(|landmark| landmark.nominal_m.z == 0.0);
        let off_px = ground.filter_map(|landmark| {
            let at = camera
                .image_from_world(field.landmark_in_world(landmark))
                .ok()
                .filter(|at| SIZE.contains(*at))?;
            let shown = fitted * Vec3::new(landmark.nominal_m.x, landmark.nominal_m.y, 1.0);
            Some(at.distance_px(ImagePoint::new(shown.x / shown.z, shown.y / shown.z)))
        });
        off_px.fold(0.0, f64::max)
    }

    #[test]
    fn crowned_ground_is_shown_nearer_than_by_the_camera_of_flat_ground() {
        let pinhole =
            Pinhole::from_ptz_camera(&reference().ptz_camera(&reference().frames[0]).unwrap());
        let straight = Pinhole {
            lens: touchline_core::camera::Radial::default(),
            ..pinhole
        };
        let template = builtin("soccer").unwrap();
        let flat = template.model(&BTreeMap::new(), 0.0).unwrap();
        let fitted = fit_image_from_ground(&straight, SIZE, &flat).unwrap();
        assert!(worst_px(&flat, &fitted, &straight) < 1e-6);
        let crowned = template.model(&BTreeMap::new(), 0.35).unwrap();
        let fitted = fit_image_from_ground(&straight, SIZE, &crowned).unwrap();
        let (off_px, flat_off_px) = (
            worst_px(&crowned, &fitted, &straight),
            worst_px(&crowned, &straight.image_from_ground(), &straight),
        );
        assert!(off_px < 0.6 * flat_off_px, "{off_px} {flat_off_px}");
    }
}
