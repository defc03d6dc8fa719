//! What tests of every crate begin with: a field, cameras that stand beside it, where they see a
//! landmark.
#![allow(
    clippy::unwrap_used,
    clippy::panic,
    clippy::missing_panics_doc,
    clippy::must_use_candidate,
    missing_docs,
    reason = "for tests alone"
)]

pub mod child;
mod derivatives;
pub mod files;
pub mod seeded;

pub use derivatives::{DerivativeError, check_derivatives};

use crate::camera::{BaseAngles, CameraBase, FocalCurve, Ptz, PtzCamera};
use crate::field::{FieldModel, Landmark, builtin};
use crate::geometry::{Angle, ImagePoint, ImageSize, PixelBox, Vec3};

/// Pictures of Full HD.
pub const SIZE: ImageSize = ImageSize::new(1920, 1080);

/// Smaller pictures.
pub const HD: ImageSize = ImageSize::new(1280, 720);

/// A soccer field of the usual size.
pub fn soccer() -> FieldModel {
    builtin("soccer").unwrap().default_model().unwrap()
}

/// The principal point, or the size of pictures of which it is the centre.
pub trait PrincipalPoint {
    /// The point.
    fn principal_point(self) -> ImagePoint;
}

impl PrincipalPoint for ImageSize {
    fn principal_point(self) -> ImagePoint {
        self.centre()
    }
}

impl PrincipalPoint for ImagePoint {
    fn principal_point(self) -> ImagePoint {
        self
    }
}

/// A camera that stands level at this place, m, and looks across the field.
pub fn base_at(position_m: impl Into<Vec3>, principal: impl PrincipalPoint) -> CameraBase {
    turned_base(position_m, [0.0; 3], principal)
}

/// The same with a heading, a pitch and a roll, degrees.
pub fn turned_base(
    position_m: impl Into<Vec3>,
    angles_deg: [f64; 3],
    principal: impl PrincipalPoint,
) -> CameraBase {
    let [heading, pitch, roll] = angles_deg.map(Angle::from_degrees);
    let angles = BaseAngles {
        heading,
        pitch,
        roll,
    };
    CameraBase::new(
        position_m.into(),
        angles.base_from_world(),
        principal.principal_point(),
    )
}

/// What tests make of a base.
pub trait TestBase {
    /// The same with a lens that bends by this k1 at every focal length.
    #[must_use]
    fn bent(self, k1: f64) -> Self;

    /// The camera with this pan, tilt and focal length, degrees and px.
    fn aim(&self, pan_deg: f64, tilt_deg: f64, focal_px: f64) -> PtzCamera;
}

impl TestBase for CameraBase {
    fn bent(self, k1: f64) -> Self {
        let distortion = FocalCurve::constant(k1);
        Self { distortion, ..self }
    }

    fn aim(&self, pan_deg: f64, tilt_deg: f64, focal_px: f64) -> PtzCamera {
        PtzCamera::new(*self, Ptz::from_degrees(pan_deg, tilt_deg, focal_px))
    }
}

/// Where a camera sees a landmark.
pub fn landmark_in(camera: &PtzCamera, field: &FieldModel, landmark: &str) -> ImagePoint {
    let world = field.landmark_in_world(field.landmark(landmark).unwrap());
    camera.image_from_world(world).unwrap()
}

/// The landmarks on the ground that lie before a camera, by their places in the field's list, and where
/// they come to lie, be it beside the picture.
pub fn ground_landmarks<'a>(
    field: &'a FieldModel,
    camera: &'a PtzCamera,
) -> impl Iterator<Item = (usize, &'a Landmark, ImagePoint)> {
    let landmarks = field.landmarks.iter().enumerate();
    landmarks.filter_map(|(index, landmark)| {
        let image = camera.image_from_world(field.landmark_in_world(landmark));
        let image = image.ok().filter(|_| landmark.is_on_ground())?;
        Some((index, landmark, image))
    })
}

/// A box of this left and top edge, width and height, px.
pub const fn pixel_box(x: f64, y: f64, width: f64, height: f64) -> PixelBox {
    PixelBox {
        x,
        y,
        width,
        height,
    }
}
