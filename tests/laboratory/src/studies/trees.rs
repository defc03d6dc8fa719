//! The number of trees, from one to ten: its effect on the distribution of 1 − `IoU`.

use super::sequences::{introduce_again, on_both};
use crate::progress::Progress;
use crate::report::contrast::{Contrast, Statement};
use crate::report::lost_iou;
use crate::report::paper::ENOUGH_TREES;
use crate::report::{Report, Stated};
use crate::scoring::answers::{FrameAnswer, Tally, frame_table, tally_table};
use crate::scoring::forests::{ForestKind, Trained};
use crate::sets::{FrameSet, SetKind};
use crate::{ExperimentError, SharedInputs};
use touchline::relocalize::TrainOptions;
use touchline::report::Cell;
use touchline::report::figure::{Axis, Figure, Line, Series};

/// Numbers of trees; the last one is the most that the paper shows.
const COUNTS: [usize; 10] = [1, 2, 3, 4, 5, 6, 7, 8, 9, 10];
const QUICK_COUNTS: [usize; 3] = [1, 2, 5];
/// The numbers of trees in the figure and the table.
const IN_FIGURE: [usize; 4] = [1, 2, 5, 10];

/// Runs the experiment.
///
/// # Errors
/// The frames cannot be drawn or read.
pub fn run(inputs: &SharedInputs, progress: Progress) -> Result<Report, ExperimentError> {
    let sets = inputs.highlights(progress)?;
    let mut report = Report::new("trees", &sets[0].heading("Trees: how many are needed"));
    introduce_again(&mut report, sets, "highlights", "");
    let counts: &[usize] = if inputs.options.quick {
        &QUICK_COUNTS
    } else {
        &COUNTS
    };
    let mut ways: Vec<(String, Vec<FrameAnswer>)> = Vec::new();
    for (number, kind) in ForestKind::PAPER_FIRST.into_iter().enumerate() {
        let answers = measure(sets, kind, counts, &|done, total| {
            progress(number * total + done, 2 * total);
        });
        if kind == ForestKind::Published {
            report.figure(
                kind.key(),
                &format!(
                    "Share of frames within 1 − IoU, a curve for each number of trees: {}.",
                    kind.describe()
                ),
                figure(counts, &answers),
            );
        }
        let named = counts.iter().map(|trees| way(kind.key(), *trees));
        ways.extend(named.zip(answers));
    }
    // `ways` has all numbers of trees of one forest, then of the other, so that the counts repeat.
    let shown = ways
        .iter()
        .zip(counts.iter().cycle())
        .filter(|(_, trees)| IN_FIGURE.contains(trees));
    let tallies: Vec<(Cell, Tally)> = shown
        .map(|((way, answers), _)| (way.as_str().into(), Tally::from_answers(answers.iter())))
        .collect();
    report.table(
        "counts",
        "By number of trees.",
        tally_table(("trees", "forest, trees"), &tallies),
    );
    let each = ways.iter().map(|(way, answers)| (way, &answers[..]));
    report.data(
        "frames",
        "Every frame, by number of trees.",
        frame_table(sets, each),
    );
    if sets[0].kind == SetKind::Drawn {
        claims(&mut report, counts);
    }
    Ok(report)
}

/// The name of a forest with so many trees in files.
fn way(kind: &str, trees: usize) -> String {
    format!("{kind} {trees}")
}

/// Adds the paper's sentence in two parts: trees help up to about five, and hardly beyond.
fn claims(report: &mut Report, counts: &[usize]) {
    let most = counts.last().copied().unwrap_or(1);
    let mean = |contrast: Contrast, weight: f64, kind: &str, trees: usize| {
        contrast.add(weight, &[("way", &way(kind, trees))])
    };
    let start = || Contrast::over_frames("iou_part");
    Statement {
        comparisons: 2,
        ..Statement::new(
            &format!("More trees help up to about {ENOUGH_TREES}: IoU with {ENOUGH_TREES} minus that with one"),
            Stated::Positive,
            "a tree of the default forest holds every sample, so that one is nearly as good as ten",
        )
    }
    .test(
        report,
        &on_both(|kind| mean(mean(start(), 1.0, kind, ENOUGH_TREES), -1.0, kind, 1)),
    );
    // Of the gain of all trees less than a half is left beyond: (IoU₁₀ − IoU₅) − (IoU₅ − IoU₁) < 0.
    Statement {
        comparisons: 2,
        ..Statement::new(
            &format!("… and hardly beyond: the gain from {ENOUGH_TREES} to {most}, minus that up to {ENOUGH_TREES}"),
            Stated::AtMost(0.0),
            "",
        )
    }
    .test(
        report,
        &on_both(|kind| {
            // (IoU of most − IoU of enough) − (IoU of enough − IoU of one).
            let gains = mean(mean(start(), 1.0, kind, most), -2.0, kind, ENOUGH_TREES);
            mean(gains, 1.0, kind, 1)
        }),
    );
}

/// The cumulative distribution of 1 − `IoU` for some numbers of trees, as the paper draws it.
fn figure(counts: &[usize], answers: &[Vec<FrameAnswer>]) -> Figure {
    let mut figure = Figure::new(
        "1 − IoU by the number of trees",
        lost_iou::axis(),
        Axis::linear("share of frames").within(0.0, 1.0),
    );
    let lines = [Line::Dotted, Line::Dashed, Line::Solid, Line::Dashed];
    let shown = counts
        .iter()
        .zip(answers)
        .filter(|(trees, _)| IN_FIGURE.contains(trees));
    for (number, ((trees, answers), line)) in shown.zip(lines).enumerate() {
        let lost: Vec<f64> = answers
            .iter()
            .filter(|answer| answer.found.is_some())
            .filter_map(|answer| Some((1.0 - answer.iou()?).max(lost_iou::ENDS[0])))
            .collect();
        let name = if *trees == 1 {
            "1 tree".to_owned()
        } else {
            format!("{trees} trees")
        };
        figure = figure
            .with(Series::cumulative(&name, number + 1, &lost, answers.len()).with_line(line));
    }
    figure
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
        // Trees are trained independently, so that the first of many are those of a smaller forest
        // (tested in `forests`).
        let all = Trained::train(set, repeat, &training);
        for (place, trees) in counts.iter().enumerate() {
            answers[place].extend(all.first_trees(*trees).ask_plainly(&kind.asking(set.seed)));
            progress(repeat * counts.len() + place + 1, sets.len() * counts.len());
        }
    }
    answers
}
