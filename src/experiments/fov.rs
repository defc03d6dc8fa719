//! `IoU` as a function of the field of view, to show where relocalization fails.

use super::answers::{FrameAnswer, TALLY_EXPLAINED, Tally, over_seeds, tally_table};
use super::forests::ForestKind;
use super::inputs::{Masks, Sets};
use super::paper::{FAILURE_IOU, FAILURES_BELOW_DEG, NO_FAILURE_ABOVE_DEG};
use super::progress::Progress;
use super::sequences::introduce;
use super::sets::SetKind;
use super::{ExperimentError, SharedInputs, lost_iou};
use touchline_documents::report::figure::{Axis, Figure, Line, Mark, Series};
use touchline_documents::report::{Cell, Report, Verdict};

/// Bounds of the bins of the field of view, degrees. They include the paper's two limits.
const BINS_DEG: [f64; 7] = [
    0.0,
    15.0,
    20.0,
    FAILURES_BELOW_DEG,
    30.0,
    NO_FAILURE_ABOVE_DEG,
    180.0,
];

/// Runs the experiment.
///
/// # Errors
/// The frames cannot be drawn or read.
pub fn run(inputs: &SharedInputs, progress: Progress) -> Result<Report, ExperimentError> {
    let sets = inputs.highlights(progress)?;
    let is_own = sets[0].kind == SetKind::Own;
    let mut report = Report::new("fov", &sets[0].heading("Field of view: where it fails"));
    introduce(&mut report, sets, "");
    report.text(&format!(
        "A failure is a frame that was not found, or whose IoU is below {FAILURE_IOU}. {TALLY_EXPLAINED}"
    ));
    let mut failures = Vec::new();
    for kind in ForestKind::BOTH {
        let answers = inputs.answers(Sets::Highlights, kind, Masks::AsTheyAre, progress)?;
        report.figure(
            kind.key(),
            &format!(
                "1 − IoU over the horizontal field of view, a dot a frame: {}; not found: 1.",
                kind.describe()
            ),
            figure(answers, !is_own),
        );
        // Statistics by bins of the field of view; empty bins are left out.
        let bins = BINS_DEG
            .windows(2)
            .map(|bin| (bin[0], bin[1]))
            .filter_map(|(from, to)| {
                let within: Vec<&FrameAnswer> = answers
                    .iter()
                    .filter(|answer| (from..to).contains(&answer.view_deg))
                    .collect();
                let name = if to < 180.0 {
                    format!("{from}–{to}°")
                } else {
                    format!("over {from}°")
                };
                (!within.is_empty()).then(|| (Cell::from(name), Tally::of(within.into_iter())))
            });
        let tallies: Vec<(Cell, Tally)> = bins.collect();
        let failed = tallies.iter().map(|(_, tally)| tally.failed.into());
        let table =
            tally_table(("view", "view"), &tallies).with_column("failures", "failures", failed);
        report.table(
            &format!("bins-{}", kind.key()),
            &format!("By field of view: {}.", kind.describe()),
            table,
        );
        failures.push((answers, failed_by_bound(answers.iter())));
    }
    // The paper's claim can be tested on synthetic frames only: their cameras are those of its
    // table 2.
    if let (SetKind::Drawn, [default, published]) = (sets[0].kind, &failures[..]) {
        let shown = |[below, between, above]: &[[usize; 2]; 3]| {
            format!(
                "{} of {} frames below {FAILURES_BELOW_DEG}°, {} of {} between, {} of {} above {NO_FAILURE_ABOVE_DEG}°",
                below[0], below[1], between[0], between[1], above[0], above[1]
            )
        };
        let share = |of: [usize; 2]| of[0] as f64 / of[1].max(1) as f64;
        let more_below = over_seeds(published.0, |answers| {
            let [below, between, _] = failed_by_bound(answers);
            share(below) - share(between)
        });
        let verdict = match published.1[2] {
            [_, 0] => Verdict::NotMeasured,
            [0, _] => Verdict::above(more_below, 0.0),
            _ => Verdict::Differs,
        };
        report.claim(
            verdict,
            &format!("Failures below about {FAILURES_BELOW_DEG}° of view, none above {NO_FAILURE_ABOVE_DEG}°"),
            &format!("failures: --published {}; default forest {}", shown(&published.1), shown(&default.1)),
            "table 2's focal lengths give hardly a view above 40°",
        );
    }
    Ok(report)
}

/// Numbers of failures and of frames: below, between and above the paper's two limits.
fn failed_by_bound<'a>(answers: impl IntoIterator<Item = &'a FrameAnswer>) -> [[usize; 2]; 3] {
    let mut counted = [[0; 2]; 3];
    for answer in answers {
        let place = usize::from(answer.view_deg >= FAILURES_BELOW_DEG)
            + usize::from(answer.view_deg > NO_FAILURE_ABOVE_DEG);
        counted[place][0] += usize::from(answer.is_failure());
        counted[place][1] += 1;
    }
    counted
}

/// 1 − `IoU` of each frame over its field of view, with the paper's limits.
fn figure(answers: &[FrameAnswer], with_paper: bool) -> Figure {
    let lost = |answer: &FrameAnswer| {
        Some([
            answer.view_deg,
            (1.0 - answer.iou()?).max(lost_iou::ENDS[0]),
        ])
    };
    let (found, not_found): (Vec<&FrameAnswer>, Vec<&FrameAnswer>) =
        answers.iter().partition(|answer| answer.found.is_some());
    let points = |answers: &[&FrameAnswer]| {
        answers
            .iter()
            .filter_map(|answer| lost(answer))
            .collect::<Vec<_>>()
    };
    let views = || answers.iter().map(|answer| answer.view_deg);
    let (least, greatest) = (
        views().fold(f64::INFINITY, f64::min),
        views().fold(FAILURES_BELOW_DEG, f64::max),
    );
    let ends = [(least - 2.0).max(0.0).floor(), (greatest + 2.0).ceil()];
    let mut figure = Figure::new(
        "",
        Axis::linear("horizontal field of view (°)").within(ends[0], ends[1]),
        lost_iou::axis(),
    )
    .with(
        Series::new("found", 1, points(&found))
            .lined(Line::None)
            .marked(Mark::Dot),
    )
    .with(
        Series::new("not found", 2, points(&not_found))
            .lined(Line::None)
            .marked(Mark::Cross),
    );
    if with_paper {
        let line = |name: &str, points: Vec<[f64; 2]>, line| {
            Series::new(name, 0, points).marked(Mark::None).lined(line)
        };
        let failure = 1.0 - FAILURE_IOU;
        figure = figure.with(line(
            "failures above",
            vec![[ends[0], failure], [ends[1], failure]],
            Line::Dotted,
        ));
        figure = figure.with(line(
            "paper: failures left",
            vec![
                [FAILURES_BELOW_DEG, lost_iou::ENDS[0]],
                [FAILURES_BELOW_DEG, lost_iou::ENDS[1]],
            ],
            Line::Dashed,
        ));
    }
    figure
}
