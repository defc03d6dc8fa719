//! A finding about wrong names: the mistake, the evidence and the new names.

mod describe;

use crate::camera::Ptz;
use crate::field::{FieldElement, FieldModel, LandmarkId, LineId, Symmetry};
use serde::{Serialize, Serializer};

/// The kind of mistake.
#[derive(Clone, Debug, PartialEq, Eq, Serialize)]
#[serde(rename_all = "snake_case")]
pub enum IdentityKind {
    /// Two names are exchanged.
    Swapped,
    /// All names are of the mirrored side.
    Mirrored(Symmetry),
    /// One or more clicks are of another landmark or line.
    WrongName,
    /// One part of the field was taken for another that has points of the same names.
    OtherPart {
        /// The part as named, in words: "penalty area".
        named: String,
        /// The part that fits.
        fits: String,
    },
}

/// The evidence for the other names.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize)]
#[serde(rename_all = "snake_case")]
pub enum Evidence {
    /// The clicks contradict each other as named.
    Clicks,
    /// Both fit, but as named the camera is outside its usual range or motion.
    MotionPrior,
    /// None: both fit, and the picture alone cannot decide.
    None,
}

/// A new name for a click.
#[derive(Clone, Debug, PartialEq, Eq, Serialize)]
pub struct Rename {
    /// Which click, from 0.
    pub click: usize,
    /// What it shows.
    pub name: Name,
    /// What a person reads.
    pub label: String,
}

/// The name of a landmark or line.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum Name {
    /// A landmark.
    Landmark(LandmarkId),
    /// A line.
    Line(LineId),
}

impl Serialize for Name {
    fn serialize<S: Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        serializer.serialize_str(self.as_str())
    }
}

impl Name {
    /// The name of a field's landmark or line; none if the field has no such element.
    pub fn from_element(element: FieldElement, field: &FieldModel) -> Option<Self> {
        match element {
            FieldElement::Landmark(index) => field
                .landmarks
                .get(index)
                .map(|known| Self::Landmark(known.id.clone())),
            FieldElement::Line(index) | FieldElement::Paint(index) => field
                .lines
                .get(index)
                .map(|known| Self::Line(known.id.clone())),
        }
    }

    /// As documents write it.
    pub fn as_str(&self) -> &str {
        match self {
            Self::Landmark(id) => id.as_str(),
            Self::Line(id) => id.as_str(),
        }
    }
}

/// Another set of names that fits better, or as well.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct IdentityFinding {
    /// What is wrong.
    pub kind: IdentityKind,
    /// What speaks for it.
    pub evidence: Evidence,
    /// The renames that correct the mistake, all of them together.
    pub renames: Vec<Rename>,
    /// The camera under the new names.
    pub ptz: Ptz,
    /// The distance of the farthest of the clicks to rename, as named, px: the residual that the
    /// list of points shows for it.
    pub as_named_px: f64,
    /// The same under the new names.
    pub renamed_px: f64,
}
