//! Iterations of RANSAC: table 1 of the paper checked by simulation, and samples of two points
//! compared with samples of four as the share of outliers grows.

use super::ExperimentOptions;
use super::progress::{Progress, step_counter};
use super::setting::{SIZE, normal, rng};
use crate::report::contrast::{Contrast, Statement};
use crate::report::statistics::median_of;
use crate::report::{Report, Stated};
use rand::RngExt;
use rand::seq::index::sample;
use rand_pcg::Pcg64Mcg;
use rayon::prelude::*;
use std::time::Instant;
use touchline::camera::{CameraBase, Ptz, PtzCamera};
use touchline::geometry::{ImagePoint, Mat3, Vec2, Vec3, homography};
use touchline::report::figure::{Axis, Figure, Mark, Series};
use touchline::report::{Cell, Table};
use touchline::solve::{Loss, Observation, refine, solve_two_points};
use touchline::synthetic::Preset;

/// Sample sizes, and the iterations that table 1 of the paper states for them.
const TABLE_1: [(usize, usize); 3] = [(4, 71), (2, 16), (1, 7)];
/// The required probability that one sample is free of outliers.
const SUCCESS: f64 = 0.99;
/// Number of matches in a picture, and the noise of inliers, 1-σ, px.
const MATCHES: usize = 200;
const NOISE_PX: f64 = 1.0;
/// Maximum distance of an inlier from a model, px.
const AGREES_PX: f64 = 3.0;
/// Maximum number of iterations.
const MOST_ROUNDS: usize = 2000;
/// A result is correct if its largest error over the visible ground points is at most this, px.
const RIGHT_PX: f64 = 5.0;
const OUTLIERS: [f64; 7] = [0.0, 0.2, 0.4, 0.5, 0.6, 0.7, 0.8];

/// Runs the experiment.
pub fn run(options: &ExperimentOptions, progress: Progress) -> Report {
    let mut report = Report::new("ransac", "RANSAC: rounds for four, two and one points");
    let table = table_1(options);
    let simulated = describe_simulation(&table);
    report.table(
        "table-1",
        &format!(
            "Table 1: rounds for success in {:.0} % of all cases with half of the matches wrong.",
            100.0 * SUCCESS
        ),
        table,
    );
    report.text(&simulated);
    for (points, rounds) in TABLE_1 {
        let points_text = points.to_string();
        let needed = Contrast::exact("table-1", "needed").plus(&[("points", points_text.as_str())]);
        let words = format!("Table 1: RANSAC rounds with {}", count_points(points));
        let reason = format!(
            "the paper rounds; {} whole rounds are due",
            whole_rounds(points)
        );
        Statement::new(&words, Stated::Level(rounds as f64, 0.5), &reason)
            .test(&mut report, &[("by formula", needed)]);
    }
    let trials = options.full_or_quick(200, 12);
    let step = step_counter(trials * OUTLIERS.len(), progress);
    let mut every = Table::new(&[
        ("outliers", "outliers"),
        ("trial", "picture"),
        ("points", "points"),
        ("right", "right"),
        ("rounds", "rounds"),
    ]);
    let shares: Vec<(f64, [Outcome; 2])> = OUTLIERS
        .into_iter()
        .enumerate()
        .map(|(place, outliers)| {
            let of_trial = |trial: usize| {
                let found = compare(
                    outliers,
                    &mut rng(options.seed, [40 + place as u64, trial as u64]),
                );
                step();
                found
            };
            // Each trial depends on its own random generator, so the order of threads does not
            // matter.
            let found: Vec<[Run; 2]> = (0..trials).into_par_iter().map(of_trial).collect();
            for (trial, runs) in found.iter().enumerate() {
                for (points, run) in [2, 4].into_iter().zip(runs) {
                    let right = usize::from(run.right);
                    every.push(vec![
                        outliers.into(),
                        trial.into(),
                        points.into(),
                        right.into(),
                        run.rounds.into(),
                    ]);
                }
            }
            let outcome = |method: usize| {
                Outcome::from_runs(&found.iter().map(|runs| runs[method]).collect::<Vec<_>>())
            };
            (outliers, [outcome(0), outcome(1)])
        })
        .collect();
    report.text(&format!(
        "Two points (a known base: pan, tilt, focal length) against four (a homography, nothing \
         known) on the same matches of points on the ground: {MATCHES} a picture, {NOISE_PX} px \
         noise; a match agrees within {AGREES_PX} px; rounds until a better sample would have \
         been missed with {:.0} %, {MOST_ROUNDS} at most; then a fit to all that agree. {trials} \
         pictures for each share. *Right*: no point of the ground in the picture is more than \
         {RIGHT_PX} px off.",
        100.0 * (1.0 - SUCCESS)
    ));
    report.table(
        "outliers",
        "Success and rounds over the share of outliers.",
        outlier_table(&shares),
    );
    report.data("pictures", "Every picture.", every);
    let most_outliers = OUTLIERS[OUTLIERS.len() - 1];
    let due = rounds_for_success(1.0 - most_outliers, 4).ceil();
    report.figure(
        "success",
        &format!(
            "With {most_outliers} outliers four points need {due} rounds and get {MOST_ROUNDS}."
        ),
        success_figure(&shares),
    );
    let mut times = Table::new(&[
        ("outliers", "outliers"),
        ("two_points_ms", "two points (ms, median)"),
        ("four_points_ms", "four points (ms, median)"),
    ]);
    for (outliers, [two, four]) in &shares {
        times.push(vec![
            Cell::Fixed(*outliers, 1),
            two.median_ms.into(),
            four.median_ms.into(),
        ]);
    }
    report.time_table("outliers-times", "One picture, fit included.", times);
    report
}

/// The number of iterations after which one of the samples of `points` matches is free of outliers
/// with probability [`SUCCESS`]: ln(1 − p) / ln(1 − wᴺ) (Fischler and Bolles 1981). Infinite
/// without inliers, 0 where all are.
fn rounds_for_success(inliers: f64, points: usize) -> f64 {
    // Without inliers the denominator is +0, and the quotient of a negative number −∞, which would
    // end the search at once.
    ((1.0 - SUCCESS).ln() / (1.0 - inliers.powi(points as i32)).ln()).abs()
}

/// [`rounds_for_success`] with half of the matches wrong, as in table 1, in whole rounds.
fn whole_rounds(points: usize) -> usize {
    rounds_for_success(0.5, points).ceil() as usize
}

/// "1 point", "2 points".
fn count_points(points: usize) -> String {
    format!("{points} point{}", if points == 1 { "" } else { "s" })
}

/// Which whole numbers of rounds are enough in the simulation.
///
/// The formula draws each match of a sample from all matches. RANSAC does not draw a match twice,
/// and after one right match fewer right ones are left, so that it needs slightly more rounds.
fn describe_simulation(table: &Table) -> String {
    let columns = ["points", "whole", "simulated"].map(|key| table.column(key));
    let results = table.rows.iter().map(|row| {
        let [points, whole, share] = columns.map(|column| {
            column
                .and_then(|column| row[column].number())
                .unwrap_or(f64::NAN)
        });
        format!(
            "{whole} rounds with {} succeed in {:.2} %, {}",
            count_points(points as usize),
            100.0 * share,
            if share >= SUCCESS {
                "enough"
            } else {
                "not enough"
            }
        )
    });
    format!(
        "Simulated with {MATCHES} matches, half of them wrong, and no match twice in a sample: {}.",
        results.collect::<Vec<_>>().join("; ")
    )
}

/// The number of iterations by formula, by the paper, and the simulated probability of success with
/// the whole rounds.
fn table_1(options: &ExperimentOptions) -> Table {
    let mut table = Table::new(&[
        ("points", "points"),
        ("needed", "rounds needed"),
        ("whole", "whole rounds"),
        ("paper", "paper"),
        ("simulated", "success after as many, simulated"),
    ]);
    // With 100 000 draws the standard error of the share is 0.03 %, below what one round changes
    // (0.06 % with four points).
    let draws = options.full_or_quick(100_000, 4000);
    for (points, paper) in TABLE_1 {
        let whole = whole_rounds(points);
        // Matches below the middle of the index are the right ones; a sample succeeds with these
        // alone.
        let mut rng = rng(options.seed, [30, points as u64]);
        let all_right = |rng: &mut Pcg64Mcg| {
            sample(rng, MATCHES, points)
                .iter()
                .all(|index| index < MATCHES / 2)
        };
        let successes = (0..draws)
            .filter(|_| (0..whole).any(|_| all_right(&mut rng)))
            .count();
        let share = successes as f64 / draws as f64;
        table.push(vec![
            points.into(),
            rounds_for_success(0.5, points).into(),
            whole.into(),
            paper.into(),
            Cell::Fixed(share, 4),
        ]);
    }
    table
}

/// A ground point (or a pixel of a reference, as x and y) and the pixel that it is matched to. May
/// be an outlier.
#[derive(Clone, Copy)]
pub(super) struct Match {
    pub ground: Vec3,
    pub image: ImagePoint,
}

/// The result of one method on one picture.
#[derive(Clone, Copy)]
struct Run {
    right: bool,
    rounds: usize,
    ms: f64,
}

/// Statistics of one method over several pictures.
struct Outcome {
    success: f64,
    rounds: f64,
    median_ms: f64,
}

impl Outcome {
    fn from_runs(runs: &[Run]) -> Self {
        let median = |of: fn(&Run) -> f64| median_of(runs.iter().map(of).collect());
        Self {
            success: runs.iter().filter(|run| run.right).count() as f64 / runs.len() as f64,
            rounds: median(|run| run.rounds as f64),
            median_ms: median(|run| run.ms),
        }
    }
}

/// Draws a picture's matches and runs both methods on them: two points, four points.
fn compare(outliers: f64, rng: &mut Pcg64Mcg) -> [Run; 2] {
    // The main camera of the drawn matches, not that of the highlights.
    let base = Preset::Paper.shoot().main_camera(SIZE);
    let ptz = Ptz::from_degrees(
        rng.random_range(-35.0..35.0),
        rng.random_range(-15.0..-11.0),
        rng.random_range(1300.0..2600.0),
    );
    let camera = PtzCamera::new(base, ptz);
    // Ground points at random pixels, within 160 m of the camera.
    let exact: Vec<Match> = std::iter::repeat_with(|| pixel(rng))
        // Pixels above the horizon show no ground and are drawn again, not without end.
        .take(50 * MATCHES)
        .filter_map(|image| {
            Some(Match {
                ground: camera.plane_from_image(image, 0.0)?,
                image,
            })
        })
        .filter(|seen| (seen.ground - base.position_m).norm() < 160.0)
        .take(MATCHES)
        .collect();
    // The first matches become outliers at random pixels; the others get noise.
    let wrong = (outliers * exact.len() as f64).round() as usize;
    let mut matches = exact.clone();
    for (index, seen) in matches.iter_mut().enumerate() {
        seen.image = if index < wrong {
            pixel(rng)
        } else {
            seen.image
                .translate(Vec2::new(normal(rng), normal(rng)) * NOISE_PX)
        };
    }
    // All points of the ground are compared, those of outliers too: the exact ones are known.
    let right = |image_of: &dyn Fn(Vec3) -> Option<ImagePoint>| {
        exact.iter().all(|seen| {
            image_of(seen.ground).is_some_and(|image| image.distance_px(seen.image) <= RIGHT_PX)
        })
    };
    // Both methods draw from the same generator, one after the other: the same matches, other
    // samples.
    let (two, two_rounds, two_ms) = measure_time(|| by_two_points(&base, &matches, rng));
    let (four, four_rounds, four_ms) = measure_time(|| by_four_points(&matches, rng));
    let two_right = two.is_some_and(|ptz| {
        let found = PtzCamera::new(base, ptz);
        right(&|ground| found.image_from_world(ground).ok())
    });
    let four_right = four.is_some_and(|h| right(&|ground| through(&h, ground)));
    [
        Run {
            right: two_right,
            rounds: two_rounds,
            ms: two_ms,
        },
        Run {
            right: four_right,
            rounds: four_rounds,
            ms: four_ms,
        },
    ]
}

fn pixel(rng: &mut Pcg64Mcg) -> ImagePoint {
    ImagePoint::new(
        rng.random_range(0.0..f64::from(SIZE.width)),
        rng.random_range(0.0..f64::from(SIZE.height)),
    )
}

fn measure_time<T>(work: impl FnOnce() -> (Option<T>, usize)) -> (Option<T>, usize, f64) {
    let start = Instant::now();
    let (found, rounds) = work();
    (found, rounds, start.elapsed().as_secs_f64() * 1e3)
}

/// Plain RANSAC: fits models to samples of `N` matches, and returns the model with most inliers,
/// these inliers, and the number of iterations.
fn ransac<const N: usize, M: Clone>(
    matches: &[Match],
    rng: &mut Pcg64Mcg,
    models: impl Fn([Match; N]) -> Vec<M>,
    image: impl Fn(&M, Vec3) -> Option<ImagePoint>,
) -> (Option<(M, Vec<Match>)>, usize) {
    let agrees = |model: &M, seen: &Match| {
        image(model, seen.ground).is_some_and(|image| image.distance_px(seen.image) <= AGREES_PX)
    };
    let mut best: Option<(M, usize)> = None;
    let (mut rounds, mut wanted) = (0, MOST_ROUNDS);
    while rounds < wanted {
        rounds += 1;
        // Without repetition, as no match is drawn twice in a sample.
        let drawn = sample(rng, matches.len(), N);
        let sampled = std::array::from_fn(|index| matches[drawn.index(index)]);
        for model in models(sampled) {
            let count = matches.iter().filter(|seen| agrees(&model, seen)).count();
            if best.as_ref().is_none_or(|(_, most)| count > *most) {
                // Each better model raises the estimated share of inliers and lowers the iterations
                // still needed. If all agree, these are 0, as ln 0 is infinite.
                let inliers = count as f64 / matches.len() as f64;
                let needed = rounds_for_success(inliers, N);
                wanted = (needed.ceil() as usize).clamp(1, MOST_ROUNDS);
                best = Some((model, count));
            }
        }
    }
    let best = best.map(|(model, _)| {
        let agreeing = matches
            .iter()
            .filter(|seen| agrees(&model, seen))
            .copied()
            .collect();
        (model, agreeing)
    });
    (best, rounds)
}

/// RANSAC with the two-point solver and a known base, then refinement on all inliers. Returns the
/// camera and the number of iterations.
fn by_two_points(base: &CameraBase, matches: &[Match], rng: &mut Pcg64Mcg) -> (Option<Ptz>, usize) {
    let models = |[one, two]: [Match; 2]| -> Vec<PtzCamera> {
        let found = solve_two_points(base, [one.ground, two.ground], [one.image, two.image]);
        found
            .map(|found| found.iter().map(|ptz| PtzCamera::new(*base, ptz)).collect())
            .unwrap_or_default()
    };
    let (best, rounds) = ransac(matches, rng, models, |camera, ground| {
        camera.image_from_world(ground).ok()
    });
    let fitted = best.map(|(camera, agreeing)| {
        let observations: Vec<Observation> = agreeing
            .iter()
            .enumerate()
            .map(|(click, seen)| Observation::from_point(seen.ground, seen.image, NOISE_PX, click))
            .collect();
        // A robust loss: some outliers agree by chance.
        refine(base, camera.ptz(), &observations, Loss::default(), None).ptz
    });
    (fitted, rounds)
}

/// RANSAC with four-point homographies, then a fit to all inliers. Returns the homography and the
/// number of iterations.
pub(super) fn by_four_points(matches: &[Match], rng: &mut Pcg64Mcg) -> (Option<Mat3>, usize) {
    let fitted = |matches: &[Match]| {
        let pairs: Vec<(Vec2, Vec2)> = matches
            .iter()
            .map(|seen| (seen.ground.xy(), Vec2::new(seen.image.x, seen.image.y)))
            .collect();
        homography(&pairs).ok()
    };
    let (best, rounds) = ransac(
        matches,
        rng,
        |sampled: [Match; 4]| fitted(&sampled).into_iter().collect(),
        through,
    );
    (
        // The fit to all inliers may fail although the sample had a model, which is then the
        // answer.
        best.and_then(|(model, agreeing)| fitted(&agreeing).or(Some(model))),
        rounds,
    )
}

/// Number of inliers of a homography.
pub(super) fn agreeing(h: &Mat3, matches: &[Match]) -> usize {
    let agrees = |seen: &&Match| {
        through(h, seen.ground).is_some_and(|at| at.distance_px(seen.image) <= AGREES_PX)
    };
    matches.iter().filter(agrees).count()
}

/// Maps a ground point (x and y) by a homography. None if the result is at infinity.
pub(super) fn through(h: &Mat3, ground: Vec3) -> Option<ImagePoint> {
    let image = h * Vec3::new(ground.x, ground.y, 1.0);
    let (x, y) = (image.x / image.z, image.y / image.z);
    (x.is_finite() && y.is_finite()).then(|| ImagePoint::new(x, y))
}

fn outlier_table(shares: &[(f64, [Outcome; 2])]) -> Table {
    let mut table = Table::new(&[
        ("outliers", "outliers"),
        ("two_points_success", "two points: right"),
        ("two_points_rounds", "rounds (median)"),
        ("four_points_success", "four points: right"),
        ("four_points_rounds", "rounds (median)"),
    ]);
    for (outliers, [two, four]) in shares {
        table.push(vec![
            Cell::Fixed(*outliers, 1),
            Cell::Fixed(two.success, 3),
            Cell::Fixed(two.rounds, 0),
            Cell::Fixed(four.success, 3),
            Cell::Fixed(four.rounds, 0),
        ]);
    }
    table
}

fn success_figure(shares: &[(f64, [Outcome; 2])]) -> Figure {
    let points = |method: usize| {
        shares
            .iter()
            .map(|(outliers, of)| [*outliers, of[method].success])
            .collect()
    };
    Figure::new(
        "Success over the share of outliers",
        Axis::linear("share of outliers").within(0.0, 0.8),
        Axis::linear("share of pictures right").within(0.0, 1.05),
    )
    .with(Series::new("two points", 1, points(0)))
    .with(Series::new("four points (homography)", 2, points(1)).with_mark(Mark::Square))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn half_of_all_matches_wrong_is_no_matter_for_two_points() {
        for trial in 0..4 {
            let [two, four] = compare(0.5, &mut rng(0, [1, trial]));
            assert!(two.right, "trial {trial}");
            assert!(two.rounds < four.rounds, "{} {}", two.rounds, four.rounds);
        }
    }

    #[test]
    fn a_model_that_nothing_agrees_with_does_not_end_the_search() {
        assert_eq!(rounds_for_success(0.0, 4), f64::INFINITY);
        assert_eq!(rounds_for_success(1.0, 4), 0.0);
    }

    #[test]
    fn simulated_success_is_the_requested_one() {
        let table = table_1(&ExperimentOptions {
            quick: true,
            seed: 3,
            seeds: None,
        });
        for row in &table.rows {
            let Cell::Fixed(share, _) = row[4] else {
                panic!("{row:?}")
            };
            assert!((0.98..=1.0).contains(&share), "{row:?}");
        }
        assert_eq!(
            table
                .rows
                .iter()
                .map(|row| row[2].clone())
                .collect::<Vec<_>>(),
            [72.into(), 17.into(), 7.into()]
        );
    }
}
