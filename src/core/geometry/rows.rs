//! Serialising a matrix row by row.

use super::Mat3;
use serde::{Serialize, Serializer};

/// For `#[serde(serialize_with = "rows")]`; nalgebra itself writes nine numbers, column by column.
///
/// # Errors
/// Those of the serializer.
pub fn rows<S: Serializer>(matrix: &Mat3, serializer: S) -> Result<S::Ok, S::Error> {
    let rows: [[f64; 3]; 3] = matrix.transpose().into();
    rows.serialize(serializer)
}
