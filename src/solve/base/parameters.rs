//! The parameters that all frames of a camera share, as a vector.

use super::{BaseModel, CrownModel, LensModel};
use crate::camera::{CameraBase, FocalCurve};
use crate::geometry::rotation::{from_rotation_vector, nearest_rotation};
use crate::geometry::{Vec2, Vec3};
use nalgebra::{SMatrix, SVector};

/// How many shared parameters there can be.
pub(super) const SHARED: usize = 10;

/// Where each stands, after the position (m) at 0: rotation about world x and y (rad), k₁, its slope per 1000 px, crown (m), principal point
/// (px).
pub(super) const ROTATION: usize = 3;
pub(super) const K1: usize = 5;
pub(super) const SLOPE: usize = 6;
pub(super) const CROWN: usize = 7;
pub(super) const PRINCIPAL_POINT: usize = 8;

pub(super) type SharedVector = SVector<f64, SHARED>;
pub(super) type SharedMatrix = SMatrix<f64, SHARED, SHARED>;

/// What all frames of a camera share.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Shared {
    pub base: CameraBase,
    pub crown_m: f64,
    /// Extent of the field along y, m; the crown's scale.
    pub width_m: f64,
}

impl Shared {
    /// The parameters after a step.
    pub fn stepped(&self, step: &SharedVector) -> Self {
        let position_m = self.base.position_m + Vec3::new(step[0], step[1], step[2]);
        let turn = from_rotation_vector(Vec3::new(step[ROTATION], step[ROTATION + 1], 0.0));
        let curve = self.base.distortion;
        let distortion =
            FocalCurve { value: curve.value + step[K1], per_1000_px: curve.per_1000_px + step[SLOPE], ..curve };
        let principal_point =
            self.base.principal_point.moved(Vec2::new(step[PRINCIPAL_POINT], step[PRINCIPAL_POINT + 1]));
        let base_from_world = nearest_rotation(&(self.base.base_from_world * turn));
        let base = CameraBase { position_m, base_from_world, principal_point, distortion, ..self.base };
        Self { base, crown_m: self.crown_m + step[CROWN], ..*self }
    }
}

/// Which parameters a model leaves free.
pub(super) fn free_parameters(model: &BaseModel) -> [bool; SHARED] {
    let mut free = [false; SHARED];
    free[..K1].fill(true);
    free[K1] = model.lens != LensModel::Pinhole;
    free[SLOPE] = model.lens == LensModel::K1Focal;
    free[CROWN] = model.crown == CrownModel::Free;
    free[PRINCIPAL_POINT..].fill(model.principal_point.is_some());
    free
}
