//! The threshold on distances of descriptors: table 4 of the paper.

use super::answers::{
    FrameAnswer, RayCount, TALLY_EXPLAINED, Tally, describe_difference, difference,
    interval_over_seeds, tally_table,
};
use super::forests::{ForestKind, Trained};
use super::paper::{INLIER_DEG, TABLE_4};
use super::progress::Progress;
use super::sequences::introduce;
use super::sets::{FrameSet, SetKind};
use super::{ExperimentError, SharedInputs};
use touchline_documents::report::figure::{Axis, Figure, Line, Mark, Series};
use touchline_documents::report::{Cell, Report, Table, Verdict};
use touchline_vision::relocalize::{PredictOptions, RelocalizeOptions};

/// The thresholds: squared distances of descriptors of unit length. These are at most 2, so the
/// last threshold accepts all.
const GATES: [f32; 7] = [0.05, 0.1, 0.2, 0.3, 0.45, 0.6, 4.0];
const PUBLISHED_GATE: f32 = 0.2;
const NO_GATE: f32 = 4.0;

/// The results with one threshold.
struct AtGate {
    gate: f32,
    answers: Vec<FrameAnswer>,
    tally: Tally,
    /// Counts for each seed.
    rays: Vec<RayCount>,
}

/// Runs the experiment.
///
/// # Errors
/// The frames cannot be drawn or read.
pub fn run(inputs: &SharedInputs, progress: Progress) -> Result<Report, ExperimentError> {
    let sets = inputs.highlights(progress)?;
    let mut report = Report::new(
        "threshold",
        &sets[0].heading("Threshold: table 4, the gate on descriptors' distances"),
    );
    introduce(
        &mut report,
        sets,
        "A leaf farther than the gate (squared distance of unit descriptors) is no match.",
    );
    report.text(ForestKind::EXPLAINED);
    report.text(&format!(
        "*Passing* is the share of features with a ray that passes the gate, *Inlier.5* the share of those whose nearest ray lies \
         within {INLIER_DEG}° of the true one. {TALLY_EXPLAINED}"
    ));
    let gates: &[f32] = if inputs.options.quick {
        &[0.1, PUBLISHED_GATE, NO_GATE]
    } else {
        &GATES
    };
    let mut axes = Figure::new(
        "",
        Axis::linear("gate (squared distance)").within(0.0, 0.65),
        Axis::linear("Inlier.5, or mean IoU").within(0.0, 1.05),
    );
    let mut both = Vec::new();
    for (number, kind) in ForestKind::BOTH.into_iter().enumerate() {
        let measured = measure(sets, kind, gates, &|done, total| {
            progress(number * total + done, 2 * total);
        });
        report.table(
            &format!("gates-{}", kind.key()),
            &format!(
                "By gate: {}; the published gate is {PUBLISHED_GATE}.",
                kind.describe()
            ),
            gate_table(&measured, sets[0].kind != SetKind::Own),
        );
        let points = |of: &dyn Fn(&AtGate) -> f64| {
            let gated = measured.iter().filter(|at| at.gate < NO_GATE);
            gated
                .map(|at| [f64::from(at.gate), of(at)])
                .collect::<Vec<_>>()
        };
        let line = if number == 0 {
            Line::Solid
        } else {
            Line::Dashed
        };
        axes = axes
            .with(
                Series::new(
                    &format!("IoU, {}", kind.key()),
                    1,
                    points(&|at| at.tally.iou_mean),
                )
                .lined(line),
            )
            .with(
                Series::new(
                    &format!("Inlier.5, {}", kind.key()),
                    2,
                    points(&AtGate::inliers),
                )
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
    /// The counts of all seeds.
    fn all_rays(&self) -> RayCount {
        self.rays
            .iter()
            .copied()
            .fold(RayCount::default(), RayCount::plus)
    }

    /// The share of accepted rays that are correct.
    fn inliers(&self) -> f64 {
        inliers(self.all_rays())
    }
}

/// The share of accepted rays that are correct.
fn inliers(rays: RayCount) -> f64 {
    rays.right as f64 / rays.passing.max(1) as f64
}

/// Trains each set's forests once, and relocalizes with each threshold.
fn measure(sets: &[FrameSet], kind: ForestKind, gates: &[f32], progress: Progress) -> Vec<AtGate> {
    let mut answers = vec![Vec::new(); gates.len()];
    let mut rays = vec![Vec::new(); gates.len()];
    for (repeat, set) in sets.iter().enumerate() {
        let trained = Trained::of(set, repeat, &kind.training(set.seed));
        for (place, gate) in gates.iter().enumerate() {
            let usual = kind.asking(set.seed);
            let predict = PredictOptions {
                max_squared_distance: *gate,
                ..usual.predict
            };
            rays[place].push(trained.count_rays(&predict));
            answers[place].extend(trained.ask_plainly(&RelocalizeOptions { predict, ..usual }));
            progress(repeat * gates.len() + place + 1, sets.len() * gates.len());
        }
    }
    let each = gates.iter().zip(answers).zip(rays);
    each.map(|((gate, answers), rays)| AtGate {
        gate: *gate,
        tally: Tally::of(answers.iter()),
        answers,
        rays,
    })
    .collect()
}

fn gate_table(measured: &[AtGate], with_paper: bool) -> Table {
    let name = |gate: f32| {
        if gate < NO_GATE {
            Cell::Fixed((f64::from(gate) * 1e6).round() / 1e6, 2)
        } else {
            "no gate".into()
        }
    };
    let tallies: Vec<(Cell, Tally)> = measured
        .iter()
        .map(|at| (name(at.gate), at.tally))
        .collect();
    let share = |count: usize, of: usize| Cell::Fixed(count as f64 / of.max(1) as f64, 3);
    let rays: Vec<RayCount> = measured.iter().map(AtGate::all_rays).collect();
    let passing = rays.iter().map(|rays| share(rays.passing, rays.features));
    let inliers = rays.iter().map(|rays| Cell::Fixed(inliers(*rays), 3));
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
    let stated = |column: usize| {
        let of = move |at: &AtGate| {
            of_paper(at).map_or(Cell::Empty, |stated| Cell::Fixed(stated[column], 2))
        };
        measured.iter().map(of).collect::<Vec<_>>()
    };
    table
        .with_column("paper_inlier_5", "paper: Inlier.5", stated(0))
        .with_column("paper_iou", "paper: IoU", stated(1))
}

/// Adds the claims that compare both forests with table 4.
fn claims(report: &mut Report, default: &[AtGate], published: &[AtGate]) {
    fn pair(measured: &[AtGate]) -> Option<[&AtGate; 2]> {
        let at = |gate: f32| measured.iter().find(|at| at.gate == gate);
        Some([at(NO_GATE)?, at(PUBLISHED_GATE)?])
    }
    let (Some(of_default), Some(of_published)) = (pair(default), pair(published)) else {
        return;
    };
    let [[rays_without, iou_without], [rays_with, iou_with]] = TABLE_4;
    let shown = |[without, with]: [&AtGate; 2], of: fn(&AtGate) -> f64| {
        format!("{:.2} → {:.2}", of(without), of(with))
    };
    let of_iou = |at: &AtGate| at.tally.iou_mean;
    let [without, with] = of_published;
    let more_rays: Vec<f64> = with
        .rays
        .iter()
        .zip(&without.rays)
        .map(|(with, without)| inliers(*with) - inliers(*without))
        .collect();
    let more_rays = interval_over_seeds(&more_rays);
    report.claim(
        Verdict::above(more_rays, 0.0),
        &format!("Table 4: the gate raises rays within .5° from {rays_without} to {rays_with}"),
        &format!(
            "--published {} (difference {}); default forest {}",
            shown(of_published, AtGate::inliers),
            describe_difference(more_rays),
            shown(of_default, AtGate::inliers)
        ),
        "",
    );
    let gain = difference(&with.answers, &without.answers, |tally| tally.iou_mean);
    report.claim(
        Verdict::above(gain, 0.0),
        &format!("Table 4: the gate raises IoU from {iou_without} to {iou_with}"),
        &format!(
            "--published {} (difference {}); default forest {}",
            shown(of_published, of_iou),
            describe_difference(gain),
            shown(of_default, of_iou)
        ),
        "both of ours find the camera by a robust search that tells wrong rays without a gate as well; the paper's needs it",
    );
}
