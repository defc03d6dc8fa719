//! Reports of an evaluation: tables, and figures of the errors.

use super::{Evaluation, FrameGroup, GroupKind, Measure};
use std::fmt::Write as _;
use touchline_core::geometry::{Angle, ImageSize};
use touchline_core::score::Summary;
use touchline_documents::report::figure::{Axis, Figure, Line, Mark, Series};
use touchline_documents::report::{Cell, Column, Report, Table};

/// The measures that are plotted as cumulative distributions.
const DRAWN: [Measure; 6] = [
    Measure::Rotation,
    Measure::Focal,
    Measure::Landmarks,
    Measure::LandmarksOnGround,
    Measure::HeldOutClicks,
    Measure::Clicks,
];

/// The report of an evaluation: its tables, the distributions of its errors, and `IoU` over the
/// field of view.
pub fn evaluation_report(evaluation: &Evaluation, groups: &[FrameGroup]) -> Report {
    let mut report = Report::new("evaluation", "Evaluation");
    report.text(&evaluation_tables(groups, Table::to_markdown));

    for measure in DRAWN {
        let values: Vec<f64> = evaluation
            .frames
            .iter()
            .filter_map(|frame| frame.scores.as_ref().ok()?.get(measure))
            .collect();
        // A logarithmic axis cannot show an error of exactly zero.
        if values.iter().any(|value| value.is_finite() && *value > 0.0) {
            let share = Axis::linear("share of frames").within(0.0, 1.0);
            let figure = Figure::new("", Axis::log(measure.label()), share)
                .with(Series::cumulative("", 1, &values, evaluation.frames.len()));
            let caption = format!("Share of all frames within a {}.", measure.label());
            report.figure(measure.key(), &caption, figure);
        }
    }
    let points: Vec<[f64; 2]> = evaluation
        .frames
        .iter()
        .filter_map(|frame| {
            Some([
                frame.view?.degrees(),
                frame.scores.as_ref().ok()?.get(Measure::IouPart)?,
            ])
        })
        .collect();
    // A frame that the estimate could not solve has no IoU. It is drawn at 0, so that a program
    // does not look better for the hard frames that it leaves out.
    if !points.is_empty() {
        let unscored = evaluation
            .frames
            .iter()
            .filter(|frame| frame.scores.is_err());
        let failed: Vec<[f64; 2]> = unscored
            .filter_map(|frame| Some([frame.view?.degrees(), 0.0]))
            .collect();
        let figure = Figure::new(
            "",
            Axis::linear("horizontal field of view (°)"),
            Axis::linear("IoU_part").within(0.0, 1.05),
        )
        .with(Series::new("scored", 1, points).with_line(Line::None))
        .with(
            Series::new("without a camera", 2, failed)
                .with_line(Line::None)
                .with_mark(Mark::Cross),
        );
        report.figure("iou-view", "IoU_part over the field of view.", figure);
    }
    report
}

/// A table of every measure of every frame, one row each; frames without scores state the reason.
pub fn frame_scores(evaluation: &Evaluation) -> Table {
    let mut table = Table::new(&[
        ("frame", "Frame"),
        ("clip", "Clip"),
        ("camera", "Camera"),
        ("view_deg", "View (°)"),
    ]);
    table
        .columns
        .extend(Measure::ALL.map(|measure| Column::new(measure.key(), measure.label())));
    table
        .columns
        .push(Column::new("unscored", "Why there is no score"));
    for frame in &evaluation.frames {
        let clip = frame.clip.as_ref().map(ToString::to_string);
        let view = frame.view.map(Angle::degrees);
        let mut row: Vec<Cell> = vec![
            frame.name.as_str().into(),
            clip.into(),
            frame.camera.as_str().into(),
            view.into(),
        ];
        let scores = frame.scores.as_ref();
        row.extend(
            Measure::ALL
                .map(|measure| Cell::from(scores.ok().and_then(|scores| scores.get(measure)))),
        );
        row.push(scores.err().map(ToString::to_string).into());
        table.push(row);
    }
    table
}

/// Sizes of pictures in words: "1280 × 720, 960 × 540".
fn describe_sizes(sizes: &[ImageSize]) -> String {
    let sizes: Vec<String> = sizes
        .iter()
        .map(|size| format!("{} × {}", size.width, size.height))
        .collect();
    sizes.join(", ")
}

/// All frames together by measure, then group by group, as text and tables in the format of
/// `write`.
pub fn evaluation_tables(groups: &[FrameGroup], write: fn(&Table) -> String) -> String {
    let mut text = String::new();
    let Some(all) = groups.first() else {
        return text;
    };
    // Writing to a string cannot fail.
    let _ = writeln!(
        text,
        "{} of {} frames have a camera (completeness {:.3}); px are of pictures of {}.\n",
        all.scored,
        all.frames,
        all.completeness(),
        describe_sizes(&all.image_sizes)
    );
    text.push_str(&write(&summary_table(all)));
    if let Some(coverage) = &all.coverage {
        let _ = writeln!(
            text,
            "\nStated sigmas: {:.1} % of {} frames lie within 68.3 %, {:.1} % within 95 %; errors are {:.2} times as large as \
             stated.",
            100.0 * coverage.within_68,
            coverage.count,
            100.0 * coverage.within_95,
            coverage.error_over_sigma
        );
    }
    if let Some(score) = all.soccernet_score() {
        let _ = writeln!(
            text,
            "\nMean JaC@5 (px at 960 px width) × completeness: {score:.3}."
        );
    }
    if groups.len() > 1 {
        text.push('\n');
        text.push_str(&write(&group_table(groups)));
    }
    text
}

/// A table with a row for each measure of a group.
fn summary_table(group: &FrameGroup) -> Table {
    let mut table = Table::new(&[
        ("measure", "measure"),
        ("count", "n"),
        ("mean", "mean"),
        ("interval", "95 % interval"),
        ("std", "std"),
        ("median", "median"),
        ("worst_tenth", "worst tenth from"),
        ("worst", "worst"),
    ]);
    for (measure, summary) in &group.measures {
        let more_is_better = measure.more_is_better();
        table.push(summary_row(measure.label(), summary, more_is_better));
    }
    for (name, summary) in [
        ("every click used (px)", &group.clicks_px),
        ("every click held out (px)", &group.held_out_px),
        ("every click held out (m)", &group.held_out_m),
    ] {
        if let Some(summary) = summary {
            table.push(summary_row(name, summary, false));
        }
    }
    table
}

/// The row of [`summary_table`] for one measure.
fn summary_row(name: &str, summary: &Summary, more_is_better: bool) -> Vec<Cell> {
    let [low, high] = summary.mean_interval.map(|end| Cell::from(end).to_string());
    // The worst tenth are the lowest values where more is better, and the highest ones of errors.
    let (tenth, worst) = if more_is_better {
        (summary.p10, summary.min)
    } else {
        (summary.p90, summary.max)
    };
    vec![
        name.into(),
        summary.count.into(),
        summary.mean.into(),
        format!("{low} to {high}").into(),
        summary.std.into(),
        summary.median.into(),
        tenth.into(),
        worst.into(),
    ]
}

/// A table of medians by group.
fn group_table(groups: &[FrameGroup]) -> Table {
    const SHOWN: [Measure; 6] = [
        Measure::IouPart,
        Measure::Rotation,
        Measure::FocalPercent,
        Measure::Landmarks,
        Measure::HeldOutClicks,
        Measure::Jaccard5,
    ];
    let mut table = Table::new(&[
        ("kind", "by"),
        ("name", "medians of"),
        ("frames", "frames"),
        ("scored", "with a camera"),
    ]);
    // A column that no group fills is left out: a truth of clicks alone has no rotation.
    let shown = SHOWN
        .into_iter()
        .filter(|measure| groups.iter().any(|group| group.measure(*measure).is_some()));
    let shown: Vec<Measure> = shown.collect();
    table.columns.extend(
        shown
            .iter()
            .map(|measure| Column::new(measure.key(), measure.label())),
    );
    for group in groups {
        let kind = match group.kind {
            GroupKind::All => "",
            kind => kind.key(),
        };
        let mut row: Vec<Cell> = vec![
            kind.into(),
            group.name.as_str().into(),
            group.frames.into(),
            group.scored.into(),
        ];
        row.extend(
            shown
                .iter()
                .map(|measure| Cell::from(group.measure(*measure).map(|summary| summary.median))),
        );
        table.push(row);
    }
    table
}
