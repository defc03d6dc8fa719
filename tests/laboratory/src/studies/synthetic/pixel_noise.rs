//! Figure (b): the noise of pixels, with the paper's eq. 2 and with the exact projection.
//!
//! The paper's eq. 2 is an approximation, and the figure depends on where it is used. Eq. 2 on both
//! sides is the paper's own model: its errors come from noise alone. The exact projection on both
//! sides is this program. Exact points that are solved by eq. 2 are what the authors' released
//! program meets in practice: to the noise comes the error of the model.

use super::Setting;
use super::collected::{Collected, Errors, camera_table};
use super::methods::{
    AUTHORS_POINTS, cramer_rao_bound, farthest_pair, refine_by_eq_2, refine_exactly,
    reproject_by_eq_2, solve_pair_by_eq_2, solve_pair_exactly,
};
use crate::report::contrast::{Contrast, Statement};
use crate::report::paper::FIGURE_B;
use crate::report::{Report, Stated};
use crate::setting::{Correspondence, RAYS};
use rand_pcg::Pcg64Mcg;
use touchline::camera::{Ptz, PtzCamera};
use touchline::report::figure::{Axis, Figure, Line, Mark, Series};
use touchline::report::{Cell, Column, Table};

/// Noise levels, 1-σ, px.
const NOISES_PX: [f64; 6] = [0.5, 1.0, 1.5, 2.0, 2.5, 3.0];
/// Number of noise levels.
pub(super) const STEPS: usize = NOISES_PX.len();
/// The noise levels that the page shows; the file has all.
const SHOWN_PX: [f64; 3] = [1.0, 2.0, 3.0];

/// The methods, in the order of the legend and of the trials' results.
const METHODS: [&str; 6] = [
    "eq. 2 on both sides, 200 rays",
    "eq. 2 on both sides, 32 rays",
    "exact on both sides, 200 rays",
    "Cramér–Rao bound",
    "exact points, eq. 2 solved, 32 rays",
    "exact on both sides, two points alone",
];
const EQ_2_ALL: usize = 0;
const EQ_2_FEW: usize = 1;
const EXACT: usize = 2;
const BOUND: usize = 3;
const MIXED: usize = 4;
// The names above have these numbers in them.
const _: () = assert!(RAYS == 200 && AUTHORS_POINTS == 32);

/// The errors of all methods at each noise level.
type ByNoise = Vec<(f64, [Collected; METHODS.len()])>;

/// One of the two errors that the figure shows.
struct Part {
    /// The name of its figure's file.
    stem: &'static str,
    /// The key of its column in files.
    column: &'static str,
    name: &'static str,
    unit: &'static str,
    decimals: usize,
    of: fn(&Errors) -> f64,
    /// The paper: the error stays below this.
    paper_below: f64,
}

impl Part {
    /// The paper's bound with its unit.
    fn describe_bound(&self) -> String {
        let space = if self.unit == "°" { "" } else { " " };
        format!("below {}{space}{}", self.paper_below, self.unit)
    }
}

const ROTATION: Part = Part {
    stem: "b-rotation",
    column: "rotation_deg",
    name: "rotation error",
    unit: "°",
    decimals: 4,
    of: |errors| errors.rotation_deg,
    paper_below: FIGURE_B.1,
};
const FOCAL: Part = Part {
    stem: "b-focal",
    column: "focal_px",
    name: "focal length error",
    unit: "px",
    decimals: 2,
    of: |errors| errors.focal_px,
    paper_below: FIGURE_B.2,
};

/// Measures figure (b), and adds it to the report.
pub(super) fn add(setting: &Setting<'_>, report: &mut Report) {
    let by_noise: ByNoise = NOISES_PX
        .into_iter()
        .enumerate()
        .map(|(place, sigma_px)| {
            // Places from 100 on; figures (c) and (d) have those from 200 and 300, so that no noise
            // is drawn twice.
            let collected = setting.collect(100 + place as u64, |camera, seen, rng| {
                solve_with_each_method(camera, seen, sigma_px, rng)
            });
            (sigma_px, collected)
        })
        .collect();

    report.text(&format!(
        "**(b) Noise of pixels.** The paper's eq. 2, x = f tan Δpan, y = −f tan Δtilt, \
         approximates the projection. *Eq. 2 on both sides*: pixels are made and solved by it, \
         with the authors' two-point start and Gauss–Newton over all {RAYS} rays, or over \
         {AUTHORS_POINTS} as in their released program. *Exact points, eq. 2 solved*: that \
         program on pixels as a camera makes them. Rotation error: the angle between the \
         rotations that the true and the estimated pan and tilt give with the true base."
    ));
    report.figure(
        ROTATION.stem,
        "Bars: ± one SD over the cameras, at the first method.",
        figure(&ROTATION, &by_noise),
    );
    report.figure(
        FOCAL.stem,
        "The same for the focal length.",
        figure(&FOCAL, &by_noise),
    );
    report.table(
        "b",
        "Figure (b): means over cameras and trials, σ in px.",
        table(&by_noise),
    );
    let cameras = by_noise
        .iter()
        .map(|(sigma_px, methods)| (*sigma_px, methods));
    report.data(
        "b-cameras",
        "Figure (b): every camera at every noise.",
        camera_table("σ (px)", METHODS, cameras),
    );
    // The least and the greatest noise.
    if let [first, .., last] = &by_noise[..] {
        report.text(&describe(first, last));
    }
    add_claims(report);
    let failed: usize = by_noise
        .iter()
        .flat_map(|(_, methods)| methods)
        .map(|method| method.failed)
        .sum();
    if failed > 0 {
        report.text(&format!("{failed} trials gave no camera and are left out."));
    }
}

/// One trial: the errors of each method with the same rays and the same noise. The pair of points
/// that are farthest apart is the start of each refinement.
fn solve_with_each_method(
    camera: &PtzCamera,
    seen: &[Correspondence],
    sigma_px: f64,
    rng: &mut Pcg64Mcg,
) -> [Option<Errors>; METHODS.len()] {
    let base = camera.base();
    let exact: Vec<Correspondence> = seen
        .iter()
        .map(|correspondence| correspondence.noisy(sigma_px, rng))
        .collect();
    let by_eq_2 = reproject_by_eq_2(camera, seen, &exact);

    let pair = solve_pair_exactly(base, farthest_pair(&exact));
    let refined = pair.map(|start| refine_exactly(base, start, &exact));
    let start = solve_pair_by_eq_2(base, farthest_pair(&by_eq_2));
    let eq_2_of = |rays: usize| start.map(|start| refine_by_eq_2(base, start, &by_eq_2, rays));
    // Exact pixels, solved by eq. 2: the model differs on the two sides.
    let mixed = solve_pair_by_eq_2(base, farthest_pair(&exact))
        .map(|start| refine_by_eq_2(base, start, &exact, AUTHORS_POINTS));

    let errors = |ptz: Ptz| Errors::between(camera, &PtzCamera::new(*base, ptz));
    [
        eq_2_of(RAYS).map(errors),
        eq_2_of(AUTHORS_POINTS).map(errors),
        refined.map(errors),
        cramer_rao_bound(camera, seen, sigma_px),
        mixed.map(errors),
        pair.map(errors),
    ]
}

/// What the table means: how near the bound is, and what is left of the mixture's errors with
/// little noise.
fn describe(
    (least_px, least): &(f64, [Collected; METHODS.len()]),
    (most_px, most): &(f64, [Collected; METHODS.len()]),
) -> String {
    let mean =
        |methods: &[Collected], method: usize, part: &Part| methods[method].mean_sd(part.of)[0];
    let [rotation, focal] =
        [&ROTATION, &FOCAL].map(|part| 100.0 * mean(most, BOUND, part) / mean(most, EXACT, part));
    format!(
        "At σ = {most_px} px the bound is {rotation:.1} % and {focal:.1} % of the errors of the \
         exact refinement (above 100 % by chance). Exact points that eq. 2 solves err by {:.3}° \
         and {:.1} px at σ = {least_px} px already, {:.3}° and {:.1} px at {most_px} px: the \
         error of the model, not of the noise.",
        mean(least, MIXED, &ROTATION),
        mean(least, MIXED, &FOCAL),
        mean(most, MIXED, &ROTATION),
        mean(most, MIXED, &FOCAL),
    )
}

/// Adds the paper's two bounds at the largest noise.
fn add_claims(report: &mut Report) {
    let sigma = FIGURE_B.0.to_string();
    for part in [&ROTATION, &FOCAL] {
        let tests = [EQ_2_ALL, EQ_2_FEW, EXACT, MIXED].map(|method| {
            let contrast = Contrast::over("b-cameras", part.column, "camera");
            let cells = [("sigma", sigma.as_str()), ("method", METHODS[method])];
            (METHODS[method], contrast.plus(&cells))
        });
        let words = format!(
            "Figure (b): {} {} at σ = {sigma} px",
            part.name,
            part.describe_bound()
        );
        let reason = "that the paper makes its pixels by eq. 2 is our reading";
        Statement {
            comparisons: 2,
            // Rotation and focal length are two comparisons of one sentence.
            ..Statement::new(&words, Stated::AtMost(part.paper_below), reason)
        }
        .test(report, &tests);
    }
}

/// A row for each method; for each error, a column for each noise.
fn table(by_noise: &[(f64, [Collected; METHODS.len()])]) -> Table {
    let mut table = Table::new(&[("method", "method")]);
    for part in [&ROTATION, &FOCAL] {
        for (sigma_px, _) in by_noise {
            let label = if SHOWN_PX.contains(sigma_px) {
                format!("{} ({}), σ = {sigma_px}", part.name, part.unit)
            } else {
                String::new()
            };
            let key = format!("{}_at_{sigma_px}", part.column);
            table.columns.push(Column::new(&key, &label));
        }
    }
    for (method, name) in METHODS.into_iter().enumerate() {
        let mut row = vec![Cell::from(name)];
        for part in [&ROTATION, &FOCAL] {
            let means = by_noise
                .iter()
                .map(|(_, methods)| methods[method].mean_sd(part.of)[0]);
            row.extend(means.map(|mean| Cell::Fixed(mean, part.decimals)));
        }
        table.push(row);
    }
    table
}

/// All methods' errors over the noise, and the paper's bound.
fn figure(part: &Part, by_noise: &[(f64, [Collected; METHODS.len()])]) -> Figure {
    let (paper_sigma, ..) = FIGURE_B;
    let mut figure = Figure::new(
        &format!("Figure (b): {} over pixel noise", part.name),
        Axis::linear("noise of pixels, σ (px)").within(0.0, paper_sigma * 1.05),
        Axis::log(&format!("{} ({})", part.name, part.unit)),
    );
    for (method, name) in METHODS.into_iter().enumerate() {
        let points = by_noise
            .iter()
            .map(|(sigma_px, methods)| [*sigma_px, methods[method].mean_sd(part.of)[0]]);
        let bars = by_noise
            .iter()
            .map(|(_, methods)| methods[method].bar(part.of));
        let series = |colour: usize| Series::new(name, colour, points.collect());
        figure = figure.with(match method {
            EQ_2_ALL => series(1).with_bars(bars.collect()),
            EQ_2_FEW => series(2).with_mark(Mark::Triangle),
            // On the same line as the first method and the bound, so that marks must do.
            EXACT => series(3).with_mark(Mark::Cross).with_line(Line::None),
            BOUND => series(0).with_mark(Mark::None).with_line(Line::Dashed),
            MIXED => series(6).with_mark(Mark::Triangle).with_line(Line::Dashed),
            _ => series(4).with_mark(Mark::Square),
        });
    }
    let bound = part.paper_below;
    let name = format!("paper: {}", part.describe_bound());
    let line = Series::new(&name, 0, vec![[0.0, bound], [paper_sigma, bound]]);
    figure.with(line.with_mark(Mark::None).with_line(Line::Dotted))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn with_one_model_on_both_sides_the_refinement_reaches_the_bound() {
        let setting = Setting {
            seed: 0,
            cameras: 10,
            trials: 40,
            step: &|| {},
        };
        let collected = setting.collect(9, |camera, seen, rng| {
            solve_with_each_method(camera, seen, 2.0, rng)
        });
        for part in [&ROTATION, &FOCAL] {
            let mean = |method: usize| collected[method].mean_sd(part.of)[0];
            // 400 trials determine the mean of a half-normal number to 4 %. The bound of eq. 2 is
            // that of the exact projection to a few percent.
            let efficiencies = [EXACT, EQ_2_ALL].map(|method| mean(BOUND) / mean(method));
            assert!((0.9..1.12).contains(&efficiencies[0]), "{efficiencies:?}");
            assert!((0.85..1.18).contains(&efficiencies[1]), "{efficiencies:?}");
            // Errors fall with the square root of the number of rays, here to 0.4.
            let few = mean(EQ_2_ALL) / mean(EQ_2_FEW);
            assert!((0.32..0.5).contains(&few), "{few}");
            assert!(mean(MIXED) > 2.0 * mean(EQ_2_FEW));
        }
    }
}
