//! Angles and arcs of them, image points and sizes, mask boxes, rotations and their derivatives.
//!
//! Everything here is `f64`. Angles are radians inside and degrees in files ([`Angle`]). Frames,
//! signs, units and the corner convention of pixels: [`crate::conventions`].

mod angle;
mod angle_range;
mod averages;
mod directions;
mod homography;
mod image;
pub mod rotation;
mod subsample;
mod text;

pub use angle::Angle;
pub use angle_range::AngleRange;
pub use averages::median;
pub use directions::Directions;
pub(crate) use homography::{HomographyError, only_null_vector};
pub use image::{ImagePoint, ImageSize, PixelBox};
pub(crate) use subsample::{farthest_pairs, keep_distinct};
// For the crates above alone: no promise to other programs.
#[doc(hidden)]
pub use {
    averages::{mean, median_high, quantile},
    homography::homography,
    image::{covariance_ellipse, distance_from_segment},
    subsample::{stride_of_subsample, subsample},
    text::{decimal, hex, is_formula, pluralise, text_cell, thousands, xml_text},
};

use serde::{Serialize, Serializer};

/// A column of two numbers; the name of the value gives frame and unit.
pub type Vec2 = nalgebra::Vector2<f64>;
/// A column of three numbers; the name of the value gives frame and unit.
pub type Vec3 = nalgebra::Vector3<f64>;
/// A 3×3 matrix, such as `base_from_world`.
pub type Mat3 = nalgebra::Matrix3<f64>;

/// Serialises a matrix row by row, for `#[serde(serialize_with = "rows")]`; nalgebra itself writes
/// nine numbers, column by column.
///
/// # Errors
/// Those of the serializer.
#[doc(hidden)]
pub fn rows<S: Serializer>(matrix: &Mat3, serializer: S) -> Result<S::Ok, S::Error> {
    let rows: [[f64; 3]; 3] = matrix.transpose().into();
    rows.serialize(serializer)
}
