//! What tests of several files begin with.

use crate::camera::{CameraBase, FocalCurve};
use crate::geometry::ImagePoint;
use crate::testing::turned_base;

/// A base beside the middle, with a roll, a lens that bends more the longer it is, and pixels that
/// are not square.
pub fn base() -> CameraBase {
    CameraBase {
        distortion: FocalCurve {
            at_focal_px: 2000.0,
            value: -0.06,
            per_1000_px: 0.21,
            k2_per_k1_squared: 1.5,
            pixel_aspect: 0.9,
        },
        ..turned_base(
            [3.0, -62.0, 17.0],
            [0.0, 0.0, 0.7],
            ImagePoint::new(955.0, 543.0),
        )
    }
}
