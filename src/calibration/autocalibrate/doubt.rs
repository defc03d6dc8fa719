//! Reasons to reject an answer of autocalibration.

use thiserror::Error;
use touchline_core::geometry::pluralise;

/// A reason to reject an answer.
#[derive(Clone, Debug, PartialEq, Error)]
#[non_exhaustive]
pub enum Doubt {
    /// Paint lies where the field has no line.
    #[error("{:.0} % of the paint is on no line", 100.0 * .share)]
    Unexplained {
        /// The share of the persistent paint.
        share: f64,
    },
    /// Lines that should be visible are not.
    #[error("{:.0} % of the lines are not seen where they should be", 100.0 * .share)]
    Unseen {
        /// The share of the lines on open ground.
        share: f64,
    },
    /// Too few lines are visible.
    #[error("only {} can be seen", pluralise(*.lines, "line"))]
    FewLines {
        /// Number of visible lines.
        lines: usize,
    },
    /// Whole lines are missing.
    #[error("no paint lies where {} should be", .lines.join(", "))]
    LinesMissing {
        /// Labels of the lines.
        lines: Vec<String>,
    },
    /// Parts of the frames give different positions.
    #[error("parts of the frames disagree by {parts_m:.1} m")]
    PartsDisagree {
        /// Distance between the positions, m.
        parts_m: f64,
    },
    /// The frames are too few for parts of them to confirm each other, or a part gives no position.
    #[error("{}", why_unconfirmed(*.frames))]
    Unconfirmed {
        /// Number of frames that took part.
        frames: usize,
    },
    /// The base is rolled more than a camera head is, levelled or not.
    #[error("the camera would be rolled by {roll_deg:.1}°")]
    Leans {
        /// Roll of the base, degrees.
        roll_deg: f64,
    },
    /// Another size of the field explains clearly more than the stated one.
    #[error(
        "a field of {length_m:.1} × {width_m:.1} m explains the paint better than the stated size"
    )]
    OtherSize {
        /// Length of that field, m.
        length_m: f64,
        /// Width of that field, m.
        width_m: f64,
    },
    /// Another position of the camera explains the paint nearly as well.
    #[error("another position of the camera explains the paint nearly as well")]
    Rival,
    /// Too few frames agree with their own paint.
    #[error("only {snapped} of {frames} frames agree with the painted lines of their own picture")]
    FewSnapped {
        /// Number of frames that agree.
        snapped: usize,
        /// Number of frames that show enough paint.
        frames: usize,
    },
    /// The frames do not determine the size of the field.
    #[error(
        "the frames do not show how {} the field is ({value_m:.1} ± {sigma_m:.1} m): state its {}, or add frames that show more of it",
        extent(.name), .name.trim_end_matches("_m")
    )]
    SizeOpen {
        /// Name of the length, as in documents: `length_m` or `width_m`.
        name: String,
        /// Estimated value, m.
        value_m: f64,
        /// 1-σ of the value, m.
        sigma_m: f64,
    },
    /// The fitted size of the field is at the limit of what is usual. The outer lines are then
    /// likely to be confused with something beside the field, such as the foot of the advertising
    /// boards.
    #[error(
        "the field would be {value_m:.1} m {}, or more unusual than that: state its {} if you know it",
        extent(.name), .name.trim_end_matches("_m")
    )]
    UnusualSize {
        /// Name of the length, as in documents: `length_m` or `width_m`.
        name: String,
        /// Fitted value, m.
        value_m: f64,
    },
    /// A click lies far from the projection of its landmark.
    #[error("the click on {landmark} in {frame} {}", relation_to_lines(*.off_px))]
    ClickContradicts {
        /// Id of the landmark.
        landmark: String,
        /// Name of the frame.
        frame: String,
        /// Distance between the two, px of the frame; infinite for a landmark behind the camera.
        off_px: f64,
    },
    /// The paint of the frames' own pictures does not determine a base.
    #[error("the painted lines of the frames' own pictures do not determine a base")]
    NotHeld,
}

/// Why parts of the frames do not confirm each other.
fn why_unconfirmed(frames: usize) -> String {
    let seen = format!("{} that show lines", pluralise(frames, "frame"));
    if frames < 3 {
        format!("{seen} are too few to confirm each other: 3 are needed")
    } else {
        format!("{seen} do not confirm each other: parts give no position")
    }
}

/// How a click lies to where the painted lines put its landmark.
fn relation_to_lines(off_px: f64) -> String {
    if off_px.is_finite() {
        format!("lies {off_px:.0} px from where the painted lines put it")
    } else {
        "shows what would lie behind the camera".to_owned()
    }
}

/// How a message speaks of a length of the field.
fn extent(name: &str) -> &'static str {
    if name == "length_m" { "long" } else { "wide" }
}

#[cfg(test)]
mod tests {
    use super::Doubt;

    fn click(off_px: f64) -> Doubt {
        Doubt::ClickContradicts {
            landmark: "centre_mark".to_owned(),
            frame: "13.png".to_owned(),
            off_px,
        }
    }

    #[test]
    fn doubts_are_in_plain_words_whatever_their_numbers() {
        for (doubt, says) in [
            (Doubt::FewLines { lines: 1 }, "only 1 line can be seen"),
            (
                Doubt::Unconfirmed { frames: 2 },
                "2 frames that show lines are too few to confirm each other: 3 are needed",
            ),
            (
                Doubt::Unconfirmed { frames: 7 },
                "7 frames that show lines do not confirm each other: parts give no position",
            ),
            (
                click(13.0),
                "the click on centre_mark in 13.png lies 13 px from where the painted lines put it",
            ),
            (
                click(f64::INFINITY),
                "the click on centre_mark in 13.png shows what would lie behind the camera",
            ),
        ] {
            assert_eq!(doubt.to_string(), says);
        }
    }
}
