//! What is known of the lens of one frame before the frame is solved.

use super::adapters::{self, finite};
use crate::document::Extra;
use serde::{Deserialize, Serialize};
use touchline_core::camera::{BaseSigma, CameraBase, FocalCurve, Radial, StatedLens, StatedRadial};
use touchline_core::geometry::ImagePoint;

/// The lens of a frame as the camera or its provider reports it, frame by frame: focal length,
/// principal point, distortion.
///
/// It is an input. Where a frame has it, it takes the place of the camera's lens and principal
/// point, and tracking seeks pan and tilt alone. `ptz` keeps what a solve found.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct FrameLens {
    /// The focal length, px of the frame.
    #[cfg_attr(feature = "schema", schemars(with = "f64", extend("exclusiveMinimum" = 0)))]
    #[serde(with = "adapters::positive")]
    pub focal_px: f64,
    /// The principal point, px.
    #[cfg_attr(feature = "schema", schemars(with = "[f64; 2]"))]
    #[serde(rename = "principal_point_px", serialize_with = "finite")]
    pub principal_point: ImagePoint,
    /// k₁ at this focal length; absent: no distortion.
    #[serde(serialize_with = "finite", skip_serializing_if = "Option::is_none")]
    pub k1: Option<f64>,
    /// k₂ at this focal length; absent: zero. It counts only beside a k₁ that is not zero.
    #[serde(serialize_with = "finite", skip_serializing_if = "Option::is_none")]
    pub k2: Option<f64>,
    /// The aspect of the pixels, fy / fx; absent: square, whatever those of the camera are.
    #[cfg_attr(feature = "schema", schemars(with = "f64", range(min = 0.25, max = 4)))]
    #[serde(
        default = "adapters::pixel_aspect::square",
        with = "adapters::pixel_aspect",
        skip_serializing_if = "adapters::pixel_aspect::is_square"
    )]
    pub pixel_aspect: f64,
    /// Unknown keys.
    #[serde(flatten)]
    pub extra: Extra,
}

impl FrameLens {
    /// A lens by its numbers.
    pub fn new(focal_px: f64, principal_point: ImagePoint, radial: Radial) -> Self {
        Self {
            focal_px,
            principal_point,
            k1: nonzero(radial.k1),
            k2: nonzero(radial.k2),
            pixel_aspect: radial.pixel_aspect,
            extra: Extra::new(),
        }
    }

    /// Its distortion and pixels.
    pub fn radial(&self) -> Radial {
        Radial {
            k1: self.k1.unwrap_or(0.0),
            k2: self.k2.unwrap_or(0.0),
            pixel_aspect: self.pixel_aspect,
        }
    }

    /// The lens as a curve. It is constant, because the lens is stated for this frame's focal length
    /// alone. A k₂ without k₁ has no curve and is left out, as the key's description says.
    fn curve(&self) -> FocalCurve {
        let pinhole = FocalCurve::NONE.with_pixel_aspect(self.pixel_aspect);
        FocalCurve::through(self.radial()).unwrap_or(pinhole)
    }

    /// The lens as the prior of a search that does not take it for exact.
    pub fn stated_lens(&self) -> StatedLens {
        StatedLens {
            principal_point: Some(self.principal_point),
            radial: Some(StatedRadial::new(self.curve(), &BaseSigma::default())),
            pixel_aspect: Some(self.pixel_aspect),
        }
    }

    /// A base with this lens and principal point in place of its own, as exact as they are stated.
    pub fn base_with(&self, base: &CameraBase) -> CameraBase {
        CameraBase {
            principal_point: self.principal_point,
            distortion: self.curve(),
            sigma: base.sigma.with_own_k1(0.0).with_own_principal_point(),
            ..*base
        }
    }
}

/// A number; none if it is zero.
fn nonzero(value: f64) -> Option<f64> {
    Some(value).filter(|value| *value != 0.0)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::document::Camera;
    use crate::testing::new_frame;
    use touchline_core::camera::Ptz;
    use touchline_core::geometry::{Vec2, Vec3};
    use touchline_core::testing::{SIZE, base_at};

    #[test]
    fn the_lens_as_stated_is_the_frames_or_that_of_a_camera_without_a_base() {
        let mut camera = Camera::new("main".into(), SIZE);
        assert_eq!(camera.stated_lens(), StatedLens::default());
        camera.set_base(&CameraBase {
            distortion: FocalCurve::constant(-0.1),
            sigma: BaseSigma {
                k1: 0.03,
                ..BaseSigma::default()
            },
            ..base_at([0.0, -70.0, 15.0], ImagePoint::new(900.0, 500.0))
        });
        // A distortion beside a base is what an estimate found.
        let beside_base = camera.stated_lens();
        let stated = ImagePoint::new(900.0, 500.0);
        assert_eq!(beside_base, StatedLens::from_principal_point(stated));
        camera.position_m = None;
        let radial = camera.stated_lens().radial.unwrap();
        assert_eq!((radial.curve.value, radial.k1_sigma), (-0.1, 0.03));

        let mut document = crate::testing::soccer_document();
        document.cameras.push(camera.into());
        let mut frame = new_frame("1.jpg", SIZE);
        assert_eq!(document.stated_lens(&frame).radial, Some(radial));
        let own = Radial {
            k1: 0.2,
            k2: 1.5,
            ..Radial::default()
        };
        frame.lens = Some(FrameLens::new(3000.0, stated, own));
        let of_frame = document.stated_lens(&frame).radial.unwrap();
        let at_3000 = of_frame.curve.radial_at(3000.0);
        assert!((at_3000.k1 - 0.2).abs() < 1e-12 && (at_3000.k2 - 1.5).abs() < 1e-12);
        assert!(of_frame.k1_at(3000.0).1 > 0.0, "no lens is exact");
    }

    #[test]
    fn the_lens_of_a_frame_takes_the_place_of_the_cameras() {
        let position_m = Vec3::new(0.0, -70.0, 15.0);
        let mut camera = Camera::new("main".into(), SIZE);
        let own = base_at(position_m, SIZE);
        camera.set_base(&CameraBase {
            distortion: FocalCurve::constant(-0.1),
            sigma: BaseSigma {
                position_m: Vec3::new(0.2, 0.3, 0.1),
                k1: 0.05,
                k1_per_1000_px: 0.1,
                principal_point_px: Vec2::new(40.0, 30.0),
                ..BaseSigma::default()
            },
            ..own
        });
        let mut frame = new_frame("1.jpg", SIZE);
        let radial = Radial {
            k1: 0.2,
            k2: 1.5,
            ..Radial::default()
        };
        frame.lens = Some(FrameLens::new(
            3000.0,
            ImagePoint::new(970.0, 520.0),
            radial,
        ));

        let base = camera.base_for(&frame).unwrap();
        assert_eq!(
            (base.position_m, base.principal_point),
            (position_m, ImagePoint::new(970.0, 520.0))
        );
        // The error of the camera's lens is none of this frame's.
        let position_alone = BaseSigma {
            position_m: Vec3::new(0.2, 0.3, 0.1),
            ..BaseSigma::default()
        };
        assert_eq!(base.sigma, position_alone);
        for focal_px in [2000.0, 3000.0] {
            let Radial { k1, k2, .. } = base.distortion.radial_at(focal_px);
            assert!(k1 == 0.2 && (k2 - 1.5).abs() < 1e-15, "{k1} {k2}");
        }
        frame.point(
            Ptz::from_degrees(0.0, -10.0, 3000.0),
            base.distortion.radial_at(3000.0),
        );
        assert_eq!(camera.ptz_camera(&frame).unwrap().base(), &base);
    }

    #[test]
    fn it_is_written_by_its_keys_and_read_again() {
        let lens = FrameLens::new(
            3000.5,
            ImagePoint::new(970.25, 520.0),
            Radial {
                k1: 0.125,
                k2: 0.0,
                ..Radial::default()
            },
        );
        let text = serde_json::to_string(&lens).unwrap();
        assert_eq!(
            text,
            r#"{"focal_px":3000.5,"principal_point_px":[970.25,520.0],"k1":0.125}"#
        );
        assert_eq!(serde_json::from_str::<FrameLens>(&text).unwrap(), lens);
        assert!(serde_json::from_str::<FrameLens>(&text.replace("3000.5", "0")).is_err());
    }
}
