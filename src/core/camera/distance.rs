//! How far apart two cameras of one base are. Each meaning has one measure.
//!
//! The *angular distance* compares directions and zoom and needs no picture. The *image-space
//! distance* is how far a point of one camera's picture moves when the other camera takes it, in
//! px: what a person sees of a wrong overlay. Which points and which summary of them count is for
//! the caller to say, because a median forgives the corners that a maximum looks for.

use super::{Ptz, PtzCamera};
use crate::geometry::{Angle, ImagePoint, ImageSize};

/// How far two cameras are apart in direction and in zoom.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct AngularDistance {
    /// The angle between the optical axes, to first order.
    pub turn: Angle,
    /// The logarithm of the ratio of the first camera's focal length to the second one's.
    pub log_zoom: f64,
}

impl AngularDistance {
    /// From one camera to another.
    pub fn between(one: &Ptz, other: &Ptz) -> Self {
        // A rotation about the vertical moves the optical axis by the cosine of its tilt.
        let pan = one.pan.turn_from(other.pan).radians() * one.tilt.radians().cos();
        let tilt = (one.tilt - other.tilt).radians();
        let log_zoom = (one.focal_px / other.focal_px).ln();
        Self {
            turn: Angle::from_radians(pan.hypot(tilt)),
            log_zoom,
        }
    }

    /// About how far points of the picture move from the first camera, of focal length `focal_px`,
    /// to the second, px: by the turn in the middle, or by the zoom at the left and right border.
    pub fn in_image_px(&self, focal_px: f64, image_size: ImageSize) -> f64 {
        let turned_px = self.turn.radians() * focal_px;
        let zoomed_px = 0.5 * f64::from(image_size.width) * self.log_zoom.abs();
        turned_px.max(zoomed_px)
    }
}

/// The image-space distances of two cameras of a picture at some of its points, px: how far the
/// point that the first camera shows there lies away in the second one's picture. Infinite where
/// the second does not see it. A point beyond the fold of the first one's lens shows nothing and
/// is left out.
pub fn image_space_distances_px(
    one: &PtzCamera,
    other: &PtzCamera,
    points: impl IntoIterator<Item = ImagePoint>,
) -> impl Iterator<Item = f64> {
    // Both cameras share a base, so a direction suffices for the other one.
    points.into_iter().filter_map(|point| {
        let ray = one.ray_from_image(point).ok()?;
        Some(
            other
                .image_from_ray(ray)
                .map_or(f64::INFINITY, |image| image.distance_px(point)),
        )
    })
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::geometry::Vec3;
    use crate::testing::{SIZE, TestBase, base_at};

    fn camera(pan_deg: f64, focal_px: f64) -> PtzCamera {
        let position_m = Vec3::new(0.0, -60.0, 15.0);
        base_at(position_m, SIZE).aim(pan_deg, -10.0, focal_px)
    }

    #[test]
    fn a_small_turn_moves_the_middle_by_its_angle_times_the_focal_length() {
        let (one, other) = (camera(0.0, 3000.0), camera(0.1, 3000.0));
        let distance = AngularDistance::between(&one.ptz(), &other.ptz());
        let expected_px = 3000.0 * 0.1_f64.to_radians() * 10.0_f64.to_radians().cos();
        assert!((distance.in_image_px(3000.0, SIZE) - expected_px).abs() < 1e-9);
        let seen_px = image_space_distances_px(&one, &other, [SIZE.centre()])
            .next()
            .unwrap();
        assert!(
            (seen_px - expected_px).abs() < 0.01,
            "{seen_px} {expected_px}"
        );
    }

    #[test]
    fn a_zoom_moves_the_border_by_half_the_width_times_its_logarithm() {
        let (one, other) = (camera(0.0, 3000.0), camera(0.0, 3003.0));
        let distance = AngularDistance::between(&one.ptz(), &other.ptz());
        assert_eq!(distance.turn, Angle::ZERO);
        let border = ImagePoint::new(0.0, SIZE.centre().y);
        let seen_px = image_space_distances_px(&one, &other, [border])
            .next()
            .unwrap();
        assert!(
            (distance.in_image_px(3000.0, SIZE) - seen_px).abs() < 0.01,
            "{seen_px}"
        );
    }

    #[test]
    fn what_the_other_camera_does_not_see_is_infinitely_far() {
        let (one, other) = (camera(0.0, 3000.0), camera(180.0, 3000.0));
        let distances = image_space_distances_px(&one, &other, [SIZE.centre()]);
        assert_eq!(distances.collect::<Vec<_>>(), [f64::INFINITY]);
    }
}
