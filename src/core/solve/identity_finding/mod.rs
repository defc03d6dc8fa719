//! A finding about wrong names: the mistake, the evidence and the new names.

use super::{Warning, WarningCode};
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

impl IdentityFinding {
    /// The warning for the user: the problem, the numbers and the remedy.
    pub fn warning(&self) -> Warning {
        // A line or landmark that the camera does not see has no distance.
        let before = if self.as_named_px.is_finite() {
            format!("{:.0} px", self.as_named_px)
        } else {
            "out of view".to_owned()
        };
        let after = self.renamed_px;
        let clicks: Vec<usize> = self.renames.iter().map(|rename| rename.click).collect();
        let points = points(&clicks);
        let contradicted = self.evidence == Evidence::Clicks;
        let (code, message) = match &self.kind {
            IdentityKind::Swapped if contradicted => {
                let message =
                    format!("{points} look swapped: {before} as named, {after:.1} px swapped.");
                (WarningCode::Swapped, message)
            }
            IdentityKind::Swapped => (
                WarningCode::Swapped,
                format!("{points} fit swapped as well, {}.", self.why_then()),
            ),
            IdentityKind::Mirrored(symmetry) => {
                let (end, what) = match symmetry {
                    Symmetry::MirrorX => ("other end", "left/right"),
                    Symmetry::MirrorY => ("other side", "near/far"),
                    Symmetry::Turn180 => ("opposite corner", "left/right and near/far"),
                };
                let message = match self.evidence {
                    Evidence::Clicks => format!(
                        "The names look mirrored: {before} as named, {after:.1} px on the {end}. Check {what}."
                    ),
                    Evidence::MotionPrior => {
                        format!("The {end} fits as well, {}. Check {what}.", self.why_then())
                    }
                    Evidence::None => format!("The {end} fits as well. Check {what}."),
                };
                (WarningCode::Mirrored, message)
            }
            IdentityKind::OtherPart { named, fits } => {
                let message = if contradicted {
                    format!(
                        "{points} look like the {fits}: {before} as {named}, {after:.1} px as {fits}."
                    )
                } else {
                    format!(
                        "{points} fit the {fits} as well as the {named}, {}.",
                        self.why_then()
                    )
                };
                (WarningCode::WrongLine, message)
            }
            IdentityKind::WrongName => {
                // The points of one line have one label.
                let mut labels: Vec<&str> = self
                    .renames
                    .iter()
                    .map(|rename| rename.label.as_str())
                    .collect();
                labels.dedup();
                let labels = labels.join(", ");
                let fit = if clicks.len() == 1 { "fits" } else { "fit" };
                let message = if contradicted {
                    format!(
                        "{points} {fit} elsewhere: {before} as named, {after:.1} px as {labels}."
                    )
                } else {
                    format!("{points} {fit} as {labels} as well, {}.", self.why_then())
                };
                (WarningCode::WrongLine, message)
            }
        };
        // A mirrored side is about the frame, not about single points.
        let clicks = if matches!(self.kind, IdentityKind::Mirrored(_)) {
            Vec::new()
        } else {
            clicks
        };
        Warning {
            code,
            message,
            clicks,
        }
    }

    /// The evidence for the other names, in words, where both fit.
    fn why_then(&self) -> &'static str {
        match self.evidence {
            Evidence::MotionPrior => "and then the camera looks where it usually does",
            Evidence::Clicks | Evidence::None => "the picture cannot tell",
        }
    }

    /// The name of the edit that corrects the names.
    pub fn step(&self) -> String {
        let clicks: Vec<usize> = self.renames.iter().map(|rename| rename.click).collect();
        let points = points(&clicks).to_lowercase();
        match self.kind {
            IdentityKind::Swapped => format!("Swap {points}"),
            IdentityKind::Mirrored(_) => "Mirror names".to_owned(),
            IdentityKind::OtherPart { .. } | IdentityKind::WrongName => format!("Rename {points}"),
        }
    }
}

/// "Point 3", "Points 2 and 3", "Points 1, 2 and 4".
fn points(clicks: &[usize]) -> String {
    let numbers: Vec<String> = clicks.iter().map(|click| (click + 1).to_string()).collect();
    match numbers.as_slice() {
        [one] => format!("Point {one}"),
        [first @ .., last] => format!("Points {} and {last}", first.join(", ")),
        [] => "No point".to_owned(),
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::camera::Ptz;
    use crate::solve::{Name, Rename};

    #[test]
    fn a_line_out_of_view_has_no_infinite_distance() {
        let rename = Rename {
            click: 0,
            name: Name::Line("penalty_arc_left".into()),
            label: "Left penalty arc".to_owned(),
        };
        let finding = IdentityFinding {
            kind: IdentityKind::WrongName,
            evidence: Evidence::Clicks,
            renames: vec![rename],
            ptz: Ptz::from_degrees(0.0, -10.0, 2000.0),
            as_named_px: f64::INFINITY,
            renamed_px: 1.2,
        };
        assert_eq!(
            finding.warning().message,
            "Point 1 fits elsewhere: out of view as named, 1.2 px as Left penalty arc."
        );
    }
}
