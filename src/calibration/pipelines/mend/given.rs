//! The cameras that frames came with, and whether they are possible.

use crate::calibrate::{Fault, impossible_camera};
use nalgebra::Matrix3;
use std::fmt;
use touchline_core::camera::{CameraBase, Ptz, PtzCamera};
use touchline_core::geometry::{Mat3, Vec3};
use touchline_documents::document::{Document, Fields, Frame};

/// The camera that a frame came with.
#[derive(Clone, Debug, PartialEq)]
pub enum GivenCamera {
    /// None, or one that could not be read.
    Missing,
    /// An implausible camera.
    Impossible(GivenFault),
    /// A plausible camera.
    Possible(Box<PtzCamera>),
    /// A camera on the other side of the mirrored field: the same camera mirrored back.
    Mirrored(Box<PtzCamera>),
}

/// What makes a camera impossible, in words. What `check` advises to do about it does not apply to
/// a camera of another program, and is left out.
#[derive(Clone, Debug, PartialEq)]
pub struct GivenFault(Fault);

impl fmt::Display for GivenFault {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        // The messages of `Fault` say what is wrong, then, after a semicolon, what to do.
        let text = self.0.to_string();
        let fault = text
            .split_once("; ")
            .map_or(text.as_str(), |(fault, _)| fault);
        f.write_str(fault)
    }
}

impl GivenCamera {
    /// The camera to begin with; none where there is none.
    pub fn usable(&self) -> Option<&PtzCamera> {
        match self {
            Self::Possible(camera) | Self::Mirrored(camera) => Some(camera),
            Self::Missing | Self::Impossible(_) => None,
        }
    }

    pub(super) const fn is_missing(&self) -> bool {
        matches!(self, Self::Missing)
    }

    pub(super) const fn is_mirrored(&self) -> bool {
        matches!(self, Self::Mirrored(_))
    }

    /// What makes it impossible, if it is.
    pub const fn fault(&self) -> Option<&GivenFault> {
        match self {
            Self::Impossible(fault) => Some(fault),
            _ => None,
        }
    }
}

/// The given camera of each frame of a document, whoever it is from. Frames that people decided on
/// help to find the places that cameras share; only the others are changed.
pub(super) fn given_cameras(document: &Document, fields: &Fields) -> Vec<GivenCamera> {
    document
        .frames
        .iter()
        .map(|frame| given_camera(document, frame, fields))
        .collect()
}

fn given_camera(document: &Document, frame: &Frame, fields: &Fields) -> GivenCamera {
    let Some(camera) = document.ptz_camera(frame) else {
        return GivenCamera::Missing;
    };
    let field = fields.for_frame(document, frame);
    match impossible_camera(document, frame, Some(field)) {
        Some(fault) => GivenCamera::Impossible(GivenFault(fault)),
        None => GivenCamera::Possible(Box::new(camera)),
    }
}

/// The camera of the world reflected at the plane x = 0 that gives the reflected picture: position
/// and pan change their sign along x.
///
/// With `D = diag(−1, 1, 1)` the reflected camera has `cam_from_world = D R D`. `D` commutes with
/// the tilt and reverses the pan, so that the base rotation becomes `D B D`.
pub(super) fn mirror(camera: &PtzCamera) -> PtzCamera {
    // The reflection on both sides keeps the determinant at 1, so the result is a rotation.
    let reflection: Mat3 = Matrix3::from_diagonal(&Vec3::new(-1.0, 1.0, 1.0));
    let base = camera.base();
    let reflected = CameraBase {
        position_m: reflection * base.position_m,
        base_from_world: reflection * base.base_from_world * reflection,
        ..*base
    };
    let ptz = camera.ptz();
    let ptz = Ptz {
        pan: -ptz.pan,
        ..ptz
    };
    PtzCamera::new(reflected, ptz)
}

#[cfg(test)]
mod tests {
    use super::*;
    use touchline_core::geometry::ImagePoint;
    use touchline_core::testing::{SIZE, TestBase, turned_base};

    fn camera() -> PtzCamera {
        turned_base([3.0, -62.0, 17.0], [0.0, 0.0, 0.7], SIZE).aim(14.0, -11.0, 2400.0)
    }

    #[test]
    fn a_mirrored_camera_sees_the_mirrored_field_in_the_mirrored_picture() {
        let (camera, reflected) = (camera(), mirror(&camera()));
        let ground = Vec3::new(20.0, 5.0, 0.0);
        let at = camera.image_from_world(ground).unwrap();
        let mirrored_ground = Vec3::new(-20.0, 5.0, 0.0);
        let opposite = reflected.image_from_world(mirrored_ground).unwrap();
        let expected = ImagePoint::new(2.0 * 960.0 - at.x, at.y);
        assert!(opposite.distance_px(expected) < 1e-9, "{opposite:?}");
        // Twice is the same camera.
        let again = mirror(&reflected).image_from_world(ground).unwrap();
        assert!(again.distance_px(at) < 1e-9);
    }
}
