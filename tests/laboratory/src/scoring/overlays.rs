//! Errors of the overlay in px, for sets in which labels may be wrong, too.

use super::answers::FrameAnswer;
use crate::report::Report;
use crate::sets::FrameSet;
use touchline::proposals::overlay_error_px;
use touchline::report::{Cell, Column, Table};

/// Number of the worst frames that are listed.
const WORST_SHOWN: usize = 5;
/// Limits of the overlay's error for which shares of frames are counted, px at 1920 px width.
const OVERLAY_PX: [f64; 4] = [2.0, 5.0, 10.0, 20.0];

/// Adds two tables to the report: shares of frames by the error of the overlay, and the worst
/// frames.
pub fn overlays(
    report: &mut Report,
    set: &FrameSet,
    answers: &[FrameAnswer],
    parts: &[(&str, Vec<&FrameAnswer>)],
) {
    report.table(
        "overlay",
        "Share of all test frames whose overlay is right within some pixels where it is off most (5 × 3 points of the picture, \
         at 1920 px width).",
        overlay_table(set, parts),
    );
    // A refusal is worse than any answer.
    let mut order: Vec<(f64, &FrameAnswer)> = answers
        .iter()
        .map(|answer| (error_px(set, answer).unwrap_or(f64::INFINITY), answer))
        .collect();
    order.sort_by(|a, b| b.0.total_cmp(&a.0));
    let mut table = Table::new(&[
        ("frame", "frame"),
        ("sequence", "sequence"),
        ("overlay_px", "overlay off by (px)"),
        ("iou", "IoU"),
        ("warnings", "what the document warns of"),
    ]);
    for (error_px, answer) in order.into_iter().take(WORST_SHOWN) {
        let known = &set.frames[answer.frame];
        table.push(vec![
            known.name.as_str().into(),
            set.splits[answer.split].name.as_str().into(),
            error_px.into(),
            answer.found.and_then(|found| found.iou).into(),
            Some(known.warnings.clone())
                .filter(|warnings| !warnings.is_empty())
                .into(),
        ]);
    }
    report.table(
        "worst",
        "The worst frames. A wrong label counts here as a wrong answer.",
        table,
    );
}

/// The largest error of an answer's overlay, px at 1920 px width; none without an answer.
fn error_px(set: &FrameSet, answer: &FrameAnswer) -> Option<f64> {
    let known = &set.frames[answer.frame];
    Some(overlay_error_px(
        &known.truth,
        &answer.found?.camera,
        known.features.image_size,
    ))
}

/// Shares of all test frames. Those without an answer count as outside every limit.
fn overlay_table(set: &FrameSet, parts: &[(&str, Vec<&FrameAnswer>)]) -> Table {
    let mut table = Table::new(&[("sequence", "sequence"), ("frames", "frames")]);
    for within in OVERLAY_PX {
        table.columns.push(Column::new(
            &format!("within_{within}_px"),
            &format!("within {within} px"),
        ));
    }
    for (name, answers) in parts {
        let errors: Vec<f64> = answers
            .iter()
            .filter_map(|answer| error_px(set, answer))
            .collect();
        let mut row: Vec<Cell> = vec![(*name).into(), answers.len().into()];
        let share = |within: f64| {
            // Of all frames, so that refusals count as beyond every limit.
            errors.iter().filter(|error| **error <= within).count() as f64 / answers.len() as f64
        };
        row.extend(OVERLAY_PX.map(|within| Cell::Fixed(share(within), 3)));
        table.push(row);
    }
    table
}
