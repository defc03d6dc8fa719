//! The contact sheet of a set: wrong, refused and right answers.

use super::answers::{FrameAnswer, Outcome};
use crate::ExperimentError;
use crate::report::{SheetFrame, contact_sheet};
use crate::sets::FrameSet;
use touchline::media::FrameReader;

/// Number of frames of each outcome.
const EACH: usize = 2;

/// Draws the sheet as PNG; none without frames. Frames of one outcome are spread evenly over all
/// frames with it, so that they are not of one sequence.
///
/// # Errors
/// A picture cannot be read, or the sheet cannot be drawn.
pub fn sheet(
    sets: &[FrameSet],
    answers: &[FrameAnswer],
) -> Result<Option<Vec<u8>>, ExperimentError> {
    let mut reader = FrameReader::new();
    let mut frames = Vec::new();
    for (outcome, name) in [
        (Outcome::Wrong, "wrong"),
        (Outcome::Refused, "refused"),
        (Outcome::Right, "right"),
    ] {
        let all: Vec<&FrameAnswer> = answers
            .iter()
            .filter(|answer| answer.outcome() == outcome)
            .collect();
        for number in 0..EACH.min(all.len()) {
            // The middles of EACH equal parts of the list.
            let answer = all[(2 * number + 1) * all.len() / (2 * EACH)];
            let known = &sets[answer.repeat].frames[answer.frame];
            let iou = answer.found.and_then(|found| found.iou);
            let iou = iou.map_or_else(String::new, |iou| format!(", IoU {iou:.3}"));
            frames.push(SheetFrame {
                picture: known.picture(&mut reader)?,
                caption: format!("{name}: view {:.0}°{iou}", answer.view_deg),
                field: &known.field,
                truth: known.truth,
                estimate: answer.found.map(|found| found.camera),
            });
        }
    }
    Ok(contact_sheet(&frames)?)
}
