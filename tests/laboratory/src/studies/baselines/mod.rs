//! Comparison of the forest with baselines, as a function of the number of references: matching to
//! the best references with a homography (the paper's baseline), the same with the known base, and
//! nearest neighbours among all references' features.

pub(crate) mod methods;
mod times;

use super::sequences::introduce_again;
use crate::progress::Progress;
use crate::report::Report;
use crate::scoring::answers::{FrameAnswer, Tally, frame_table, tally_table};
use crate::scoring::forests::{ForestKind, train_forest, without_test};
use crate::sets::{FrameSet, SetKind};
use crate::setting::rng;
use crate::{ExperimentError, SharedInputs};
use methods::{Matched, Reference};
use rand::seq::SliceRandom;
use rayon::prelude::*;
use touchline::camera::PtzCamera;
use touchline::relocalize::{Forest, PoseOptions, SeenRange, relocalize};
use touchline::report::Cell;
use touchline::report::figure::{Axis, Figure, Line, Mark, Series};

/// The methods: names in files and in the report.
const METHODS: [(&str, &str); 5] = [
    ("homography", "best reference, homography"),
    ("known_base", "best reference, known base"),
    ("neighbours", "nearest neighbours"),
    ("default", "default forest"),
    ("published", "--published forest"),
];
/// Places in [`METHODS`].
const HOMOGRAPHY: usize = 0;
const DEFAULT: usize = 3;
const PUBLISHED: usize = 4;
const MARKS: [(Mark, Line); METHODS.len()] = [
    (Mark::Square, Line::Solid),
    (Mark::Square, Line::Dashed),
    (Mark::Triangle, Line::Solid),
    (Mark::Disc, Line::Solid),
    (Mark::Disc, Line::Dashed),
];
/// Factor between the horizontal positions of neighbouring methods in the figure, so that their
/// error bars do not overlap.
const ASIDE: f64 = 1.025;
/// Numbers of references of a split.
const COUNTS: [usize; 5] = [5, 10, 20, 40, 87];
const QUICK_COUNTS: [usize; 2] = [5, 15];

/// The results of each method, by the number of references.
type ByCount = Vec<(usize, [Vec<FrameAnswer>; METHODS.len()])>;

/// Runs the experiment.
///
/// # Errors
/// The frames cannot be drawn or read.
pub fn run(inputs: &SharedInputs, progress: Progress) -> Result<Report, ExperimentError> {
    let sets = inputs.highlights(progress)?;
    let mut report = Report::new(
        "baselines",
        &sets[0].heading("Baselines: over the number of references"),
    );
    // The numbers of references: at most as many as the largest split has.
    let splits = || sets.iter().flat_map(|set| &set.splits);
    let most = splits()
        .map(|split| split.training_frames.len())
        .max()
        .unwrap_or(0);
    let wanted: &[usize] = if inputs.options.quick {
        &QUICK_COUNTS
    } else {
        &COUNTS
    };
    // A set of few frames gives fewer numbers, none of them twice.
    let counts = no_more_than(most, wanted);
    let stride = inputs.options.full_or_quick(4, 2);
    introduce_again(
        &mut report,
        sets,
        "highlights",
        &format!("One frame in {stride} is tested."),
    );
    report.text(&format!(
        "References are drawn at random from the training frames of a sequence, the same for all \
         methods. *{}*: the paper's baseline, made strong: of the five references with most \
         matches (ratio test) the one whose homography most matches agree with (four-point \
         RANSAC); its camera, without use of the base. *{}*: the same five, each verified by two \
         points with the known base. *{}*: every feature's nearest neighbour among all \
         references is its ray, then the camera as from a forest's rays. No method tests its \
         answer here: the program's rule of confidence is left off for all.",
        METHODS[0].1, METHODS[1].1, METHODS[2].1
    ));
    let mut by_count: ByCount = counts
        .iter()
        .map(|count| (*count, std::array::from_fn(|_| Vec::new())))
        .collect();
    // Splits run one after the other, frames of a split in parallel.
    let total = splits().count();
    let mut done = 0;
    for (repeat, set) in sets.iter().enumerate() {
        for split in 0..set.splits.len() {
            ask_split(&SplitOfSet { set, repeat, split }, stride, &mut by_count);
            done += 1;
            progress(done, total);
        }
    }
    write(&mut report, sets, &by_count);
    let times = times::measure_times(sets, inputs.options.quick)?;
    times::write(&mut report, &times);
    if sets[0].kind == SetKind::Drawn {
        times::claims(&mut report);
    }
    Ok(report)
}

/// The numbers of references, limited to `most`, without repetition.
fn no_more_than(most: usize, wanted: &[usize]) -> Vec<usize> {
    let mut counts: Vec<usize> = wanted.iter().map(|count| (*count).min(most)).collect();
    counts.dedup();
    counts
}

/// A split of a set, and the set's index among those of other seeds.
struct SplitOfSet<'a> {
    set: &'a FrameSet,
    repeat: usize,
    split: usize,
}

/// Runs all methods on the test frames of a split, with each number of references.
fn ask_split(place: &SplitOfSet<'_>, stride: usize, by_count: &mut ByCount) {
    let (set, split) = (place.set, &place.set.splits[place.split]);
    let mut order = split.training_frames.clone();
    // One order for all numbers: the five references are among the ten, so that curves differ by
    // the number alone.
    order.shuffle(&mut rng(set.seed, [70, place.split as u64]));
    let references: Vec<Reference<'_>> = order
        .iter()
        .map(|&frame| Reference::from_known_frame(&set.frames[frame]))
        .collect();
    // Trained for each number on the first references, as the other methods get them.
    let forests: Vec<[Option<(Forest, SeenRange)>; 2]> = by_count
        .iter()
        .map(|(count, _)| {
            let known = &references[..(*count).min(references.len())];
            ForestKind::BOTH.map(|kind| {
                train_forest(known.iter().map(|one| one.known), &kind.training(set.seed))
            })
        })
        .collect();
    let counts: Vec<usize> = by_count
        .iter()
        .map(|(count, _)| (*count).min(order.len()))
        .collect();
    let tested: Vec<usize> = split.test_frames.iter().copied().step_by(stride).collect();
    let one = |&frame: &usize| -> Vec<[FrameAnswer; METHODS.len()]> {
        let known = &set.frames[frame];
        // Match once to all references. Smaller numbers use the first of them.
        let matched = Matched::to(known, &references, set.seed.wrapping_add(frame as u64));
        let blank = FrameAnswer::blank(set, place.repeat, place.split, frame);
        let answered = |camera: Option<PtzCamera>| {
            camera.map_or(blank, |camera| blank.with_camera(set, &camera, true))
        };
        let of_count = |(count, forests): (&usize, &[Option<(Forest, SeenRange)>; 2])| {
            let references = &references[..*count];
            // Methods without a forest get the same limits of plausible cameras, which follow from
            // where the references look.
            let ranges = forests[0].as_ref().map(|(_, seen)| seen.plausible());
            let options = PoseOptions {
                seed: set.seed,
                ranges,
                min_confidence: 0.0,
                ..PoseOptions::default()
            };
            let by_forest = |number: usize| {
                let (forest, seen) = forests[number].as_ref()?;
                let asking = without_test(&ForestKind::BOTH[number].asking(set.seed));
                let answer = relocalize(&known.features, forest, seen, known.truth.base(), &asking);
                answer
                    .pose
                    .ok()
                    .map(|pose| PtzCamera::new(*known.truth.base(), pose.ptz))
            };
            [
                matched.by_homography(references),
                matched.by_known_base(references, &options),
                matched.by_neighbours(references, &options),
                by_forest(0),
                by_forest(1),
            ]
            .map(answered)
        };
        counts.iter().zip(&forests).map(of_count).collect()
    };
    let answers: Vec<Vec<[FrameAnswer; METHODS.len()]>> = tested.par_iter().map(one).collect();
    // Sorted from frames into methods and numbers, in the order of the frames.
    for of_frame in answers {
        for ((_, methods), of_count) in by_count.iter_mut().zip(of_frame) {
            for (method, answers) in methods.iter_mut().zip(of_count) {
                method.push(answers);
            }
        }
    }
}

/// Adds the table and the figure of all methods.
fn write(report: &mut Report, sets: &[FrameSet], by_count: &ByCount) {
    let mut figure = Figure::new(
        "Mean IoU by number of references",
        Axis::log("references"),
        Axis::linear("mean IoU").within(0.5, 1.0),
    );
    let mut rows: Vec<(Cell, Tally)> = Vec::new();
    for (method, (_, name)) in METHODS.into_iter().enumerate() {
        let tallies: Vec<(f64, Tally)> = by_count
            .iter()
            .map(|(count, answers)| (*count as f64, Tally::from_answers(answers[method].iter())))
            .collect();
        // A factor, because the axis is logarithmic; the middle method stays in place.
        let aside = ASIDE.powi(method as i32 - METHODS.len() as i32 / 2);
        let points = tallies
            .iter()
            .map(|(count, tally)| [count * aside, tally.iou_mean])
            .collect();
        let bars = tallies
            .iter()
            .map(|(_, tally)| tally.iou_interval)
            .collect();
        let (mark, line) = MARKS[method];
        figure = figure.with(
            Series::new(name, method + 1, points)
                .with_bars(bars)
                .with_mark(mark)
                .with_line(line),
        );
        // The figure has all of them, the table the fewest and the most references.
        let ends = [tallies.first(), tallies.last()].into_iter().flatten();
        rows.extend(ends.map(|(count, tally)| (format!("{name}, {count}").into(), *tally)));
    }
    report.figure(
        "iou",
        "Mean IoU (no answer: 0) by number of references; bars: 95 % interval over the seeds.",
        figure,
    );
    report.table(
        "methods",
        "By method and number of references.",
        tally_table(("method", "method, references"), &rows),
    );
    let ways = by_count.iter().flat_map(|(count, answers)| {
        METHODS
            .iter()
            .zip(answers)
            .map(move |((key, _), answers)| (format!("{key} {count}"), &answers[..]))
    });
    report.data(
        "frames",
        "Every frame, by method and number of references.",
        frame_table(sets, ways),
    );
}
