//! What is known of a broadcast camera before any click: its levelled head, its usual lens, its
//! crown and principal point, and where it usually looks.
//!
//! The priors of the lean refer to the direction from the camera to the field, those of a constant
//! k₁ to the frames' mean focal length. So they depend on the view of the frames ([`UsualView`]).

use super::shared_prior::{Expected, SharedPrior};
use super::{BaseModel, CrownModel, LensModel};
use crate::camera::{CameraBase, FocalCurve, Ptz, StatedLens};
use crate::geometry::{Angle, ImageSize, Vec2, Vec3};

/// The focal length at which k₁ itself is a parameter, px of a frame 1920 px wide.
pub(super) const LENS_FOCAL_PX: f64 = 2000.0;

/// Views whose directions (radians) and logarithms of focal length differ by less have nearly the
/// same priors: k₁ by a quarter of its σ at 2000 px, the lean by a twentieth.
const NEAR_VIEW: f64 = 0.05;

/// Priors of a broadcast camera. They are weak, and matter only where the clicks are few.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct BasePriors {
    /// 1-σ of the base's pitch: camera heads are levelled, but less well along the view than across
    /// it.
    pub pitch: Angle,
    /// 1-σ of the base's roll.
    pub roll: Angle,
    /// k₁ at a focal length of 2000 px of a frame 1920 px wide, and its 1-σ.
    pub k1: (f64, f64),
    /// The change of k₁ per 1000 px of such a frame, and its 1-σ.
    pub k1_slope: (f64, f64),
    /// The crown, m, and its 1-σ.
    pub crown_m: (f64, f64),
    /// 1-σ of the principal point, px of a frame 1920 px wide.
    pub principal_point_px: f64,
    /// The position (`world`) and its 1-σ along each axis, m, where something is known about it
    /// beforehand.
    pub position_m: Option<(Vec3, Vec3)>,
}

impl Default for BasePriors {
    /// Measured on nine matches: rolls of 0.1 to 0.4°, pitches of up to 1.6°, crowns of 0.05 to
    /// 0.25 m, k₁ ≈ −0.02 + 0.21 (f − 2000) / 1000. Twenty lenses of a World Cup, calibrated frame
    /// by frame by its provider, have principal points up to 69 px off the middle.
    fn default() -> Self {
        Self {
            pitch: Angle::from_degrees(1.0),
            roll: Angle::from_degrees(0.4),
            k1: (-0.02, 0.04),
            k1_slope: (0.21, 0.1),
            crown_m: (0.13, 0.07),
            principal_point_px: 40.0,
            position_m: None,
        }
    }
}

impl BasePriors {
    /// The same with a lens as it is stated for pictures of a size in place of the usual one.
    #[must_use]
    pub fn with_lens(self, lens: &StatedLens, image_size: ImageSize) -> Self {
        let Some(radial) = lens.radial else {
            return self;
        };
        let per_1920 = image_size.scale_from_1920();
        Self {
            k1: radial.k1_at(LENS_FOCAL_PX * per_1920),
            k1_slope: (
                radial.curve.per_1000_px * per_1920,
                radial.per_1000_px_sigma * per_1920,
            ),
            ..self
        }
    }

    /// The usual lens of broadcast cameras for pictures of a size: k₁ follows the focal length.
    pub fn usual_lens(&self, image_size: ImageSize) -> FocalCurve {
        let per_1920 = image_size.scale_from_1920();
        // k₁ is of normalised coordinates and has no unit of px; the focal lengths scale with the
        // width, and the slope per px of focal length with its inverse.
        FocalCurve {
            at_focal_px: LENS_FOCAL_PX * per_1920,
            value: self.k1.0,
            per_1000_px: self.k1_slope.0 / per_1920,
            k2_per_k1_squared: FocalCurve::WITHOUT_FOLD,
            ..FocalCurve::NONE
        }
    }

    /// The priors of the parameters that a model leaves free.
    ///
    /// Pitch and roll refer to the direction from the camera to the field, along and across which
    /// heads are levelled, not to the field's axes.
    pub(in crate::solve) fn for_model(
        &self,
        model: &BaseModel,
        image_size: ImageSize,
        view: &UsualView,
    ) -> Vec<SharedPrior> {
        let per_1920 = image_size.scale_from_1920();
        let [pitch, roll] = view.lean_sigmas(self.pitch, self.roll);
        let mut found = vec![
            SharedPrior::new(Expected::Pitch(view.along), pitch),
            SharedPrior::new(Expected::Roll(view.along), roll),
        ];
        if model.lens != LensModel::Pinhole {
            // A constant k₁ is that of the frames' mean focal length: evaluate the usual curve of
            // k₁ there, and add the uncertainty of its slope.
            let own_px = view.focal_px.filter(|_| !model.lens.follows_focal());
            // The distance of that focal length from the reference one, px of a frame 1920 px wide.
            let beyond_px = own_px.map_or(0.0, |own_px| own_px / per_1920 - LENS_FOCAL_PX);
            let expected = self.k1.0 + self.k1_slope.0 * beyond_px / 1000.0;
            found.push(SharedPrior::new(
                Expected::K1(expected),
                self.k1.1.hypot(self.k1_slope.1 * beyond_px / 1000.0),
            ));
        }
        if model.lens.follows_focal() {
            found.push(SharedPrior::new(
                Expected::Slope(self.k1_slope.0 / per_1920),
                self.k1_slope.1 / per_1920,
            ));
        }
        if let Some((position_m, sigma_m)) = self.position_m {
            found.extend(
                (0..3).map(|axis| {
                    SharedPrior::new(Expected::Position(position_m, axis), sigma_m[axis])
                }),
            );
        }
        if model.crown == CrownModel::Free {
            found.push(SharedPrior::new(
                Expected::Crown(self.crown_m.0),
                self.crown_m.1,
            ));
        }
        if let Some(nominal) = model.principal_point {
            let sigma_px = self.principal_point_px * per_1920;
            found.extend(
                (0..2).map(|axis| {
                    SharedPrior::new(Expected::PrincipalPoint(nominal, axis), sigma_px)
                }),
            );
        }
        found
    }
}

/// Where a camera usually looks: the direction and focal length that its priors refer to.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(in crate::solve) struct UsualView {
    /// From the camera to the middle of the field, seen from above: unit, `world` x and y.
    /// Operators level the head along and across this direction, wherever a single frame looks.
    pub along: Vec2,
    /// 1-σ of that direction.
    pub sigma: Angle,
    /// The geometric mean of the frames' focal lengths, px; none where the focal length of the
    /// priors is used.
    pub focal_px: Option<f64>,
}

impl UsualView {
    /// The usual view of the frames of a base. One frame with four landmarks gives the direction
    /// from its camera to the field to a few degrees; the base's own sigma says how well.
    pub fn from_frames(base: &CameraBase, ptz: &[Ptz]) -> Self {
        // The direction's error is that of the position across it, seen from the field's middle.
        let along = direction_to_field(base.position_m);
        let across = Vec3::new(-along.y, along.x, 0.0);
        let variance = across.dot(&(base.sigma.position_covariance() * across));
        let sigma_rad = if variance.is_finite() {
            variance.max(0.0).sqrt() / base.position_m.xy().norm().max(1.0)
        } else {
            f64::INFINITY
        };
        let logs: f64 = ptz.iter().map(|ptz| ptz.focal_px.ln()).sum();
        Self {
            along,
            sigma: Angle::from_radians(sigma_rad),
            focal_px: (!ptz.is_empty()).then(|| (logs / ptz.len() as f64).exp()),
        }
    }

    /// Whether the priors of another view are nearly those of this one.
    pub(super) fn is_near(&self, other: &Self) -> bool {
        let turned = (1.0 - self.along.dot(&other.along)).max(0.0) * 2.0;
        let zoomed = match (self.focal_px, other.focal_px) {
            (Some(own), Some(other)) => (own / other).ln().abs(),
            (own, other) => f64::from(own != other),
        };
        turned.sqrt() < NEAR_VIEW && zoomed < NEAR_VIEW
    }

    /// 1-σ of the lean along and across the stated direction, where heads lean by `pitch` and
    /// `roll` along and across the true one. A direction that is off by δ mixes the two: the
    /// variance of each has the share sin² δ of the other's, whose mean over a Gaussian δ is
    /// (1 − exp(−2σ²)) / 2.
    fn lean_sigmas(&self, pitch: Angle, roll: Angle) -> [f64; 2] {
        let mixed = 0.5 * (1.0 - (-2.0 * self.sigma.radians().powi(2)).exp());
        let [pitch, roll] = [pitch, roll].map(|sigma| sigma.radians().powi(2));
        [
            (pitch + mixed * (roll - pitch)).sqrt(),
            (roll + mixed * (pitch - roll)).sqrt(),
        ]
    }
}

/// The direction from a camera to the middle of the field, seen from above (`world` x and y, unit);
/// that of the main stand for a camera above the middle.
pub(in crate::solve) fn direction_to_field(position_m: Vec3) -> Vec2 {
    (-position_m.xy())
        .try_normalize(1e-9)
        .unwrap_or(Vec2::new(0.0, 1.0))
}
