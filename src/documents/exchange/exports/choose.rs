//! The choice of frames to export.

use crate::document::{Frame, FrameStatus};
use crate::exchange::error::ExchangeError;
use crate::exchange::format::Format;
use crate::exchange::options::FrameChoice;
use std::collections::BTreeMap;
use touchline_core::geometry::{ImageSize, pluralise};

/// Why a frame without a camera is left out.
pub const NOT_SOLVED: &str = "it is not solved";

/// Why a frame is left out whose picture cannot be rescaled to the wanted size.
pub fn other_proportions(of: ImageSize) -> String {
    format!(
        "its picture of {} × {} px has other proportions",
        of.width, of.height
    )
}

/// Whether a frame is chosen.
pub fn is_chosen(frame: &Frame, choice: &FrameChoice) -> bool {
    // Without a request everything counts but what a person rejected.
    let by_status = match choice.statuses.as_slice() {
        [] => frame.status != FrameStatus::Rejected,
        statuses => statuses.contains(&frame.status),
    };
    let confidence = frame.confidence();
    let by_confidence = choice
        .min_confidence
        .is_none_or(|least| confidence.is_none_or(|of| of >= least));
    by_status
        && by_confidence
        && (choice.cameras.is_empty() || choice.cameras.contains(&frame.camera))
}

/// Names the accepted frames whose paint contradicts their cameras; none where there are none.
pub fn off_paint_note<'a>(frames: impl Iterator<Item = &'a Frame>) -> Option<String> {
    let off: Vec<String> = frames
        .filter(|frame| frame.evidence_against_acceptance().is_some())
        .map(Frame::name)
        .collect();
    let first = off.first()?;
    Some(match off.len() {
        1 => format!(
            "the paint contradicts the camera of {first}, which is accepted: look at it again"
        ),
        count => format!(
            "the paint contradicts the cameras of {count} accepted frames, the first {first}: look at them again"
        ),
    })
}

/// Refuses two frames of one name. Each pair is the name of a frame in the files and its own name.
///
/// # Errors
/// Two frames have the same name in the files; it is named with both frames.
pub fn refuse_same_names<'a>(
    names: impl IntoIterator<Item = (&'a str, &'a str)>,
) -> Result<(), ExchangeError> {
    let mut seen = BTreeMap::new();
    for (name, frame) in names {
        if let Some(first) = seen.insert(name, frame) {
            return Err(ExchangeError::SameName {
                name: name.to_owned(),
                first: first.to_owned(),
                second: frame.to_owned(),
            });
        }
    }
    Ok(())
}

/// The error that nothing is left to export, with the reasons.
pub fn nothing(format: Format, left_out: &[(String, String)]) -> ExchangeError {
    let why = first_left_out(left_out)
        .unwrap_or_else(|| "no frame has the requested status, camera and confidence".to_owned());
    ExchangeError::NothingToExport { format, why }
}

/// The first frame that is left out with its reason, and how many are.
pub fn first_left_out(left_out: &[(String, String)]) -> Option<String> {
    let (frame, why) = left_out.first()?;
    let all = pluralise(left_out.len(), "frame");
    Some(format!("{frame}: {why} ({all} in all)"))
}
