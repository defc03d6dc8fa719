//! The place and the rotation of one frame's camera, where they are not quite those of its camera's
//! base.

use super::adapters;
use crate::document::Extra;
use serde::{Deserialize, Serialize};
use touchline_core::camera::{BaseAngles, BaseSigma, CameraBase, PtzCamera};
use touchline_core::geometry::{Angle, Mat3, Vec3};

/// Where the camera of a frame stands and looks by another program's file, where its place wavers
/// about that of its camera, or it rolls about its optical axis.
///
/// Sensors on a tripod, and programs that calibrate a video frame by frame, state a place and a
/// roll for every frame. All frames of such a video have one camera of the document. `ptz` is what
/// comes nearest on that camera's base, and this beside it is what came: with it the frame is
/// drawn, exported and compared. A solve, an alignment to paint or tracking replaces `ptz` and this
/// with it; the frame then stands on the base of its camera.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct OwnPlace {
    /// Its position in `world`, m.
    #[cfg_attr(feature = "schema", schemars(with = "[f64; 3]"))]
    #[serde(with = "adapters::vector")]
    pub position_m: Vec3,
    /// The direction in which it looks, seen from above: 0 is world +y, positive towards +x.
    #[cfg_attr(feature = "schema", schemars(with = "f64"))]
    #[serde(with = "adapters::number")]
    pub heading_deg: f64,
    /// The elevation of its optical axis above the horizon.
    #[cfg_attr(feature = "schema", schemars(with = "f64"))]
    #[serde(with = "adapters::number")]
    pub pitch_deg: f64,
    /// Its rotation about the optical axis, positive when it leans to its right.
    #[cfg_attr(feature = "schema", schemars(with = "f64"))]
    #[serde(with = "adapters::number")]
    pub roll_deg: f64,
    /// Unknown keys.
    #[serde(flatten)]
    pub extra: Extra,
}

impl OwnPlace {
    /// A camera at a position (`world`, m) with this rotation.
    pub fn new(position_m: Vec3, cam_from_world: &Mat3) -> Self {
        let looks = BaseAngles::from_base_from_world(cam_from_world);
        Self {
            position_m,
            heading_deg: looks.heading.degrees(),
            pitch_deg: looks.pitch.degrees(),
            roll_deg: looks.roll.degrees(),
            extra: Extra::new(),
        }
    }

    /// The rotation from `world` to `cam`.
    pub fn cam_from_world(&self) -> Mat3 {
        let angles = BaseAngles {
            heading: Angle::from_degrees(self.heading_deg),
            pitch: Angle::from_degrees(self.pitch_deg),
            roll: Angle::from_degrees(self.roll_deg),
        };
        angles.base_from_world()
    }

    /// A camera moved here and turned as this says, with its pan, tilt, focal length and lens: what
    /// is left of the rotation becomes that of its base. The σ of the base it came from is not that
    /// of this place.
    pub fn camera_like(&self, on_base: &PtzCamera) -> PtzCamera {
        let base = on_base.base();
        let cam_from_base = on_base.cam_from_world() * base.base_from_world.transpose();
        let own = CameraBase {
            position_m: self.position_m,
            base_from_world: cam_from_base.transpose() * self.cam_from_world(),
            sigma: BaseSigma::default(),
            ..*base
        };
        PtzCamera::new(own, on_base.ptz())
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::document::{Camera, FramePtz, ImportedCamera, Solution, SolutionSource};
    use crate::testing::new_frame;
    use touchline_core::camera::{Ptz, Radial};
    use touchline_core::testing::{SIZE, TestBase, base_at, turned_base};

    #[test]
    fn a_frame_with_a_place_of_its_own_shows_what_came_until_it_is_solved() {
        let came = turned_base([0.4, -60.2, 18.1], [0.0, 0.3, 1.1], SIZE).aim(12.0, -9.0, 2400.0);
        let mut camera = Camera::new("main".into(), SIZE);
        camera.set_base(&base_at([0.0, -60.0, 18.0], SIZE));
        let mut frame = new_frame("1.jpg", SIZE);
        frame.ptz = Some(FramePtz {
            own_place: Some(Box::new(OwnPlace::new(
                came.base().position_m,
                &came.cam_from_world(),
            ))),
            ..FramePtz::new(Ptz::from_degrees(12.1, -9.1, 2400.0), None)
        });
        frame.solution = Some(Solution {
            source: Some(SolutionSource::Import),
            ..Solution::default()
        });

        let text = serde_json::to_string(&frame).unwrap();
        let again: crate::document::Frame = serde_json::from_str(&text).unwrap();
        assert_eq!(again, frame);
        let shown = camera.ptz_camera(&again).unwrap();
        assert!((shown.cam_from_world() - came.cam_from_world()).amax() < 1e-14);
        assert_eq!(shown.base().position_m, came.base().position_m);
        assert_eq!(shown.ptz(), Ptz::from_degrees(12.1, -9.1, 2400.0));

        let solved = Ptz::from_degrees(12.2, -9.2, 2410.0);
        frame.point(solved, Radial::default());
        let now = camera.ptz_camera(&frame).unwrap();
        assert_eq!(now.base(), &camera.base().unwrap());
        assert_eq!(now.ptz(), solved);
        // The frame says where it stood before.
        let kept = frame.take_imported().unwrap();
        let expected = ImportedCamera::new(&came, None, None).unwrap();
        assert_eq!(kept.position_m, expected.position_m);
        assert!((kept.roll_deg - expected.roll_deg).abs() < 1e-12);
        assert_eq!(kept.focal_px, 2400.0);
    }
}
