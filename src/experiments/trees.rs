//! One to ten trees: the distribution of 1 − `IoU`.

use super::answers::{AskedFrame, mean_sd};
use super::forests::{ForestKind, Trained};
use super::paper::ENOUGH_TREES;
use super::progress::Progress;
use super::sequences::introduce;
use super::sets::{FrameSet, SetKind};
use super::{ExperimentError, SharedInputs};
use crate::relocalize::TrainOptions;
use crate::report::figure::{Axis, Figure, Line, Mark, Series};
use crate::report::{Cell, Column, Report, Table, Verdict};
use crate::score::quantile;

/// The quantiles of 1 − `IoU` that are shown.
const QUANTILES: [(f64, &str); 4] = [(0.5, "median"), (0.75, "75 %"), (0.9, "90 %"), (0.95, "95 %")];
/// A log axis has no place for an `IoU` of 1.
const LEAST_SHOWN: f64 = 1e-5;
/// The mean `IoU` improves if it grows by more than this.
const IMPROVES: f64 = 0.005;

/// Runs the experiment.
///
/// # Errors
/// The frames cannot be had.
pub fn run(inputs: &SharedInputs, progress: Progress) -> Result<Report, ExperimentError> {
    let sets = inputs.highlights(progress)?;
    let mut report = Report::new("trees", &sets[0].heading("Trees: how many are needed"));
    introduce(&mut report, sets, "1 − IoU of all frames asked; not found counts as 1.");
    report.text(ForestKind::EXPLAINED);
    let counts: &[usize] = if inputs.options.quick { &[1, 2, 5] } else { &[1, 2, 3, 4, 5, 6, 7, 8, 9, 10] };
    let mut means = Vec::new();
    for (number, kind) in ForestKind::BOTH.into_iter().enumerate() {
        let lost = measure(sets, kind, counts, &|done, total| progress(number * total + done, 2 * total));
        let mut figure = Figure::new(
            "",
            Axis::linear("trees").within(0.0, counts.last().copied().unwrap_or(1) as f64 + 0.5),
            Axis::log("1 − IoU").within(LEAST_SHOWN, 1.3),
        );
        let styles = [
            (Mark::Disc, Line::Solid),
            (Mark::Square, Line::Dashed),
            (Mark::Triangle, Line::Dotted),
            (Mark::Cross, Line::Solid),
        ];
        for (place, ((share, name), (mark, line))) in QUANTILES.into_iter().zip(styles).enumerate() {
            let points =
                counts.iter().zip(&lost).map(|(trees, lost)| [*trees as f64, quantile(lost, share).max(LEAST_SHOWN)]);
            figure = figure.with(Series::new(name, place + 1, points.collect()).marked(mark).lined(line));
        }
        report.figure(
            kind.key(),
            &format!(
                "The distribution of 1 − IoU by the number of trees: {} (quantiles of all frames; 1: not found).",
                kind.describe()
            ),
            figure,
        );
        report.table(kind.key(), &format!("1 − IoU: {}.", kind.describe()), table(counts, &lost));
        means.push(lost.iter().map(|lost| 1.0 - mean_sd(lost)[0]).collect::<Vec<f64>>());
    }
    if let (SetKind::Drawn, [default, published]) = (sets[0].kind, &means[..]) {
        let shown = |means: &[f64]| {
            let each = counts.iter().zip(means).filter(|(trees, _)| [1, 2, 5, 10].contains(*trees));
            each.map(|(trees, iou)| format!("{trees}: {iou:.3}")).collect::<Vec<_>>().join(", ")
        };
        let beyond = |means: &[f64]| {
            let at = counts.iter().position(|trees| *trees == ENOUGH_TREES).unwrap_or(0);
            let most = means[at..].iter().copied().fold(f64::NEG_INFINITY, f64::max);
            (means[at] - means[0] > IMPROVES, most - means[at] <= IMPROVES)
        };
        let (improves, enough) = beyond(published);
        report.claim(
            Verdict::of(improves && enough),
            &format!("The distribution of 1 − IoU improves up to about {ENOUGH_TREES} trees"),
            &format!("mean IoU by trees: --published {}; default forest {}", shown(published), shown(default)),
            "a tree of the default forest holds every sample, so that one tree is nearly as good as ten",
        );
    }
    Ok(report)
}

/// 1 − `IoU` of all frames, ascending, for each number of trees.
fn measure(sets: &[FrameSet], kind: ForestKind, counts: &[usize], progress: Progress) -> Vec<Vec<f64>> {
    let most = counts.iter().copied().max().unwrap_or(1);
    let mut lost = vec![Vec::new(); counts.len()];
    for (repeat, set) in sets.iter().enumerate() {
        let training = TrainOptions { trees: most as u32, ..kind.training(set.seed) };
        let all = Trained::of(set, repeat, &training);
        for (place, trees) in counts.iter().enumerate() {
            let asked = all.first_trees(*trees).ask_plainly(&kind.asking(set.seed));
            lost[place].extend(asked.iter().filter_map(AskedFrame::iou).map(|iou| 1.0 - iou));
            progress(repeat * counts.len() + place + 1, sets.len() * counts.len());
        }
    }
    for lost in &mut lost {
        lost.sort_by(f64::total_cmp);
    }
    lost
}

fn table(counts: &[usize], lost: &[Vec<f64>]) -> Table {
    let mut table = Table::new(&[("trees", "trees"), ("mean", "mean"), ("sd", "SD")]);
    for (share, name) in QUANTILES {
        table.columns.push(Column::new(&format!("quantile_{}", 100.0 * share), name));
    }
    for (trees, lost) in counts.iter().zip(lost) {
        let [mean, sd] = mean_sd(lost);
        let mut row: Vec<Cell> = vec![(*trees).into(), Cell::Fixed(mean, 4), Cell::Fixed(sd, 4)];
        row.extend(QUANTILES.map(|(share, _)| Cell::Fixed(quantile(lost, share), 4)));
        table.push(row);
    }
    table
}
