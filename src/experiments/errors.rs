//! The distributions of rotation and focal length errors.

use super::answers::{
    FoundCamera, FrameAnswer, TALLY_EXPLAINED, Tally, difference, over_seeds, tally_table,
};
use super::forests::ForestKind;
use super::inputs::{Masks, Sets};
use super::paper::ROTATION;
use super::progress::Progress;
use super::sequences::introduce;
use super::sets::SetKind;
use super::{ExperimentError, SharedInputs};
use touchline_documents::report::figure::{Axis, Figure, Line, Mark, Series};
use touchline_documents::report::{Cell, Report, Verdict};

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
    let mut chosen = vec![("highlights", Sets::Highlights)];
    match one[0].kind {
        SetKind::Own => chosen[0].0 = "own frames",
        // Published and drawn frames share no diagram.
        kind if inputs.worldcup(progress)?[0].kind == kind => {
            chosen.push(("World Cup", Sets::WorldCup));
        }
        _ => {}
    }
    for (_, sets) in &chosen {
        introduce(&mut report, inputs.sets(*sets, progress)?, "");
    }
    let mut by_set: Vec<(String, &[FrameAnswer])> = Vec::new();
    for (name, sets) in &chosen {
        for kind in ForestKind::BOTH {
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
            "",
            Axis::log(label),
            Axis::linear("share of frames").within(0.0, 1.0),
        );
        for (number, (name, answers)) in by_set.iter().enumerate() {
            let values: Vec<f64> = answers
                .iter()
                .filter_map(|answer| answer.found.as_ref())
                .map(of)
                .collect();
            let line = if number % 2 == 0 {
                Line::Solid
            } else {
                Line::Dashed
            };
            figure = figure
                .with(Series::cumulative(name, number + 1, &values, answers.len()).lined(line));
        }
        if stem == "rotation" && one[0].kind != SetKind::Own {
            let (degrees, share) = ROTATION;
            figure = figure.with(
                Series::new("paper", 0, vec![[degrees, share]])
                    .lined(Line::None)
                    .marked(Mark::Square),
            );
        }
        report.figure(
            stem,
            &format!("Share of all frames asked within a {label}; frames that were not found count as never."),
            figure,
        );
    }
    let tallies: Vec<(Cell, Tally)> = by_set
        .iter()
        .map(|(name, answers)| (name.as_str().into(), Tally::of(answers.iter())))
        .collect();
    report.text(TALLY_EXPLAINED);
    report.table(
        "summary",
        "In numbers.",
        tally_table(("set", "set and forest"), &tallies),
    );
    let (degrees, share) = ROTATION;
    if one[0].kind != SetKind::Own {
        let within = |answers: Vec<&FrameAnswer>| Tally::of(answers.into_iter()).within_rotation;
        let intervals: Vec<[f64; 2]> = by_set
            .iter()
            .map(|(_, answers)| over_seeds(*answers, within))
            .collect();
        let shown = tallies
            .iter()
            .zip(&intervals)
            .map(|((name, tally), [low, high])| {
                let [mean, low, high] =
                    [tally.within_rotation, *low, high.min(1.0)].map(|share| 100.0 * share);
                format!("{name} {mean:.0} % ({low:.0} to {high:.0})")
            });
        report.claim(
            Verdict::all(
                intervals
                    .iter()
                    .map(|interval| Verdict::above(*interval, share)),
            ),
            &format!(
                "Rotation error below {degrees}° for more than about {:.0} % of the images",
                100.0 * share
            ),
            &shown.collect::<Vec<_>>().join(", "),
            "not found counts as not below",
        );
    }
    if let ([(_, one), _, (_, other), _], [(_, highlights), _, (_, world_cup), _]) =
        (&tallies[..], &by_set[..])
    {
        report.claim(
            Verdict::above(difference(*highlights, *world_cup, |tally| tally.focal_median_px), 0.0),
            "Focal length errors are small, smallest on the World Cup data",
            &format!(
                "median of the found frames, default forest: highlights {:.2} px, World Cup {:.2} px",
                one.focal_median_px, other.focal_median_px
            ),
            "",
        );
    }
    Ok(report)
}
