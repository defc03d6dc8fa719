//! The scores of cameras for homographies of the ground, for datasets that contain nothing else.
//!
//! A homography here takes a point of the plane z = 0 (x and y in world, m) to the picture (px).
//! Its scale and sign are arbitrary; [`PlaneView::new`] chooses them so that the ground in the
//! middle of the picture has depth 1.

use super::ground::field_corners;
use super::overlap::intersection_over_union;
use super::polygon::{Ring, cut};
use crate::camera::PtzCamera;
use crate::field::FieldModel;
use crate::geometry::{ImagePoint, ImageSize, Mat3, Vec2, Vec3};

/// The minimum depth of visible ground, as a fraction of the depth in the middle of the picture.
const MIN_DEPTH_SHARE: f64 = 1e-3;

/// The view of the ground under a homography.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct PlaneView {
    image_from_ground: Mat3,
    ground_from_image: Mat3,
    size: ImageSize,
}

impl PlaneView {
    /// Normalises a homography from the ground (world x and y, m) to a picture (px). None if it is
    /// singular, or if the middle of the picture shows no ground.
    pub fn new(image_from_ground: &Mat3, size: ImageSize) -> Option<Self> {
        let middle = size.centre();
        let ground = image_from_ground.try_inverse()? * Vec3::new(middle.x, middle.y, 1.0);
        let depth = (image_from_ground * (ground / ground.z)).z;
        // Normalise the depth in the middle of the picture to 1.
        let image_from_ground = image_from_ground / depth;
        let ground_from_image = image_from_ground.try_inverse()?;
        let finite = image_from_ground
            .iter()
            .chain(ground_from_image.iter())
            .all(|entry| entry.is_finite());
        finite.then_some(Self {
            image_from_ground,
            ground_from_image,
            size,
        })
    }

    /// The view of a camera without its distortion.
    pub fn from_camera(camera: &PtzCamera, size: ImageSize) -> Option<Self> {
        // On the plane z = 0 the third column of [R | −R C] drops out (Hartley and Zisserman,
        // Multiple View Geometry, section 8.1).
        let rotation = camera.cam_from_world();
        let at_origin = -(rotation * camera.base().position_m);
        let cam_from_ground = Mat3::from_columns(&[
            rotation.column(0).into(),
            rotation.column(1).into(),
            at_origin,
        ]);
        Self::new(&(camera.calibration_matrix() * cam_from_ground), size)
    }

    /// Projects a ground point into the picture, px. None beyond the horizon.
    pub fn image_from_ground(&self, ground: Vec2) -> Option<ImagePoint> {
        let image = self.image_from_ground * Vec3::new(ground.x, ground.y, 1.0);
        (image.z > MIN_DEPTH_SHARE).then(|| ImagePoint::new(image.x / image.z, image.y / image.z))
    }

    /// The ground point at a pixel (world x and y, m). None above the horizon.
    pub fn ground_from_image(&self, image: ImagePoint) -> Option<Vec2> {
        let ground = self.ground_from_image * Vec3::new(image.x, image.y, 1.0);
        // The third coordinate of the back-projection is the inverse of the ground point's depth.
        (ground.z > 0.0 && ground.z < 1.0 / MIN_DEPTH_SHARE).then(|| ground.xy() / ground.z)
    }

    /// The part of the field that the picture shows: a convex polygon (world x and y, m), empty if
    /// it shows nothing.
    pub fn visible_field(&self, field: &FieldModel) -> Vec<Vec2> {
        let (width, height) = (f64::from(self.size.width), f64::from(self.size.height));
        let h = &self.image_from_ground;
        let (x, y, depth) = (h.row(0), h.row(1), h.row(2));
        // The picture as half-planes of the ground: depth ≥ MIN_DEPTH_SHARE, 0 ≤ x ≤ width and 0 ≤
        // y ≤ height, each multiplied by the depth. They are then linear in the ground point, and
        // no division by a depth of 0 occurs.
        let sides = [
            depth - Vec3::new(0.0, 0.0, MIN_DEPTH_SHARE).transpose(),
            x.into_owned(),
            depth * width - x,
            y.into_owned(),
            depth * height - y,
        ];
        sides
            .iter()
            .fold(field_corners(field).to_vec(), |polygon, side| {
                cut(&polygon, &|point: &Vec2| {
                    side[0] * point.x + side[1] * point.y + side[2]
                })
            })
    }

    /// The same as a list of polygons: one, or none if the picture shows nothing of the field.
    fn visible_rings(&self, field: &FieldModel) -> Vec<Ring> {
        Some(self.visible_field(field))
            .filter(|ring| ring.len() >= 3)
            .into_iter()
            .collect()
    }

    /// `IoU_part` of an estimate, with this view as the truth: see [`iou_part`](super::iou_part).
    pub fn iou_part(&self, field: &FieldModel, estimate: &Self) -> Option<f64> {
        intersection_over_union(&self.visible_rings(field), &estimate.visible_rings(field))
    }

    /// `IoU_whole` of an estimate, with this view as the truth: see
    /// [`iou_whole`](super::iou_whole).
    pub fn iou_whole(&self, field: &FieldModel, estimate: &Self) -> f64 {
        let carry = estimate.ground_from_image * self.image_from_ground;
        let corners = field_corners(field);
        let projected: Option<Ring> = corners
            .iter()
            .map(|corner| {
                let ground = carry * Vec3::new(corner.x, corner.y, 1.0);
                // The product of both homographies keeps the sign of depths; a negative one is
                // beyond the estimate's horizon.
                (ground.z > 0.0).then(|| ground.xy() / ground.z)
            })
            .collect();
        projected
            .and_then(|projected| intersection_over_union(&[corners.to_vec()], &[projected]))
            .unwrap_or(0.0)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::score::{iou_part, iou_whole, visible_field};
    use crate::testing::{TestBase, base_at, soccer};

    const SIZE: ImageSize = ImageSize::new(1280, 720);

    fn camera(pan_deg: f64, focal_px: f64) -> PtzCamera {
        base_at([3.0, -60.0, 15.0], ImagePoint::new(630.0, 365.0)).aim(pan_deg, -12.0, focal_px)
    }

    #[test]
    fn a_cameras_homography_scores_as_the_camera_does() {
        let field = soccer();
        for (truth, estimate) in [
            ((-20.0, 1500.0), (-19.0, 1540.0)),
            ((5.0, 3000.0), (5.2, 2900.0)),
            ((0.0, 900.0), (9.0, 900.0)),
        ] {
            let (truth, estimate) = (camera(truth.0, truth.1), camera(estimate.0, estimate.1));
            let [true_view, view] =
                [truth, estimate].map(|camera| PlaneView::from_camera(&camera, SIZE).unwrap());
            // Scale and sign of a homography are arbitrary.
            let turned = PlaneView::new(&(true_view.image_from_ground * -7.0), SIZE).unwrap();
            assert!((turned.image_from_ground - true_view.image_from_ground).amax() < 1e-9);
            let part = iou_part(&field, &truth, &estimate, SIZE).unwrap();
            assert!(
                (true_view.iou_part(&field, &view).unwrap() - part).abs() < 1e-6,
                "{part}"
            );
            let whole = iou_whole(&field, &truth, &estimate);
            assert!(
                (true_view.iou_whole(&field, &view) - whole).abs() < 1e-9,
                "{whole}"
            );
            assert_eq!(true_view.iou_part(&field, &true_view), Some(1.0));
            let seen = visible_field(&field, &truth, SIZE);
            let corners = |ring: &[Vec2]| {
                ring.iter().fold(Vec2::zeros(), |sum, point| sum + point) / ring.len() as f64
            };
            assert!((corners(&true_view.visible_field(&field)) - corners(&seen[0])).norm() < 1e-6);
        }
    }

    #[test]
    fn nothing_is_seen_where_there_is_nothing() {
        let field = soccer();
        assert_eq!(PlaneView::new(&Mat3::zeros(), SIZE), None);
        // Looks at the ground far beside the field.
        let away = PlaneView::new(
            &Mat3::new(10.0, 0.0, -5000.0, 0.0, 10.0, -5000.0, 0.0, 0.0, 1.0),
            SIZE,
        )
        .unwrap();
        assert!(away.visible_field(&field).is_empty());
        assert_eq!(away.iou_part(&field, &away), None);
    }
}
