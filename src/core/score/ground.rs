//! The part of the field that a picture shows, seen from above.

use super::polygon::{Ring, area, cut, intersect};
use crate::camera::PtzCamera;
use crate::field::FieldModel;
use crate::geometry::{ImageSize, Vec2, Vec3};

/// Minimum depth of visible ground, m.
const NEAR_M: f64 = 0.05;
/// Number of points on each edge of a picture with distortion, which has curved borders.
const POINTS_PER_EDGE: u32 = 64;
/// The visible radius, as a fraction of the radius at which the distortion model folds.
const FOLD_SHARE: f64 = 1.0 - 1e-6;

/// How far an outline may be off that is simplified, m.
const OUTLINE_M: f64 = 0.05;

/// The corners of the field on the plane z = 0, m.
pub(super) fn field_corners(field: &FieldModel) -> [Vec2; 4] {
    let (x, y) = (0.5 * field.length_m, 0.5 * field.width_m);
    [
        Vec2::new(-x, -y),
        Vec2::new(x, -y),
        Vec2::new(x, y),
        Vec2::new(-x, y),
    ]
}

/// The part of the field that a picture shows: the playing area on the plane z = 0, m, as polygons
/// that do not overlap. Empty if the picture shows nothing of it.
///
/// Exact for a lens without distortion. With distortion the picture's curved border is approximated
/// by 256 points, and pixels beyond the fold of the model show nothing. The crown of a few
/// centimetres is neglected.
pub fn visible_field(field: &FieldModel, camera: &PtzCamera, size: ImageSize) -> Vec<Vec<Vec2>> {
    let border = ideal_border(camera, size);
    let (mut low, mut high) = (Vec2::repeat(f64::INFINITY), Vec2::repeat(f64::NEG_INFINITY));
    for point in &border {
        (low, high) = (low.inf(point), high.sup(point));
    }
    if !(low.x < high.x && low.y < high.y) {
        return Vec::new();
    }
    let corners = field_corners(field)
        .map(|corner| camera.cam_from_world_point(Vec3::new(corner.x, corner.y, 0.0)));
    // Clip in `cam`, before the division by z, because corners of the field may lie behind the
    // camera. There the bounding box of the picture's border becomes a pyramid: x ≥ low.x · z, and
    // so on.
    let sides: [&dyn Fn(&Vec3) -> f64; 5] = [
        &|p| p.z - NEAR_M,
        &|p| p.x - low.x * p.z,
        &|p| high.x * p.z - p.x,
        &|p| p.y - low.y * p.z,
        &|p| high.y * p.z - p.y,
    ];
    let seen = sides
        .iter()
        .fold(corners.to_vec(), |polygon, side| cut(&polygon, side));
    let ideal: Ring = seen
        .iter()
        .map(|p| Vec2::new(p.x / p.z, p.y / p.z))
        .collect();
    if ideal.len() < 3 {
        return Vec::new();
    }
    // Without distortion the border is that bounding box, a rectangle on the plane z = 1, and the
    // clipping is complete.
    let ideal = if camera.lens().is_none() {
        vec![ideal]
    } else {
        intersect(&[ideal], &[border])
    };
    ideal
        .iter()
        .filter_map(|ring| {
            ring.iter()
                .map(|point| ground_from_ideal(camera, *point))
                .collect::<Option<Ring>>()
        })
        .collect()
}

/// The outline of the part of the field that a picture shows: the largest polygon of
/// [`visible_field`], without the points that lie within 5 cm of a line between others.
/// Empty if the picture shows nothing of the field.
#[must_use]
pub fn visible_outline(field: &FieldModel, camera: &PtzCamera, size: ImageSize) -> Vec<Vec2> {
    let rings = visible_field(field, camera, size).into_iter();
    let area_of = |ring: &Ring| area(std::slice::from_ref(ring));
    let Some(mut ring) = rings.max_by(|a, b| area_of(a).total_cmp(&area_of(b))) else {
        return Vec::new();
    };
    // Closed, and opened again at the end: the first point always stays.
    ring.extend(ring.first().copied());
    let mut kept = simplify(&ring);
    kept.pop();
    kept
}

/// The points of a line without those near the straight line between others (Ramer 1972; Douglas
/// and Peucker 1973).
fn simplify(line: &[Vec2]) -> Vec<Vec2> {
    let (Some(first), Some(last)) = (line.first(), line.last()) else {
        return Vec::new();
    };
    let along = last - first;
    // Of a closed line both ends are one point, and the distance is that from it.
    let away_m = |point: &Vec2| {
        let from_first = point - first;
        if along.norm() > 0.0 {
            along.perp(&from_first).abs() / along.norm()
        } else {
            from_first.norm()
        }
    };
    let distances = line.iter().map(away_m).enumerate();
    match distances.max_by(|a, b| a.1.total_cmp(&b.1)) {
        Some((at, away_m)) if away_m > OUTLINE_M => {
            let mut kept = simplify(&line[..=at]);
            kept.pop();
            kept.extend(simplify(&line[at..]));
            kept
        }
        _ => vec![*first, *last],
    }
}

/// The picture's border on the plane z = 1 of `cam`, before distortion: its corners, or points
/// along its curved edges.
fn ideal_border(camera: &PtzCamera, size: ImageSize) -> Ring {
    let steps = if camera.lens().is_none() {
        1
    } else {
        POINTS_PER_EDGE
    };
    // The radius of the fold, in the plane z = 1 and, distorted, in the picture.
    let corners = size.corners();
    let principal = camera.base().principal_point;
    let focal_px = camera.ptz().focal_px;
    let fold = camera.fold_radius() * FOLD_SHARE;
    let fold_px = fold * camera.lens().stretch(fold * fold) * focal_px;
    let mut border = Ring::new();
    for (i, from) in corners.iter().enumerate() {
        let along = corners[(i + 1) % corners.len()].offset_from(*from);
        for step in 0..steps {
            let offset = from
                .translate(along * (f64::from(step) / f64::from(steps)))
                .offset_from(principal);
            // A point beyond the fold has no ray: move it towards the principal point to just
            // inside.
            let shrink = if fold.is_finite() {
                (fold_px / camera.lens().square_from_pixels(offset).norm()).min(1.0)
            } else {
                1.0
            };
            border.extend(
                camera
                    .cam_plane_from_image(principal.translate(offset * shrink))
                    .ok(),
            );
        }
    }
    border
}

/// The intersection of the ray of an ideal point with the plane z = 0, `world` x and y, m.
fn ground_from_ideal(camera: &PtzCamera, ideal: Vec2) -> Option<Vec2> {
    let direction = camera.cam_from_world().transpose() * Vec3::new(ideal.x, ideal.y, 1.0);
    let position = camera.base().position_m;
    let ground = position - direction * (position.z / direction.z);
    (ground.x.is_finite() && ground.y.is_finite()).then_some(ground.xy())
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::testing::{TestBase, base_at, soccer, turned_base};

    const SIZE: ImageSize = ImageSize::new(1280, 720);

    /// A camera straight above the middle, 100 m up: the top of the picture is +y.
    fn from_above(focal_px: f64, k1: f64) -> PtzCamera {
        turned_base([0.0, 0.0, 100.0], [0.0, -90.0, 0.0], SIZE)
            .bent(k1)
            .aim(0.0, 0.0, focal_px)
    }

    #[test]
    fn from_above_the_picture_is_a_rectangle_on_the_field() {
        // f 3200: 1280 px are 40 m, 720 px are 22.5 m.
        let seen = visible_field(&soccer(), &from_above(3200.0, 0.0), SIZE);
        assert!((area(&seen) - 40.0 * 22.5).abs() < 1e-9);
        // f 320: the picture is 400 m wide and shows all of it.
        let seen = visible_field(&soccer(), &from_above(320.0, 0.0), SIZE);
        assert!((area(&seen) - 105.0 * 68.0).abs() < 1e-9);
        // f 1000: 128 m by 72 m, wider and higher than the field.
        assert!(
            (area(&visible_field(&soccer(), &from_above(1000.0, 0.0), SIZE)) - 7140.0).abs() < 1e-9
        );
    }

    #[test]
    fn barrel_distortion_shows_more_and_its_curved_border_is_followed() {
        // On the x axis x_d = x (1 + k₁ x²): at k₁ = −0.5 the right edge, x_d = 0.2, shows x =
        // 0.20442…
        let straight = area(&visible_field(&soccer(), &from_above(3200.0, 0.0), SIZE));
        let distorted = area(&visible_field(&soccer(), &from_above(3200.0, -0.5), SIZE));
        // The area element of the ideal plane by the distorted one, to first order 1 − 4 k₁ r²; ∫
        // over the picture by hand: A (1 − 4 k₁ (a² + b²) / 3) with half sides a = 0.2 and b =
        // 0.1125.
        let by_hand = straight * (1.0 + 4.0 * 0.5 * (0.2f64.powi(2) + 0.1125f64.powi(2)) / 3.0);
        assert!(
            (distorted - by_hand).abs() < 0.005 * straight,
            "{distorted} {by_hand}"
        );
    }

    #[test]
    fn an_outline_keeps_the_area_with_few_points() {
        let field = soccer();
        let rectangle = visible_outline(&field, &from_above(3200.0, 0.0), SIZE);
        assert_eq!(rectangle.len(), 4);
        let camera = from_above(3200.0, -0.5);
        let outline = visible_outline(&field, &camera, SIZE);
        let whole = area(&visible_field(&field, &camera, SIZE));
        assert!((5..40).contains(&outline.len()), "{}", outline.len());
        // Along a border of 125 m it is at most 5 cm off.
        assert!((area(&[outline]) - whole).abs() < 125.0 * OUTLINE_M);
        let away = base_at([0.0, -60.0, 15.0], SIZE).aim(0.0, 60.0, 1000.0);
        assert!(visible_outline(&field, &away, SIZE).is_empty());
    }

    #[test]
    fn beyond_the_fold_nothing_is_seen() {
        // k₁ = −2 folds at radius 0.408, distorted 0.272; with f 1000 the picture reaches 0.64.
        let camera = from_above(1000.0, -2.0);
        let seen = area(&visible_field(&soccer(), &camera, SIZE));
        let fold_m = camera.fold_radius() * 100.0;
        // The disc of radius 40.8 m, cut by the field's touchlines at ±34 m.
        let cap = |r: f64, h: f64| r * r * (h / r).acos() - h * (r * r - h * h).sqrt();
        let by_hand = std::f64::consts::PI * fold_m * fold_m - 2.0 * cap(fold_m, 34.0);
        assert!((seen - by_hand).abs() < 0.01 * by_hand, "{seen} {by_hand}");
    }

    #[test]
    fn the_sky_shows_no_field_and_the_horizon_no_infinity() {
        let camera = |tilt: f64| base_at([0.0, -60.0, 15.0], SIZE).aim(0.0, tilt, 1000.0);
        assert!(visible_field(&soccer(), &camera(60.0), SIZE).is_empty());
        let level = area(&visible_field(&soccer(), &camera(0.0), SIZE));
        // The lower edge, 0.36 below the axis, meets the ground 41.7 m ahead: y = −18.3. From there
        // to the far touchline, y = 34, the sides open by 0.64 to each side: a trapezium 53.3 m
        // and, cut at the goal lines, 105 m wide.
        let [near, far, full] = [15.0 / 0.36, 94.0, 52.5 / 0.64];
        let by_hand = 0.64 * (full * full - near * near) + 105.0 * (far - full);
        assert!((level - by_hand).abs() < 1e-8, "{level} {by_hand}");
    }
}
