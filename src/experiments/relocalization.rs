//! The forest on sequences: by sequence, by field of view, by gate and by number of trees.

use super::answers::{AskedFrame, FoundCamera, Tally, ask_plainly, by_name, tally_table};
use super::progress::Progress;
use super::sets::{FrameSet, SetKind};
use super::{ExperimentError, SharedInputs};
use crate::geometry::AngleRange;
use crate::media::FrameReader;
use crate::proposals::overlay_error_px;
use crate::relocalize::{PredictOptions, RelocalizeOptions, TrainOptions};
use crate::report::figure::{Axis, Figure, Line, Mark, Series};
use crate::report::{Cell, Column, Report, SheetFrame, Table, contact_sheet};
use crate::score::quantile;

/// The gates of the `threshold` experiment: squared distances of descriptors of unit length.
const GATES: [f32; 6] = [0.05, 0.1, 0.2, 0.3, 0.45, 0.6];
/// Rotation errors within which frames are counted, degrees.
const WITHIN_DEG: [f64; 4] = [0.005, 0.01, 0.02, 0.1];
/// The same for frames whose truth was fitted to clicks.
const WITHIN_FITTED_DEG: [f64; 4] = [0.02, 0.05, 0.1, 0.5];
/// How many frames the contact sheet shows.
const SHEET_FRAMES: usize = 6;
/// How many of the worst frames are named.
const WORST_SHOWN: usize = 5;
/// Errors of the overlay within which frames are counted, px at 1920 px width.
const OVERLAY_PX: [f64; 4] = [2.0, 5.0, 10.0, 20.0];

fn training(inputs: &SharedInputs) -> TrainOptions {
    TrainOptions { seed: inputs.options.seed, ..TrainOptions::default() }
}

fn asking(inputs: &SharedInputs) -> RelocalizeOptions {
    let mut options = RelocalizeOptions::default();
    options.pose.seed = inputs.options.seed;
    options
}

fn ask_set(inputs: &SharedInputs, set: &FrameSet) -> Vec<AskedFrame> {
    ask_plainly(set, &training(inputs), &asking(inputs))
}

/// Says what the frames are.
fn introduce(report: &mut Report, set: &FrameSet, words: &str) {
    report.text(&format!("Frames: {}. {} {words}", set.title, set.protocol));
}

/// What the paper's sets are, for those who compare.
const PAPERS_SETS: &str = "The paper's own sets (its table 2) are four sequences of 29 frames and two games of 42 and 33; it \
    states an IoU of .83 with SIFT. Of one of its sequences the cameras are published: pan 49.2 to 69.8°, tilt −10.1 to −5.9°, \
    focal length 1917 to 4228 px.";

/// Four sequences of 29 frames, each asked of the other three (the paper's `highlights`).
pub fn highlights(inputs: &SharedInputs, progress: Progress) -> Result<Report, ExperimentError> {
    let set = inputs.highlights(progress)?;
    let own = set.kind == SetKind::Own;
    let heading = if own { "Sequences: asked of other sequences" } else { "Highlights: sequences of one match" };
    let mut report = Report::new("highlights", &set.heading(heading));
    introduce(&mut report, set, "");
    if !own {
        report.text(PAPERS_SETS);
    }
    sequences(&mut report, inputs, set)?;
    Ok(report)
}

/// Two games of 42 and 33 frames, half of them for training (the paper's `worldcup`).
pub fn worldcup(inputs: &SharedInputs, progress: Progress) -> Result<Report, ExperimentError> {
    let set = inputs.worldcup(progress)?;
    let mut report = Report::new("worldcup", &set.heading("World Cup: games"));
    introduce(&mut report, set, "");
    sequences(&mut report, inputs, set)?;
    Ok(report)
}

fn sequences(report: &mut Report, inputs: &SharedInputs, set: &FrameSet) -> Result<(), ExperimentError> {
    let asked = ask_set(inputs, set);
    let parts = by_name(set, &asked);
    let tallies: Vec<(Cell, Tally)> =
        parts.iter().map(|(name, asked)| ((*name).into(), Tally::of(asked.iter().copied()))).collect();
    report.table("sequences", "By sequence.", tally_table(("sequence", "sequence"), &tallies));
    // Drawn frames are all within the least bound.
    if set.kind != SetKind::Drawn {
        overlays(report, set, &asked, &parts);
    }
    let ranges = parts.iter().filter(|(name, _)| *name != "all");
    let ranges = ranges.map(|(name, asked)| ranges_row(set, name, asked));
    let mut table = Table::new(&[
        ("sequence", "sequence"),
        ("pan_deg", "pan (°)"),
        ("tilt_deg", "tilt (°)"),
        ("focal_px", "focal length (px)"),
    ]);
    ranges.for_each(|row| table.push(row));
    report.table("ranges", "Where the frames look.", table);
    report.figure("views", "Fields of view of the frames asked.", view_distribution(&asked));
    let mut times = Table::new(&[("step", "step"), ("median_ms", "median (ms)"), ("p90_ms", "90 % (ms)")]);
    for (step, of) in [
        ("asking the forest", (|asked: &AskedFrame| asked.predict_ms) as fn(&AskedFrame) -> f64),
        ("finding the camera", |asked| asked.pose_ms),
    ] {
        let mut values: Vec<f64> = asked.iter().map(of).collect();
        values.sort_by(f64::total_cmp);
        times.push(vec![step.into(), quantile(&values, 0.5).into(), quantile(&values, 0.9).into()]);
    }
    report.time_table(
        "steps-times",
        "One frame, features found already; other frames were asked at the same time.",
        times,
    );
    if let Some(png) = contact_sheet(&worst_to_best(set, &asked)?)? {
        report.picture(
            "sheet",
            "Six frames from the worst to the best: the answer's lines over the picture; from above what the picture shows by the \
             true camera (blue) and by the answer (orange).",
            png,
        );
    }
    Ok(())
}

/// Six of the frames asked, from the worst to the best.
fn worst_to_best<'a>(set: &'a FrameSet, asked: &[AskedFrame]) -> Result<Vec<SheetFrame<'a>>, ExperimentError> {
    let mut order: Vec<&AskedFrame> = asked.iter().collect();
    let iou = |asked: &AskedFrame| asked.found.map_or(-1.0, |found| found.iou.unwrap_or(0.0));
    order.sort_by(|a, b| iou(a).total_cmp(&iou(b)));
    let tiles = SHEET_FRAMES.min(order.len());
    let chosen = (0..tiles).map(|tile| order[tile * (order.len() - 1) / (tiles - 1).max(1)]);
    let mut reader = FrameReader::new();
    let sheet_frame = |asked: &AskedFrame| {
        let known = &set.frames[asked.frame];
        let caption = match asked.found {
            Some(found) => format!("view {:.0}°, IoU {:.4}", asked.view_deg, found.iou.unwrap_or(f64::NAN)),
            None => format!("view {:.0}°, not found", asked.view_deg),
        };
        Ok(SheetFrame {
            picture: known.picture(&mut reader)?,
            caption,
            field: &known.field,
            truth: known.truth,
            estimate: asked.found.map(|found| found.camera),
        })
    };
    chosen.map(sheet_frame).collect()
}

/// How far the overlay is off where a label may be wrong itself: shares of frames, and the worst frames by name.
fn overlays(report: &mut Report, set: &FrameSet, asked: &[AskedFrame], parts: &[(&str, Vec<&AskedFrame>)]) {
    report.table(
        "overlay",
        "Share of all frames asked whose overlay is right within some pixels where it is off most (5 × 3 points of the picture, \
         at 1920 px width).",
        overlay_table(set, parts),
    );
    let mut order: Vec<(f64, &AskedFrame)> =
        asked.iter().map(|asked| (error_px(set, asked).unwrap_or(f64::INFINITY), asked)).collect();
    order.sort_by(|a, b| b.0.total_cmp(&a.0));
    let mut table = Table::new(&[
        ("frame", "frame"),
        ("sequence", "sequence"),
        ("overlay_px", "overlay off by (px)"),
        ("iou", "IoU"),
        ("warnings", "what the document warns of"),
    ]);
    for (error_px, asked) in order.into_iter().take(WORST_SHOWN) {
        let known = &set.frames[asked.frame];
        table.push(vec![
            known.name.as_str().into(),
            set.splits[asked.split].name.as_str().into(),
            error_px.into(),
            asked.found.and_then(|found| found.iou).into(),
            Some(known.warnings.clone()).filter(|warnings| !warnings.is_empty()).into(),
        ]);
    }
    report.table("worst", "The worst frames. A wrong label counts here as a wrong answer.", table);
}

/// How far the overlay of an answer is off, px at 1920 px width; none where there is no answer.
fn error_px(set: &FrameSet, asked: &AskedFrame) -> Option<f64> {
    let known = &set.frames[asked.frame];
    Some(overlay_error_px(&known.truth, &asked.found?.camera, known.features.image_size))
}

/// Shares of the frames asked, those that were not found among them.
fn overlay_table(set: &FrameSet, parts: &[(&str, Vec<&AskedFrame>)]) -> Table {
    let mut table = Table::new(&[("sequence", "sequence"), ("frames", "frames")]);
    for within in OVERLAY_PX {
        table.columns.push(Column::new(&format!("within_{within}_px"), &format!("within {within} px")));
    }
    for (name, asked) in parts {
        let errors: Vec<f64> = asked.iter().filter_map(|asked| error_px(set, asked)).collect();
        let mut row: Vec<Cell> = vec![(*name).into(), asked.len().into()];
        let share = |within: f64| errors.iter().filter(|error| **error <= within).count() as f64 / asked.len() as f64;
        row.extend(OVERLAY_PX.map(|within| Cell::Number(share(within))));
        table.push(row);
    }
    table
}

fn ranges_row(set: &FrameSet, name: &str, asked: &[&AskedFrame]) -> Vec<Cell> {
    let range = |of: &dyn Fn(usize) -> f64, digits: usize| -> Cell {
        let values = asked.iter().map(|asked| of(asked.frame));
        let (low, high) = values.fold((f64::INFINITY, f64::NEG_INFINITY), |(l, h), v| (l.min(v), h.max(v)));
        format!("{low:.digits$} to {high:.digits$}").into()
    };
    let ptz = |frame: usize| set.frames[frame].truth.ptz();
    let pans = AngleRange::smallest(asked.iter().map(|asked| ptz(asked.frame).pan)).unwrap_or(AngleRange::FULL);
    vec![
        name.into(),
        format!("{:.1} to {:.1}", pans.start().degrees(), pans.end().wrapped().degrees()).into(),
        range(&|frame| ptz(frame).tilt.degrees(), 1),
        range(&|frame| ptz(frame).focal_px, 0),
    ]
}

fn view_distribution(asked: &[AskedFrame]) -> Figure {
    let views: Vec<f64> = asked.iter().map(|asked| asked.view_deg).collect();
    Figure::new("", Axis::linear("horizontal field of view (°)"), Axis::linear("share of frames").within(0.0, 1.0))
        .with(Series::cumulative("", 1, &views, views.len()))
}

/// The distribution of rotation and focal length errors.
pub fn errors(inputs: &SharedInputs, progress: Progress) -> Result<Report, ExperimentError> {
    let (one, two) = (inputs.highlights(progress)?, inputs.worldcup(progress)?);
    let mut report = Report::new("errors", &one.heading("Errors: cumulative distributions"));
    let sets = match (one.kind, two.kind) {
        (SetKind::Own, _) => vec![("own frames", one)],
        (of_one, of_two) if of_one == of_two => vec![("highlights", one), ("World Cup", two)],
        // Published and drawn frames share no diagram.
        _ => vec![("highlights", one)],
    };
    let asked: Vec<(&str, Vec<AskedFrame>)> = sets.iter().map(|(name, set)| (*name, ask_set(inputs, set))).collect();
    for (name, set) in &sets {
        introduce(&mut report, set, &format!("Below: {name}."));
    }
    for (stem, label, of) in [
        ("rotation", "rotation error (°)", (|found| found.error.rotation.degrees()) as fn(&FoundCamera) -> f64),
        ("focal", "focal length error (px)", |found| found.error.focal_px.abs()),
    ] {
        let mut figure = Figure::new("", Axis::log(label), Axis::linear("share of frames").within(0.0, 1.0));
        for (number, (name, asked)) in asked.iter().enumerate() {
            let values: Vec<f64> = asked.iter().filter_map(|asked| asked.found.as_ref()).map(of).collect();
            let line = if number == 0 { Line::Solid } else { Line::Dashed };
            figure = figure.with(Series::cumulative(name, number + 1, &values, asked.len()).lined(line));
        }
        report.figure(
            stem,
            &format!("Share of frames within a {label}; frames that were not found count as never."),
            figure,
        );
    }
    let tallies: Vec<(Cell, Tally)> =
        asked.iter().map(|(name, asked)| ((*name).into(), Tally::of(asked.iter()))).collect();
    report.table("summary", "In numbers.", tally_table(("set", "set"), &tallies));
    Ok(report)
}

/// The gate on descriptors' distances (the paper's table 4).
pub fn threshold(inputs: &SharedInputs, progress: Progress) -> Result<Report, ExperimentError> {
    let set = inputs.highlights(progress)?;
    let mut report = Report::new("threshold", &set.heading("Threshold: the gate on descriptors' distances"));
    introduce(&mut report, set, "A leaf farther than the gate (squared distance of unit descriptors) is no match.");
    let tallies: Vec<(Cell, Tally)> = GATES
        .into_iter()
        .enumerate()
        .map(|(done, gate)| {
            let predict = PredictOptions { max_squared_distance: gate, ..PredictOptions::default() };
            let options = RelocalizeOptions { predict, ..asking(inputs) };
            let asked = ask_plainly(set, &training(inputs), &options);
            progress(done + 1, GATES.len());
            (Cell::Number((f64::from(gate) * 1e6).round() / 1e6), Tally::of(asked.iter()))
        })
        .collect();
    report.table("gates", "By gate; the published one is 0.2.", tally_table(("gate", "gate"), &tallies));
    let found = tallies.iter().map(|(gate, tally)| {
        let Cell::Number(gate) = gate else { return [f64::NAN; 2] };
        [*gate, tally.found as f64 / tally.asked.max(1) as f64]
    });
    let figure = Figure::new(
        "",
        Axis::linear("gate (squared distance)"),
        Axis::linear("share of frames found").within(0.0, 1.05),
    )
    .with(Series::new("", 1, found.collect()));
    report.figure("found", "Frames found by gate.", figure);
    Ok(report)
}

/// One to ten trees: the share of frames within an error.
pub fn trees(inputs: &SharedInputs, progress: Progress) -> Result<Report, ExperimentError> {
    let set = inputs.highlights(progress)?;
    let mut report = Report::new("trees", &set.heading("Trees: how many are needed"));
    introduce(&mut report, set, "Each tree is trained with all training frames.");
    let bounds = if set.kind == SetKind::Drawn { WITHIN_DEG } else { WITHIN_FITTED_DEG };
    let counts: Vec<u32> = if inputs.options.quick { vec![1, 2, 5] } else { (1..=10).collect() };
    let mut table = Table::new(&[("trees", "trees")]);
    for within in bounds {
        table.columns.push(Column::new(&format!("within_{within}_deg"), &format!("within {within}°")));
    }
    table.columns.push(Column::new("found", "found"));
    let mut curves: Vec<Vec<[f64; 2]>> = vec![Vec::new(); bounds.len()];
    for (done, &trees) in counts.iter().enumerate() {
        let asked = ask_plainly(set, &TrainOptions { trees, ..training(inputs) }, &asking(inputs));
        let share = |of: &dyn Fn(&FoundCamera) -> bool| {
            asked.iter().filter_map(|asked| asked.found.as_ref()).filter(|found| of(found)).count() as f64
                / asked.len().max(1) as f64
        };
        let mut row: Vec<Cell> = vec![(trees as usize).into()];
        for (within, curve) in bounds.into_iter().zip(&mut curves) {
            let share = share(&|found| found.error.rotation.degrees() <= within);
            curve.push([f64::from(trees), share]);
            row.push(share.into());
        }
        row.push(share(&|_| true).into());
        table.push(row);
        progress(done + 1, counts.len());
    }
    let marks = [Mark::Disc, Mark::Square, Mark::Triangle, Mark::Cross];
    let mut figure = Figure::new("", Axis::linear("trees"), Axis::linear("share of frames").within(0.0, 1.05));
    for (number, (within, curve)) in bounds.into_iter().zip(curves).enumerate() {
        figure = figure.with(Series::new(&format!("within {within}°"), number + 1, curve).marked(marks[number]));
    }
    report.figure("shares", "Share of frames whose rotation error is within a bound.", figure);
    report.table("trees", "Shares of all frames asked.", table);
    Ok(report)
}

/// `IoU` over the field of view, failures marked.
pub fn fov(inputs: &SharedInputs, progress: Progress) -> Result<Report, ExperimentError> {
    let set = inputs.highlights(progress)?;
    let asked = ask_set(inputs, set);
    let mut report = Report::new("fov", &set.heading("Field of view: where it fails"));
    introduce(&mut report, set, "A frame that was not found is marked at zero.");
    let point = |asked: &AskedFrame| asked.found.map(|found| [asked.view_deg, found.iou.unwrap_or(f64::NAN)]);
    let failed = asked.iter().filter(|asked| asked.found.is_none()).map(|asked| [asked.view_deg, 0.0]);
    let figure = Figure::new("", Axis::linear("horizontal field of view (°)"), Axis::linear("IoU").within(0.0, 1.05))
        .with(Series::new("found", 1, asked.iter().filter_map(point).collect()).lined(Line::None))
        .with(Series::new("not found", 2, failed.collect()).lined(Line::None).marked(Mark::Cross));
    report.figure("iou", "IoU over the field of view.", figure);
    let bin = |asked: &AskedFrame| (asked.view_deg / 10.0).floor() as usize;
    let mut bins: Vec<usize> = asked.iter().map(bin).collect();
    bins.sort_unstable();
    bins.dedup();
    let tallies: Vec<(Cell, Tally)> = bins
        .into_iter()
        .map(|number| {
            let tally = Tally::of(asked.iter().filter(|asked| bin(asked) == number));
            (format!("{}–{}°", 10 * number, 10 * (number + 1)).into(), tally)
        })
        .collect();
    report.table("bins", "By field of view.", tally_table(("view", "view"), &tallies));
    Ok(report)
}
