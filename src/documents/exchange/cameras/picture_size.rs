//! Cameras of one picture size for pictures of another: rescaled if the aspect ratios agree, else
//! rejected.
//!
//! Focal length, principal point and homography are in pixels of the camera's own picture. Used
//! unchanged with a picture twice as wide, they would be off by up to half a picture.

use super::frame_camera::{FrameCamera, FrameProjection};
use touchline_core::geometry::{ImageSize, Mat3, Vec3, pluralise};

/// The source of a format's picture size.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum SizeSource {
    /// The format states it.
    Stated,
    /// Twice the principal point, as readers of the format assume. A principal point that is not in
    /// the middle gives no size.
    PrincipalPoint,
    /// The picture size of the data set for which the format was made.
    Assumed,
}

/// The largest plausible distance of a principal point from the middle of its own picture, as a
/// fraction of the picture's width.
const OFF_CENTRE: f64 = 0.1;

/// The frame rescaled to a picture of another size, and the factor; none where the aspect ratios
/// differ.
pub fn fit_to_picture(
    frame: &FrameCamera,
    picture: ImageSize,
    source: SizeSource,
) -> Option<(FrameCamera, f64)> {
    let Some(stated) = frame.size.filter(|size| *size != picture) else {
        return Some((frame.clone(), 1.0));
    };
    // A size that the format does not state may simply be wrong; then the camera already belongs to
    // the picture. A principal point beside the middle hardly gives a size of exactly the picture's
    // proportions.
    let is_as_it_is = match source {
        SizeSource::Stated => false,
        SizeSource::PrincipalPoint => {
            !has_same_proportions(stated, picture) && has_its_centre_in(frame, picture)
        }
        SizeSource::Assumed => true,
    };
    if is_as_it_is {
        return Some((frame.clone(), 1.0));
    }
    let factor = stated.factor_to(picture)?;
    Some((rescale(frame, factor, picture), factor))
}

/// Whether two sizes have exactly the same proportions, compared as whole numbers.
pub fn has_same_proportions(a: ImageSize, b: ImageSize) -> bool {
    u64::from(a.width) * u64::from(b.height) == u64::from(a.height) * u64::from(b.width)
}

fn has_its_centre_in(frame: &FrameCamera, picture: ImageSize) -> bool {
    let principal_point = frame.pinhole().map(|pinhole| pinhole.principal_point);
    // A homography has no principal point, and the sizes of its formats are never derived from one.
    principal_point.is_some_and(|point| {
        point.distance_px(picture.centre()) <= OFF_CENTRE * f64::from(picture.width)
    })
}

fn rescale(frame: &FrameCamera, factor: f64, picture: ImageSize) -> FrameCamera {
    let shown = match frame.shown {
        FrameProjection::Camera(pinhole) => FrameProjection::Camera(pinhole.scale_by(factor)),
        // Pixels count from the corner, so that a scaling about the origin is all; from pixel
        // centres it would also shift them.
        FrameProjection::Ground(image_from_ground) => FrameProjection::Ground(
            Mat3::from_diagonal(&Vec3::new(factor, factor, 1.0)) * image_from_ground,
        ),
        FrameProjection::Lens(lens) => {
            FrameProjection::Lens(lens.camera_at_origin().scale_by(factor).known_lens())
        }
        FrameProjection::Nothing => FrameProjection::Nothing,
    };
    FrameCamera {
        size: Some(picture),
        shown,
        ..frame.clone()
    }
}

/// The rescaled cameras and assumed sizes of an import, for its notes.
#[derive(Default)]
pub struct FittedSizes {
    rescaled: usize,
    /// The sizes of the first rescaled camera.
    first: Option<(ImageSize, ImageSize)>,
}

impl FittedSizes {
    /// Counts a camera that was rescaled.
    pub fn count(&mut self, stated: ImageSize, picture: ImageSize) {
        self.rescaled += 1;
        self.first.get_or_insert((stated, picture));
    }

    /// The note about them; `what` is one of them.
    pub fn note(&self, what: &str) -> Option<String> {
        let (stated, picture) = self.first?;
        Some(format!(
            "{} rescaled to the size of the pictures, the first from {} × {} to {} × {}",
            pluralise(self.rescaled, what),
            stated.width,
            stated.height,
            picture.width,
            picture.height
        ))
    }
}

#[cfg(test)]
mod tests {
    use super::super::frame_camera::Pinhole;
    use super::*;
    use crate::exchange::tests::awkward;
    use touchline_core::geometry::ImagePoint;

    const FULL: ImageSize = ImageSize::new(1920, 1080);
    const HALF: ImageSize = ImageSize::new(960, 540);

    fn camera(size: ImageSize, principal_point: ImagePoint) -> FrameCamera {
        let pointed =
            Pinhole::from_ptz_camera(&awkward().ptz_camera(&awkward().frames[0]).unwrap());
        FrameCamera::new(
            "a",
            Some(size),
            FrameProjection::Camera(Pinhole {
                principal_point,
                ..pointed
            }),
        )
    }

    #[test]
    fn a_camera_of_half_the_size_is_rescaled_and_shows_the_same() {
        let small = camera(HALF, HALF.centre());
        let (large, factor) = fit_to_picture(&small, FULL, SizeSource::Stated).unwrap();
        assert_eq!((factor, large.size), (2.0, Some(FULL)));
        let point = Vec3::new(-40.0, 3.0, 0.0);
        let (at, there) = (
            small.image_from_world(point).unwrap(),
            large.image_from_world(point).unwrap(),
        );
        assert!(there.distance_px(ImagePoint::new(2.0 * at.x, 2.0 * at.y)) < 1e-9);
        let ground = FrameCamera {
            shown: FrameProjection::Ground(small.pinhole().unwrap().image_from_ground()),
            ..small
        };
        let at = ground.image_from_world(point).unwrap();
        let (large, _) = fit_to_picture(&ground, FULL, SizeSource::Stated).unwrap();
        let there = large.image_from_world(point).unwrap();
        assert!(there.distance_px(ImagePoint::new(2.0 * at.x, 2.0 * at.y)) < 1e-9);
    }

    #[test]
    fn other_proportions_are_refused_and_rounded_heights_are_not() {
        let small = camera(HALF, HALF.centre());
        assert_eq!(
            fit_to_picture(&small, ImageSize::new(1280, 960), SizeSource::Stated),
            None
        );
        let rounded = camera(ImageSize::new(854, 480), ImagePoint::new(427.0, 240.0));
        assert!(fit_to_picture(&rounded, FULL, SizeSource::Stated).is_some());
    }

    #[test]
    fn a_principal_point_beside_the_middle_is_no_other_size() {
        let off = camera(ImageSize::new(1903, 1096), ImagePoint::new(951.5, 548.0));
        assert_eq!(
            fit_to_picture(&off, FULL, SizeSource::PrincipalPoint)
                .unwrap()
                .1,
            1.0
        );
        let half = camera(HALF, HALF.centre());
        for (picture, factor) in [(FULL, 2.0), (ImageSize::new(1024, 576), 1024.0 / 960.0)] {
            let (_, by) = fit_to_picture(&half, picture, SizeSource::PrincipalPoint).unwrap();
            assert_eq!(by, factor);
        }
    }
}
