//! The lens of a camera as it is stated before anything of the camera is found: the prior of
//! every search and of every start.

use super::{BaseSigma, FocalCurve, Radial};
use crate::geometry::{ImagePoint, ImageSize};

/// Principal point and distortion as a person or a file states them. What is not stated is that of
/// usual cameras.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct StatedLens {
    /// The principal point, px; none: near the middle of the picture.
    pub principal_point: Option<ImagePoint>,
    /// The distortion; none: that of usual cameras.
    pub radial: Option<StatedRadial>,
    /// The aspect of the pixels, fy / fx; none: square.
    pub pixel_aspect: Option<f64>,
}

/// A stated distortion with its 1-σ.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct StatedRadial {
    /// k₁ by focal length, px of the frame.
    pub curve: FocalCurve,
    /// 1-σ of k₁ where the curve has its value.
    pub k1_sigma: f64,
    /// 1-σ of its change per 1000 px.
    pub per_1000_px_sigma: f64,
}

/// The least 1-σ of a stated k₁ and of its change per 1000 px: lenses are stated with two or
/// three digits. Together they move the corner of a 1080p broadcast by less than a pixel.
const LEAST_K1_SIGMA: f64 = 0.005;
const LEAST_SLOPE_SIGMA: f64 = 0.002;

impl StatedLens {
    /// A principal point without a distortion.
    pub const fn from_principal_point(principal_point: ImagePoint) -> Self {
        Self {
            principal_point: Some(principal_point),
            radial: None,
            pixel_aspect: None,
        }
    }

    /// The principal point with which a search in pictures of a size begins, px.
    pub fn principal_point_in(&self, image_size: ImageSize) -> ImagePoint {
        self.principal_point.unwrap_or(image_size.centre())
    }

    /// A lens without distortion in front of these pixels, with which a search begins.
    pub fn without_distortion(&self) -> FocalCurve {
        FocalCurve::NONE.with_pixel_aspect(self.pixel_aspect.unwrap_or(1.0))
    }

    /// The same at one focal length, as at any.
    pub fn pixels(&self) -> Radial {
        self.without_distortion().radial_at(0.0)
    }
}

impl StatedRadial {
    /// A distortion with the 1-σ that is stated of it.
    pub fn new(curve: FocalCurve, sigma: &BaseSigma) -> Self {
        Self {
            curve,
            k1_sigma: sigma.k1.max(LEAST_K1_SIGMA),
            per_1000_px_sigma: sigma.k1_per_1000_px.max(LEAST_SLOPE_SIGMA),
        }
    }

    /// k₁ at a focal length, px, and its 1-σ.
    pub fn k1_at(&self, focal_px: f64) -> (f64, f64) {
        let beyond = (focal_px - self.curve.at_focal_px) / 1000.0;
        let sigma = self.k1_sigma.hypot(self.per_1000_px_sigma * beyond);
        (self.curve.at(focal_px), sigma)
    }
}
