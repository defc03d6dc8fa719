//! A camera from four or more straight lines on the ground, in closed form.
//!
//! The homography G takes the picture to the ground. That a pixel p lies on the ground line ℓ is ℓᵀ
//! G p = 0: one linear equation in the nine entries of G for each drawn point, whatever its place
//! along the line. Four lines in general position with two points each give the eight that are
//! needed; the solution is the eigenvector of the smallest eigenvalue, as for point pairs (Hartley
//! and Zisserman, Multiple View Geometry, section 4.1). The drawn points and their images under G
//! are then point pairs, and [`pose_from_plane`] splits them into focal length, rotation and
//! position.

use crate::camera::{FocalCurve, PtzCamera};
use crate::geometry::{ImagePoint, ImageSize, Mat3, Vec2, Vec3, only_null_vector};
use crate::solve::initial_cameras::plane_pose::pose_from_plane;
use crate::solve::observations::drawn_line::DrawnLine;
use nalgebra::{SMatrix, SVector};

/// Minimum second smallest eigenvalue, as a fraction of the largest: below it the lines leave a
/// second solution.
const MIN_SECOND_EIGENVALUE: f64 = 1e-7;

/// Drawn lines on the ground that give a homography.
const MIN_LINES: usize = 4;

/// The camera of the straight lines on the ground; none where they determine no homography, or
/// where no focal length explains it.
pub(super) fn camera_from_ground_lines(
    lines: &[DrawnLine],
    size: ImageSize,
    (principal_point, pinhole): (ImagePoint, FocalCurve),
) -> Option<PtzCamera> {
    let ground: Vec<(Vec3, &DrawnLine)> = lines
        .iter()
        .filter_map(|line| Some((ground_line(line)?, line)))
        .collect();
    if ground.len() < MIN_LINES {
        return None;
    }
    // Both sides in units in which coordinates are about one, which conditions the equations.
    let half_width_px = 0.5 * f64::from(size.width);
    let unit_m = ground
        .iter()
        .filter_map(|(_, line)| line.segment())
        .flatten()
        .map(|end| end.xy().norm())
        .fold(1.0, f64::max);
    let mut normal = SMatrix::<f64, 9, 9>::zeros();
    for (of_field, line) in &ground {
        // In the new unit the line's distance from the origin shrinks, its direction does not.
        let of_field = Vec3::new(of_field.x, of_field.y, of_field.z / unit_m);
        for point in &line.points {
            let pixel = pixel_in_units(
                pinhole.square_point(*point, principal_point),
                principal_point,
                half_width_px,
            );
            // ℓᵀ G p = Σ ℓ_i G_ij p_j: the coefficients are the products, in nalgebra's order of
            // columns, in which G is read back below.
            let products = of_field * pixel.transpose();
            let row = SVector::<f64, 9>::from_column_slice(products.as_slice());
            normal += row * row.transpose();
        }
    }
    let solution = only_null_vector(&normal, MIN_SECOND_EIGENVALUE).ok()?;
    let ground_from_image = Mat3::from_column_slice(solution.as_slice());

    // The images of the drawn points on the ground, m. They lie on their lines only as well as the
    // homography fits; a point at its horizon has no image.
    let pairs: Vec<(Vec2, ImagePoint)> = ground
        .iter()
        .flat_map(|(_, line)| &line.points)
        .map(|point| {
            let point = pinhole.square_point(*point, principal_point);
            let on_ground =
                ground_from_image * pixel_in_units(point, principal_point, half_width_px);
            (on_ground.xy() / on_ground.z * unit_m, point)
        })
        .filter(|(ground, _)| ground.iter().all(|x| x.is_finite()))
        .collect();
    let pose = pose_from_plane(&pairs, principal_point).ok()?;
    (pose.position_m.z > 0.0).then(|| pose.camera(principal_point, pinhole))
}

/// A pixel from the middle of the picture in halves of its width, homogeneous.
fn pixel_in_units(pixel: ImagePoint, centre: ImagePoint, half_width_px: f64) -> Vec3 {
    let offset = pixel.offset_from(centre) / half_width_px;
    Vec3::new(offset.x, offset.y, 1.0)
}

/// The line through two points of the ground, a x + b y + c = 0 with a² + b² = 1; none for a curve,
/// a post and a crossbar.
fn ground_line(line: &DrawnLine) -> Option<Vec3> {
    let [from, to] = line.segment()?;
    let along = (to - from).xy();
    if from.z != 0.0 || to.z != 0.0 || line.straight().is_none() {
        return None;
    }
    let normal = Vec2::new(-along.y, along.x).normalize();
    Some(Vec3::new(normal.x, normal.y, -normal.dot(&from.xy())))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::field::builtin;
    use crate::solve::Observation;
    use crate::testing::{TestBase, base_at};

    const SIZE: ImageSize = ImageSize::new(960, 540);

    #[test]
    fn exact_points_on_four_lines_give_the_camera_and_parallel_ones_none() {
        let field = builtin("soccer")
            .unwrap()
            .model(&std::collections::BTreeMap::new(), 0.0)
            .unwrap();
        let base = base_at([5.0, -70.0, 21.0], SIZE);
        let truth = base.aim(31.0, -14.0, 1400.0);
        let on_lines = |names: &[&str]| {
            let mut observations = Vec::new();
            for name in names {
                let curve = field.line(name).unwrap().curve;
                for share in [0.3, 0.8] {
                    let pixel = truth.image_from_world(curve.point_at(share)).unwrap();
                    let click = observations.len();
                    observations
                        .push(Observation::from_line(&field, name, pixel, SIZE, click).unwrap());
                }
            }
            camera_from_ground_lines(
                &DrawnLine::group(&observations),
                SIZE,
                (SIZE.centre(), FocalCurve::NONE),
            )
        };
        let area = ["near", "far", "front"].map(|side| format!("penalty_area_right_{side}"));
        let [near, far, front] = area.each_ref().map(String::as_str);
        let camera = on_lines(&[near, far, front, "goal_line_right"]).unwrap();
        let (found, ptz) = (camera.base(), camera.ptz());
        assert!(
            (found.position_m - base.position_m).norm() < 1e-3,
            "{found:?}"
        );
        assert!((ptz.focal_px - 1400.0).abs() < 0.01, "{ptz:?}");
        assert!(
            (ptz.pan - truth.ptz().pan).abs().degrees() < 1e-3,
            "{ptz:?}"
        );
        let parallel = [near, far, "touchline_far", "goal_area_right_near"];
        assert_eq!(on_lines(&parallel), None);
        assert_eq!(on_lines(&[near, far, front]), None);
    }
}
