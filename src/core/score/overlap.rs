//! Intersection over union of the field seen from above.
//!
//! The literature uses two conventions that give different numbers; both are implemented.
//! `IoU_part` (Homayounfar et al., CVPR 2017; Chen and Little, CVPRW 2019): the part of the field
//! that the picture shows by the true camera against the part that it shows by the estimated one.
//! `IoU_whole` (Sharma et al., WACV 2018): the whole field is projected into the picture by the
//! true camera and back by the estimated one, and compared with itself; parts outside the picture
//! count as well. The literature rasterises to whole yards; here polygons are clipped exactly.

use super::ground::{field_corners, visible_field};
use super::polygon::{Ring, area, intersect};
use crate::camera::PtzCamera;
use crate::field::FieldModel;
use crate::geometry::{ImageSize, Vec2, Vec3};

/// `IoU_part`, 0 to 1, of the parts of the field that the picture shows under the two cameras. None
/// where neither camera shows any of the field; 0 where only one does.
pub fn iou_part(
    field: &FieldModel,
    truth: &PtzCamera,
    estimate: &PtzCamera,
    size: ImageSize,
) -> Option<f64> {
    intersection_over_union(
        &visible_field(field, truth, size),
        &visible_field(field, estimate, size),
    )
}

/// `IoU_whole`, 0 to 1, of the field and of the field projected into the picture by the true camera
/// and back by the estimated one.
///
/// Distortion is neglected, because it has no meaning far outside the picture; only focal lengths
/// and principal points are used. 0 where a part of the field lies beyond the estimate's horizon.
pub fn iou_whole(field: &FieldModel, truth: &PtzCamera, estimate: &PtzCamera) -> f64 {
    let corners = field_corners(field);
    transfer_ring(truth, estimate, &corners)
        .and_then(|projected| intersection_over_union(&[corners.to_vec()], &[projected]))
        .unwrap_or(0.0)
}

/// The number of segments along and across the field of [`iou_segments`].
const SEGMENTS: [u8; 2] = [6, 4];

/// Mean `IoU` of the segments of the field that the picture shows, 0 to 1. None where the true
/// camera shows none.
///
/// The field is divided into 6 × 4 equal segments. The part of each that the picture shows is
/// projected into the picture by the true camera and back by the estimated one, as for
/// [`iou_whole`], and compared with itself. Each segment counts alike, so that a camera that is
/// right in the middle of its view and wrong at an end does not hide that.
pub fn iou_segments(
    field: &FieldModel,
    truth: &PtzCamera,
    estimate: &PtzCamera,
    size: ImageSize,
) -> Option<f64> {
    let seen = visible_field(field, truth, size);
    let mut scores: Vec<f64> = Vec::new();
    for segment in segments(field) {
        let shown = intersect(&[segment], &seen);
        if area(&shown) < LEAST_SEGMENT_M2 {
            continue;
        }
        // A corner beyond the estimate's horizon makes the whole segment count as missed.
        let projected: Option<Vec<Ring>> = shown
            .iter()
            .map(|ring| transfer_ring(truth, estimate, ring))
            .collect();
        let score = projected.and_then(|projected| intersection_over_union(&shown, &projected));
        scores.push(score.unwrap_or(0.0));
    }
    let count = scores.len();
    (count > 0).then(|| scores.iter().sum::<f64>() / count as f64)
}

/// Of a segment less than this is a sliver at the border of the picture, whose overlap says nothing,
/// m².
const LEAST_SEGMENT_M2: f64 = 1.0;

/// The segments of a field, by their corners.
fn segments(field: &FieldModel) -> impl Iterator<Item = Ring> {
    let [corner, _, opposite, _] = field_corners(field);
    let [along, across] = SEGMENTS;
    (0..along).flat_map(move |x| {
        (0..across).map(move |y| {
            [(x, y), (x + 1, y), (x + 1, y + 1), (x, y + 1)]
                .map(|(x, y)| {
                    let share = Vec2::new(
                        f64::from(x) / f64::from(along),
                        f64::from(y) / f64::from(across),
                    );
                    corner + (opposite - corner).component_mul(&share)
                })
                .to_vec()
        })
    })
}

/// [`transfer`] of the corners of a polygon. None if one of them lies beyond the estimate's
/// horizon.
fn transfer_ring(truth: &PtzCamera, estimate: &PtzCamera, ring: &[Vec2]) -> Option<Ring> {
    ring.iter()
        .map(|corner| transfer(truth, estimate, *corner))
        .collect()
}

/// The ground point that the estimate sees at the pixel of a ground point under the truth: a
/// homography of the plane z = 0. None beyond the estimate's horizon.
fn transfer(truth: &PtzCamera, estimate: &PtzCamera, ground: Vec2) -> Option<Vec2> {
    let in_cam = truth.cam_from_world_point(Vec3::new(ground.x, ground.y, 0.0));
    let apart = truth
        .base()
        .principal_point
        .offset_from(estimate.base().principal_point);
    // Homogeneous, without a division by the depth, which may be zero.
    let offset_px = truth
        .lens()
        .pixels_from_square(in_cam.xy() * truth.ptz().focal_px)
        + apart * in_cam.z;
    let seen = estimate.lens().square_from_pixels(offset_px) / estimate.ptz().focal_px;
    let direction = estimate.cam_from_world().transpose() * Vec3::new(seen.x, seen.y, in_cam.z);
    let position = estimate.base().position_m;
    // Depths keep their sign, so a point behind both cameras is mapped as correctly as one in
    // front.
    let distance = -position.z / direction.z;
    (distance > 0.0 && distance.is_finite()).then(|| (position + direction * distance).xy())
}

/// Intersection over union of two sets of polygons that do not overlap within a set; none where
/// both are empty.
pub(super) fn intersection_over_union(one: &[Ring], other: &[Ring]) -> Option<f64> {
    let both = area(&intersect(one, other));
    let union = area(one) + area(other) - both;
    // Rounding to the grid of the clipping may put the quotient slightly above 1.
    (union > 0.0).then(|| (both / union).clamp(0.0, 1.0))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::camera::CameraBase;
    use crate::geometry::ImagePoint;
    use crate::testing::{TestBase, base_at, soccer, turned_base};

    const SIZE: ImageSize = ImageSize::new(1280, 720);

    fn from_above(x_m: f64, y_m: f64, focal_px: f64) -> PtzCamera {
        turned_base([x_m, y_m, 100.0], [0.0, -90.0, 0.0], SIZE).aim(0.0, 0.0, focal_px)
    }

    fn broadcast(pan_deg: f64, focal_px: f64) -> PtzCamera {
        base_at([0.0, -60.0, 15.0], SIZE).aim(pan_deg, -12.0, focal_px)
    }

    #[test]
    fn shifted_views_from_above_overlap_by_the_known_area() {
        // Views of 40 m × 22.5 m, 10 m apart: 30 × 22.5 shared of 50 × 22.5.
        let (truth, estimate) = (from_above(0.0, 0.0, 3200.0), from_above(10.0, 0.0, 3200.0));
        assert!((iou_part(&soccer(), &truth, &estimate, SIZE).unwrap() - 0.6).abs() < 1e-12);
        // The whole field moves by 10 m: 95 of 115.
        assert!((iou_whole(&soccer(), &truth, &estimate) - 95.0 / 115.0).abs() < 1e-12);
        // A focal length a quarter too long shrinks the field by that: (4/5)².
        assert!((iou_whole(&soccer(), &truth, &from_above(0.0, 0.0, 4000.0)) - 0.64).abs() < 1e-12);
    }

    #[test]
    fn segments_say_how_far_the_seen_ground_moves() {
        // A view of 40 m × 22.5 m around the middle, moved by 2 m. The four segments beside the
        // middle are 17.5 m × 17 m; of each, 17.5 m × 11.25 m are seen, of the next ones 2.5 m. So
        // the overlaps are 15.5/19.5 and 0.5/4.5.
        let (truth, estimate) = (from_above(0.0, 0.0, 3200.0), from_above(2.0, 0.0, 3200.0));
        let found = iou_segments(&soccer(), &truth, &estimate, SIZE).unwrap();
        let expected = (4.0 * 15.5 / 19.5 + 4.0 * 0.5 / 4.5) / 8.0;
        assert!((found - expected).abs() < 1e-6, "{found} {expected}");
        let itself = iou_segments(&soccer(), &truth, &truth, SIZE).unwrap();
        assert!((itself - 1.0).abs() < 1e-9);
        let away = from_above(0.0, 500.0, 3200.0);
        assert_eq!(iou_segments(&soccer(), &away, &truth, SIZE), None);
    }

    #[test]
    fn a_picture_that_shows_all_of_the_field_is_right_by_part_and_wrong_by_whole() {
        let (truth, estimate) = (from_above(0.0, 0.0, 320.0), from_above(0.0, 0.0, 400.0));
        assert!((iou_part(&soccer(), &truth, &estimate, SIZE).unwrap() - 1.0).abs() < 1e-12);
        assert!((iou_whole(&soccer(), &truth, &estimate) - 0.64).abs() < 1e-12);
    }

    #[test]
    fn a_moved_principal_point_carries_the_field() {
        let truth = from_above(0.0, 0.0, 3200.0);
        let base = CameraBase {
            principal_point: ImagePoint::new(640.0 + 320.0, 360.0),
            ..*truth.base()
        };
        // 320 px are 10 m.
        let estimate = PtzCamera::new(base, truth.ptz());
        assert!((iou_whole(&soccer(), &truth, &estimate) - 95.0 / 115.0).abs() < 1e-12);
    }

    #[test]
    fn the_right_camera_scores_one_even_with_the_field_behind_it() {
        // The near corners of the field lie behind a camera that is panned far to the side.
        for pan_deg in [0.0, 40.0, 80.0] {
            let camera = broadcast(pan_deg, 1500.0);
            assert!((iou_whole(&soccer(), &camera, &camera) - 1.0).abs() < 1e-12);
            if let Some(part) = iou_part(&soccer(), &camera, &camera, SIZE) {
                assert!((part - 1.0).abs() < 1e-12);
            }
        }
    }

    #[test]
    fn small_errors_cost_little_and_the_order_is_kept() {
        let truth = broadcast(5.0, 2000.0);
        let scores = [0.05, 0.5, 5.0].map(|pan| {
            let estimate = broadcast(5.0 + pan, 2000.0);
            (
                iou_part(&soccer(), &truth, &estimate, SIZE).unwrap(),
                iou_whole(&soccer(), &truth, &estimate),
            )
        });
        assert!(scores[0].0 > 0.995 && scores[0].1 > 0.98, "{scores:?}");
        assert!(
            scores
                .windows(2)
                .all(|pair| pair[0].0 > pair[1].0 && pair[0].1 > pair[1].1),
            "{scores:?}"
        );
    }

    #[test]
    fn edge_cases_are_as_stated() {
        let field = soccer();
        let sky = broadcast(0.0, 2000.0).base().aim(0.0, 45.0, 2000.0);
        assert_eq!(iou_part(&field, &sky, &sky, SIZE), None);
        assert_eq!(
            iou_part(&field, &broadcast(0.0, 2000.0), &sky, SIZE),
            Some(0.0)
        );
        assert!(iou_whole(&field, &broadcast(0.0, 2000.0), &sky) == 0.0);
        // An absurd lens gives a number and does not panic.
        let base = (*broadcast(0.0, 2000.0).base()).bent(-50.0);
        let folded = base.aim(0.0, -12.0, 2000.0);
        assert!(
            iou_part(&field, &broadcast(0.0, 2000.0), &folded, SIZE)
                .is_some_and(|iou| (0.0..1.0).contains(&iou))
        );
    }
}
