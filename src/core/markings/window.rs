//! The part of the plane z = 1 of `cam`, before distortion, that a picture shows.

use crate::camera::PtzCamera;
use crate::geometry::{ImagePoint, ImageSize, Vec2};

/// Minimum depth of drawn lines, m.
pub const NEAR_M: f64 = 0.05;
/// The maximum radius of drawn lines, as a fraction of the radius at which the distortion model
/// folds.
const FOLD_SHARE: f64 = 1.0 - 1e-4;

/// The rectangle of the picture to draw in, and bounds of its preimage on the undistorted plane.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Window {
    /// The first corner of the frame with its margin, px.
    pub min: ImagePoint,
    /// The opposite corner, px.
    pub max: ImagePoint,
    /// Minimum visible ideal x and y.
    pub ideal_min: Vec2,
    /// Maximum visible ideal x and y.
    pub ideal_max: Vec2,
    /// Maximum ideal radius that is visible and has an image.
    pub ideal_radius: f64,
}

impl Window {
    /// The window of a camera's picture. None if the camera has NaN or infinite parameters.
    pub fn new(camera: &PtzCamera, size: ImageSize, margin_px: f64) -> Option<Self> {
        if !(camera.ptz().is_finite() && camera.base().is_finite() && margin_px.is_finite()) {
            return None;
        }
        let min = ImagePoint::new(-margin_px, -margin_px);
        let max = ImagePoint::new(
            f64::from(size.width) + margin_px,
            f64::from(size.height) + margin_px,
        );
        if !(min.x < max.x && min.y < max.y) {
            return None;
        }
        // The lens scales a radius by a factor that depends on the radius alone. So the extremes of
        // the ideal coordinates on an edge can lie only at its ends, at its point nearest to the
        // principal point, and where the factor is smallest.
        let principal = camera.base().principal_point;
        let (near_x, near_y) = (
            principal.x.clamp(min.x, max.x),
            principal.y.clamp(min.y, max.y),
        );
        let on_edges = [min.y, near_y, max.y]
            .into_iter()
            .flat_map(|y| [ImagePoint::new(min.x, y), ImagePoint::new(max.x, y)])
            .chain([min.y, max.y].map(|y| ImagePoint::new(near_x, y)))
            .chain(most_shrunk(camera, min, max));
        let fold = camera.fold_radius() * FOLD_SHARE;
        let mut window = Self {
            min,
            max,
            ideal_min: Vec2::repeat(0.0),
            ideal_max: Vec2::repeat(0.0),
            ideal_radius: 0.0,
        };
        let (mut low, mut high) = (Vec2::repeat(f64::INFINITY), Vec2::repeat(f64::NEG_INFINITY));
        for point in on_edges {
            // A point beyond the fold has no ray. Then the fold bounds the window.
            if let Ok(ideal) = camera.cam_plane_from_image(point) {
                window.ideal_radius = window.ideal_radius.max(ideal.norm());
                (low, high) = (low.inf(&ideal), high.sup(&ideal));
            } else {
                window.ideal_radius = fold;
                (low, high) = (Vec2::repeat(-fold), Vec2::repeat(fold));
            }
        }
        // The square around the visible disc may be smaller than what the edges reach.
        window.ideal_radius = window.ideal_radius.min(fold);
        let disc = Vec2::repeat(window.ideal_radius);
        (window.ideal_min, window.ideal_max) = (low.sup(&-disc), high.inf(&disc));
        (window.ideal_radius > 0.0).then_some(window)
    }
}

/// The points of a rectangle's edges at the radius where the lens's factor is smallest. None if
/// there is no such radius.
fn most_shrunk(
    camera: &PtzCamera,
    min: ImagePoint,
    max: ImagePoint,
) -> impl Iterator<Item = ImagePoint> {
    // In the picture that radius is a circle about the principal point, which meets each edge at up
    // to two points. A radius of NaN makes all of them NaN, which the filter drops.
    let (lens, principal) = (camera.lens(), camera.base().principal_point);
    let squared = lens.narrowest_radius_squared();
    let radius_px = squared.map_or(f64::NAN, |squared| {
        squared.sqrt() * lens.stretch(squared) * camera.ptz().focal_px
    });
    let upright = [min.x, max.x].into_iter().flat_map(move |x| {
        let half = half_chord_px(radius_px, x - principal.x);
        [principal.y - half, principal.y + half].map(|y| ImagePoint::new(x, y))
    });
    let level = [min.y, max.y].into_iter().flat_map(move |y| {
        let half = half_chord_px(radius_px, y - principal.y);
        [principal.x - half, principal.x + half].map(|x| ImagePoint::new(x, y))
    });
    upright
        .chain(level)
        .filter(move |p| (min.x..=max.x).contains(&p.x) && (min.y..=max.y).contains(&p.y))
}

/// Half of the chord of a circle at a distance from its centre, px; NaN, which lies in no range, if
/// the circle does not reach there.
fn half_chord_px(radius_px: f64, offset_px: f64) -> f64 {
    (radius_px * radius_px - offset_px * offset_px).sqrt()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::camera::{CameraBase, FocalCurve, Ptz};
    use crate::testing::{SIZE, base_at};

    fn camera(distortion: FocalCurve, focal_px: f64) -> PtzCamera {
        let base = base_at([0.0; 3], SIZE);
        PtzCamera::new(
            CameraBase { distortion, ..base },
            Ptz::from_degrees(0.0, 0.0, focal_px),
        )
    }

    #[test]
    fn the_window_holds_every_point_of_the_picture() {
        let without_k2 = [(0.0, 2000.0), (-0.1, 1500.0), (0.3, 1500.0), (-0.4, 900.0)];
        let with_k2 = [(-0.25, 900.0, 2.0), (-0.25, 900.0, 0.5), (0.3, 1500.0, 2.0)];
        for (k1, focal_px, k2_per_k1_squared) in without_k2
            .map(|(k1, px)| (k1, px, 0.0))
            .into_iter()
            .chain(with_k2)
        {
            let camera = camera(
                FocalCurve {
                    k2_per_k1_squared,
                    ..FocalCurve::constant(k1)
                },
                focal_px,
            );
            let window = Window::new(&camera, ImageSize::new(1920, 1080), 4.0).unwrap();
            for step in 0..4000 {
                let (x, y) = (f64::from(step % 80) * 24.3, f64::from(step / 80) * 22.0);
                let Ok(ideal) = camera.cam_plane_from_image(ImagePoint::new(x, y)) else {
                    continue;
                };
                assert!(
                    ideal.norm() <= window.ideal_radius + 1e-12 || k1 < 0.0,
                    "k1 {k1}: {ideal}"
                );
                if ideal.norm() <= window.ideal_radius {
                    assert!(
                        ideal >= window.ideal_min - Vec2::repeat(1e-12),
                        "k1 {k1}: {ideal}"
                    );
                    assert!(
                        ideal <= window.ideal_max + Vec2::repeat(1e-12),
                        "k1 {k1}: {ideal}"
                    );
                }
            }
        }
    }

    #[test]
    fn a_camera_of_nan_has_no_window() {
        assert_eq!(
            Window::new(
                &camera(FocalCurve::constant(f64::NAN), 2000.0),
                ImageSize::new(1920, 1080),
                4.0
            ),
            None
        );
        assert_eq!(
            Window::new(
                &camera(FocalCurve::NONE, f64::NAN),
                ImageSize::new(1920, 1080),
                4.0
            ),
            None
        );
        assert_eq!(
            Window::new(&camera(FocalCurve::NONE, 2000.0), ImageSize::new(0, 0), 0.0),
            None
        );
    }
}
