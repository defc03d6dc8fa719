//! A camera of the document.

use super::adapters::{self, finite};
use super::size_sigma::SizeSigma;
use crate::document::{CameraId, Extra, FieldSpec, Frame, RangedMask};
use serde::{Deserialize, Serialize};
use touchline_core::camera::{
    BaseCorrelation, BaseSigma, CameraBase, FocalCurve, PtzCamera, SizeError, StatedLens,
    StatedRadial,
};
use touchline_core::geometry::rotation::{distance_from_rotation, nearest_rotation};
use touchline_core::geometry::{ImagePoint, ImageSize, Mat3, PixelBox, Vec2, Vec3};

/// A matrix nearer to a rotation than this is not orthogonalised, so that its digits are kept.
/// Rounding explains such a distance: it is about fifty times the precision of `f64`.
const EXACT_ROTATION: f64 = 1e-14;

/// A camera of the document: its picture, and its base as far as it is known.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct Camera {
    /// Its name; frames refer to it.
    pub id: CameraId,
    /// The size of its pictures, px.
    #[cfg_attr(
        feature = "schema",
        schemars(with = "[u32; 2]", inner(range(min = 1, max = 65535)))
    )]
    #[serde(rename = "image_size_px", with = "adapters::image_size")]
    pub image_size: ImageSize,
    /// The principal point, px.
    #[cfg_attr(feature = "schema", schemars(with = "[f64; 2]"))]
    #[serde(rename = "principal_point_px", serialize_with = "finite")]
    pub principal_point: ImagePoint,
    /// The aspect of the pixels, their width over their height: fy / fx of the calibration matrix;
    /// absent: 1, square. Focal lengths are fx.
    #[cfg_attr(feature = "schema", schemars(with = "f64", range(min = 0.25, max = 4)))]
    #[serde(
        default = "adapters::pixel_aspect::square",
        with = "adapters::pixel_aspect",
        skip_serializing_if = "adapters::pixel_aspect::is_square"
    )]
    pub pixel_aspect: f64,
    /// The centre of projection in `world`, m.
    #[cfg_attr(feature = "schema", schemars(with = "Option<[f64; 3]>"))]
    #[serde(
        default,
        with = "adapters::optional_vector",
        skip_serializing_if = "Option::is_none"
    )]
    pub position_m: Option<Vec3>,
    /// The rotation from `world` to `base` as the document states it, a rotation up to rounded
    /// digits ([`Camera::base`] tidies them).
    #[cfg_attr(feature = "schema", schemars(with = "Option<[[f64; 3]; 3]>"))]
    #[serde(
        default,
        with = "adapters::optional_rotation",
        skip_serializing_if = "Option::is_none"
    )]
    pub base_from_world: Option<Mat3>,
    /// The lens; absent: no distortion, unless a frame brings its own k₁.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub distortion: Option<Distortion>,
    /// The 1-σ of position and rotation; absent: exactly known.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub sigma: Option<CameraSigma>,
    /// Boxes that are excluded from feature detection in all frames: the score bug, a logo.
    #[cfg_attr(feature = "schema", schemars(with = "Vec<[f64; 4]>"))]
    #[serde(
        rename = "masks_px",
        default,
        with = "adapters::boxes",
        skip_serializing_if = "Vec::is_empty"
    )]
    pub masks: Vec<PixelBox>,
    /// Further such boxes that count for a part of the frames, or that the program found itself.
    #[serde(rename = "masks", default, skip_serializing_if = "Vec::is_empty")]
    pub ranged_masks: Vec<RangedMask>,
    /// 1-σ of a click in its pictures, px, where it is known.
    #[serde(serialize_with = "finite", skip_serializing_if = "Option::is_none")]
    pub click_noise_px: Option<f64>,
    /// The width of its sensor, mm, where it is known.
    #[serde(serialize_with = "finite", skip_serializing_if = "Option::is_none")]
    pub sensor_width_mm: Option<f64>,
    /// The stage of a virtual production in whose axes its tracks are written.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub stage: Option<Stage>,
    /// The field this camera looks at, where it is not the document's.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub field: Option<FieldSpec>,
    /// Unknown keys.
    #[serde(flatten)]
    pub extra: Extra,
}

/// Where the stage of a virtual production lies on the field.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct Stage {
    /// Its origin in `world`, m.
    #[cfg_attr(feature = "schema", schemars(with = "[f64; 3]"))]
    #[serde(with = "adapters::vector")]
    pub origin_m: Vec3,
    /// Where its y axis looks, seen from above: 0 is across the field, positive to the right,
    /// degrees.
    #[serde(default, serialize_with = "finite")]
    pub heading_deg: f64,
    /// Unknown keys.
    #[serde(flatten)]
    pub extra: Extra,
}

impl Stage {
    /// A stage in the field's axes, with its origin there.
    pub fn at(origin_m: Vec3) -> Self {
        Self {
            origin_m,
            heading_deg: 0.0,
            extra: Extra::new(),
        }
    }
}

/// The lens of a camera: Brown's model on normalised coordinates.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct Distortion {
    /// k₁ by focal length.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub k1: Option<K1Curve>,
    /// k₂ = this · k₁², at every focal length; absent: k₂ is zero. From 0.45 on the lens folds
    /// nowhere.
    #[serde(serialize_with = "finite", skip_serializing_if = "Option::is_none")]
    pub k2_per_k1_squared: Option<f64>,
    /// Unknown keys, further coefficients among them.
    #[serde(flatten)]
    pub extra: Extra,
}

/// k₁ = `value` + `per_1000_px` · (f − `at_focal_px`) / 1000.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct K1Curve {
    /// The focal length at which `value` holds, px.
    #[serde(default, serialize_with = "finite")]
    pub at_focal_px: f64,
    /// k₁ there.
    #[serde(serialize_with = "finite")]
    pub value: f64,
    /// The change of k₁ per 1000 px of focal length.
    #[serde(default, serialize_with = "finite")]
    pub per_1000_px: f64,
    /// Unknown keys.
    #[serde(flatten)]
    pub extra: Extra,
}

/// Prior 1-σ of a base in the document's units.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct CameraSigma {
    /// Along world x, y, z, m.
    #[cfg_attr(feature = "schema", schemars(with = "[f64; 3]"))]
    #[serde(default, with = "adapters::vector")]
    pub position_m: Vec3,
    /// About world x, y, z (z is the pan gauge), degrees.
    #[cfg_attr(feature = "schema", schemars(with = "[f64; 3]"))]
    #[serde(default, with = "adapters::vector")]
    pub rotation_deg: Vec3,
    /// Of k₁ at `at_focal_px` of the lens.
    #[serde(default, serialize_with = "finite", skip_serializing_if = "is_zero")]
    pub k1: f64,
    /// Of the change of k₁ per 1000 px of focal length.
    #[serde(default, serialize_with = "finite", skip_serializing_if = "is_zero")]
    pub k1_per_1000_px: f64,
    /// Of the height of the pitch's crown, m.
    #[serde(default, serialize_with = "finite", skip_serializing_if = "is_zero")]
    pub crown_m: f64,
    /// The width of the pitch that is crowned, m.
    #[serde(default, serialize_with = "finite", skip_serializing_if = "is_zero")]
    pub crown_width_m: f64,
    /// Of the principal point, px.
    #[cfg_attr(feature = "schema", schemars(with = "Option<[f64; 2]>"))]
    #[serde(
        default,
        with = "adapters::optional_pair",
        skip_serializing_if = "Option::is_none"
    )]
    pub principal_point_px: Option<Vec2>,
    /// How the errors of position x, y, z, rotation about x, y, and behind them those of k₁, its
    /// slope, crown and principal point x, y go together: their correlation matrix, 5 × 5 where
    /// only position and rotation do, else 10 × 10; none: not at all.
    #[cfg_attr(feature = "schema", schemars(with = "Option<Vec<Vec<f64>>>"))]
    #[serde(
        default,
        with = "adapters::optional_correlation",
        skip_serializing_if = "Option::is_none"
    )]
    pub correlation: Option<BaseCorrelation>,
    /// What is open of the field's length; absent: nothing. All other errors are given the size.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub length: Option<SizeSigma>,
    /// The same of its width.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub width: Option<SizeSigma>,
    /// Unknown keys.
    #[serde(flatten)]
    pub extra: Extra,
}

#[expect(
    clippy::trivially_copy_pass_by_ref,
    reason = "serde passes fields by reference"
)]
fn is_zero(number: &f64) -> bool {
    *number == 0.0
}

impl From<&BaseSigma> for CameraSigma {
    fn from(sigma: &BaseSigma) -> Self {
        Self {
            // Degrees in documents, radians in the program. What is exactly known, with a sigma of
            // zero, or independent is stated by leaving its key out.
            position_m: sigma.position_m,
            rotation_deg: sigma.rotation.map(f64::to_degrees),
            k1: sigma.k1,
            k1_per_1000_px: sigma.k1_per_1000_px,
            crown_m: sigma.crown_m,
            crown_width_m: sigma.crown_width_m,
            principal_point_px: Some(sigma.principal_point_px)
                .filter(|sigma_px| *sigma_px != Vec2::zeros()),
            correlation: Some(sigma.correlation)
                .filter(|correlation| *correlation != BaseCorrelation::NONE),
            length: SizeSigma::new(&sigma.size[0]),
            width: SizeSigma::new(&sigma.size[1]),
            extra: Extra::new(),
        }
    }
}

impl From<&CameraSigma> for BaseSigma {
    fn from(sigma: &CameraSigma) -> Self {
        Self {
            position_m: sigma.position_m,
            rotation: sigma.rotation_deg.map(f64::to_radians),
            k1: sigma.k1,
            k1_per_1000_px: sigma.k1_per_1000_px,
            crown_m: sigma.crown_m,
            crown_width_m: sigma.crown_width_m,
            principal_point_px: sigma.principal_point_px.unwrap_or_default(),
            correlation: sigma.correlation.unwrap_or_default(),
            size: [&sigma.length, &sigma.width]
                .map(|size| size.as_ref().map(SizeError::from).unwrap_or_default()),
        }
    }
}

impl Camera {
    /// A camera of which only the picture is known: principal point in the middle, no base.
    pub fn new(id: CameraId, image_size: ImageSize) -> Self {
        Self {
            id,
            image_size,
            principal_point: image_size.centre(),
            pixel_aspect: 1.0,
            position_m: None,
            base_from_world: None,
            distortion: None,
            sigma: None,
            masks: Vec::new(),
            ranged_masks: Vec::new(),
            click_noise_px: None,
            sensor_width_mm: None,
            stage: None,
            field: None,
            extra: Extra::new(),
        }
    }

    /// Whether its base leaves something open of the size of its field.
    pub fn states_open_size(&self) -> bool {
        let sigma = self.sigma.as_ref();
        sigma.is_some_and(|sigma| sigma.length.is_some() || sigma.width.is_some())
    }

    /// The lens as it is stated. The middle of the picture stands for an unknown principal
    /// point; the distortion beside a base is a result, and no prior of the next one.
    pub fn stated_lens(&self) -> StatedLens {
        let centre = self.image_size.centre();
        let curve = self.curve().filter(|_| self.base().is_none());
        let sigma = self.sigma.as_ref().map(BaseSigma::from).unwrap_or_default();
        StatedLens {
            principal_point: Some(self.principal_point).filter(|point| *point != centre),
            radial: curve.map(|curve| StatedRadial::new(curve, &sigma)),
            pixel_aspect: Some(self.pixel_aspect).filter(|aspect| *aspect != 1.0),
        }
    }

    /// The lens by focal length, where the camera has a curve.
    pub fn curve(&self) -> Option<FocalCurve> {
        let distortion = self.distortion.as_ref()?;
        let k1 = distortion.k1.as_ref()?;
        Some(FocalCurve {
            at_focal_px: k1.at_focal_px,
            value: k1.value,
            per_1000_px: k1.per_1000_px,
            k2_per_k1_squared: distortion.k2_per_k1_squared.unwrap_or(0.0),
            pixel_aspect: self.pixel_aspect,
        })
    }

    /// The same, and that of a pinhole where the camera has no curve.
    fn curve_or_pinhole(&self) -> FocalCurve {
        let pinhole = FocalCurve::NONE.with_pixel_aspect(self.pixel_aspect);
        self.curve().unwrap_or(pinhole)
    }

    /// The base, where position and rotation are known; the rotation is orthogonalised.
    pub fn base(&self) -> Option<CameraBase> {
        let (position_m, stated) = (self.position_m?, self.base_from_world?);
        // Projection and its derivatives suppose a rotation; a document may state one with few
        // digits.
        let exact = distance_from_rotation(&stated) <= EXACT_ROTATION;
        Some(CameraBase {
            position_m,
            base_from_world: if exact {
                stated
            } else {
                nearest_rotation(&stated)
            },
            principal_point: self.principal_point,
            distortion: self.curve_or_pinhole(),
            sigma: self.sigma.as_ref().map(BaseSigma::from).unwrap_or_default(),
        })
    }

    /// The base with which a frame is solved and drawn.
    ///
    /// A frame with its own [lens](Frame::lens) uses that lens and its principal point. Otherwise
    /// the camera's curve is used, or the k₁ of the frame's `ptz` if the camera has no curve.
    pub fn base_for(&self, frame: &Frame) -> Option<CameraBase> {
        Some(frame.base_from(&self.base_without_frame_lens(frame)?))
    }

    /// [`Self::base_for`] without the frame's own [lens](Frame::lens).
    pub fn base_without_frame_lens(&self, frame: &Frame) -> Option<CameraBase> {
        // A frame's k₁ is a record of what was used. It is an input only where the camera states no
        // curve, as the document's schema says.
        let mut base = self.base()?;
        if self.curve().is_none()
            && let Some(k1) = frame.ptz.as_ref().and_then(|ptz| ptz.k1)
        {
            base.distortion = FocalCurve::constant(k1).with_pixel_aspect(self.pixel_aspect);
        }
        Some(base)
    }

    /// The camera of a solved frame: as it was imported, where `ptz` says so, else on the base;
    /// none without a base or the frame's `ptz`.
    pub fn ptz_camera(&self, frame: &Frame) -> Option<PtzCamera> {
        let on_base = self.ptz_camera_on_base(frame)?;
        let imported = frame.ptz.as_ref()?.imported.as_ref();
        Some(imported.map_or(on_base, |imported| imported.camera_like(&on_base)))
    }

    /// The camera of a solved frame at its pan, tilt and focal length on this camera's base, where
    /// solving it again starts.
    pub fn ptz_camera_on_base(&self, frame: &Frame) -> Option<PtzCamera> {
        Some(PtzCamera::new(
            self.base_for(frame)?,
            frame.ptz.as_ref()?.ptz(),
        ))
    }

    /// Sets the base; unchanged values keep their digits, and unknown keys stay.
    pub fn set_base(&mut self, base: &CameraBase) {
        // Each part is compared with what the document gives, and written only if it differs: a
        // base that was read and is set again leaves the file's digits and keys as they are.
        let before = self.base();
        if before.is_none_or(|before| before.position_m != base.position_m) {
            self.position_m = Some(base.position_m);
        }
        if before.is_none_or(|before| before.base_from_world != base.base_from_world) {
            self.base_from_world = Some(base.base_from_world);
        }
        self.principal_point = base.principal_point;
        self.pixel_aspect = base.distortion.pixel_aspect;
        if self.curve_or_pinhole() != base.distortion {
            let distortion = self.distortion.get_or_insert_default();
            distortion.k2_per_k1_squared =
                Some(base.distortion.k2_per_k1_squared).filter(|share| *share != 0.0);
            let k1 = distortion.k1.get_or_insert_default();
            k1.at_focal_px = base.distortion.at_focal_px;
            k1.value = base.distortion.value;
            k1.per_1000_px = base.distortion.per_1000_px;
        }
        let sigma = self.sigma.as_ref().map(BaseSigma::from).unwrap_or_default();
        if sigma != base.sigma {
            let extra = self
                .sigma
                .take()
                .map(|sigma| sigma.extra)
                .unwrap_or_default();
            self.sigma = Some(CameraSigma {
                extra,
                ..CameraSigma::from(&base.sigma)
            });
        }
    }
}
