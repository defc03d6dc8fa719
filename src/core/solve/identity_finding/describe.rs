//! User texts about wrong names.

use super::{Evidence, IdentityFinding, IdentityKind};
use crate::field::Symmetry;
use crate::solve::{Warning, WarningCode};

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
