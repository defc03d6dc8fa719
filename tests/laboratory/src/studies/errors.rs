//! The distributions of rotation and focal length errors.

use super::sequences::{introduce_again, on_both, sets_of_one_kind};
use crate::inputs::{Masks, Sets};
use crate::progress::Progress;
use crate::report::contrast::{Contrast, Statement};
use crate::report::paper::ROTATION;
use crate::report::{Report, Stated};
use crate::scoring::answers::{FoundCamera, FrameAnswer, Tally, frame_table, tally_table};
use crate::scoring::forests::ForestKind;
use crate::sets::SetKind;
use crate::{ExperimentError, SharedInputs};
use touchline::report::figure::{Axis, Figure, Line, Mark, Series};
use touchline::report::{Cell, Table};

/// Runs the experiment.
///
/// # Errors
/// The frames cannot be drawn or read.
pub fn run(inputs: &SharedInputs, progress: Progress) -> Result<Report, ExperimentError> {
    let one = inputs.highlights(progress)?;
    let mut report = Report::new(
        "errors",
        &one[0].heading("Errors: cumulative distributions"),
    );
    let chosen = sets_of_one_kind(inputs, progress)?;
    for (name, which) in &chosen {
        // The experiment that describes the frames.
        let experiment = if *which == Sets::WorldCup {
            "worldcup"
        } else {
            "highlights"
        };
        introduce_again(
            &mut report,
            inputs.sets(*which, progress)?,
            experiment,
            name,
        );
    }
    let mut by_set: Vec<(String, &[FrameAnswer])> = Vec::new();
    for (name, sets) in &chosen {
        for kind in ForestKind::PAPER_FIRST {
            let answers = inputs.answers(*sets, kind, Masks::AsTheyAre, progress)?;
            by_set.push((format!("{name}, {}", kind.key()), answers));
        }
    }
    for (stem, label, of) in [
        (
            "rotation",
            "rotation error (°)",
            (|found| found.error.rotation.degrees()) as fn(&FoundCamera) -> f64,
        ),
        ("focal", "focal length error (px)", |found| {
            found.error.focal_px.abs()
        }),
    ] {
        let mut figure = Figure::new(
            &format!("Distribution of the {label}"),
            Axis::log(label),
            Axis::linear("share of frames").within(0.0, 1.0),
        );
        for (number, (name, answers)) in by_set.iter().enumerate() {
            let values: Vec<f64> = answers
                .iter()
                // The curve is a share of all frames, so that refused ones lower its end.
                .filter_map(|answer| answer.found.as_ref())
                .map(of)
                .collect();
            // Published and default forests alternate in `by_set`.
            let line = if number % 2 == 0 {
                Line::Solid
            } else {
                Line::Dashed
            };
            figure = figure
                .with(Series::cumulative(name, number + 1, &values, answers.len()).with_line(line));
        }
        if stem == "rotation" && one[0].kind != SetKind::Own {
            let (degrees, share) = ROTATION;
            figure = figure.with(
                Series::new("paper", 0, vec![[degrees, share]])
                    .with_line(Line::None)
                    .with_mark(Mark::Square),
            );
        }
        report.figure(
            stem,
            &format!("Share of all frames within a {label}; refused frames count as never."),
            figure,
        );
    }
    let tallies: Vec<(Cell, Tally)> = by_set
        .iter()
        .map(|(name, answers)| (name.as_str().into(), Tally::from_answers(answers.iter())))
        .collect();
    report.table(
        "summary",
        "In numbers.",
        tally_table(("set", "frames, forest"), &tallies),
    );
    let mut every = Table::default();
    for (name, which) in &chosen {
        // Rows of one set refer to its frames by index. No name of a set begins with another one.
        let ways = by_set.iter().filter(|(way, _)| way.starts_with(name));
        let ways = ways.map(|(way, answers)| (way, *answers));
        let table = frame_table(inputs.sets(*which, progress)?, ways);
        every.append(table);
    }
    report.data("frames", "Every frame, by forest.", every);
    if one[0].kind == SetKind::Drawn {
        claims(&mut report, &chosen);
    }
    Ok(report)
}

/// Adds the paper's two sentences on errors.
fn claims(report: &mut Report, chosen: &[(&str, Sets)]) {
    let (degrees, share) = ROTATION;
    for (name, _) in chosen {
        let within = |kind: &str| {
            let way = format!("{name}, {kind}");
            Contrast::over_frames("right").plus(&[("way", &way)])
        };
        Statement {
            comparisons: chosen.len(),
            ..Statement::new(
                &format!(
                    "Rotation error below {degrees}° for more than about {:.0} % of the images: {name}",
                    100.0 * share
                ),
                Stated::AtLeast(share),
                "refused counts as not below",
            )
        }
        .test(report, &on_both(within));
    }
    Statement::new(
        "Focal length errors are small, smallest on the World Cup data",
        Stated::Nothing,
        "the paper gives no number, and ours are below what its figure can show: see the table's file for the medians",
    )
    .test(report, &[]);
}
