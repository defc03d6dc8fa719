//! The gate on descriptors' distances: table 4 of the paper.

use super::answers::{RayCount, TALLY_EXPLAINED, Tally, tally_table};
use super::forests::{ForestKind, Trained};
use super::paper::{INLIER_DEG, TABLE_4};
use super::progress::Progress;
use super::sequences::introduce;
use super::sets::{FrameSet, SetKind};
use super::{ExperimentError, SharedInputs};
use crate::relocalize::{PredictOptions, RelocalizeOptions};
use crate::report::figure::{Axis, Figure, Line, Mark, Series};
use crate::report::{Cell, Report, Table, Verdict};

/// The gates, squared distances of descriptors of unit length. None can be larger than 2: the last is no gate.
const GATES: [f32; 7] = [0.05, 0.1, 0.2, 0.3, 0.45, 0.6, 4.0];
const PUBLISHED_GATE: f32 = 0.2;
const NO_GATE: f32 = 4.0;

/// What was measured at one gate.
struct AtGate {
    gate: f32,
    tally: Tally,
    rays: RayCount,
}

/// Runs the experiment.
///
/// # Errors
/// The frames cannot be had.
pub fn run(inputs: &SharedInputs, progress: Progress) -> Result<Report, ExperimentError> {
    let sets = inputs.highlights(progress)?;
    let mut report =
        Report::new("threshold", &sets[0].heading("Threshold: table 4, the gate on descriptors' distances"));
    introduce(&mut report, sets, "A leaf farther than the gate (squared distance of unit descriptors) is no match.");
    report.text(ForestKind::EXPLAINED);
    report.text(&format!(
        "*Passing* is the share of features with a ray that passes the gate, *Inlier.5* the share of those whose nearest ray lies \
         within {INLIER_DEG}° of the true one. {TALLY_EXPLAINED}"
    ));
    let gates: &[f32] = if inputs.options.quick { &[0.1, PUBLISHED_GATE, NO_GATE] } else { &GATES };
    let mut axes = Figure::new(
        "",
        Axis::linear("gate (squared distance)").within(0.0, 0.65),
        Axis::linear("Inlier.5, or mean IoU").within(0.0, 1.05),
    );
    let mut both = Vec::new();
    for (number, kind) in ForestKind::BOTH.into_iter().enumerate() {
        let measured = measure(sets, kind, gates, &|done, total| progress(number * total + done, 2 * total));
        report.table(
            &format!("gates-{}", kind.key()),
            &format!("By gate: {}; the published gate is {PUBLISHED_GATE}.", kind.describe()),
            gate_table(&measured, sets[0].kind != SetKind::Own),
        );
        let points = |of: &dyn Fn(&AtGate) -> f64| {
            let gated = measured.iter().filter(|at| at.gate < NO_GATE);
            gated.map(|at| [f64::from(at.gate), of(at)]).collect::<Vec<_>>()
        };
        let line = if number == 0 { Line::Solid } else { Line::Dashed };
        axes = axes
            .with(Series::new(&format!("IoU, {}", kind.key()), 1, points(&|at| at.tally.iou_mean)).lined(line))
            .with(
                Series::new(&format!("Inlier.5, {}", kind.key()), 2, points(&AtGate::inliers))
                    .lined(line)
                    .marked(Mark::Square),
            );
        both.push(measured);
    }
    report.figure(
        "gates",
        "Mean IoU (not found: 0) and the share of passing rays within .5° of the true one, by gate.",
        axes,
    );
    if let (SetKind::Drawn, [default, published]) = (sets[0].kind, &both[..]) {
        claims(&mut report, default, published);
    }
    Ok(report)
}

impl AtGate {
    /// The share of passing rays that are right.
    fn inliers(&self) -> f64 {
        self.rays.right as f64 / self.rays.passing.max(1) as f64
    }
}

/// Trains once and asks at every gate.
fn measure(sets: &[FrameSet], kind: ForestKind, gates: &[f32], progress: Progress) -> Vec<AtGate> {
    let mut asked = vec![Vec::new(); gates.len()];
    let mut rays = vec![RayCount::default(); gates.len()];
    for (repeat, set) in sets.iter().enumerate() {
        let trained = Trained::of(set, repeat, &kind.training(set.seed));
        for (place, gate) in gates.iter().enumerate() {
            let usual = kind.asking(set.seed);
            let predict = PredictOptions { max_squared_distance: *gate, ..usual.predict };
            rays[place] = rays[place].plus(trained.count_rays(&predict));
            asked[place].extend(trained.ask_plainly(&RelocalizeOptions { predict, ..usual }));
            progress(repeat * gates.len() + place + 1, sets.len() * gates.len());
        }
    }
    let each = gates.iter().zip(asked).zip(rays);
    each.map(|((gate, asked), rays)| AtGate { gate: *gate, tally: Tally::of(asked.iter()), rays }).collect()
}

fn gate_table(measured: &[AtGate], with_paper: bool) -> Table {
    let name = |gate: f32| {
        if gate < NO_GATE { Cell::Fixed((f64::from(gate) * 1e6).round() / 1e6, 2) } else { "no gate".into() }
    };
    let tallies: Vec<(Cell, Tally)> = measured.iter().map(|at| (name(at.gate), at.tally)).collect();
    let share = |count: usize, of: usize| Cell::Fixed(count as f64 / of.max(1) as f64, 3);
    let passing = measured.iter().map(|at| share(at.rays.passing, at.rays.features));
    let inliers = measured.iter().map(|at| share(at.rays.right, at.rays.passing));
    let table = tally_table(("gate", "gate"), &tallies)
        .with_column("passing", "passing", passing)
        .with_column("inlier_5", "Inlier.5", inliers);
    if !with_paper {
        return table;
    }
    let [without, with] = TABLE_4;
    let of_paper = |at: &AtGate| match at.gate {
        NO_GATE => Some(without),
        PUBLISHED_GATE => Some(with),
        _ => None,
    };
    let stated: Vec<Option<(&str, f64, f64)>> = measured.iter().map(of_paper).collect();
    let of = |get: fn(&(&str, f64, f64)) -> f64| -> Vec<Cell> {
        stated.iter().map(|stated| stated.as_ref().map_or(Cell::Empty, |stated| Cell::Fixed(get(stated), 2))).collect()
    };
    table.with_column("paper_inlier_5", "paper: Inlier.5", of(|stated| stated.1)).with_column(
        "paper_iou",
        "paper: IoU",
        of(|stated| stated.2),
    )
}

fn claims(report: &mut Report, default: &[AtGate], published: &[AtGate]) {
    let at = |measured: &[AtGate], gate: f32| -> Option<[f64; 2]> {
        let found = measured.iter().find(|at| at.gate == gate)?;
        Some([found.inliers(), found.tally.iou_mean])
    };
    let pair = |measured: &[AtGate]| at(measured, NO_GATE).zip(at(measured, PUBLISHED_GATE));
    let (Some(of_default), Some(of_published)) = (pair(default), pair(published)) else { return };
    let [(_, rays_without, iou_without), (_, rays_with, iou_with)] = TABLE_4;
    let shown = |(without, with): ([f64; 2], [f64; 2])| {
        format!("{:.2} → {:.2}, IoU {:.2} → {:.2}", without[0], with[0], without[1], with[1])
    };
    let (without, with) = of_published;
    report.claim(
        Verdict::of(with[0] > without[0] && with[1] > without[1]),
        &format!("Table 4: the gate raises rays within .5° from {rays_without} to {rays_with} and IoU from {iou_without} to {iou_with}"),
        &format!("--published {}; default forest {}", shown(of_published), shown(of_default)),
        "both of ours find the camera by a robust search that tells wrong rays without a gate as well; the paper's needs it",
    );
}
