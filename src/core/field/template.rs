//! The template of a sport's field, with free parameters.

use super::parts::{LandmarkPart, LinePart};
use super::{Expression, Symmetry};
use std::collections::BTreeMap;

/// A crown higher than this is a mistake: pitches are 0.05 to 0.25 m higher in the middle.
pub const MAX_CROWN_M: f64 = 2.0;

/// A sport's field: named landmarks and lines whose places are expressions over parameters.
#[derive(Clone, Debug, PartialEq)]
pub struct Template {
    /// What documents call it: "soccer".
    pub name: String,
    /// What people read: "Soccer (IFAB)".
    pub title: String,
    /// What to know before trusting it.
    pub notes: Vec<String>,
    /// What differs between venues, in the template's order.
    pub params: Vec<Param>,
    /// What the rules fix, in the template's order.
    pub dimensions: Vec<Dimension>,
    /// The symmetries that the template promises; checked when it is read.
    pub symmetry: Vec<Symmetry>,
    pub(super) extent_m: [Expression; 2],
    pub(super) landmarks: Vec<LandmarkPart>,
    pub(super) lines: Vec<LinePart>,
    pub(super) place: String,
}

/// Something that differs between venues, such as `length_m`.
#[derive(Clone, Debug, PartialEq)]
pub struct Param {
    /// Its name in documents; the unit is its ending.
    pub name: String,
    /// What people read: "Length".
    pub label: String,
    /// Always "m".
    pub unit: String,
    /// Where nothing is said.
    pub default: f64,
    /// The smallest that the rules allow.
    pub min: f64,
    /// The largest.
    pub max: f64,
    /// Where the range comes from.
    pub source: String,
}

/// Something that the rules fix, such as `penalty_area_depth_m`; it may follow from parameters.
#[derive(Clone, Debug, PartialEq)]
pub struct Dimension {
    /// Its name in expressions.
    pub name: String,
    /// Its value, over parameters and the dimensions before it.
    pub value: Expression,
    /// Where it comes from.
    pub source: String,
}

impl Template {
    /// The parameters where nothing is said.
    #[must_use]
    pub fn default_params(&self) -> BTreeMap<String, f64> {
        self.params
            .iter()
            .map(|param| (param.name.clone(), param.default))
            .collect()
    }
}
