//! The time of one frame as a function of the number of references. All methods are timed one after
//! the other in one run.

use super::methods::{Matched, Reference};
use super::{MARKS, METHODS, no_more_than};
use crate::forests::{ForestKind, trained_on};
use crate::sets::{FrameSet, KnownFrame};
use std::hint::black_box;
use std::time::Instant;
use touchline_core::geometry::quantile;
use touchline_documents::report::figure::{Axis, Figure, Series};
use touchline_documents::report::{Cell, Column, Report, Table};
use touchline_vision::relocalize::{PoseOptions, SeenRange, relocalize};

/// Numbers of references.
const COUNTS: [usize; 7] = [5, 10, 20, 50, 100, 200, 500];
const QUICK_COUNTS: [usize; 3] = [5, 20, 40];
/// Number of frames that are timed.
const TESTED: usize = 6;

/// Median times (ms) of the methods, by the number of references.
pub type Times = Vec<(usize, [f64; METHODS.len()])>;

/// Measures the times. References are the training frames of the first split, then frames of the
/// sets with other seeds. These show other stadiums, but cost as much.
pub fn measured(sets: &[FrameSet], quick: bool) -> Times {
    let Some((set, split)) = sets
        .first()
        .and_then(|set| Some((set, set.splits.first()?)))
    else {
        return Vec::new();
    };
    let own = split
        .training_frames
        .iter()
        .map(|&frame| &set.frames[frame]);
    let others = sets.iter().skip(1).flat_map(|set| &set.frames);
    let references: Vec<&KnownFrame> = own.chain(others).collect();
    let wanted: &[usize] = if quick { &QUICK_COUNTS } else { &COUNTS };
    let counts = no_more_than(references.len(), wanted);
    let stride = (split.test_frames.len() / TESTED).max(1);
    let tested: Vec<&KnownFrame> = split
        .test_frames
        .iter()
        .step_by(stride)
        .map(|&frame| &set.frames[frame])
        .collect();
    counts
        .into_iter()
        .map(|count| (count, of_count(&references[..count], &tested, set.seed)))
        .collect()
}

/// Median times (ms) of the methods with these references.
fn of_count(references: &[&KnownFrame], tested: &[&KnownFrame], seed: u64) -> [f64; METHODS.len()] {
    // Preparation is not timed: descriptors of references and trained forests are ready.
    let ready: Vec<Reference<'_>> = references
        .iter()
        .map(|known| Reference::of(known))
        .collect();
    let forests = ForestKind::BOTH.map(|kind| {
        (
            trained_on(references.iter().copied(), &kind.training(seed)),
            kind.asking(seed),
        )
    });
    let looked: Vec<_> = references.iter().map(|known| known.truth.ptz()).collect();
    let ranges = SeenRange::of(&looked).map(|seen| seen.plausible());
    let options = PoseOptions {
        ranges,
        seed,
        ..PoseOptions::default()
    };
    let mut times: [Vec<f64>; METHODS.len()] = std::array::from_fn(|_| Vec::new());
    for known in tested {
        let mut take = |method: usize, work: &dyn Fn()| {
            let start = Instant::now();
            work();
            times[method].push(start.elapsed().as_secs_f64() * 1e3);
        };
        take(0, &|| {
            _ = black_box(Matched::to(known, &ready, seed).by_homography(&ready));
        });
        take(1, &|| {
            _ = black_box(Matched::to(known, &ready, seed).by_known_base(&ready, &options));
        });
        take(2, &|| {
            _ = black_box(Matched::to(known, &ready, seed).by_neighbours(&ready, &options));
        });
        for (number, (forest, asking)) in forests.iter().enumerate() {
            if let Some((forest, seen)) = forest {
                take(3 + number, &|| {
                    drop(black_box(relocalize(
                        &known.features,
                        forest,
                        seen,
                        known.truth.base(),
                        asking,
                    )));
                });
            }
        }
    }
    times.map(|mut times| {
        times.sort_by(f64::total_cmp);
        quantile(&times, 0.5)
    })
}

/// The growth of a method's time: the number of references to start from, the maximum number, and
/// the ratio of the times. The start is the smallest number that is at least a tenth of the
/// maximum.
pub fn growth(times: &Times, method: usize) -> Option<(usize, usize, f64)> {
    let (most, last) = times.last()?;
    let (from, first) = times.iter().find(|(count, _)| 10 * count >= *most)?;
    Some((*from, *most, last[method] / first[method]))
}

/// Adds the table and the figure of times.
pub fn write(report: &mut Report, times: &Times) {
    let mut table = Table::new(&[("references", "references")]);
    table
        .columns
        .extend(METHODS.map(|(key, name)| Column::new(&format!("{key}_ms"), name)));
    for (count, times) in times {
        let mut row: Vec<Cell> = vec![(*count).into()];
        row.extend(times.map(Cell::Number));
        table.push(row);
    }
    let mut figure = Figure::new(
        "",
        Axis::log("references"),
        Axis::log("time of one frame (ms)"),
    );
    for (method, (_, name)) in METHODS.into_iter().enumerate() {
        let points = times
            .iter()
            .map(|(count, times)| [*count as f64, times[method]])
            .collect();
        let (mark, line) = MARKS[method];
        figure = figure.with(
            Series::new(name, method + 1, points)
                .marked(mark)
                .lined(line),
        );
    }
    report.time_table(
        "references-times",
        "One frame, features found already, median of a few frames (ms), on one thread.",
        table,
    );
    report.time_figure(
        "growth-times",
        "The time of one frame over the number of references, on one thread.",
        figure,
    );
}
