//! The ray of a pixel and how it changes from one pixel to the next.

use touchline_core::camera::PtzCamera;
use touchline_core::geometry::{ImagePoint, Mat3, Vec2, Vec3};

/// A viewing ray with its differentials. `direction` has depth 1, so that a parameter along the
/// ray is a depth in m.
#[derive(Clone, Copy, Debug)]
pub(super) struct Ray {
    /// The camera's centre of projection, `world`, m.
    pub origin: Vec3,
    /// `world`, of depth 1.
    pub direction: Vec3,
    /// The change of `direction` from this pixel to the one at its right.
    pub by_x: Vec3,
    /// The change of `direction` from this pixel to the one below.
    pub by_y: Vec3,
}

/// Where a ray meets a plane, and how the point moves from pixel to pixel.
#[derive(Clone, Copy, Debug)]
pub(super) struct PlaneHit {
    /// Depth, m.
    pub depth: f64,
    /// `world`, m.
    pub point: Vec3,
    /// m per px to the right.
    pub by_x: Vec3,
    /// m per px downwards.
    pub by_y: Vec3,
}

impl Ray {
    /// The point at a depth.
    pub fn at(&self, depth: f64) -> Vec3 {
        self.origin + self.direction * depth
    }

    /// The width of a pixel at depth 1 (m per m): times a depth it is the size of a pixel there.
    pub fn pixel_at_unit_depth(&self) -> f64 {
        (self.by_x.norm() * self.by_y.norm()).sqrt()
    }

    /// The meeting with the plane through `point` with this `normal`, ahead of the camera.
    pub fn meets(&self, point: Vec3, normal: Vec3) -> Option<PlaneHit> {
        // A ray along the plane divides by 0 and is no meeting; a millimetre ahead of the camera is
        // none, either.
        let depth = (point - self.origin).dot(&normal) / self.direction.dot(&normal);
        (depth.is_finite() && depth > 1e-3).then(|| self.on_plane(depth, normal))
    }

    /// The hit at a known depth on a surface with this normal.
    pub fn on_plane(&self, depth: f64, normal: Vec3) -> PlaneHit {
        // Ray differentials (Igehy, "Tracing Ray Differentials", SIGGRAPH 1999): with P = o + t D
        // and P on the plane, ∂P = t ∂D − D t (∂D · n) / (D · n).
        let slope = depth / self.direction.dot(&normal);
        let along = |by: Vec3| by * depth - self.direction * (slope * by.dot(&normal));
        PlaneHit {
            depth,
            point: self.at(depth),
            by_x: along(self.by_x),
            by_y: along(self.by_y),
        }
    }
}

impl PlaneHit {
    /// How far a pixel reaches along a direction of the surface (unit vector), m.
    pub fn reach(&self, along: Vec3) -> f64 {
        self.by_x.dot(&along).hypot(self.by_y.dot(&along))
    }
}

/// Makes the rays of one camera's pixels.
pub(super) struct RayCaster<'a> {
    camera: &'a PtzCamera,
    world_from_cam: Mat3,
}

impl<'a> RayCaster<'a> {
    pub fn new(camera: &'a PtzCamera) -> Self {
        Self {
            camera,
            world_from_cam: camera.cam_from_world().transpose(),
        }
    }

    /// The ray of a pixel's centre; none beyond the fold of the lens model.
    pub fn ray_of_pixel(&self, column: usize, row: usize) -> Option<Ray> {
        self.ray(ImagePoint::new(column as f64 + 0.5, row as f64 + 0.5))
    }

    /// The ray of an image point; none beyond the fold of the lens model.
    pub fn ray(&self, point: ImagePoint) -> Option<Ray> {
        // In `cam` the direction is (x, y, 1); a step of a pixel changes x and y and not the depth.
        let ideal = self.camera.cam_plane_from_image(point).ok()?;
        let (by_x, by_y) = self.ideal_per_px(ideal);
        // A pixel that is wide for its height takes a shorter step down than across.
        let by_y = by_y / self.camera.lens().pixel_aspect;
        let turn = |x: f64, y: f64, z: f64| self.world_from_cam * Vec3::new(x, y, z);
        Some(Ray {
            origin: self.camera.base().position_m,
            direction: turn(ideal.x, ideal.y, 1.0),
            by_x: turn(by_x.x, by_x.y, 0.0),
            by_y: turn(by_y.x, by_y.y, 0.0),
        })
    }

    /// The inverse of the lens's derivative: radially one over its slope, across one over its
    /// stretch.
    fn ideal_per_px(&self, ideal: Vec2) -> (Vec2, Vec2) {
        // The derivative of x · stretch(|x|²) has the eigenvalue slope along x and stretch across
        // it. Its inverse is therefore across · I + (radial − across) · x xᵀ / |x|², of which the
        // columns are returned. In the middle there is no direction, and both eigenvalues are 1.
        let (per_px, lens) = (1.0 / self.camera.ptz().focal_px, self.camera.lens());
        let squared = ideal.norm_squared();
        if lens.is_none() || squared == 0.0 {
            return (Vec2::new(per_px, 0.0), Vec2::new(0.0, per_px));
        }
        let (radial, across) = (per_px / lens.slope(squared), per_px / lens.stretch(squared));
        let twist = (radial - across) / squared;
        let (xx, xy, yy) = (ideal.x * ideal.x, ideal.x * ideal.y, ideal.y * ideal.y);
        (
            Vec2::new(across + twist * xx, twist * xy),
            Vec2::new(twist * xy, across + twist * yy),
        )
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use touchline_core::camera::{CameraBase, FocalCurve};
    use touchline_core::testing::{HD, TestBase, base_at};

    #[test]
    fn differentials_agree_with_the_neighbouring_rays() {
        for (k1, k2_per_k1_squared) in
            [(0.0, 0.0), (-0.1, 0.0), (0.2, 0.0), (-0.2, 0.5), (0.2, 2.0)]
        {
            let base = CameraBase {
                distortion: FocalCurve {
                    k2_per_k1_squared,
                    ..FocalCurve::constant(k1)
                },
                ..base_at([1.0, -62.0, 17.0], HD)
            };
            let camera = base.aim(20.0, -11.0, 1500.0);
            let caster = RayCaster::new(&camera);
            let h = 1e-3;
            for (x, y) in [(640.0, 360.0), (20.0, 50.0), (1200.0, 700.0)] {
                let ray = |dx: f64, dy: f64| caster.ray(ImagePoint::new(x + dx, y + dy)).unwrap();
                let by_x = (ray(h, 0.0).direction - ray(-h, 0.0).direction) / (2.0 * h);
                let by_y = (ray(0.0, h).direction - ray(0.0, -h).direction) / (2.0 * h);
                let here = ray(0.0, 0.0);
                assert!((here.by_x - by_x).norm() < 1e-9 && (here.by_y - by_y).norm() < 1e-9);
                let ground = |r: Ray| r.meets(Vec3::zeros(), Vec3::z());
                let Some(hit) = ground(here) else { continue };
                let moved = (ground(ray(h, 0.0)).unwrap().point
                    - ground(ray(-h, 0.0)).unwrap().point)
                    / (2.0 * h);
                assert!((hit.by_x - moved).norm() < 1e-5 * (1.0 + moved.norm()));
            }
        }
    }
}
