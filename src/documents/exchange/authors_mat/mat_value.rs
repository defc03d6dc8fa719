//! The value of a MATLAB variable.

use std::sync::Arc;

/// Fields of a structure or variables of a file: name and value, in order.
pub type NamedValues = Vec<(Arc<str>, MatValue)>;

/// A MATLAB variable, or an entry of one. Array sizes are not kept, because only rows of numbers
/// are needed.
#[derive(Clone, Debug, PartialEq)]
pub enum MatValue {
    /// Numbers in column order; imaginary parts are dropped.
    Numbers(Vec<f64>),
    /// Characters: the first row.
    Words(String),
    /// A cell array.
    Cells(Vec<MatValue>),
    /// An array of structures: their fields by name, in order.
    Structures(Vec<NamedValues>),
    /// Something else: objects, functions, sparse matrices.
    Other,
}

impl MatValue {
    /// The numbers; none for anything else.
    pub fn numbers(&self) -> Option<&[f64]> {
        match self {
            Self::Numbers(numbers) => Some(numbers),
            _ => None,
        }
    }

    /// The words, also where they lie in a cell of their own; none for anything else.
    pub fn words(&self) -> Option<&str> {
        match self {
            Self::Words(words) => Some(words),
            Self::Cells(cells) => match cells.as_slice() {
                [one] => one.words(),
                _ => None,
            },
            _ => None,
        }
    }

    /// The structures; none for anything else.
    pub fn structures(&self) -> Option<&[NamedValues]> {
        match self {
            Self::Structures(structures) => Some(structures),
            _ => None,
        }
    }
}

/// A field or variable by its name.
pub fn find_by_name<'a>(fields: &'a [(Arc<str>, MatValue)], name: &str) -> Option<&'a MatValue> {
    fields
        .iter()
        .find(|(known, _)| **known == *name)
        .map(|(_, value)| value)
}
