//! `touchline evaluate`: how far one document's cameras are from another's.

use super::Outcome;
use super::document::{DocumentArg, Loaded};
use super::messages::Messages;
use super::output::{print, refuse_existing, write_file};
use crate::experiments::{Cell, Column, Table};
use crate::project::{Evaluation, Group, GroupKind, Measure, evaluate as evaluated};
use crate::score::Summary;
use serde_json::{Map, Value, json};
use std::fmt::Write as _;
use std::io::IsTerminal as _;
use std::path::{Path, PathBuf};

/// Compares the cameras of a document with those (or the clicks) of another one: `IoU`, angles, focal length, reprojection,
/// markings found.
///
/// Frames are matched by where their pictures lie, by SHA-256, or by name; frames without a partner or a camera are named, and
/// the exit code is 1. Clicks of the truth that the estimate was not made from count as held out. Standard output gets a
/// table on a terminal, JSON otherwise.
#[derive(clap::Args, Debug)]
pub struct EvaluateArgs {
    /// The document that is right: cameras, clicks, or both.
    #[arg(value_name = "TRUTH")]
    truth: PathBuf,
    /// The document that is judged.
    #[arg(value_name = "ESTIMATE")]
    estimate: PathBuf,
    /// The file to write; its ending chooses: .json everything, .csv a line for each frame, .md tables.
    #[arg(short, long, value_name = "FILE", value_parser = known_ending)]
    output: Option<PathBuf>,
    /// Print the table, also where standard output is no terminal.
    #[arg(long)]
    table: bool,
    /// Decides the resamples of the bootstrap intervals.
    #[arg(long, value_name = "S", default_value_t = 0)]
    seed: u64,
    /// Replace an existing file.
    #[arg(long)]
    force: bool,
}

fn known_ending(text: &str) -> Result<PathBuf, String> {
    let path = PathBuf::from(text);
    match ending(&path).as_str() {
        "json" | "csv" | "md" => Ok(path),
        _ => Err("the name must end with .json, .csv or .md".to_owned()),
    }
}

fn ending(path: &Path) -> String {
    path.extension().map(|ending| ending.to_string_lossy().to_ascii_lowercase()).unwrap_or_default()
}

/// How many frames of the estimate that have no truth are named.
const NAMED: usize = 5;

/// Carries out the command.
///
/// # Errors
/// A document cannot be read, a field is not valid, the truth holds nothing, or the result cannot be written.
pub fn evaluate(args: &EvaluateArgs, messages: Messages) -> anyhow::Result<Outcome> {
    if let Some(path) = &args.output {
        refuse_existing(path, args.force)?;
    }
    let read = |document: &PathBuf| DocumentArg { document: document.clone() }.load(messages);
    let Loaded { location: true_location, document: truth } = read(&args.truth)?;
    let Loaded { location, document: estimate } = read(&args.estimate)?;
    let evaluation = evaluated((&truth, true_location.folder()), (&estimate, location.folder()))?;
    let groups = evaluation.groups(args.seed);
    for frame in &evaluation.frames {
        if let Err(reason) = &frame.scores {
            messages.frame_failed(&frame.name, &reason.to_string());
        }
    }
    if let Some(note) = without_truth(&evaluation.without_truth) {
        messages.note(&note);
    }
    let as_json = || format!("{:#}\n", report(&evaluation, &groups));
    match &args.output {
        Some(path) => {
            let text = match ending(path).as_str() {
                "csv" => frame_table(&evaluation).to_csv(),
                "md" => tables(&groups, Table::to_markdown),
                _ => as_json(),
            };
            write_file(path, text.as_bytes(), args.force)?;
            if args.table {
                print(&tables(&groups, Table::to_text))?;
            }
        }
        None if args.table || (messages == Messages::Text && std::io::stdout().is_terminal()) => {
            print(&tables(&groups, Table::to_text))?;
        }
        None => print(&as_json())?,
    }
    let all_scored = evaluation.frames.iter().all(|frame| frame.scores.is_ok());
    Ok(if all_scored { Outcome::Done } else { Outcome::SomeFailed })
}

fn without_truth(names: &[String]) -> Option<String> {
    let (count, shown) = (names.len(), names.iter().take(NAMED).cloned().collect::<Vec<_>>().join(", "));
    let more = if count > NAMED { format!(" and {} more", count - NAMED) } else { String::new() };
    (count > 0).then(|| format!("{count} frames of the estimate have no truth and are left out: {shown}{more}"))
}

/// A line for each frame.
fn frame_table(evaluation: &Evaluation) -> Table {
    let mut table = Table::new(&[("frame", "Frame"), ("clip", "Clip"), ("camera", "Camera"), ("view_deg", "View (°)")]);
    table.columns.extend(Measure::ALL.map(|measure| Column::new(measure.key(), measure.label())));
    table.columns.push(Column::new("unscored", "Why there is no score"));
    for frame in &evaluation.frames {
        let clip = frame.clip.as_ref().map(ToString::to_string);
        let view = frame.view.map(crate::geometry::Angle::degrees);
        let mut row: Vec<Cell> =
            vec![frame.name.as_str().into(), clip.into(), frame.camera.as_str().into(), view.into()];
        let scores = frame.scores.as_ref();
        row.extend(Measure::ALL.map(|measure| Cell::from(scores.ok().and_then(|scores| scores.get(measure)))));
        row.push(scores.err().map(ToString::to_string).into());
        table.push(row);
    }
    table
}

/// All frames together by measure, then group by group.
fn tables(groups: &[Group], write: fn(&Table) -> String) -> String {
    let mut text = String::new();
    let Some(all) = groups.first() else { return text };
    // Writing to a string cannot fail.
    let _ = writeln!(
        text,
        "{} of {} frames have a camera (completeness {:.3}).\n",
        all.scored,
        all.frames,
        all.completeness()
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
        let _ = writeln!(text, "\nMean JaC@5 × completeness: {score:.3}.");
    }
    if groups.len() > 1 {
        text.push('\n');
        text.push_str(&write(&group_table(groups)));
    }
    text
}

fn summary_table(group: &Group) -> Table {
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
    let mut add = |name: &str, summary: &Summary, more_is_better: bool| {
        let [low, high] = summary.mean_interval.map(|end| Cell::from(end).to_string());
        let (tenth, worst) = if more_is_better { (summary.p10, summary.min) } else { (summary.p90, summary.max) };
        table.push(vec![
            name.into(),
            summary.count.into(),
            summary.mean.into(),
            format!("{low} to {high}").into(),
            summary.std.into(),
            summary.median.into(),
            tenth.into(),
            worst.into(),
        ]);
    };
    for (measure, summary) in &group.measures {
        add(measure.label(), summary, measure.more_is_better());
    }
    for (name, summary) in [
        ("every click used (px)", &group.clicks_px),
        ("every click held out (px)", &group.held_out_px),
        ("every click held out (m)", &group.held_out_m),
    ] {
        if let Some(summary) = summary {
            add(name, summary, false);
        }
    }
    table
}

/// Medians by group.
fn group_table(groups: &[Group]) -> Table {
    const SHOWN: [Measure; 6] = [
        Measure::IouPart,
        Measure::Rotation,
        Measure::FocalPercent,
        Measure::Landmarks,
        Measure::HeldOutClicks,
        Measure::Jaccard5,
    ];
    let mut table =
        Table::new(&[("kind", "by"), ("name", "medians of"), ("frames", "frames"), ("scored", "with a camera")]);
    let shown = SHOWN.into_iter().filter(|measure| groups.iter().any(|group| group.measure(*measure).is_some()));
    let shown: Vec<Measure> = shown.collect();
    table.columns.extend(shown.iter().map(|measure| Column::new(measure.key(), measure.label())));
    for group in groups {
        let kind = match group.kind {
            GroupKind::All => "",
            kind => kind.key(),
        };
        let mut row: Vec<Cell> =
            vec![kind.into(), group.name.as_str().into(), group.frames.into(), group.scored.into()];
        row.extend(shown.iter().map(|measure| Cell::from(group.measure(*measure).map(|summary| summary.median))));
        table.push(row);
    }
    table
}

/// Everything, for scripts.
fn report(evaluation: &Evaluation, groups: &[Group]) -> Value {
    json!({
        "summary": groups.first().map(described_group),
        "groups": groups.iter().skip(1).map(described_group).collect::<Vec<_>>(),
        "frames": frame_table(evaluation).to_json(),
        "without_truth": evaluation.without_truth,
    })
}

fn described_group(group: &Group) -> Value {
    let measures: Map<String, Value> =
        group.measures.iter().map(|(measure, summary)| (measure.key().to_owned(), described(summary))).collect();
    let mut value = json!({
        "by": group.kind.key(),
        "name": group.name,
        "frames": group.frames,
        "scored": group.scored,
        "completeness": group.completeness(),
        "soccernet_score": group.soccernet_score(),
        "measures": measures,
    });
    for (key, summary) in [
        ("every_click_px", &group.clicks_px),
        ("every_held_out_click_px", &group.held_out_px),
        ("every_held_out_click_m", &group.held_out_m),
    ] {
        if let Some(summary) = summary {
            value[key] = described(summary);
        }
    }
    if let Some(coverage) = &group.coverage {
        value["coverage"] = json!({
            "count": coverage.count,
            "within_68": coverage.within_68,
            "within_95": coverage.within_95,
            "error_over_sigma": coverage.error_over_sigma,
        });
    }
    value
}

fn described(summary: &Summary) -> Value {
    json!({
        "count": summary.count, "mean": summary.mean, "mean_interval_95": summary.mean_interval, "std": summary.std,
        "min": summary.min, "p10": summary.p10, "p25": summary.p25, "median": summary.median,
        "median_interval_95": summary.median_interval, "p75": summary.p75, "p90": summary.p90, "p95": summary.p95,
        "max": summary.max,
    })
}
