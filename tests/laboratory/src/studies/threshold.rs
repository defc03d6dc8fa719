//! The threshold on distances of descriptors: table 4 of the paper.

use super::sequences::{introduce_again, on_both};
use crate::progress::Progress;
use crate::report::contrast::{Contrast, Statement};
use crate::report::paper::{INLIER_DEG, TABLE_4};
use crate::report::{Report, Stated};
use crate::scoring::answers::{FrameAnswer, RayCount, Tally, frame_table, tally_table};
use crate::scoring::forests::{ForestKind, Trained};
use crate::sets::{FrameSet, SetKind};
use crate::{ExperimentError, SharedInputs};
use touchline::relocalize::{PredictOptions, RelocalizeOptions};
use touchline::report::figure::{Axis, Figure, Line, Mark, Series};
use touchline::report::{Cell, Table};

/// The thresholds: squared distances of descriptors of unit length. These are at most 2, so the
/// last threshold accepts all.
const GATES: [f32; 7] = [0.05, 0.1, 0.2, 0.3, 0.45, 0.6, 4.0];
const PUBLISHED_GATE: f32 = 0.2;
const NO_GATE: f32 = 4.0;
/// Where the figure shows the forest without a gate.
const NO_GATE_AT: f64 = 0.75;

/// The results with one threshold.
struct AtGate {
    gate: f32,
    answers: Vec<FrameAnswer>,
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
    introduce_again(
        &mut report,
        sets,
        "highlights",
        "A leaf farther than the gate (squared distance of unit descriptors) is no match.",
    );
    report.text(&format!(
        "*Inlier.5* counts the predictions of every tree, as the paper does: the share of them within {INLIER_DEG}° of the true ray."
    ));
    let gates: &[f32] = if inputs.options.quick {
        &[0.1, PUBLISHED_GATE, NO_GATE]
    } else {
        &GATES
    };
    let mut axes = Figure::new(
        "The gate on descriptors' distances",
        Axis::linear("gate (squared distance; the last: none)").within(0.0, NO_GATE_AT + 0.05),
        Axis::linear("Inlier.5, or mean IoU").within(0.0, 1.05),
    );
    let (mut rows, mut rays, mut ways) = (Vec::new(), Vec::new(), Vec::new());
    for (number, kind) in ForestKind::PAPER_FIRST.into_iter().enumerate() {
        let measured = measure(sets, kind, gates, &|done, total| {
            progress(number * total + done, 2 * total);
        });
        let line = if number == 0 {
            Line::Solid
        } else {
            Line::Dashed
        };
        let points = |of: &dyn Fn(&AtGate) -> f64| {
            // No gate is drawn at the right end of the axis, not at its number.
            let place = |gate: f32| {
                if gate < NO_GATE {
                    f64::from(gate)
                } else {
                    NO_GATE_AT
                }
            };
            measured
                .iter()
                .map(|at| [place(at.gate), of(at)])
                .collect::<Vec<_>>()
        };
        axes = axes
            .with(
                Series::new(
                    &format!("IoU, {}", kind.key()),
                    1,
                    points(&|at| Tally::from_answers(at.answers.iter()).iou_mean),
                )
                .with_line(line),
            )
            .with(
                Series::new(
                    &format!("Inlier.5, {}", kind.key()),
                    2,
                    points(&|at| inliers(at.all_rays())),
                )
                .with_line(line)
                .with_mark(Mark::Square),
            );
        for at in measured {
            let way = way(kind.key(), at.gate);
            let tally = Tally::from_answers(at.answers.iter());
            rows.push((Cell::from(way.as_str()), tally, at.all_rays(), at.gate));
            // The counts are of whole seeds, so that the share of right rays has one value for each
            // seed, which the claim's interval needs.
            rays.extend(
                at.rays
                    .iter()
                    .zip(sets)
                    .map(|(count, set)| ray_row(&way, set.seed, *count)),
            );
            ways.push((way, at.answers));
        }
    }
    if sets[0].kind != SetKind::Own {
        axes = with_paper(axes);
    }
    report.figure(
        "gates",
        "Mean IoU (refused: 0) and Inlier.5 by gate; black: the paper.",
        axes,
    );
    report.table(
        "gates",
        "By gate.",
        gate_table(&rows, sets[0].kind != SetKind::Own),
    );
    let mut counted = Table::new(&[
        ("way", "way"),
        ("seed", "seed"),
        ("features", "features"),
        ("with_ray", "with a ray"),
        ("nearest_right", "nearest right"),
        ("rays", "rays"),
        ("right", "right"),
        ("inlier_5", "Inlier.5"),
    ]);
    counted.rows = rays;
    report.data("rays", "Features and rays, by gate and seed.", counted);
    let each = ways.iter().map(|(way, answers)| (way, &answers[..]));
    report.data("frames", "Every frame, by gate.", frame_table(sets, each));
    if sets[0].kind == SetKind::Drawn {
        claims(&mut report);
    }
    Ok(report)
}

/// The name of a forest with a gate in files.
fn way(kind: &str, gate: f32) -> String {
    if gate < NO_GATE {
        format!("{kind} {gate}")
    } else {
        format!("{kind} no gate")
    }
}

/// Adds the paper's four numbers to the figure.
fn with_paper(mut axes: Figure) -> Figure {
    let places = [NO_GATE_AT, f64::from(PUBLISHED_GATE)];
    for (column, (name, mark)) in [
        ("paper: Inlier.5", Mark::Square),
        ("paper: IoU", Mark::Disc),
    ]
    .into_iter()
    .enumerate()
    {
        let points = places
            .iter()
            .zip(TABLE_4)
            .map(|(place, stated)| [*place, stated[column]]);
        let series = Series::new(name, 0, points.collect());
        axes = axes.with(series.with_line(Line::None).with_mark(mark));
    }
    axes
}

impl AtGate {
    /// The counts of all seeds.
    fn all_rays(&self) -> RayCount {
        self.rays
            .iter()
            .copied()
            .fold(RayCount::default(), RayCount::plus)
    }
}

/// The share of predicted rays that are right.
fn inliers(rays: RayCount) -> f64 {
    // Without any ray the share is 0.
    rays.right as f64 / rays.rays.max(1) as f64
}

/// Trains each set's forests once, and relocalizes with each threshold.
fn measure(sets: &[FrameSet], kind: ForestKind, gates: &[f32], progress: Progress) -> Vec<AtGate> {
    let mut answers = vec![Vec::new(); gates.len()];
    let mut rays = vec![Vec::new(); gates.len()];
    for (repeat, set) in sets.iter().enumerate() {
        let trained = Trained::train(set, repeat, &kind.training(set.seed));
        for (place, gate) in gates.iter().enumerate() {
            let usual = kind.asking(set.seed);
            // A forest does not depend on the gate: it is trained once, and each gate is applied to
            // its predictions.
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
        answers,
        rays,
    })
    .collect()
}

/// The counts of rays of one seed.
fn ray_row(way: &str, seed: u64, count: RayCount) -> Vec<Cell> {
    let mut row: Vec<Cell> = vec![way.into(), (seed as usize).into()];
    row.extend(
        [
            count.features,
            count.with_ray,
            count.nearest_right,
            count.rays,
            count.right,
        ]
        .map(Cell::from),
    );
    row.push(inliers(count).into());
    row
}

/// A row for each forest and gate.
fn gate_table(rows: &[(Cell, Tally, RayCount, f32)], with_paper: bool) -> Table {
    let tallies: Vec<(Cell, Tally)> = rows
        .iter()
        .map(|(name, tally, ..)| (name.clone(), *tally))
        .collect();
    let shares = rows
        .iter()
        .map(|(.., rays, _)| Cell::Fixed(inliers(*rays), 3));
    let nearest = rows.iter().map(|(.., rays, _)| {
        Cell::Fixed(rays.nearest_right as f64 / rays.with_ray.max(1) as f64, 3)
    });
    let table = tally_table(("gate", "forest, gate"), &tallies)
        .with_column("inlier_5", "Inlier.5", shares)
        .with_column("nearest_inlier_5", "", nearest);
    if !with_paper {
        return table;
    }
    let [without, with] = TABLE_4;
    let stated = |gate: f32| match gate {
        // A pattern of constants: the gates are copied from the same constants, so that they
        // compare exactly.
        NO_GATE => format!("{}, {}", without[0], without[1]).into(),
        PUBLISHED_GATE => format!("{}, {}", with[0], with[1]).into(),
        _ => Cell::Empty,
    };
    let stated = rows.iter().map(|(.., gate)| stated(*gate));
    table.with_column("paper", "paper: Inlier.5, IoU", stated)
}

/// Adds the claims of table 4.
fn claims(report: &mut Report) {
    let [[rays_without, iou_without], [rays_with, iou_with]] = TABLE_4;
    let gain = |start: Contrast, kind: &str| {
        start
            .plus(&[("way", &way(kind, PUBLISHED_GATE))])
            .minus(&[("way", &way(kind, NO_GATE))])
    };
    Statement::new(
        &format!("Table 4: the gate raises Inlier.5 from {rays_without} to {rays_with}"),
        Stated::difference(rays_with, rays_without),
        "",
    )
    .test(
        report,
        &on_both(|kind| gain(Contrast::over("rays", "inlier_5", "seed"), kind)),
    );
    Statement::new(
        &format!("Table 4: the gate raises IoU from {iou_without} to {iou_with}"),
        Stated::difference(iou_with, iou_without),
        "our search for the camera tells wrong rays without a gate as well; the paper's needs it",
    )
    .test(
        report,
        &on_both(|kind| gain(Contrast::over_frames("iou_part"), kind)),
    );
}
