//! The parameters that all frames of a camera share, as a vector.

use super::{BaseModel, CrownModel, LensModel};
use crate::camera::{CameraBase, FocalCurve};
use crate::field::Crown;
use crate::geometry::rotation::{from_rotation_vector, nearest_rotation};
use crate::geometry::{Vec2, Vec3};
use nalgebra::{SMatrix, SVector};

/// The index of each parameter, after the position (m) at 0: rotation about world x and y (rad),
/// k₁, its slope per 1000 px, height of the crown (m), principal point (px), and the increase of
/// the field's lengths over the assumed ones (m).
pub(super) const ROTATION: usize = 3;
pub(super) const K1: usize = 5;
pub(super) const SLOPE: usize = 6;
pub(super) const CROWN: usize = 7;
pub(super) const PRINCIPAL_POINT: usize = 8;
pub(in crate::solve) const SIZE: usize = 10;

/// The maximum number of fitted lengths of the field.
pub(super) const SIZES: usize = 2;

/// The number of shared parameters on a field of known size, and on one whose size is fitted.
pub(in crate::solve) const OF_BASE: usize = SIZE;
pub(super) const OF_BASE_AND_SIZE: usize = SIZE + SIZES;

/// The parameters that all frames of a camera share.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(in crate::solve) struct Shared {
    pub base: CameraBase,
    pub crown: Crown,
    /// The differences of the field's lengths from those of the clicks' field, m.
    pub larger_m: [f64; SIZES],
    /// The derivative of the field's width by each of these lengths, m/m.
    pub width_by_size: [f64; SIZES],
}

impl Shared {
    /// A base on the field of the clicks, of unchanged size.
    pub const fn new(base: &CameraBase, crown: Crown) -> Self {
        Self {
            base: *base,
            crown,
            larger_m: [0.0; SIZES],
            width_by_size: [0.0; SIZES],
        }
    }

    /// The parameters after a step. The rotation is multiplied from the right, in `world`, and made
    /// orthonormal again, because rounding accumulates over steps.
    pub fn apply_step<const SHARED: usize>(&self, step: &SVector<f64, SHARED>) -> Self {
        let position_m = self.base.position_m + Vec3::new(step[0], step[1], step[2]);
        // A rotation about world z is left out: the pans of all frames compensate for it.
        let turn = from_rotation_vector(Vec3::new(step[ROTATION], step[ROTATION + 1], 0.0));
        let curve = self.base.distortion;
        let distortion = FocalCurve {
            value: curve.value + step[K1],
            per_1000_px: curve.per_1000_px + step[SLOPE],
            ..curve
        };
        let principal_point = self
            .base
            .principal_point
            .translate(Vec2::new(step[PRINCIPAL_POINT], step[PRINCIPAL_POINT + 1]));
        let base_from_world = nearest_rotation(&(self.base.base_from_world * turn));
        let base = CameraBase {
            position_m,
            base_from_world,
            principal_point,
            distortion,
            ..self.base
        };
        let mut stepped = Self { base, ..*self };
        stepped.crown.height_m += step[CROWN];
        // The field's width, on which the shape of the crown depends, grows with its lengths.
        for (size, by) in step.iter().skip(SIZE).enumerate() {
            stepped.larger_m[size] += by;
            stepped.crown.width_m += self.width_by_size[size] * by;
        }
        stepped
    }
}

/// Clears the rows and columns of fixed parameters in a covariance: they are exact and have no
/// correlations.
pub(in crate::solve) fn clear_fixed<const SHARED: usize>(
    covariance: &mut SMatrix<f64, SHARED, SHARED>,
    free: &[bool; SHARED],
) {
    for fixed in (0..SHARED).filter(|&parameter| !free[parameter]) {
        covariance.row_mut(fixed).fill(0.0);
        covariance.column_mut(fixed).fill(0.0);
    }
}

/// Which parameters a model leaves free; the field's size is not among them.
pub(in crate::solve) fn free_parameters<const SHARED: usize>(model: &BaseModel) -> [bool; SHARED] {
    // Position and rotation, which come before the lens, are always free.
    let mut free = [false; SHARED];
    free[..K1].fill(true);
    free[K1] = model.lens != LensModel::Pinhole;
    free[SLOPE] = model.lens.follows_focal();
    free[CROWN] = model.crown == CrownModel::Free;
    free[PRINCIPAL_POINT..SIZE].fill(model.principal_point.is_some());
    free
}
