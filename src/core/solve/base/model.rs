//! Which parameters of a base are free in an adjustment: lens, crown, principal point.

use crate::geometry::ImagePoint;
use serde::Serialize;
use std::fmt;

/// How k₁ depends on the focal length.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize)]
#[serde(rename_all = "snake_case")]
#[non_exhaustive]
pub enum LensModel {
    /// No distortion.
    Pinhole,
    /// One k₁.
    K1,
    /// k₁ linear in the focal length, the slope with a prior.
    K1Focal,
    /// Like `K1Focal`, with k₂ = 2 k₁², so that the lens folds nowhere.
    K1FocalK2,
}

impl LensModel {
    /// Whether k₁ changes with the focal length.
    pub(super) const fn follows_focal(self) -> bool {
        matches!(self, Self::K1Focal | Self::K1FocalK2)
    }

    /// Whether every point before the camera has an image, however strong the distortion.
    pub(super) const fn never_folds(self) -> bool {
        matches!(self, Self::Pinhole | Self::K1FocalK2)
    }
}

/// The shape of the pitch.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
#[serde(rename_all = "snake_case")]
#[non_exhaustive]
pub enum CrownModel {
    /// A given height of the middle above the touchlines, m.
    Fixed(f64),
    /// The height is estimated, with a prior.
    Free,
}

impl CrownModel {
    /// The height of the crown, m; none where it is estimated.
    pub const fn fixed_height_m(self) -> Option<f64> {
        match self {
            Self::Fixed(crown_m) => Some(crown_m),
            Self::Free => None,
        }
    }
}

/// Which parameters are free beside position, base rotation and every frame's pan, tilt and focal
/// length.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct BaseModel {
    /// The lens.
    pub lens: LensModel,
    /// The pitch.
    pub crown: CrownModel,
    /// If set, the principal point is estimated as well, with a prior around this point.
    #[serde(rename = "principal_point_px")]
    pub principal_point: Option<ImagePoint>,
}

/// Parameters that the user prescribed and that therefore count as exact. Others that a model fixes
/// count as uncertain by their priors.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Prescribed {
    /// The lens.
    pub lens: bool,
    /// The crown of the pitch.
    pub crown: bool,
    /// The principal point.
    pub principal_point: bool,
}

impl fmt::Display for BaseModel {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let lens = match self.lens {
            LensModel::Pinhole => "pinhole",
            LensModel::K1 => "one k1",
            LensModel::K1Focal => "k1 linear in f",
            LensModel::K1FocalK2 => "k1, k2 by f",
        };
        let crown = if self.crown == CrownModel::Free {
            ", crowned pitch"
        } else {
            ""
        };
        let centre = if self.principal_point.is_some() {
            ", principal point"
        } else {
            ""
        };
        f.pad(&format!("{lens}{crown}{centre}"))
    }
}
