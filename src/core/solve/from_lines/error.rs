//! Why lines give no camera, with the numbers.

use crate::geometry::pluralise;
use thiserror::Error;

/// Why the lines of one picture give no camera. Clicks are indices into the picture's
/// observations, from 0; the messages count from 1.
#[derive(Clone, Debug, PartialEq, Error)]
#[non_exhaustive]
pub enum FromLinesError {
    /// A coordinate of a point or of its line is NaN or infinite, or its sigma is not positive.
    #[error("point {} is not a finite pixel with a positive sigma: place it again", .click + 1)]
    NotFinite {
        /// The click.
        click: usize,
    },
    /// Too few equations for position, rotation and focal length.
    #[error(
        "{} from {}, {needed} are needed: draw more lines (a straight one with two points gives \
         two, a circle one for each point, at most five)",
        pluralise(*.equations, "equation"), pluralise(*.lines, "line")
    )]
    TooFewLines {
        /// Lines, and landmarks, that have points.
        lines: usize,
        /// Equations that they give.
        equations: usize,
        /// Equations that are needed.
        needed: usize,
    },
    /// The lines leave the camera free to move along them.
    #[error(
        "all {lines} lines are parallel on the field: draw one that crosses them, or points on the \
         circle"
    )]
    Parallel {
        /// How many lines there are.
        lines: usize,
    },
    /// No place around the field shows the lines.
    #[error(
        "no place around the field shows these lines: check their names, and the field; draw one \
         more line"
    )]
    NoStart,
    /// The points do not determine all parameters.
    #[error("these lines leave the camera undetermined: draw one more line, away from the others")]
    Undetermined,
    /// The best-fitting camera is below the field.
    #[error(
        "the camera that fits these lines is {depth_m:.1} m below the field: check the names of \
         the lines, left and right, near and far"
    )]
    BelowGround {
        /// How deep, m.
        depth_m: f64,
    },
    /// No camera explains half of the lines.
    #[error(
        "no camera explains the lines: the best one {}. Check the names of the lines, and the \
         field",
        if median_px.is_finite() {
            format!("leaves half of the points more than {median_px:.0} px off")
        } else {
            "does not see half of the points".to_owned()
        }
    )]
    NoFit {
        /// Median distance of the points, px; infinite where most of them have no image.
        median_px: f64,
    },
}
