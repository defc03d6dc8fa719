//! `IoU` as a function of the field of view, with coverage apart: where relocalization fails.

use super::sequences::{introduce_again, on_both, sets_of_one_kind};
use crate::inputs::Masks;
use crate::progress::Progress;
use crate::report::contrast::{Contrast, Statement};
use crate::report::lost_iou;
use crate::report::paper::{FAILURE_IOU, FAILURES_BELOW_DEG, NO_FAILURE_ABOVE_DEG};
use crate::report::{Report, Stated};
use crate::scoring::answers::{FrameAnswer, Tally, frame_table, tally_table};
use crate::scoring::coverage::{ViewBin, is_covered};
use crate::scoring::forests::ForestKind;
use crate::sets::{FrameSet, SetKind};
use crate::{ExperimentError, SharedInputs};
use touchline::report::figure::{Axis, Figure, Line, Mark, Series};
use touchline::report::{Cell, Table};

/// Test frames of one kind of sets.
struct TestFrames<'a> {
    name: &'static str,
    sets: &'a [FrameSet],
    answers: &'a [FrameAnswer],
}

/// Runs the experiment.
///
/// # Errors
/// The frames cannot be drawn or read.
pub fn run(inputs: &SharedInputs, progress: Progress) -> Result<Report, ExperimentError> {
    let sets = inputs.highlights(progress)?;
    // All sets of an experiment are of one kind.
    let kind = sets[0].kind;
    let mut report = Report::new("fov", &sets[0].heading("Field of view: where it fails"));
    introduce_again(&mut report, sets, "highlights", "");
    let chosen = sets_of_one_kind(inputs, progress)?;
    report.text(&format!(
        "A failure is a frame that was refused, or whose IoU is below {FAILURE_IOU}. A frame is \
         *covered* if its middle lies within the picture of one of its references, by pan: a \
         narrow view and a view that no reference shows are two causes."
    ));
    let mut views = Figure::new(
        "Fields of view",
        Axis::linear("horizontal field of view (°)"),
        Axis::linear("share of frames").within(0.0, 1.0),
    );
    for (number, (name, which)) in chosen.iter().enumerate() {
        let answers = inputs.answers(*which, ForestKind::Published, Masks::AsTheyAre, progress)?;
        let degrees: Vec<f64> = answers.iter().map(|answer| answer.view_deg).collect();
        views = views.with(Series::cumulative(
            name,
            number + 1,
            &degrees,
            degrees.len(),
        ));
    }
    report.figure("distribution", "How wide the test frames look.", views);
    let (mut rows, mut every) = (Vec::new(), Table::default());
    for forest in ForestKind::PAPER_FIRST {
        for (name, which) in &chosen {
            let test_frames = TestFrames {
                name,
                sets: inputs.sets(*which, progress)?,
                answers: inputs.answers(*which, forest, Masks::AsTheyAre, progress)?,
            };
            rows.extend(test_frames.by_view(forest));
            if forest == ForestKind::Published {
                report.figure(
                    &format!("iou-{}", test_frames.file_name()),
                    &format!(
                        "1 − IoU of the {} over the field of view, a dot for each frame, with the paper's two limits; refused: 1.",
                        forest.describe()
                    ),
                    test_frames.figure(kind != SetKind::Own),
                );
            }
            let table = frame_table(
                test_frames.sets,
                [(format!("{}, {name}", forest.key()), test_frames.answers)],
            );
            every.append(table);
        }
    }
    // Failures are a column of this table alone.
    let failed: Vec<Cell> = rows.iter().map(|(_, tally)| tally.failed.into()).collect();
    report.table(
        "views",
        "By field of view; covered or not.",
        tally_table(("view", "forest, frames, view"), &rows)
            .with_column("failures", "failures", failed),
    );
    report.data("frames", "Every frame, by forest.", every);
    if kind == SetKind::Drawn {
        claims(&mut report);
    }
    Ok(report)
}

impl TestFrames<'_> {
    fn file_name(&self) -> String {
        self.name.to_lowercase().replace(' ', "-")
    }

    /// A row for each field of view, of covered frames and of the others. Empty ones are left out.
    fn by_view(&self, forest: ForestKind) -> Vec<(Cell, Tally)> {
        let parts = [true, false]
            .into_iter()
            .flat_map(|covered| ViewBin::ALL.map(|bin| (covered, bin)));
        let row = |(covered, bin): (bool, ViewBin)| {
            // Field of view and coverage apart: a narrow view and a view without a reference fail
            // for different reasons.
            let within: Vec<&FrameAnswer> = self
                .answers
                .iter()
                .filter(|answer| ViewBin::from_view_deg(answer.view_deg) == bin)
                .filter(|answer| {
                    is_covered(&self.sets[answer.repeat], answer.frame, answer.split) == covered
                })
                .collect();
            let coverage = if covered { "covered" } else { "not covered" };
            let name = format!(
                "{}, {}, {}, {coverage}",
                forest.key(),
                self.name,
                bin.describe()
            );
            (!within.is_empty())
                .then(|| (Cell::from(name), Tally::from_answers(within.into_iter())))
        };
        parts.filter_map(row).collect()
    }

    /// 1 − `IoU` of each frame over its field of view, with the paper's limits.
    fn figure(&self, with_paper: bool) -> Figure {
        let points = |covered: bool| -> Vec<[f64; 2]> {
            let answers = self.answers.iter().filter(|answer| {
                is_covered(&self.sets[answer.repeat], answer.frame, answer.split) == covered
            });
            answers
                .filter_map(|answer| {
                    // An exact answer is drawn at the lower end of the axis, a refusal at 1.
                    let lost = (1.0 - answer.iou()?).max(lost_iou::ENDS[0]);
                    Some([answer.view_deg, lost])
                })
                .collect()
        };
        let views = self.answers.iter().map(|answer| answer.view_deg);
        let (least, greatest) = views.fold(
            (FAILURES_BELOW_DEG, NO_FAILURE_ABOVE_DEG),
            |(l, g), view| (l.min(view), g.max(view)),
        );
        // Both limits of the paper are on the axis, whatever the frames show.
        let ends = [(least - 2.0).max(0.0).floor(), (greatest + 2.0).ceil()];
        let mut figure = Figure::new(
            &format!("Field of view: {}", self.name),
            Axis::linear("horizontal field of view (°)").within(ends[0], ends[1]),
            lost_iou::axis(),
        )
        .with(
            Series::new("covered", 1, points(true))
                .with_line(Line::None)
                .with_mark(Mark::Dot),
        )
        .with(
            Series::new("not covered", 2, points(false))
                .with_line(Line::None)
                .with_mark(Mark::Cross),
        );
        if with_paper {
            let line = |name: &str, points: Vec<[f64; 2]>, line| {
                Series::new(name, 0, points)
                    .with_mark(Mark::None)
                    .with_line(line)
            };
            let failure = 1.0 - FAILURE_IOU;
            let upright = |view: f64| vec![[view, lost_iou::ENDS[0]], [view, lost_iou::ENDS[1]]];
            figure = figure
                .with(line(
                    "failures above",
                    vec![[ends[0], failure], [ends[1], failure]],
                    Line::Dotted,
                ))
                .with(line(
                    "paper: failures left",
                    upright(FAILURES_BELOW_DEG),
                    Line::Dashed,
                ))
                .with(line(
                    "paper: none right",
                    upright(NO_FAILURE_ABOVE_DEG),
                    Line::Solid,
                ));
        }
        figure
    }
}

/// Adds the paper's two sentences on failures, tested on the frames that references cover.
fn claims(report: &mut Report) {
    let rows = |forest: &str, bin: ViewBin| -> [(&'static str, String); 3] {
        [
            ("way", format!("{forest}, highlights")),
            ("view", bin.key().to_owned()),
            ("covered", "1".to_owned()),
        ]
    };
    let more_than = |forest: &str, other: ViewBin| {
        let [narrow, other] = [rows(forest, ViewBin::Narrow), rows(forest, other)];
        // `Contrast` copies the texts it is given.
        let narrow = narrow.each_ref().map(|(key, text)| (*key, text.as_str()));
        let other = other.each_ref().map(|(key, text)| (*key, text.as_str()));
        Contrast::over_frames("failed").plus(&narrow).minus(&other)
    };
    for (words, other) in [
        (
            format!(
                "Failures lie below about {FAILURES_BELOW_DEG}°: share of failures below, minus \
                 that from {FAILURES_BELOW_DEG}° to {NO_FAILURE_ABOVE_DEG}°"
            ),
            ViewBin::Middle,
        ),
        (
            format!(
                "There are none above {NO_FAILURE_ABOVE_DEG}°: share of failures below \
                 {FAILURES_BELOW_DEG}°, minus that above {NO_FAILURE_ABOVE_DEG}°"
            ),
            ViewBin::Wide,
        ),
    ] {
        Statement {
            comparisons: 2,
            ..Statement::new(
                &words,
                Stated::Positive,
                "of the highlights' frames that a reference covers",
            )
        }
        .test(report, &on_both(|forest| more_than(forest, other)));
    }
}
