//! Comparison of the forest with baselines, as a function of the number of references: matching to
//! the best references with a homography (the paper's baseline), the same with the known base, and
//! nearest neighbours among all references' features.

mod methods;
mod times;

use super::answers::{
    FoundCamera, FrameAnswer, TALLY_EXPLAINED, Tally, describe_difference, difference, frame_table,
    tally_table,
};
use super::forests::{ForestKind, trained_on};
use super::progress::Progress;
use super::sequences::introduce;
use super::sets::{FrameSet, SetKind};
use super::setting::rng;
use super::{ExperimentError, SharedInputs};
use methods::{Matched, Reference};
use rand::seq::SliceRandom;
use rayon::prelude::*;
use touchline_core::camera::PtzCamera;
use touchline_documents::report::figure::{Axis, Figure, Line, Mark, Series};
use touchline_documents::report::{Cell, Report, Verdict};
use touchline_vision::relocalize::{Forest, PoseOptions, SeenRange, relocalize};

/// The methods: names in files and in the report.
const METHODS: [(&str, &str); 5] = [
    ("homography", "best reference, homography"),
    ("known_base", "best reference, known base"),
    ("neighbours", "nearest neighbours"),
    ("default", "default forest"),
    ("published", "--published forest"),
];
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
    let counts = no_more_than(most, wanted);
    let stride = inputs.options.sized(4, 2);
    introduce(
        &mut report,
        sets,
        &format!("One frame in {stride} is asked."),
    );
    report.text(&format!(
        "References are drawn at random from the training frames of a sequence, the same for all methods. *{}*: the paper's baseline, \
         made strong: of the five references with most matches (ratio test) the one whose homography most matches agree with \
         (four-point RANSAC); its camera, without use of the base. *{}*: the same five, each verified by two points with the known \
         base. *{}*: every feature's nearest neighbour among all references is its ray, then the camera as the forests' answers have \
         it. {TALLY_EXPLAINED}",
        METHODS[0].1, METHODS[1].1, METHODS[2].1
    ));
    report.text(ForestKind::EXPLAINED);
    let mut by_count: ByCount = counts
        .iter()
        .map(|count| (*count, std::array::from_fn(|_| Vec::new())))
        .collect();
    // Splits run one after the other, frames of a split in parallel.
    let total = splits().count();
    let mut done = 0;
    for (repeat, set) in sets.iter().enumerate() {
        for split in 0..set.splits.len() {
            ask_split(&Place { set, repeat, split }, stride, &mut by_count);
            done += 1;
            progress(done, total);
        }
    }
    write(&mut report, sets, &by_count);
    let times = times::measured(sets, inputs.options.quick);
    times::write(&mut report, &times);
    if sets[0].kind == SetKind::Drawn {
        claim(&mut report, &by_count, &times);
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
struct Place<'a> {
    set: &'a FrameSet,
    repeat: usize,
    split: usize,
}

/// Runs all methods on the test frames of a split, with each number of references.
fn ask_split(place: &Place<'_>, stride: usize, by_count: &mut ByCount) {
    let (set, split) = (place.set, &place.set.splits[place.split]);
    let mut order = split.training_frames.clone();
    order.shuffle(&mut rng(set.seed, [70, place.split as u64]));
    let references: Vec<Reference<'_>> = order
        .iter()
        .map(|&frame| Reference::of(&set.frames[frame]))
        .collect();
    let forests: Vec<[Option<(Forest, SeenRange)>; 2]> = by_count
        .iter()
        .map(|(count, _)| {
            let known = &references[..(*count).min(references.len())];
            ForestKind::BOTH
                .map(|kind| trained_on(known.iter().map(|one| one.known), &kind.training(set.seed)))
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
            let found = camera.map(|camera| FoundCamera::of(set, frame, &camera));
            FrameAnswer { found, ..blank }
        };
        let of_count = |(count, forests): (&usize, &[Option<(Forest, SeenRange)>; 2])| {
            let references = &references[..*count];
            let ranges = forests[0].as_ref().map(|(_, seen)| seen.plausible());
            let options = PoseOptions {
                seed: set.seed,
                ranges,
                ..PoseOptions::default()
            };
            let by_forest = |number: usize| {
                let (forest, seen) = forests[number].as_ref()?;
                let asking = ForestKind::BOTH[number].asking(set.seed);
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
    for of_frame in answers {
        for ((_, methods), of_count) in by_count.iter_mut().zip(of_frame) {
            for (method, answers) in methods.iter_mut().zip(of_count) {
                method.push(answers);
            }
        }
    }
}

/// Adds a table for each method, and the figure of all.
fn write(report: &mut Report, sets: &[FrameSet], by_count: &ByCount) {
    let mut figure = Figure::new(
        "",
        Axis::log("references"),
        Axis::linear("mean IoU").within(0.5, 1.0),
    );
    for (method, (key, name)) in METHODS.into_iter().enumerate() {
        let tallies: Vec<(Cell, Tally)> = by_count
            .iter()
            .map(|(count, answers)| ((*count).into(), Tally::of(answers[method].iter())))
            .collect();
        let each = || {
            by_count
                .iter()
                .zip(&tallies)
                .map(|((count, _), (_, tally))| (*count as f64, tally))
        };
        let aside = ASIDE.powi(method as i32 - METHODS.len() as i32 / 2);
        let points = each()
            .map(|(count, tally)| [count * aside, tally.iou_mean])
            .collect();
        let bars = each().map(|(_, tally)| tally.iou_interval).collect();
        let (mark, line) = MARKS[method];
        figure = figure.with(
            Series::new(name, method + 1, points)
                .with_bars(bars)
                .marked(mark)
                .lined(line),
        );
        report.table(
            key,
            &format!("{name}."),
            tally_table(("references", "references"), &tallies),
        );
    }
    report.figure(
        "iou",
        "Mean IoU (not found: 0) over the number of references, the methods of one number side by side; bars: 95 % interval over the seeds.",
        figure,
    );
    let ways = by_count.iter().flat_map(|(count, answers)| {
        METHODS
            .iter()
            .zip(answers)
            .map(move |((key, _), answers)| (format!("{key}, {count} references"), &answers[..]))
    });
    report.data(
        "frames",
        "Every frame asked, by method and number of references.",
        frame_table(sets, ways),
    );
    report.text(
        "Times of one frame over the number of references, all methods side by side in one run: in the file of times.",
    );
}

/// Adds the claims of the paper that are tested.
fn claim(report: &mut Report, by_count: &ByCount, times: &times::Times) {
    if let Some((count, answers)) = by_count.last() {
        let iou = |method: usize| Tally::of(answers[method].iter()).iou_mean;
        let gain =
            |method: usize| difference(&answers[method], &answers[0], |tally| tally.iou_mean);
        report.claim(
            Verdict::above(gain(4), 0.0),
            "Their method beats matching to a nearest reference (CalibMe: .68 against .83)",
            &format!(
                "IoU with {count} references: homography of the best {:.2}, best with known base {:.2}, nearest neighbours {:.2}, \
                 default forest {:.2} ({} more than the homography), --published {:.2} ({})",
                iou(0),
                iou(1),
                iou(2),
                iou(3),
                describe_difference(gain(3)),
                iou(4),
                describe_difference(gain(4))
            ),
            "what helps is the known base: with it the best reference and nearest neighbours can be compared with a forest",
        );
    }
    if let (Some((from, to, matching)), Some((.., default)), Some((.., published))) = (
        times::growth(times, 0),
        times::growth(times, 3),
        times::growth(times, 4),
    ) {
        report.time_claim(
            Verdict::of(published < 0.5 * matching),
            "The time of matching grows with the number of references, a forest's does not",
            &format!(
                "from {from} to {to} references: matching takes {matching:.1} times as long, the default forest {default:.1} times, \
                 --published {published:.1} times"
            ),
            "a --published tree has 30 frames however many there are; one of the default forest has all of them",
        );
    }
}
