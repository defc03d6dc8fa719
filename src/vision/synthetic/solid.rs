//! Rounded sticks and nets: everything that stands on the pitch is made of these, with exact
//! geometry and smooth rims.

use super::coverage::{comb, inside, strip};
use super::light::{Light, Lighting};
use super::ray::Ray;
use touchline_core::geometry::Vec3;

/// A stick with round ends whose radius may differ from end to end; with both ends in one place, a
/// ball.
#[derive(Clone, Copy, Debug)]
pub(super) struct Stick {
    pub from: Vec3,
    pub to: Vec3,
    pub radius_from_m: f64,
    pub radius_to_m: f64,
    pub albedo: Light,
}

/// How near a ray comes to a stick's axis.
struct Approach {
    depth: f64,
    on_axis: Vec3,
    distance_m: f64,
    radius_m: f64,
}

/// What a ray meets: how deep, how much of the pixel, in what light.
#[derive(Clone, Copy, Debug)]
pub(super) struct Touch {
    pub depth: f64,
    pub share: f32,
    pub light: Light,
}

impl Stick {
    pub const fn new(from: Vec3, to: Vec3, radius_m: f64, albedo: Light) -> Self {
        Self::with_radii(from, to, radius_m, radius_m, albedo)
    }

    pub const fn with_radii(
        from: Vec3,
        to: Vec3,
        radius_from_m: f64,
        radius_to_m: f64,
        albedo: Light,
    ) -> Self {
        Self {
            from,
            to,
            radius_from_m,
            radius_to_m,
            albedo,
        }
    }

    pub const fn ball(centre: Vec3, radius_m: f64, albedo: Light) -> Self {
        Self::new(centre, centre, radius_m, albedo)
    }

    /// The closest approach of the line origin + t · direction to the axis.
    fn approach(&self, origin: Vec3, direction: Vec3) -> Approach {
        // Where line and axis, both taken as endless, are nearest: the normal equations of
        // |offset + t · direction − s · axis|², solved for the share s of the axis. The distance is
        // convex in s, so clamping s to the stick and projecting that point on the line again gives
        // t exactly. A ball, or a ray along the axis, has no unique s; 0 serves as well as any.
        let (axis, offset) = (self.to - self.from, origin - self.from);
        let (dd, de, ee) = (
            direction.norm_squared(),
            direction.dot(&axis),
            axis.norm_squared(),
        );
        let (d, e) = (direction.dot(&offset), axis.dot(&offset));
        let denominator = dd * ee - de * de;
        let share = if denominator > 1e-12 * dd {
            ((dd * e - de * d) / denominator).clamp(0.0, 1.0)
        } else {
            0.0
        };
        let on_axis = self.from + axis * share;
        let depth = (on_axis - origin).dot(&direction) / dd;
        let distance_m = (origin + direction * depth - on_axis).norm();
        let radius_m = self.radius_from_m + (self.radius_to_m - self.radius_from_m) * share;
        Approach {
            depth,
            on_axis,
            distance_m,
            radius_m,
        }
    }

    /// What a pixel sees of the stick.
    pub fn touch(&self, ray: &Ray, lighting: &Lighting) -> Option<Touch> {
        let near = self.approach(ray.origin, ray.direction);
        if near.depth <= 0.0 {
            return None;
        }
        // From the side a stick is a strip: its share of the pixel is exact but for the ends.
        let share = strip(
            near.distance_m,
            near.radius_m,
            near.depth * ray.pixel_at_unit_depth(),
        ) as f32;
        if share <= 0.0 {
            return None;
        }
        // The normal of a round body from the distance of the ray to its axis: it faces the camera
        // in the middle and is turned aside at the rim. A pixel beyond the rim, which the body
        // still covers in part, takes the rim's.
        let view = -ray.direction.normalize();
        let rim = (near.distance_m / near.radius_m).min(1.0);
        let facing = (1.0 - rim * rim).sqrt();
        let aside = ray.at(near.depth) - near.on_axis;
        let normal = if near.distance_m > 1e-9 {
            aside * (rim / near.distance_m) + view * facing
        } else {
            view
        };
        // The surface lies before the axis; metres along the ray become depth by its length.
        Some(Touch {
            depth: near.depth - near.radius_m * facing / ray.direction.norm(),
            share,
            light: lighting.shade(self.albedo, normal, near.on_axis),
        })
    }

    /// How much of a lamp the stick hides from a point, 0 to 1; `blur_m` is how far a pixel or the
    /// haze smears its rim.
    pub fn shadow(&self, point: Vec3, towards: Vec3, blur_m: f64) -> f32 {
        let near = self.approach(point, towards);
        // The lamp is wide: the rim softens with the distance. 0.03 rad is three times the diameter
        // of the sun, which thin cloud spreads.
        let soft = blur_m + 0.03 * near.depth.max(0.0);
        if near.depth < 0.0 {
            0.0
        } else {
            inside((near.distance_m - near.radius_m) as f32, soft as f32)
        }
    }
}

/// A flat piece of net or cloth: from `corner` along `across` (unit) and `up` (unit); its breadth
/// may narrow upwards.
#[derive(Clone, Copy, Debug)]
pub(super) struct Sheet {
    pub corner: Vec3,
    pub across: Vec3,
    pub up: Vec3,
    /// Breadth at the foot and at the top, m.
    pub breadth_m: [f64; 2],
    pub height_m: f64,
    /// Cords of this width at this spacing, m; none: solid cloth.
    pub mesh_m: Option<[f64; 2]>,
    pub albedo: Light,
}

impl Sheet {
    /// What a pixel sees of the sheet.
    pub fn touch(&self, ray: &Ray, lighting: &Lighting) -> Option<Touch> {
        // The sheet's own coordinates of the hit, and what the pixel covers of them.
        let normal = self.across.cross(&self.up);
        let hit = ray.meets(self.corner, normal)?;
        let offset = hit.point - self.corner;
        let (across, up) = (offset.dot(&self.across), offset.dot(&self.up));
        let (reach_across, reach_up) = (hit.reach(self.across), hit.reach(self.up));
        let half_height = 0.5 * self.height_m;
        let breadth =
            self.breadth_m[0] + (self.breadth_m[1] - self.breadth_m[0]) * (up / self.height_m);
        let on = strip(across - 0.5 * breadth, 0.5 * breadth, reach_across)
            * strip(up - half_height, half_height, reach_up);
        if on <= 0.0 {
            return None;
        }
        // A hole is where neither the upright nor the level cords are. Cords thinner than a pixel
        // make the net an even veil.
        let woven = self.mesh_m.map_or(1.0, |[width, spacing]| {
            let holes = (1.0 - comb(across, spacing, width, reach_across))
                * (1.0 - comb(up, spacing, width, reach_up));
            1.0 - holes
        });
        // Cloth has two sides: the one that the camera sees is lit.
        let facing = if normal.dot(&ray.direction) > 0.0 {
            -normal
        } else {
            normal
        };
        Some(Touch {
            depth: hit.depth,
            share: (on * woven) as f32,
            light: lighting.shade(self.albedo, facing, hit.point),
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_ray_beside_a_stick_knows_its_distance() {
        let post = Stick::new(
            Vec3::zeros(),
            Vec3::new(0.0, 0.0, 2.44),
            0.06,
            Light::zeros(),
        );
        let beside = post.approach(Vec3::new(1.0, -10.0, 1.0), Vec3::y());
        assert!((beside.distance_m - 1.0).abs() < 1e-12 && (beside.depth - 10.0).abs() < 1e-12);
        let over = post.approach(Vec3::new(0.0, -10.0, 3.44), Vec3::y());
        assert!((over.distance_m - 1.0).abs() < 1e-12);
        let ball = Stick::ball(Vec3::zeros(), 0.11, Light::zeros());
        assert!(
            (ball
                .approach(Vec3::new(0.0, -5.0, 0.2), Vec3::y())
                .distance_m
                - 0.2)
                .abs()
                < 1e-12
        );
    }

    #[test]
    fn a_shadow_falls_away_from_the_lamp() {
        let post = Stick::new(Vec3::zeros(), Vec3::new(0.0, 0.0, 2.0), 0.1, Light::zeros());
        let towards = Vec3::new(-1.0, 0.0, 1.0).normalize();
        assert_eq!(post.shadow(Vec3::new(1.0, 0.0, 0.0), towards, 0.01), 1.0);
        assert_eq!(post.shadow(Vec3::new(-1.0, 0.0, 0.0), towards, 0.01), 0.0);
        assert_eq!(post.shadow(Vec3::new(3.0, 0.0, 0.0), towards, 0.01), 0.0);
    }
}
