//! `touchline evaluate`: measures how far the cameras of one document are from those of another.

use crate::cli::Outcome;
use crate::cli::terminal::document::Loaded;
use crate::cli::terminal::messages::Messages;
use crate::cli::terminal::output::{
    ending, print, refuse_existing, refuse_existing_file, refuse_file, write_file, write_report,
};
use serde_json::{Map, Value, json};
use std::io::IsTerminal as _;
use std::path::PathBuf;
use touchline_calibration::evaluate::{
    Agreement, Evaluation, FrameGroup, GroundComparison, agreement, agreement_json,
    agreement_tables, compare_on_ground, evaluate as evaluated, evaluation_report,
    evaluation_tables, frame_scores,
};
use touchline_core::geometry::pluralise;
use touchline_documents::exchange::read_picture_points;
use touchline_documents::report::Table;

/// Compares the cameras of a document with those (or the clicks) of another one: `IoU`, angles,
/// focal length, reprojection, markings found.
///
/// Frames are matched by where their pictures lie, by SHA-256, or by name; frames without a partner
/// or a camera are named, and the exit code is 1. Clicks of the truth that the estimate was not
/// made from count as held out. Where both hold clicks of their own on the same frames, they are
/// compared as two annotators' as well: distances by landmark, names that differ, and the click
/// noise.
///
/// JaC@t is the `SoccerNet` task's: the share of markings all of whose annotated points lie nearer
/// than t px (of a picture 960 px wide) to the estimate's, among all that either shows; the better
/// of the names as they are and turned by half a turn, at every t for itself; a circle that leaves
/// the picture is joined where it comes back. Ends of straight markings, nine points of round ones.
/// The task's own script draws markings more coarsely and gives up to 0.05 less.
///
/// Where both have a camera, the ground that they see at the same image points is compared in
/// metres: at the points of `--points`, else on a grid over the visible field.
///
/// Standard output gets a table on a terminal, JSON otherwise.
#[derive(clap::Args, Debug)]
pub struct EvaluateArgs {
    /// The truth: a document with cameras, clicks, or both.
    #[arg(value_name = "TRUTH")]
    truth: PathBuf,
    /// The document to be evaluated.
    #[arg(value_name = "ESTIMATE")]
    estimate: PathBuf,
    /// The file to write; its ending chooses: .json everything, .csv a line for each frame, .md
    /// tables.
    #[arg(short, long, value_name = "FILE", value_parser = parse_report_path)]
    output: Option<PathBuf>,
    /// A folder for a report: tables, and figures of the errors as SVG and PNG.
    #[arg(long, value_name = "DIR")]
    report: Option<PathBuf>,
    /// Print the table, also where standard output is no terminal.
    #[arg(long)]
    table: bool,
    /// Image points whose places on the ground are compared, such as players' feet: MOT
    /// (`frame,id,left,top,width,height`, frames from 1), CVAT's XML, or CSV (`frame,x,y[,w,h]`,
    /// frames from 0 or names). Of a box it is the middle of the lower side.
    #[arg(long, value_name = "FILE")]
    points: Option<PathBuf>,
    /// The seed of the bootstrap intervals.
    #[arg(long, value_name = "S", default_value_t = 0)]
    seed: u64,
    /// Replace an existing file.
    #[arg(long)]
    force: bool,
}

fn parse_report_path(text: &str) -> Result<PathBuf, String> {
    let path = PathBuf::from(text);
    match ending(&path).as_str() {
        "json" | "csv" | "md" => Ok(path),
        _ => Err("the name must end with .json, .csv or .md".to_owned()),
    }
}

/// Maximum number of frames without truth that a message names.
const NAMED: usize = 5;

/// Evaluates a document and writes or prints the result. [`Outcome::SomeFailed`] if a frame has no
/// score.
///
/// # Errors
/// A document cannot be read, a field is invalid, the truth has neither cameras nor clicks, or the
/// result cannot be written.
pub fn evaluate(args: &EvaluateArgs, messages: Messages) -> anyhow::Result<Outcome> {
    if let Some(file) = &args.output {
        refuse_existing_file(file, args.force)?;
    }
    if let Some(folder) = &args.report {
        refuse_existing(folder, args.force)?;
        refuse_file(folder, "the report")?;
    }
    let Loaded {
        location: true_location,
        document: truth,
    } = Loaded::read(&args.truth, messages)?;
    let Loaded {
        location,
        document: estimate,
    } = Loaded::read(&args.estimate, messages)?;
    let (truth_at, estimate_at) = (
        truth.at(true_location.folder()),
        estimate.at(location.folder()),
    );
    let points = args.points.as_deref();
    let points = points.map(read_picture_points).transpose()?;
    // The clicks that the estimate was not made from, and the frames' partners, are found here. The
    // ground is compared apart, because it may be given its own points.
    let evaluation = evaluated(truth_at, estimate_at)?;
    let ground = compare_on_ground(truth_at, estimate_at, points.as_ref())?;
    let groups = evaluation.groups(args.seed);
    // If both documents have their own clicks on the same frames, compare the annotators, too.
    let agreed = agreement(truth_at, estimate_at)?;
    let agreed = agreed.says_something().then_some(agreed);
    // A frame without a score is named and decides the exit code; a frame of the estimate without
    // truth is no failure of the estimate, and is only noted.
    let frames = evaluation.frames.iter();
    messages.frames_failed(
        frames.filter_map(|frame| Some((&frame.name, frame.scores.as_ref().err()?))),
    );
    if let Some(note) = without_truth(&evaluation.without_truth) {
        messages.note(&note);
    }
    if let Some(folder) = &args.report {
        write_report(&evaluation_report(&evaluation, &groups), folder, args.force)?;
    }
    let as_json = || {
        let report = report(&evaluation, &groups, agreed.as_ref(), &ground);
        format!("{report:#}\n")
    };
    let as_tables = |write: fn(&Table) -> String| {
        let mut text = evaluation_tables(&groups, write);
        text.push('\n');
        text.push_str(&ground.to_text());
        if let Some(agreed) = &agreed {
            text.push('\n');
            text.push_str(&agreement_tables(agreed, write));
        }
        text
    };
    // To a file in the format of its ending, else a table to a terminal and JSON to a pipe.
    match &args.output {
        Some(path) => {
            let text = match ending(path).as_str() {
                "csv" => frame_scores(&evaluation).to_csv(),
                "md" => as_tables(Table::to_markdown),
                _ => as_json(),
            };
            write_file(path, text.as_bytes(), args.force)?;
            if args.table {
                print(&as_tables(Table::to_text))?;
            }
        }
        None if args.table || (messages == Messages::Text && std::io::stdout().is_terminal()) => {
            print(&as_tables(Table::to_text))?;
        }
        None => print(&as_json())?,
    }
    let all_scored = evaluation.frames.iter().all(|frame| frame.scores.is_ok());
    Ok(Outcome::from_failure(!all_scored))
}

/// A message about frames of the estimate without truth; `None` if there are none.
fn without_truth(names: &[String]) -> Option<String> {
    let count = names.len();
    let shown = names[..count.min(NAMED)].join(", ");
    let more = if count > NAMED {
        format!(" and {} more", count - NAMED)
    } else {
        String::new()
    };
    let frames = pluralise(count, "frame");
    (count > 0).then(|| format!("{frames} of the estimate without truth, left out: {shown}{more}"))
}

/// The complete result as JSON.
fn report(
    evaluation: &Evaluation,
    groups: &[FrameGroup],
    agreed: Option<&Agreement>,
    ground: &GroundComparison,
) -> Value {
    let mut report = json!({
        // The first group is that of all frames.
        "summary": groups.first().map(group_json),
        "groups": groups.iter().skip(1).map(group_json).collect::<Vec<_>>(),
        "frames": frame_scores(evaluation).to_json(),
        "without_truth": evaluation.without_truth,
        "ground": ground.to_json(),
    });
    if let Some(agreed) = agreed {
        report["agreement"] = agreement_json(agreed);
    }
    report
}

fn group_json(group: &FrameGroup) -> Value {
    let measures: Map<String, Value> = group
        .measures
        .iter()
        .map(|(measure, summary)| (measure.key().to_owned(), json!(summary)))
        .collect();
    let mut value = json!({
        "by": group.kind.key(),
        "name": group.name,
        "image_sizes_px": group.image_sizes,
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
            value[key] = json!(summary);
        }
    }
    if let Some(coverage) = &group.coverage {
        value["coverage"] = json!(coverage);
    }
    value
}
