//! The stands as a surface: one profile drawn around the field, straight along its sides and
//! conical in the corners.

use super::ray::{PlaneHit, Ray};
use touchline_core::field::FieldModel;
use touchline_core::geometry::Vec3;

/// A piece of the profile.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Part {
    FrontWall,
    LowerTier,
    Fascia,
    UpperTier,
    BackWall,
    RoofUnderside,
    RoofEdge,
}

/// The profile from the ground up: distance beyond the field's edge and height, m. Every piece is
/// seen from the field.
const PROFILE: [(Part, [f64; 2], [f64; 2]); 7] = [
    (Part::FrontWall, [9.0, 0.0], [9.0, 1.5]),
    (Part::LowerTier, [9.0, 1.5], [25.0, 10.3]),
    (Part::Fascia, [25.0, 10.3], [25.0, 12.6]),
    (Part::UpperTier, [25.0, 12.6], [42.0, 26.5]),
    (Part::BackWall, [42.0, 26.5], [42.0, 32.0]),
    (Part::RoofUnderside, [42.0, 32.0], [19.0, 33.5]),
    (Part::RoofEdge, [19.0, 33.5], [19.0, 35.4]),
];

/// The distance beyond the field's edge at which the front wall stands, m.
const FRONT_M: f64 = PROFILE[0].1[0];
/// The radius of the front wall in the corners, m.
const CORNER_RADIUS_M: f64 = 13.0;
/// The radius at which a metre around a corner is a metre of seats.
const SEAT_RADIUS_M: f64 = CORNER_RADIUS_M + 10.0;

/// The stands around a field.
#[derive(Clone, Copy, Debug)]
pub(super) struct Bowl {
    half_length: f64,
    half_width: f64,
}

/// Where a ray meets the stands.
#[derive(Clone, Copy, Debug)]
pub(super) struct BowlHit {
    pub part: Part,
    pub at: PlaneHit,
    /// Around the bowl, m, from the middle of the far stand to the right; continuous from side to
    /// corner.
    pub around_m: f64,
    /// The direction in which `around_m` grows.
    pub around: Vec3,
    /// Height above the piece's foot, m.
    pub above_foot_m: f64,
}

/// A ray in the plane of distance and height, or what is left of it in a corner.
struct Candidate {
    depth: f64,
    piece: usize,
}

impl Bowl {
    pub fn new(field: &FieldModel) -> Self {
        Self {
            half_length: 0.5 * field.length_m,
            half_width: 0.5 * field.width_m,
        }
    }

    /// The nearest piece of the stands that a ray meets from the field's side.
    pub fn meets(&self, ray: &Ray) -> Option<BowlHit> {
        // The axes of the corners: the front wall goes round them, and the straight sides end where
        // the corners begin. Sides and corners are tried one after the other, and the nearest
        // counts.
        let corner = [
            self.half_length + FRONT_M - CORNER_RADIUS_M,
            self.half_width + FRONT_M - CORNER_RADIUS_M,
        ];
        let mut nearest: Option<BowlHit> = None;
        let mut keep = |hit: BowlHit| {
            if nearest.is_none_or(|other| hit.at.depth < other.at.depth) {
                nearest = Some(hit);
            }
        };
        for side in 0..4 {
            // Far, right, near, left: clockwise seen from above, 90° apart.
            let (out, along) = side_axes(side);
            let (edge, half_run) = if side % 2 == 0 {
                (self.half_width, corner[0])
            } else {
                (self.half_length, corner[1])
            };
            // In the plane of distance and height a straight side is its profile.
            let origin = [ray.origin.dot(&out) - edge, ray.origin.z];
            let slope = [ray.direction.dot(&out), ray.direction.z];
            if let Some(hit) = straight(origin, slope, |depth| {
                ray.at(depth).dot(&along).abs() <= half_run
            }) {
                let (part, normal) = piece_normal(hit.piece, out);
                let at = ray.on_plane(hit.depth, normal);
                let around_m = side_start(side, corner) + at.point.dot(&along);
                let above_foot_m = at.point.z - PROFILE[hit.piece].1[1];
                keep(BowlHit {
                    part,
                    at,
                    around_m,
                    around: along,
                    above_foot_m,
                });
            }
        }
        for quarter in 0..4 {
            // Between side `quarter` and the next: far right, near right, near left, far left.
            let (out, along) = side_axes(quarter);
            let axis = if quarter % 2 == 0 {
                along * corner[0] + out * corner[1]
            } else {
                along * corner[1] + out * corner[0]
            };
            if let Some(hit) = conical(ray, axis, out, along) {
                // Around a corner, metres of seats are measured at one radius for all rows, so that
                // seats of neighbouring rows keep their columns.
                let from_axis = ray.at(hit.depth) - axis;
                let (forward, sideways) = (from_axis.dot(&out), from_axis.dot(&along));
                let radial = Vec3::new(from_axis.x, from_axis.y, 0.0).normalize();
                let (part, normal) = piece_normal(hit.piece, radial);
                let at = ray.on_plane(hit.depth, normal);
                let half_run = if quarter % 2 == 0 {
                    corner[0]
                } else {
                    corner[1]
                };
                let around_m = side_start(quarter, corner)
                    + half_run
                    + SEAT_RADIUS_M * sideways.atan2(forward);
                let around = Vec3::new(radial.y, -radial.x, 0.0);
                let above_foot_m = at.point.z - PROFILE[hit.piece].1[1];
                keep(BowlHit {
                    part,
                    at,
                    around_m,
                    around,
                    above_foot_m,
                });
            }
        }
        nearest
    }
}

/// `around_m` at the middle of a side.
fn side_start(side: usize, corner: [f64; 2]) -> f64 {
    let turn = 0.5 * std::f64::consts::PI * SEAT_RADIUS_M;
    // The seam lies behind the main camera: the left side counts as the one before the far side.
    let place = if side == 3 { -1.0 } else { side as f64 };
    place * (corner[0] + corner[1] + turn)
}

/// Outwards and along (to the right, seen from the field) for far, right, near, left.
fn side_axes(side: usize) -> (Vec3, Vec3) {
    match side {
        0 => (Vec3::y(), Vec3::x()),
        1 => (Vec3::x(), -Vec3::y()),
        2 => (-Vec3::y(), -Vec3::x()),
        _ => (-Vec3::x(), Vec3::y()),
    }
}

/// The inner normal of a piece whose outward direction is `out`.
fn piece_normal(piece: usize, out: Vec3) -> (Part, Vec3) {
    let (part, from, to) = PROFILE[piece];
    let (run, rise) = (to[0] - from[0], to[1] - from[1]);
    (part, (Vec3::z() * run - out * rise).normalize())
}

/// The nearest piece on a straight side; `origin` and `slope` are (distance beyond the edge,
/// height).
fn straight(origin: [f64; 2], slope: [f64; 2], on_side: impl Fn(f64) -> bool) -> Option<Candidate> {
    let cross = |a: [f64; 2], b: [f64; 2]| a[0] * b[1] - a[1] * b[0];
    let mut nearest: Option<Candidate> = None;
    for (piece, (_, from, to)) in PROFILE.iter().enumerate() {
        let edge = [to[0] - from[0], to[1] - from[1]];
        // The inner normal is (−rise, run): the piece is seen from the field when the ray goes
        // against it.
        if slope[1] * edge[0] - slope[0] * edge[1] >= 0.0 {
            continue;
        }
        // origin + depth · slope = from + share · edge, solved by Cramer's rule. The denominator is
        // positive, because the ray goes against the normal.
        let to_foot = [from[0] - origin[0], from[1] - origin[1]];
        let turn = cross(slope, edge);
        let (depth, share) = (cross(to_foot, edge) / turn, cross(to_foot, slope) / turn);
        let met = depth > 1e-3 && (0.0..=1.0).contains(&share);
        if met && nearest.as_ref().is_none_or(|other| depth < other.depth) && on_side(depth) {
            nearest = Some(Candidate { depth, piece });
        }
    }
    nearest
}

/// The nearest piece in a corner: each is a cone, a cylinder or a ring about the vertical through
/// `axis`.
fn conical(ray: &Ray, axis: Vec3, out: Vec3, along: Vec3) -> Option<Candidate> {
    let start = ray.origin - axis;
    let horizontal = |v: Vec3| (v.dot(&out), v.dot(&along));
    let ((of, os), (df, ds)) = (horizontal(start), horizontal(ray.direction));
    // Squared radius along the ray: a t² + 2 b t + c.
    let (a, b, c) = (df * df + ds * ds, of * df + os * ds, of * of + os * os);
    let mut nearest: Option<Candidate> = None;
    for (piece, (_, from, to)) in PROFILE.iter().enumerate() {
        let radius = from[0] - FRONT_M + CORNER_RADIUS_M;
        let (run, rise) = (to[0] - from[0], to[1] - from[1]);
        // On the piece: rise · (ρ − radius) = run · (z − foot), so rise · ρ = k + l t.
        let (k, l) = (
            rise * radius + run * (ray.origin.z - from[1]),
            run * ray.direction.z,
        );
        let (qa, qb, qc) = (
            rise * rise * a - l * l,
            rise * rise * b - k * l,
            rise * rise * c - k * k,
        );
        let root = (qb * qb - qa * qc).sqrt();
        for depth in [(-qb - root) / qa, (-qb + root) / qa] {
            // NaN (no meeting) fails the first comparison.
            if !(depth > 1e-3) || nearest.as_ref().is_some_and(|other| depth >= other.depth) {
                continue;
            }
            let (forward, sideways) = (of + df * depth, os + ds * depth);
            // Other quarters have their own axis. Squaring added the mirror image of the piece
            // beyond its apex, where rise · ρ, which is positive for every piece, would be
            // negative.
            if forward < 0.0 || sideways < 0.0 || k + l * depth < 0.0 {
                continue;
            }
            let rho = forward.hypot(sideways);
            let z = ray.origin.z + ray.direction.z * depth;
            let length = run * run + rise * rise;
            let share = ((rho - radius) * run + (z - from[1]) * rise) / length;
            let outwards = (forward * df + sideways * ds) / rho;
            let faces = ray.direction.z * run - outwards * rise < 0.0;
            if faces && (0.0..=1.0).contains(&share) {
                nearest = Some(Candidate { depth, piece });
            }
        }
    }
    nearest
}

#[cfg(test)]
mod tests {
    use super::*;

    fn field_bowl() -> Bowl {
        Bowl {
            half_length: 52.5,
            half_width: 34.0,
        }
    }

    fn ray(direction: Vec3) -> Ray {
        Ray {
            origin: Vec3::new(0.0, -66.0, 18.0),
            direction,
            by_x: Vec3::x() * 1e-3,
            by_y: Vec3::z() * -1e-3,
        }
    }

    #[test]
    fn the_bowl_is_closed_seen_from_the_main_camera() {
        let mut last = f64::NAN;
        for step in -600..=600 {
            let pan = f64::from(step) * 0.1_f64.to_radians();
            let hit = field_bowl()
                .meets(&ray(Vec3::new(pan.sin(), pan.cos(), -0.03)))
                .expect("a hole in the stands");
            // Around the bowl there is no gap and no overlap where side and corner meet.
            assert!(
                !((hit.around_m - last).abs() > 3.0),
                "jump from {last} to {} at {pan}",
                hit.around_m
            );
            last = hit.around_m;
        }
    }

    #[test]
    fn a_level_ray_meets_the_far_upper_tier_and_a_steep_one_leaves_through_the_roof() {
        let level = field_bowl().meets(&ray(Vec3::new(0.0, 1.0, 0.0))).unwrap();
        assert_eq!(level.part, Part::UpperTier);
        assert!((level.above_foot_m - 5.4).abs() < 1e-9 && level.around_m.abs() < 1e-9);
        assert!(field_bowl().meets(&ray(Vec3::new(0.0, 1.0, 0.6))).is_none());
    }

    #[test]
    fn above_the_roof_of_a_corner_is_the_sky() {
        // Through a point 10 m beyond the axis of the far right corner, and a metre above the
        // roof's edge: there the cone of the roof's underside has its mirror image.
        let level = Vec3::new(58.5, 106.0, 0.0).normalize();
        let above = ray(level + Vec3::z() * 0.14);
        assert!(field_bowl().meets(&above).is_none());
    }
}
