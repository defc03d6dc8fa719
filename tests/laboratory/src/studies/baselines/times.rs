//! The time of one frame as a function of the number of references. All methods are timed one after
//! the other in one run.

use super::super::sequences::on_both;
use super::methods::{Matched, Reference};
use super::{DEFAULT, HOMOGRAPHY, MARKS, METHODS, PUBLISHED, no_more_than};
use crate::ExperimentError;
use crate::report::contrast::{Contrast, Statement};
use crate::report::paper::TABLE_2_SECONDS;
use crate::report::statistics::median_of;
use crate::report::{Report, Stated};
use crate::scoring::forests::{ForestKind, train_forest};
use crate::sets::{FrameSet, KnownFrame, as_picture};
use std::hint::black_box;
use std::time::Instant;
use touchline::features::{FeatureOptions, extract};
use touchline::media::FrameReader;
use touchline::relocalize::{PoseOptions, SeenRange, relocalize};
use touchline::report::figure::{Axis, Figure, Series};
use touchline::report::{Cell, Column, Table};

/// Numbers of references.
const COUNTS: [usize; 7] = [5, 10, 20, 50, 100, 200, 500];
const QUICK_COUNTS: [usize; 3] = [5, 20, 40];
/// Number of frames that are timed.
const TESTED: usize = 6;
/// Number of references of a sequence of table 2: three sequences of 29 frames.
const REFERENCES_OF_TABLE_2: usize = 87;

/// Times of one frame.
pub struct Times {
    /// Finding its features, ms (median).
    features_ms: f64,
    /// The rest, ms (median): of each method, by the number of references.
    answer_ms: Vec<(usize, [f64; METHODS.len()])>,
}

/// Measures the times. References are the training frames of the first split, then frames of the
/// sets with other seeds. These show other stadiums, but cost as much.
///
/// # Errors
/// A picture cannot be read, or its features cannot be found.
pub fn measure_times(sets: &[FrameSet], quick: bool) -> Result<Times, ExperimentError> {
    let Some((set, split)) = sets
        .first()
        .and_then(|set| Some((set, set.splits.first()?)))
    else {
        return Ok(Times {
            features_ms: f64::NAN,
            answer_ms: Vec::new(),
        });
    };
    // The times do not depend on what the references show, so that other stadiums fill up to
    // numbers that one sequence does not have.
    let own = split
        .training_frames
        .iter()
        .map(|&frame| &set.frames[frame]);
    let others = sets.iter().skip(1).flat_map(|set| &set.frames);
    let references: Vec<&KnownFrame> = own.chain(others).collect();
    let wanted: &[usize] = if quick { &QUICK_COUNTS } else { &COUNTS };
    let counts = no_more_than(references.len(), wanted);
    // Spread over the sequence. The last may be one more than `TESTED`.
    let stride = (split.test_frames.len() / TESTED).max(1);
    let tested: Vec<&KnownFrame> = split
        .test_frames
        .iter()
        .step_by(stride)
        .map(|&frame| &set.frames[frame])
        .collect();
    let answer_ms = counts
        .into_iter()
        .map(|count| (count, median_times(&references[..count], &tested, set.seed)))
        .collect();
    Ok(Times {
        features_ms: features_ms(&tested)?,
        answer_ms,
    })
}

/// Median time (ms) of finding a frame's features.
fn features_ms(tested: &[&KnownFrame]) -> Result<f64, ExperimentError> {
    let mut reader = FrameReader::new();
    let mut times = Vec::with_capacity(tested.len());
    for known in tested {
        let picture = as_picture(known.picture(&mut reader)?)?;
        let start = Instant::now();
        // Without `black_box` a result that is not used might not be computed.
        _ = black_box(extract(
            &picture,
            known.used_masks(),
            &FeatureOptions::default(),
        )?);
        times.push(start.elapsed().as_secs_f64() * 1e3);
    }
    Ok(median_of(times))
}

/// Median times (ms) of the methods with these references.
fn median_times(
    references: &[&KnownFrame],
    tested: &[&KnownFrame],
    seed: u64,
) -> [f64; METHODS.len()] {
    // Preparation is not timed: descriptors of references and trained forests are ready.
    let ready: Vec<Reference<'_>> = references
        .iter()
        .map(|known| Reference::from_known_frame(known))
        .collect();
    let forests = ForestKind::BOTH.map(|kind| {
        (
            train_forest(references.iter().copied(), &kind.training(seed)),
            kind.asking(seed),
        )
    });
    let looked: Vec<_> = references.iter().map(|known| known.truth.ptz()).collect();
    let ranges = SeenRange::from_cameras(&looked).map(|seen| seen.plausible());
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
        // Matching is a part of each baseline's time, for it depends on the frame. Each method
        // begins from the frame's features.
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
    times.map(median_of)
}

/// Adds the tables and the figure of times.
pub fn write(report: &mut Report, times: &Times) {
    let mut table = Table::new(&[("references", "references")]);
    table
        .columns
        .extend(METHODS.map(|(key, name)| Column::new(&format!("{key}_ms"), name)));
    for (count, times) in &times.answer_ms {
        let mut row: Vec<Cell> = vec![(*count).into()];
        row.extend(times.map(Cell::Number));
        table.push(row);
    }
    report.time_table(
        "references-times",
        "One frame, features found already, median of a few frames (ms), on one thread.",
        table,
    );
    report.time_table(
        "growth-times",
        "How many times as long with the most references as with about a tenth of them.",
        growth_table(times),
    );
    report.time_table(
        "whole-times",
        "One frame from picture to camera: CalibMe with the fewest references, forests with about as many as table 2 has.",
        whole_table(times),
    );
    let mut figure = Figure::new(
        "Time of one frame by number of references",
        Axis::log("references"),
        Axis::log("time of one frame (ms)"),
    );
    for (method, (_, name)) in METHODS.into_iter().enumerate() {
        let points = times
            .answer_ms
            .iter()
            .map(|(count, times)| [*count as f64, times[method]])
            .collect();
        let (mark, line) = MARKS[method];
        figure = figure.with(
            Series::new(name, method + 1, points)
                .with_mark(mark)
                .with_line(line),
        );
    }
    report.time_figure(
        "references-times-figure",
        "The time of one frame by the number of references, on one thread.",
        figure,
    );
}

/// The growth of each method's time, from the smallest number of references that is at least a
/// tenth of the greatest.
fn growth_table(times: &Times) -> Table {
    let mut table = Table::new(&[
        ("method", "method"),
        ("from", "from"),
        ("to", "to"),
        ("growth", "times as long"),
    ]);
    let Some((most, last)) = times.answer_ms.last() else {
        return table;
    };
    // A tenth, so that both ends are measured and the growth is over one order of magnitude.
    let from = times
        .answer_ms
        .iter()
        .find(|(count, _)| 10 * count >= *most);
    if let Some((from, first)) = from {
        for (method, (key, _)) in METHODS.into_iter().enumerate() {
            table.push(vec![
                key.into(),
                (*from).into(),
                (*most).into(),
                (last[method] / first[method]).into(),
            ]);
        }
    }
    table
}

/// The time from picture to camera of `CalibMe` and of both forests, beside the paper's.
fn whole_table(times: &Times) -> Table {
    let mut table = Table::new(&[
        ("method", "method"),
        ("references", "references"),
        ("features_ms", "features (ms)"),
        ("answer_ms", "camera (ms)"),
        ("whole_ms", "whole (ms)"),
        ("as_published", "times --published"),
        ("paper_ms", "paper (ms)"),
    ]);
    let with_all = times
        .answer_ms
        .iter()
        .find(|(count, _)| *count >= REFERENCES_OF_TABLE_2);
    let (Some((few, least)), Some((many, all))) = (
        times.answer_ms.first(),
        with_all.or_else(|| times.answer_ms.last()),
    ) else {
        return table;
    };
    let [calib_me, theirs] = TABLE_2_SECONDS.map(|seconds| 1e3 * seconds);
    // The paper's times are of its own forest, so that the ratio of `CalibMe` is to that one.
    let published = times.features_ms + all[PUBLISHED];
    for (method, references, answer_ms, paper) in [
        (HOMOGRAPHY, few, least[HOMOGRAPHY], Some(calib_me)),
        (DEFAULT, many, all[DEFAULT], None),
        (PUBLISHED, many, all[PUBLISHED], Some(theirs)),
    ] {
        let whole = times.features_ms + answer_ms;
        table.push(vec![
            METHODS[method].0.into(),
            (*references).into(),
            times.features_ms.into(),
            answer_ms.into(),
            whole.into(),
            (whole / published).into(),
            paper.into(),
        ]);
    }
    table
}

/// Adds the paper's claims about times.
pub fn claims(report: &mut Report) {
    Statement::new(
        "Matching's time grows with the number of references, a forest's does not (growth, forest's less half of matching's)",
        Stated::AtMost(0.0),
        "a --published tree has 30 frames however many there are; one of the default forest has all of them",
    )
    .test_times(
        report,
        &on_both(|kind| {
            Contrast::exact("growth-times", "growth")
                .plus(&[("method", kind)])
                // Less than half of matching's growth is what *does not grow* is tested by: the
                // forest's growth minus half of matching's is at most 0.
                .add(-0.5, &[("method", METHODS[HOMOGRAPHY].0)])
        }),
    );
    let [calib_me, theirs] = TABLE_2_SECONDS;
    Statement::new(
        "Table 2: CalibMe takes so many times as long for a frame, from picture to camera",
        Stated::Level(calib_me / theirs, 0.5),
        "features on both sides; our matching is a product of matrices",
    )
    .test_times(
        report,
        &[(
            "published",
            Contrast::exact("whole-times", "as_published")
                .plus(&[("method", METHODS[HOMOGRAPHY].0)]),
        )],
    );
}
