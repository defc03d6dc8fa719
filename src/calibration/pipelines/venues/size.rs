//! A camera of a venue in pictures of another size: a match is recorded in more than one.

use touchline_core::camera::{BaseSigma, CameraBase, FocalCurve};
use touchline_core::geometry::{ImagePoint, ImageSize, Mat3, Vec3};
use touchline_vision::relocalize::SeenRange;

/// The factor from pictures of one size to those of another; none if their proportions differ.
pub fn factor_between(from: ImageSize, to: ImageSize) -> Option<f64> {
    /// Sizes are whole numbers.
    const ROUNDED_PX: f64 = 1.0;
    let factor = f64::from(to.width) / f64::from(from.width);
    let height_px = factor * f64::from(from.height);
    ((height_px - f64::from(to.height)).abs() <= ROUNDED_PX).then_some(factor)
}

/// A base in pictures that are larger by a factor. Coefficients of the lens are of normalised
/// coordinates and stay; what is in px, or per px, changes.
pub fn scale_base(base: &CameraBase, factor: f64) -> CameraBase {
    let (at, curve, sigma) = (base.principal_point, base.distortion, base.sigma);
    CameraBase {
        principal_point: ImagePoint::new(at.x * factor, at.y * factor),
        distortion: FocalCurve {
            at_focal_px: curve.at_focal_px * factor,
            per_1000_px: curve.per_1000_px / factor,
            ..curve
        },
        sigma: BaseSigma {
            k1_per_1000_px: sigma.k1_per_1000_px / factor,
            principal_point_px: sigma.principal_point_px * factor,
            ..sigma
        },
        ..*base
    }
}

/// The views of a forest's references in pictures that are larger by a factor.
pub fn scale_seen(seen: &SeenRange, factor: f64) -> SeenRange {
    let scale = Mat3::from_diagonal(&Vec3::new(1.0, 1.0, factor));
    // Focal lengths are in px, angles are not.
    let mut cameras = seen.cameras.clone();
    for ptz in &mut cameras {
        ptz.focal_px *= factor;
    }
    SeenRange {
        focal_px: seen.focal_px.start() * factor..=seen.focal_px.end() * factor,
        cameras,
        labels: seen
            .labels
            .iter()
            .map(|label| scale * label * scale)
            .collect(),
        ..seen.clone()
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use touchline_core::camera::{Ptz, PtzCamera};
    use touchline_core::testing::{TestBase, base_at};

    #[test]
    fn a_larger_picture_shows_the_same() {
        let [small, large] = [ImageSize::new(1280, 720), ImageSize::new(1920, 1080)];
        let factor = factor_between(small, large).unwrap();
        assert_eq!(factor_between(small, ImageSize::new(640, 480)), None);
        let base = base_at([0.0, -60.0, 18.0], small).bent(-0.05);
        let ptz = Ptz::from_degrees(8.0, -12.0, 1500.0);
        let seen = SeenRange::from_cameras(&[ptz]).unwrap();
        let seen = scale_seen(&seen.with_labels(vec![Mat3::identity()]), factor);
        let [before, after] = [
            PtzCamera::new(base, ptz),
            PtzCamera::new(scale_base(&base, factor), seen.cameras[0]),
        ];
        for at in [Vec3::zeros(), Vec3::new(14.0, 20.0, 0.0)] {
            let [before, after] = [before, after].map(|it| it.image_from_world(at).unwrap());
            let larger = ImagePoint::new(before.x * factor, before.y * factor);
            assert!(after.distance_px(larger) < 1e-6, "{after:?} {larger:?}");
        }
        assert_eq!(seen.labels[0][(2, 2)], factor * factor);
        assert!(seen.focal_px.contains(&seen.cameras[0].focal_px));
    }
}
