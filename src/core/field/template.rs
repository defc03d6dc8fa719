//! The template of a sport's field, with free parameters.

use super::parts::{LandmarkPart, LinePart};
use super::{Expression, Symmetry};
use std::collections::BTreeMap;

/// The maximum height of a crown, m; pitches have 0.05 to 0.25 m.
pub const MAX_CROWN_M: f64 = 2.0;
/// A yard, m.
pub const YARD_M: f64 = 0.9144;

/// A sport's field: named landmarks and lines whose coordinates are expressions over parameters.
#[derive(Clone, Debug, PartialEq)]
pub struct Template {
    /// Its name in documents: "soccer".
    pub name: String,
    /// Its title for the user: "Soccer (IFAB)".
    pub title: String,
    /// Notes for the user about its reliability.
    pub notes: Vec<String>,
    /// The parameters, which differ between venues, in the template's order.
    pub params: Vec<Param>,
    /// The dimensions, which the rules fix, in the template's order.
    pub dimensions: Vec<Dimension>,
    /// The symmetries that the template states; they are checked when it is read.
    pub symmetry: Vec<Symmetry>,
    pub(super) extent_m: [Expression; 2],
    pub(super) landmarks: Vec<LandmarkPart>,
    pub(super) lines: Vec<LinePart>,
    pub(super) place: String,
}

/// A quantity that differs between venues, such as `length_m`.
#[derive(Clone, Debug, PartialEq)]
pub struct Param {
    /// Its name in documents; the unit is its ending.
    pub name: String,
    /// Its label for the user: "Length".
    pub label: String,
    /// Always "m".
    pub unit: String,
    /// Its default value.
    pub default: f64,
    /// The smallest that the rules allow.
    pub min: f64,
    /// The largest.
    pub max: f64,
    /// Whether fields differ in it without a word in the document. The courts of a league do not,
    /// although a school may state another value.
    pub varies: bool,
    /// The source of the range.
    pub source: String,
}

impl Param {
    /// Whether a field may have another value than the default where none is stated.
    pub fn is_open(&self) -> bool {
        self.varies && self.min < self.max
    }
}

/// A quantity that the rules fix, such as `penalty_area_depth_m`; it may depend on parameters.
#[derive(Clone, Debug, PartialEq)]
pub struct Dimension {
    /// Its name in expressions.
    pub name: String,
    /// Its value, over parameters and the dimensions before it.
    pub value: Expression,
    /// The source of the value.
    pub source: String,
}

impl Template {
    /// The default values of all parameters.
    pub fn default_params(&self) -> BTreeMap<String, f64> {
        self.params
            .iter()
            .map(|param| (param.name.clone(), param.default))
            .collect()
    }
}
