//! What speaks against an answer of a search without clicks.

use thiserror::Error;

/// What speaks against an answer.
#[derive(Clone, Debug, PartialEq, Error)]
#[non_exhaustive]
pub enum Doubt {
    /// Paint lies where the field has no line.
    #[error("{:.0} % of the paint is on no line", 100.0 * .share)]
    Unexplained {
        /// Of the paint that stays.
        share: f64,
    },
    /// Lines should be seen and are not.
    #[error("{:.0} % of the lines are not seen where they should be", 100.0 * .share)]
    Unseen {
        /// Of the lines on open ground.
        share: f64,
    },
    /// Few lines were seen.
    #[error("only {lines} lines are seen")]
    FewLines {
        /// How many.
        lines: usize,
    },
    /// Whole lines are missing.
    #[error("no paint lies where {} should be", .lines.join(", "))]
    LinesMissing {
        /// Their names.
        lines: Vec<String>,
    },
    /// The paint is near its lines, not on them.
    #[error("paint lies {residual_px:.1} px off its lines")]
    OffLines {
        /// The median, px at 1920 px width.
        residual_px: f64,
    },
    /// Parts of the frames give different bases.
    #[error("parts of the frames disagree by {parts_m:.1} m")]
    PartsDisagree {
        /// How far they lie apart, m.
        parts_m: f64,
    },
    /// Some of the frames cannot be asked whether they agree with the others.
    #[error("{frames} frames that show lines are too few to confirm each other: 3 are needed")]
    Unconfirmed {
        /// Frames that took part.
        frames: usize,
    },
    /// Camera heads are levelled.
    #[error("the camera would be rolled by {roll_deg:.1}°")]
    Leans {
        /// Its roll, degrees.
        roll_deg: f64,
    },
    /// The stated size of the field explains less than another.
    #[error(
        "a field of {length_m:.1} × {width_m:.1} m explains the paint better than the stated size"
    )]
    OtherSize {
        /// The length that explains more, m.
        length_m: f64,
        /// The width, m.
        width_m: f64,
    },
    /// Another place for the camera is as good.
    #[error("another position of the camera explains the paint nearly as well")]
    Rival,
    /// Frames do not agree with their own paint.
    #[error("only {snapped} of {frames} frames agree with the painted lines of their own picture")]
    FewSnapped {
        /// Frames that agree.
        snapped: usize,
        /// Frames that were asked.
        frames: usize,
    },
    /// The frames do not show how large the field is.
    #[error(
        "the frames do not show how {} the field is ({value_m:.1} ± {sigma_m:.1} m): state its {}, or add frames that show more of it",
        if .name == "length_m" { "long" } else { "wide" },
        .name.trim_end_matches("_m")
    )]
    SizeOpen {
        /// Of the length, as documents have it.
        name: String,
        /// What the frames hardly decide, m.
        value_m: f64,
        /// Its 1-σ, m.
        sigma_m: f64,
    },
    /// A click lies far from where the camera has its landmark.
    #[error(
        "the click on {landmark} in {frame} lies {off_px:.0} px from where the painted lines put it"
    )]
    ClickContradicts {
        /// The landmark's name.
        landmark: String,
        /// The frame's.
        frame: String,
        /// How far, px.
        off_px: f64,
    },
    /// The paint of the frames' own pictures does not hold a base.
    #[error("the painted lines of the frames' own pictures do not determine a base")]
    NotHeld,
}
