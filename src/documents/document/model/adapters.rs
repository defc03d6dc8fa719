//! Serde adapters between JSON and the types of the program: arrays to points, sizes, boxes and
//! matrices.
//!
//! Writing refuses NaN and infinity (JSON has neither, and a silent `null` would lose the value);
//! reading refuses impossible sizes, and both refuse impossible focal lengths.

#![allow(
    clippy::wildcard_imports,
    clippy::ref_option,
    clippy::trivially_copy_pass_by_ref,
    reason = "serde prescribes the signatures, and each adapter needs the same few names"
)]

use serde::de::Error as _;
use serde::ser::Error as _;
use serde::{Deserialize, Deserializer, Serialize, Serializer};
use std::collections::BTreeMap;
use touchline_core::camera::BaseCorrelation;
use touchline_core::geometry::rotation::{ROTATION_TOLERANCE, distance_from_rotation};
use touchline_core::geometry::{ImagePoint, ImageSize, Mat3, PixelBox, Vec2, Vec3};

fn refuse_infinite<'a, S: Serializer>(
    numbers: impl IntoIterator<Item = &'a f64>,
) -> Result<(), S::Error> {
    match numbers.into_iter().find(|x| !x.is_finite()) {
        Some(bad) => Err(S::Error::custom(format!(
            "{bad} cannot be written: JSON holds only finite numbers"
        ))),
        None => Ok(()),
    }
}

/// The name of a landmark or line.
pub(in crate::document) mod name {
    use super::*;

    pub fn serialize<S: Serializer>(
        name: &impl std::fmt::Display,
        serializer: S,
    ) -> Result<S::Ok, S::Error> {
        serializer.collect_str(name)
    }

    pub fn deserialize<'de, D: Deserializer<'de>, T: for<'a> From<&'a str>>(
        deserializer: D,
    ) -> Result<T, D::Error> {
        Ok(T::from(&String::deserialize(deserializer)?))
    }
}

/// A number, several or none.
pub(in crate::document) trait Numbers: Serialize {
    fn numbers(&self) -> impl Iterator<Item = &f64>;
}

impl Numbers for f64 {
    fn numbers(&self) -> impl Iterator<Item = &f64> {
        std::iter::once(self)
    }
}

impl<T: Numbers> Numbers for Option<T> {
    fn numbers(&self) -> impl Iterator<Item = &f64> {
        self.iter().flat_map(T::numbers)
    }
}

impl Numbers for ImagePoint {
    fn numbers(&self) -> impl Iterator<Item = &f64> {
        [&self.x, &self.y].into_iter()
    }
}

impl Numbers for Vec<f64> {
    fn numbers(&self) -> impl Iterator<Item = &f64> {
        self.iter()
    }
}

impl Numbers for [f64; 2] {
    fn numbers(&self) -> impl Iterator<Item = &f64> {
        self.iter()
    }
}

impl Numbers for BTreeMap<String, f64> {
    fn numbers(&self) -> impl Iterator<Item = &f64> {
        self.values()
    }
}

/// Writes numbers as they are, if they are finite.
pub(in crate::document) fn finite<S: Serializer>(
    value: &impl Numbers,
    serializer: S,
) -> Result<S::Ok, S::Error> {
    refuse_infinite::<S>(value.numbers())?;
    value.serialize(serializer)
}

/// Degrees, wrapped into (−180, 180] when they are read.
pub(in crate::document) mod degrees {
    use super::*;

    pub(in crate::document) use super::finite as serialize;

    pub fn deserialize<'de, D: Deserializer<'de>>(deserializer: D) -> Result<f64, D::Error> {
        let degrees = f64::deserialize(deserializer)?;
        // An angle that is in range keeps its last digit, which the arithmetic below could change.
        if degrees > -180.0 && degrees <= 180.0 {
            return Ok(degrees);
        }
        let turned = degrees.rem_euclid(360.0);
        Ok(if turned > 180.0 {
            turned - 360.0
        } else {
            turned
        })
    }
}

/// A length that must be positive, also when it is written: a file with another one could not be
/// read again, nor could the edits behind it in a journal.
pub(in crate::document) mod positive {
    use super::*;

    pub fn serialize<S: Serializer>(value: &f64, serializer: S) -> Result<S::Ok, S::Error> {
        let value = refuse_others(*value).map_err(S::Error::custom)?;
        finite(&value, serializer)
    }

    pub fn deserialize<'de, D: Deserializer<'de>>(deserializer: D) -> Result<f64, D::Error> {
        refuse_others(f64::deserialize(deserializer)?).map_err(D::Error::custom)
    }

    pub(super) fn refuse_others(value: f64) -> Result<f64, String> {
        // NaN passes here: of numbers that JSON lacks, `finite` says so.
        if value <= 0.0 {
            Err(format!("must be positive, not {value}"))
        } else {
            Ok(value)
        }
    }
}

/// The aspect of pixels: a number of [`PIXEL_ASPECTS`], 1 where it is left out.
pub(in crate::document) mod pixel_aspect {
    use super::*;
    use touchline_core::camera::PIXEL_ASPECTS;

    pub fn serialize<S: Serializer>(value: &f64, serializer: S) -> Result<S::Ok, S::Error> {
        let value = refuse_others(*value).map_err(S::Error::custom)?;
        super::finite(&value, serializer)
    }

    pub fn deserialize<'de, D: Deserializer<'de>>(deserializer: D) -> Result<f64, D::Error> {
        refuse_others(f64::deserialize(deserializer)?).map_err(D::Error::custom)
    }

    fn refuse_others(value: f64) -> Result<f64, String> {
        if PIXEL_ASPECTS.contains(&value) {
            Ok(value)
        } else {
            Err(format!("must be from 0.25 to 4, fy / fx, not {value}"))
        }
    }

    /// What is meant where it is left out.
    pub const fn square() -> f64 {
        1.0
    }

    #[expect(
        clippy::trivially_copy_pass_by_ref,
        reason = "serde passes fields by reference"
    )]
    pub fn is_square(value: &f64) -> bool {
        *value == 1.0
    }
}

/// A length that may be absent and must be positive.
pub(super) mod optional_positive {
    use super::*;

    pub(in crate::document) use super::finite as serialize;

    pub fn deserialize<'de, D: Deserializer<'de>>(
        deserializer: D,
    ) -> Result<Option<f64>, D::Error> {
        let value = Option::deserialize(deserializer)?;
        value
            .map(super::positive::refuse_others)
            .transpose()
            .map_err(D::Error::custom)
    }
}

/// `[width, height]`.
pub(in crate::document) mod image_size {
    use super::*;

    pub fn serialize<S: Serializer>(size: &ImageSize, serializer: S) -> Result<S::Ok, S::Error> {
        [size.width, size.height].serialize(serializer)
    }

    pub fn deserialize<'de, D: Deserializer<'de>>(deserializer: D) -> Result<ImageSize, D::Error> {
        let [width, height] = <[u32; 2]>::deserialize(deserializer)?;
        if [width, height]
            .iter()
            .all(|side| ImageSize::is_side_px(f64::from(*side)))
        {
            return Ok(ImageSize::new(width, height));
        }
        let most = ImageSize::MAX_SIDE_PX;
        Err(D::Error::custom(format!(
            "a picture of {width}x{height} px: each side must be 1 to {most}"
        )))
    }
}

/// `[x, y, width, height]`; whole pixels are written without a fraction.
pub(super) mod pixel_box {
    use super::*;

    /// The largest whole number that is written without a fraction.
    const WHOLE_LIMIT: f64 = 1e9;

    #[derive(Serialize)]
    #[serde(untagged)]
    pub(super) enum Side {
        Whole(i64),
        Fraction(f64),
    }

    fn side(value: f64) -> Side {
        // A negative zero stays a fraction: as a whole number it would lose its sign, and reading
        // would not give the same box again.
        if value.fract() == 0.0
            && value.abs() < WHOLE_LIMIT
            && !(value == 0.0 && value.is_sign_negative())
        {
            Side::Whole(value as i64)
        } else {
            Side::Fraction(value)
        }
    }

    /// A box of its four numbers.
    pub(super) fn from_sides([x, y, width, height]: [f64; 4]) -> PixelBox {
        PixelBox::new(x, y, width, height)
    }

    /// The four numbers of a box that are written.
    pub(super) fn sides<S: Serializer>(pixel_box: &PixelBox) -> Result<[Side; 4], S::Error> {
        let numbers = [pixel_box.x, pixel_box.y, pixel_box.width, pixel_box.height];
        refuse_infinite::<S>(&numbers)?;
        Ok(numbers.map(side))
    }

    pub fn serialize<S: Serializer>(
        pixel_box: &PixelBox,
        serializer: S,
    ) -> Result<S::Ok, S::Error> {
        sides::<S>(pixel_box)?.serialize(serializer)
    }

    pub fn deserialize<'de, D: Deserializer<'de>>(deserializer: D) -> Result<PixelBox, D::Error> {
        <[f64; 4]>::deserialize(deserializer).map(from_sides)
    }
}

/// `[[x, y, width, height], …]`.
pub(in crate::document) mod boxes {
    use super::*;

    pub fn serialize<S: Serializer>(boxes: &[PixelBox], serializer: S) -> Result<S::Ok, S::Error> {
        let sides: Vec<_> = boxes
            .iter()
            .map(super::pixel_box::sides::<S>)
            .collect::<Result<_, _>>()?;
        sides.serialize(serializer)
    }

    pub fn deserialize<'de, D: Deserializer<'de>>(
        deserializer: D,
    ) -> Result<Vec<PixelBox>, D::Error> {
        let boxes = Vec::<[f64; 4]>::deserialize(deserializer)?;
        Ok(boxes
            .into_iter()
            .map(super::pixel_box::from_sides)
            .collect())
    }
}

/// `[x, y, z]`.
pub(super) mod vector {
    use super::*;

    pub fn serialize<S: Serializer>(vector: &Vec3, serializer: S) -> Result<S::Ok, S::Error> {
        refuse_infinite::<S>(vector.as_slice())?;
        [vector.x, vector.y, vector.z].serialize(serializer)
    }

    pub fn deserialize<'de, D: Deserializer<'de>>(deserializer: D) -> Result<Vec3, D::Error> {
        <[f64; 3]>::deserialize(deserializer).map(Vec3::from)
    }
}

/// `[x, y, z]`, or absent.
pub(super) mod optional_vector {
    use super::*;

    pub fn serialize<S: Serializer>(
        vector: &Option<Vec3>,
        serializer: S,
    ) -> Result<S::Ok, S::Error> {
        match vector {
            Some(vector) => super::vector::serialize(vector, serializer),
            None => serializer.serialize_none(),
        }
    }

    pub fn deserialize<'de, D: Deserializer<'de>>(
        deserializer: D,
    ) -> Result<Option<Vec3>, D::Error> {
        Ok(Option::<[f64; 3]>::deserialize(deserializer)?.map(Vec3::from))
    }
}

/// `[x, y]`, or absent.
pub(super) mod optional_pair {
    use super::*;

    pub fn serialize<S: Serializer>(pair: &Option<Vec2>, serializer: S) -> Result<S::Ok, S::Error> {
        pair.iter()
            .try_for_each(|pair| refuse_infinite::<S>(pair.as_slice()))?;
        pair.map(|pair| [pair.x, pair.y]).serialize(serializer)
    }

    pub fn deserialize<'de, D: Deserializer<'de>>(
        deserializer: D,
    ) -> Result<Option<Vec2>, D::Error> {
        Ok(Option::<[f64; 2]>::deserialize(deserializer)?.map(Vec2::from))
    }
}

fn rows(matrix: &Mat3) -> [[f64; 3]; 3] {
    std::array::from_fn(|row| std::array::from_fn(|column| matrix[(row, column)]))
}

fn matrix(rows: [[f64; 3]; 3]) -> Mat3 {
    Mat3::from_fn(|row, column| rows[row][column])
}

/// A 3×3 matrix by rows, or absent.
pub(super) mod optional_matrix {
    use super::*;

    pub fn serialize<S: Serializer>(
        value: &Option<Mat3>,
        serializer: S,
    ) -> Result<S::Ok, S::Error> {
        if let Some(matrix) = value {
            refuse_infinite::<S>(matrix.as_slice())?;
        }
        value.as_ref().map(rows).serialize(serializer)
    }

    pub fn deserialize<'de, D: Deserializer<'de>>(
        deserializer: D,
    ) -> Result<Option<Mat3>, D::Error> {
        Ok(Option::<[[f64; 3]; 3]>::deserialize(deserializer)?.map(matrix))
    }
}

/// A correlation matrix of a base's errors by rows, or absent.
pub(super) mod optional_correlation {
    use super::*;

    pub fn serialize<S: Serializer>(
        value: &Option<BaseCorrelation>,
        serializer: S,
    ) -> Result<S::Ok, S::Error> {
        let rows = value.as_ref().map(BaseCorrelation::rows);
        for row in rows.iter().flatten() {
            refuse_infinite::<S>(row)?;
        }
        rows.serialize(serializer)
    }

    pub fn deserialize<'de, D: Deserializer<'de>>(
        deserializer: D,
    ) -> Result<Option<BaseCorrelation>, D::Error> {
        let Some(rows) = Option::<Vec<Vec<f64>>>::deserialize(deserializer)? else {
            return Ok(None);
        };
        // A covariance must have no negative eigenvalue, or the variance that follows from it for
        // some pixel would be negative. `from_rows` checks this.
        let wrong = "no correlation matrix: 5 × 5 of position x, y, z and rotation about x, y, or 10 × 10 with k1, its slope, crown and \
                     principal point x, y behind them; symmetric, ones on its diagonal, no negative eigenvalue; leave it out if it \
                     is not known";
        BaseCorrelation::from_rows(&rows)
            .map(Some)
            .ok_or_else(|| D::Error::custom(wrong))
    }
}

/// A rotation by rows, or absent. One that is slightly off (rounded digits) is kept as it is; one
/// that is further off than [`ROTATION_TOLERANCE`], or a reflection, is refused.
pub(super) mod optional_rotation {
    use super::*;

    pub use super::optional_matrix::serialize;

    pub fn deserialize<'de, D: Deserializer<'de>>(
        deserializer: D,
    ) -> Result<Option<Mat3>, D::Error> {
        let matrix = super::optional_matrix::deserialize(deserializer)?;
        let Some(rotation) = matrix else {
            return Ok(None);
        };
        // `distance_from_rotation` is infinite for a reflection, which says less than this message.
        if rotation.determinant() < 0.0 {
            return Err(D::Error::custom(
                "the matrix is a reflection, not a rotation (its determinant is negative)",
            ));
        }
        let distance = distance_from_rotation(&rotation);
        if distance > ROTATION_TOLERANCE {
            return Err(D::Error::custom(format!(
                "the matrix is not a rotation: its rows are off by {distance:.2e}, allowed is {ROTATION_TOLERANCE:.0e}"
            )));
        }
        Ok(matrix)
    }
}
