//! The camera that another program gave a frame, kept beside the one on its camera's base.

use super::adapters::{self, finite};
use crate::document::Extra;
use serde::{Deserialize, Serialize};
use touchline_core::camera::{BaseAngles, BaseSigma, CameraBase, Ptz, PtzCamera};
use touchline_core::geometry::{Angle, Mat3, Vec3};

/// Less roll than this is none: the rounding of a recorded camera.
const LEVEL_DEG: f64 = 1e-6;

/// The camera that another program gave a frame, as it came.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct ImportedCamera {
    /// Its position in `world`, m.
    #[cfg_attr(feature = "schema", schemars(with = "[f64; 3]"))]
    #[serde(with = "adapters::vector")]
    pub position_m: Vec3,
    /// The direction in which it looks, seen from above: 0 is world +y, positive towards +x.
    #[serde(serialize_with = "finite")]
    pub heading_deg: f64,
    /// The elevation of its optical axis above the horizon.
    #[serde(serialize_with = "finite")]
    pub pitch_deg: f64,
    /// Its rotation about the optical axis, positive when it leans to its right.
    #[serde(serialize_with = "finite")]
    pub roll_deg: f64,
    /// Its focal length, px.
    #[serde(serialize_with = "finite")]
    pub focal_px: f64,
    /// How far the ground moved in the picture when it was mended, px: the median over the picture.
    /// None if the two pictures have no ground in common.
    #[serde(serialize_with = "finite", skip_serializing_if = "Option::is_none")]
    pub moved_px: Option<f64>,
    /// What made it impossible, in words.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub fault: Option<String>,
    /// Unknown keys.
    #[serde(flatten)]
    pub extra: Extra,
}

impl ImportedCamera {
    /// The record of a camera; none if one of its numbers is not finite, which a document cannot
    /// hold.
    pub fn new(camera: &PtzCamera, moved_px: Option<f64>, fault: Option<String>) -> Option<Self> {
        // Heading, pitch and roll are those of the frame, pan and tilt included, because the other
        // program's base need not be the document's.
        let looks = BaseAngles::from_base_from_world(&camera.cam_from_world());
        let imported = Self {
            position_m: camera.base().position_m,
            heading_deg: looks.heading.degrees(),
            pitch_deg: looks.pitch.degrees(),
            roll_deg: looks.roll.degrees(),
            focal_px: camera.ptz().focal_px,
            moved_px: moved_px.filter(|moved| moved.is_finite()),
            fault,
            extra: Extra::new(),
        };
        let Self {
            heading_deg,
            pitch_deg,
            roll_deg,
            focal_px,
            ..
        } = imported;
        let mut numbers =
            imported
                .position_m
                .iter()
                .copied()
                .chain([heading_deg, pitch_deg, roll_deg, focal_px]);
        numbers.all(f64::is_finite).then_some(imported)
    }
}

impl ImportedCamera {
    /// The rotation from `world` to `cam`.
    fn cam_from_world(&self) -> Mat3 {
        let [heading, pitch, roll] =
            [self.heading_deg, self.pitch_deg, self.roll_deg].map(Angle::from_degrees);
        let angles = BaseAngles {
            heading,
            pitch,
            roll,
        };
        angles.base_from_world()
    }

    /// This camera with the lens of another, and with pan and tilt of that: what is left of its
    /// rotation is that of its base. It states no σ of a base.
    pub fn camera_like(&self, like: &PtzCamera) -> PtzCamera {
        let cam_from_base = like.cam_from_world() * like.base().base_from_world.transpose();
        let base = CameraBase {
            position_m: self.position_m,
            base_from_world: cam_from_base.transpose() * self.cam_from_world(),
            sigma: BaseSigma::default(),
            ..*like.base()
        };
        let ptz = Ptz {
            focal_px: self.focal_px,
            ..like.ptz()
        };
        PtzCamera::new(base, ptz)
    }

    /// Pan and tilt with which it looks where it does from another base, and its focal length.
    pub fn ptz_on(&self, base: &CameraBase) -> Ptz {
        base.ptz_like(&self.cam_from_world(), self.focal_px)
    }

    /// The base of the camera, with principal point and lens of `like`, and pan, tilt and focal
    /// length on it. Cameras without roll at one place have one base.
    pub fn on_base_of(&self, like: &CameraBase) -> (CameraBase, Ptz) {
        let is_level = self.roll_deg.abs() < LEVEL_DEG;
        let (base_from_world, pan_deg, tilt_deg) = if is_level {
            let level = BaseAngles::default().base_from_world();
            (level, self.heading_deg, self.pitch_deg)
        } else {
            (self.cam_from_world(), 0.0, 0.0)
        };
        let base = CameraBase {
            position_m: self.position_m,
            base_from_world,
            sigma: BaseSigma::default(),
            ..*like
        };
        (base, Ptz::from_degrees(pan_deg, tilt_deg, self.focal_px))
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::document::{Camera, Frame, FramePtz};
    use crate::testing::new_frame;
    use touchline_core::camera::Radial;
    use touchline_core::geometry::ImageSize;
    use touchline_core::testing::{SIZE, TestBase, base_at, turned_base};

    #[test]
    fn a_camera_is_recorded_as_it_looks_and_survives_the_file() {
        let rotation = BaseAngles::default().base_from_world();
        let base = CameraBase::new(
            Vec3::new(1.0, -62.0, 17.0),
            rotation,
            ImageSize::new(1920, 1080).centre(),
        );
        let camera = base.aim(12.0, -9.0, 2400.0);
        let recorded = ImportedCamera::new(&camera, Some(41.2), None).unwrap();
        let looks = [recorded.heading_deg, recorded.pitch_deg, recorded.roll_deg];
        for (is, expected) in looks.into_iter().zip([12.0, -9.0, 0.0]) {
            assert!((is - expected).abs() < 1e-9, "{looks:?}");
        }
        let text = serde_json::to_string(&recorded).unwrap();
        assert_eq!(
            serde_json::from_str::<ImportedCamera>(&text).unwrap(),
            recorded
        );
        // It is given back as it looked, with roll or without.
        let lean = BaseAngles {
            roll: Angle::from_degrees(2.0),
            ..BaseAngles::default()
        };
        for base_from_world in [rotation, lean.base_from_world()] {
            let base = CameraBase {
                base_from_world,
                ..base
            };
            let camera = PtzCamera::new(base, camera.ptz());
            let recorded = ImportedCamera::new(&camera, None, None).unwrap();
            let (base, ptz) = recorded.on_base_of(&base);
            let again = PtzCamera::new(base, ptz);
            let turned = again.cam_from_world() - camera.cam_from_world();
            assert!(turned.abs().max() < 1e-9, "{turned}");
            assert_eq!(again.base().position_m, camera.base().position_m);
        }
        let nowhere = CameraBase {
            position_m: Vec3::new(f64::NAN, 0.0, 0.0),
            ..base
        };
        assert!(ImportedCamera::new(&PtzCamera::new(nowhere, camera.ptz()), None, None).is_none());
    }

    #[test]
    fn a_frame_beside_its_base_shows_what_came_until_it_is_solved() {
        let came = turned_base([0.4, -60.2, 18.1], [0.0, 0.3, 1.1], SIZE).aim(12.0, -9.0, 2400.0);
        let mut camera = Camera::new("main".into(), SIZE);
        camera.set_base(&base_at([0.0, -60.0, 18.0], SIZE));
        let recorded = ImportedCamera::new(&came, None, None).unwrap();
        let mut frame = new_frame("1.jpg", SIZE);
        frame.ptz = Some(FramePtz {
            imported: Some(Box::new(recorded.clone())),
            ..FramePtz::new(Ptz::from_degrees(12.1, -9.1, 2390.0), None)
        });
        let text = serde_json::to_string(&frame).unwrap();
        assert_eq!(serde_json::from_str::<Frame>(&text).unwrap(), frame);
        let shown = camera.ptz_camera(&frame).unwrap();
        assert!((shown.cam_from_world() - came.cam_from_world()).amax() < 1e-14);
        assert_eq!(shown.base().position_m, came.base().position_m);
        assert_eq!(shown.ptz(), Ptz::from_degrees(12.1, -9.1, 2400.0));

        let solved = Ptz::from_degrees(12.2, -9.2, 2410.0);
        frame.point(solved, Radial::default());
        let now = camera.ptz_camera(&frame).unwrap();
        assert_eq!(now.base(), &camera.base().unwrap());
        assert!((now.ptz().tilt - solved.tilt).radians().abs() < 1e-12);
        // The frame says what it showed before.
        assert_eq!(frame.take_imported(), Some(recorded));
    }
}
