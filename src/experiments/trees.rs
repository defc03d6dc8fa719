//! The number of trees, from one to ten: its effect on the distribution of 1 − `IoU`.

use super::answers::{FrameAnswer, difference, mean_sd};
use super::forests::{ForestKind, Trained};
use super::paper::ENOUGH_TREES;
use super::progress::Progress;
use super::sequences::introduce;
use super::sets::{FrameSet, SetKind};
use super::{ExperimentError, SharedInputs, lost_iou};
use touchline_core::geometry::quantile;
use touchline_documents::report::figure::{Axis, Figure, Line, Mark, Series};
use touchline_documents::report::{Cell, Column, Report, Table, Verdict};
use touchline_vision::relocalize::TrainOptions;

/// The quantiles of 1 − `IoU` in tables and figures.
const QUANTILES: [(f64, &str); 4] = [
    (0.5, "median"),
    (0.75, "75 %"),
    (0.9, "90 %"),
    (0.95, "95 %"),
];
/// A gain of mean `IoU` up to this counts as none.
const IMPROVES: f64 = 0.005;

/// Runs the experiment.
///
/// # Errors
/// The frames cannot be drawn or read.
pub fn run(inputs: &SharedInputs, progress: Progress) -> Result<Report, ExperimentError> {
    let sets = inputs.highlights(progress)?;
    let mut report = Report::new("trees", &sets[0].heading("Trees: how many are needed"));
    introduce(
        &mut report,
        sets,
        "1 − IoU of all frames asked; not found counts as 1.",
    );
    report.text(ForestKind::EXPLAINED);
    let counts: &[usize] = if inputs.options.quick {
        &[1, 2, 5]
    } else {
        &[1, 2, 3, 4, 5, 6, 7, 8, 9, 10]
    };
    let mut both = Vec::new();
    for (number, kind) in ForestKind::BOTH.into_iter().enumerate() {
        let answers = measure(sets, kind, counts, &|done, total| {
            progress(number * total + done, 2 * total);
        });
        let lost: Vec<Vec<f64>> = answers.iter().map(|answer| lost(answer)).collect();
        let mut figure = Figure::new(
            "",
            Axis::linear("trees").within(0.0, counts.last().copied().unwrap_or(1) as f64 + 0.5),
            lost_iou::axis(),
        );
        let styles = [
            (Mark::Disc, Line::Solid),
            (Mark::Square, Line::Dashed),
            (Mark::Triangle, Line::Dotted),
            (Mark::Cross, Line::Solid),
        ];
        for (place, ((share, name), (mark, line))) in QUANTILES.into_iter().zip(styles).enumerate()
        {
            let points = counts
                .iter()
                .zip(&lost)
                .map(|(trees, lost)| [*trees as f64, quantile(lost, share).max(lost_iou::ENDS[0])]);
            figure = figure.with(
                Series::new(name, place + 1, points.collect())
                    .marked(mark)
                    .lined(line),
            );
        }
        report.figure(
            kind.key(),
            &format!(
                "The distribution of 1 − IoU by the number of trees: {} (quantiles of all frames; 1: not found).",
                kind.describe()
            ),
            figure,
        );
        report.table(
            kind.key(),
            &format!("1 − IoU: {}.", kind.describe()),
            table(counts, &lost),
        );
        both.push(answers);
    }
    if let (SetKind::Drawn, [default, published]) = (sets[0].kind, &both[..]) {
        let shown = |answers: &[Vec<FrameAnswer>]| {
            let each = counts
                .iter()
                .zip(answers)
                .filter(|(trees, _)| [1, 2, 5, 10].contains(*trees));
            let means = each.map(|(trees, answers)| {
                format!("{trees}: {:.3}", 1.0 - mean_sd(&lost(answers))[0])
            });
            means.collect::<Vec<_>>().join(", ")
        };
        let at = counts
            .iter()
            .position(|trees| *trees == ENOUGH_TREES)
            .unwrap_or(0);
        let gain = |to: usize, from: usize| {
            difference(&published[to], &published[from], |tally| tally.iou_mean)
        };
        // Contradicted if more trees are better by more than [`IMPROVES`], by the whole interval.
        let verdict = match Verdict::above(gain(at, 0), 0.0) {
            Verdict::Confirmed
                if (at + 1..counts.len()).any(|more| gain(more, at)[0] > IMPROVES) =>
            {
                Verdict::Differs
            }
            verdict => verdict,
        };
        report.claim(
            verdict,
            &format!("The distribution of 1 − IoU improves up to about {ENOUGH_TREES} trees"),
            &format!("mean IoU by trees: --published {}; default forest {}", shown(published), shown(default)),
            "beyond, little is gained and the seeds are few; a tree of the default forest holds every sample, so that one tree is nearly as good as ten",
        );
    }
    Ok(report)
}

/// 1 − `IoU` of all frames, ascending.
fn lost(answers: &[FrameAnswer]) -> Vec<f64> {
    let mut lost: Vec<f64> = answers
        .iter()
        .filter_map(FrameAnswer::iou)
        .map(|iou| 1.0 - iou)
        .collect();
    lost.sort_by(f64::total_cmp);
    lost
}

/// The results of all test frames, for each number of trees.
fn measure(
    sets: &[FrameSet],
    kind: ForestKind,
    counts: &[usize],
    progress: Progress,
) -> Vec<Vec<FrameAnswer>> {
    let most = counts.iter().copied().max().unwrap_or(1);
    let mut answers = vec![Vec::new(); counts.len()];
    for (repeat, set) in sets.iter().enumerate() {
        let training = TrainOptions {
            trees: most as u32,
            ..kind.training(set.seed)
        };
        let all = Trained::of(set, repeat, &training);
        for (place, trees) in counts.iter().enumerate() {
            answers[place].extend(all.first_trees(*trees).ask_plainly(&kind.asking(set.seed)));
            progress(repeat * counts.len() + place + 1, sets.len() * counts.len());
        }
    }
    answers
}

fn table(counts: &[usize], lost: &[Vec<f64>]) -> Table {
    let mut table = Table::new(&[("trees", "trees"), ("mean", "mean"), ("sd", "SD")]);
    for (share, name) in QUANTILES {
        table
            .columns
            .push(Column::new(&format!("quantile_{}", 100.0 * share), name));
    }
    for (trees, lost) in counts.iter().zip(lost) {
        let [mean, sd] = mean_sd(lost);
        let mut row: Vec<Cell> = vec![(*trees).into(), Cell::Fixed(mean, 4), Cell::Fixed(sd, 4)];
        row.extend(QUANTILES.map(|(share, _)| Cell::Fixed(quantile(lost, share), 4)));
        table.push(row);
    }
    table
}
