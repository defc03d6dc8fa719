//! What the drawn highlights assume and the paper does not state, and how table 2 moves with it.
//!
//! Each assumption is varied alone, to a milder and to a harsher value; then all together. The
//! frames show the same places at the same times in all variations, so that differences are those
//! of the assumption.

use super::sequences::introduce;
use crate::progress::{Progress, step_counter};
use crate::report::Report;
use crate::report::paper::TABLE_2;
use crate::scoring::answers::{FrameAnswer, Outcome, Tally, frame_table};
use crate::scoring::forests::{ForestKind, Trained};
use crate::sets::{FrameSet, KnownPicture, Scenery, frames_a_sequence, highlights_in};
use crate::{ExperimentError, SharedInputs};
use touchline::report::{Cell, Table};

/// One frame of a sequence in so many is drawn. Fifteen variations of 40 frames take as long as
/// five sets of the highlights.
const STRIDE: usize = 3;
/// A quick run draws every other frame, and varies all assumptions together only.
const QUICK_STRIDE: usize = 2;

/// An assumption, with a value that makes frames more alike than the default does, and one that
/// makes them less alike.
struct Assumption {
    name: &'static str,
    /// Its value in a scenery, for readers.
    value: fn(&Scenery) -> String,
    milden: fn(&mut Scenery),
    harshen: fn(&mut Scenery),
}

const ASSUMPTIONS: [Assumption; 6] = [
    Assumption {
        name: "spectators replaced",
        value: |scenery| format!("{:.1}", scenery.people_changed[1]),
        milden: |scenery| scenery.people_changed[1] = 0.5,
        harshen: |scenery| scenery.people_changed[1] = 1.0,
    },
    Assumption {
        name: "spectators' movement",
        value: |scenery| format!("{:.0}", scenery.restlessness),
        milden: |scenery| scenery.restlessness = 0.0,
        harshen: |scenery| scenery.restlessness = 2.0,
    },
    Assumption {
        name: "boards redrawn",
        value: |scenery| format!("{:.1}", scenery.boards_changed[1]),
        milden: |scenery| scenery.boards_changed[1] = 0.3,
        harshen: |scenery| scenery.boards_changed[1] = 1.0,
    },
    Assumption {
        name: "shutter",
        value: |scenery| format!("1/{:.0} s", 1.0 / scenery.shoot.shutter_s),
        milden: |scenery| scenery.shoot.shutter_s = 1.0 / 1000.0,
        harshen: |scenery| scenery.shoot.shutter_s = 1.0 / 60.0,
    },
    Assumption {
        name: "defocus",
        value: |scenery| format!("{:.1} px", scenery.shoot.defocus_px_at_1280),
        milden: |scenery| scenery.shoot.defocus_px_at_1280 = 0.0,
        harshen: |scenery| scenery.shoot.defocus_px_at_1280 = 1.6,
    },
    Assumption {
        name: "JPEG quality",
        value: |scenery| scenery.shoot.jpeg_quality.to_string(),
        milden: |scenery| scenery.shoot.jpeg_quality = 90,
        harshen: |scenery| scenery.shoot.jpeg_quality = 30,
    },
];

/// A scenery with one or all assumptions changed.
struct Variation {
    /// Its name in tables and files: `shutter 1/60 s`.
    name: String,
    /// What it replaces, for a single assumption: `1/200 s`.
    instead_of: Option<String>,
    scenery: Scenery,
}

/// A variation with the answers of the forests, in the order of [`ForestKind::PAPER_FIRST`].
struct VariationResult {
    variation: Variation,
    answers: [Vec<FrameAnswer>; ForestKind::PAPER_FIRST.len()],
    tallies: [Tally; ForestKind::PAPER_FIRST.len()],
}

/// Runs the experiment. It draws its frames, whatever frames or data were given.
///
/// # Errors
/// The frames cannot be drawn.
pub fn run(inputs: &SharedInputs, progress: Progress) -> Result<Report, ExperimentError> {
    let options = &inputs.options;
    let stride = options.full_or_quick(STRIDE, QUICK_STRIDE);
    let variations = variations(options.quick);
    // Every sequence begins with its first frame, so that the number is rounded up.
    let frames = TABLE_2.len() * frames_a_sequence(options).div_ceil(stride);
    let step = step_counter(variations.len() * frames, progress);
    let (mut sets, mut measured) = (Vec::new(), Vec::new());
    for variation in variations {
        // The same seed for all variations: places, times and noise are the same, and a difference
        // is that of the assumption.
        let set = highlights_in(options, &variation.scenery, stride, options.seed, &step)?;
        // Each variation is a set of its own, to which its answers refer by index.
        let repeat = sets.len();
        let answers = ForestKind::PAPER_FIRST.map(|kind| {
            Trained::train(&set, repeat, &kind.training(set.seed))
                .ask_plainly(&kind.asking(set.seed))
        });
        measured.push(VariationResult {
            variation,
            tallies: answers
                .each_ref()
                .map(|answers| Tally::from_answers(answers.iter())),
            answers,
        });
        sets.push(without_pictures(set));
    }

    let mut report = Report::new(
        "assumptions",
        &sets[0].heading("Assumptions: how table 2 moves with what the drawn scenes assume"),
    );
    introduce(
        &mut report,
        &sets[..1],
        &format!(
            "They are one in {stride} of the frames of one seed of `highlights`. With fewer \
             references the level is not the one there; what counts is the difference from the \
             row *as assumed*."
        ),
    );
    report.text(&explain());
    for (place, kind) in ForestKind::PAPER_FIRST.into_iter().enumerate() {
        report.text(&summarize(&measured, place, kind));
    }
    report.table(
        "summary",
        "Spectators replaced, boards redrawn: shares in the other game. Movement 1: spectators \
         lean by up to 0.11 m, and one in eight stands; 2: twice that. Defocus: the greatest \
         radius of the blur; each frame has its own. Right: rotation within 1°; wrong: beyond; \
         refused: no answer.",
        summary_table(&measured),
    );
    let ways = measured.iter().flat_map(|measured| {
        let ways = ForestKind::PAPER_FIRST.into_iter().zip(&measured.answers);
        ways.map(move |(kind, answers)| {
            let way = format!("{} {}", measured.variation.name, kind.key());
            (way, answers.as_slice())
        })
    });
    report.data(
        "frames",
        "Every frame, by variation and forest.",
        frame_table(&sets, ways),
    );
    Ok(report)
}

/// The scenery as assumed; each assumption alone, milder and harsher, but for a quick run; all
/// milder and all harsher.
fn variations(quick: bool) -> Vec<Variation> {
    let mut variations = vec![Variation {
        name: "as assumed".to_owned(),
        instead_of: None,
        scenery: Scenery::default(),
    }];
    if !quick {
        for assumption in &ASSUMPTIONS {
            // Each variation starts from the default, so that exactly one assumption differs.
            for change in [assumption.milden, assumption.harshen] {
                let mut scenery = Scenery::default();
                change(&mut scenery);
                variations.push(Variation {
                    name: format!("{} {}", assumption.name, (assumption.value)(&scenery)),
                    instead_of: Some((assumption.value)(&Scenery::default())),
                    scenery,
                });
            }
        }
    }
    let (mut milder, mut harsher) = (Scenery::default(), Scenery::default());
    for assumption in &ASSUMPTIONS {
        (assumption.milden)(&mut milder);
        (assumption.harshen)(&mut harsher);
    }
    for (name, scenery) in [("all milder", milder), ("all harsher", harsher)] {
        variations.push(Variation {
            name: name.to_owned(),
            instead_of: None,
            scenery,
        });
    }
    variations
}

/// The set without pictures and features, of which those of all variations would fill the memory.
/// Names, cameras and sizes stay.
fn without_pictures(mut set: FrameSet) -> FrameSet {
    for frame in &mut set.frames {
        frame.picture = KnownPicture::Drawn(Vec::new());
        frame.features.keypoints = Vec::new();
        frame.features.descriptors = Vec::new();
    }
    set
}

/// Says where the assumptions come from, and which of them stay as they are.
fn explain() -> String {
    let assumed = Scenery::default();
    let ([people, _], [boards, _]) = (assumed.people_changed, assumed.boards_changed);
    format!(
        "None of this is in the paper, whose frames are real. All values were set by eye, to \
         look like broadcast frames of 2014 to 2016, in one commit that replaced drawn sets so \
         easy that most figures were flat lines; they have not been changed since. Not varied: \
         {people} of the spectators and {boards} of the boards change from one sequence to the \
         next of the same game; the exposure changes by {} stops (σ) between sequences and by {} \
         between frames; the noise has {} levels of 255 (σ).",
        assumed.exposure_sigma_ev, assumed.shoot.exposure_sigma_ev, assumed.shoot.noise_levels
    )
}

/// Says in numbers how far a forest's results move.
fn summarize(measured: &[VariationResult], place: usize, kind: ForestKind) -> String {
    // The order of `variations`: as assumed first, all milder and all harsher last. A quick run has
    // no single ones.
    let [assumed, singles @ .., milder, harsher] = measured else {
        return String::new();
    };
    let [iou, iou_milder, iou_harsher] =
        [assumed, milder, harsher].map(|measured| measured.tallies[place].iou_mean);
    let together = format!(
        "*{}*: mean IoU {iou:.3} as assumed, {iou_milder:.3} with all assumptions milder, {iou_harsher:.3} with all harsher.",
        kind.describe()
    );
    let mut by_iou: Vec<&VariationResult> = singles.iter().collect();
    by_iou.sort_by(|one, other| {
        let [one, other] = [one, other].map(|measured| measured.tallies[place].iou_mean);
        one.total_cmp(&other)
    });
    let alone = if let [lowest, .., highest] = by_iou[..] {
        let [down, up] = [lowest, highest].map(|measured| measured.tallies[place].iou_mean - iou);
        format!(
            " One assumption alone moves it by between {down:+.3} ({}) and {up:+.3} ({}).",
            lowest.variation.name, highest.variation.name
        )
    } else {
        String::new()
    };
    let wrong = measured
        .iter()
        .map(|measured| measured.tallies[place].wrong);
    let (least, most) = wrong.fold((usize::MAX, 0), |(least, most), wrong| {
        (least.min(wrong), most.max(wrong))
    });
    // The frames are in the same order in all variations.
    let frames = assumed.answers[place].len();
    // Whether the same frames are right in all variations tells a few hard frames from chance.
    let times_right = |frame: usize| {
        measured
            .iter()
            .filter(|measured| measured.answers[place][frame].outcome() == Outcome::Right)
            .count()
    };
    let always = (0..frames)
        .filter(|&frame| times_right(frame) == measured.len())
        .count();
    let never = (0..frames).filter(|&frame| times_right(frame) == 0).count();
    format!(
        "{together}{alone} One frame more or less moves a mean by up to {:.3}. Of {frames} \
         frames, {always} are right in every row of the table and {never} in no row. Wrong \
         answers in a row: {least} to {most}.",
        // The smallest change that one frame can make, for comparison with the differences above.
        1.0 / frames as f64
    )
}

/// A row for each variation. For readers, some numbers share a column; in files each has its own.
fn summary_table(measured: &[VariationResult]) -> Table {
    let mut table = Table::new(&[
        ("variation", "assumption"),
        ("instead_of", "instead of"),
        ("published_iou", "--published: IoU"),
        ("published_counts", "right / wrong / refused"),
        ("published_right", ""),
        ("published_wrong", ""),
        ("published_refused", ""),
        ("default_iou", "default: IoU"),
        ("default_counts", "right / wrong / refused"),
        ("default_right", ""),
        ("default_wrong", ""),
        ("default_refused", ""),
        (
            "rotation",
            "rotation error, median (°): --published / default",
        ),
        ("published_rotation_median_deg", ""),
        ("default_rotation_median_deg", ""),
    ]);
    for VariationResult {
        variation, tallies, ..
    } in measured
    {
        let mut row = vec![
            Cell::from(variation.name.as_str()),
            variation.instead_of.clone().into(),
        ];
        for tally in tallies {
            let counts = [tally.right, tally.wrong, tally.refused];
            row.push(Cell::Fixed(tally.iou_mean, 3));
            row.push(counts.map(|count| count.to_string()).join(" / ").into());
            row.extend(counts.map(Cell::from));
        }
        let medians_deg = tallies.map(|tally| tally.rotation_median_deg);
        let described = medians_deg.map(|deg| Cell::Fixed(deg, 5).to_string());
        row.push(described.join(" / ").into());
        row.extend(medians_deg.map(Cell::from));
        table.push(row);
    }
    table
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::collections::BTreeSet;

    #[test]
    fn variations_differ_from_the_default_as_their_names_say() {
        let all = variations(false);
        assert_eq!(all.len(), 1 + 2 * ASSUMPTIONS.len() + 2);
        let names: BTreeSet<&str> = all
            .iter()
            .map(|variation| variation.name.as_str())
            .collect();
        assert_eq!(names.len(), all.len(), "{names:?}");
        assert!(names.contains("shutter 1/60 s"), "{names:?}");
        let changed = |scenery: &Scenery| {
            let differs = |assumption: &&Assumption| {
                (assumption.value)(scenery) != (assumption.value)(&Scenery::default())
            };
            ASSUMPTIONS.iter().filter(differs).count()
        };
        for variation in &all {
            let expected = match variation.name.as_str() {
                "as assumed" => 0,
                "all milder" | "all harsher" => ASSUMPTIONS.len(),
                _ => 1,
            };
            assert_eq!(changed(&variation.scenery), expected, "{}", variation.name);
        }
        assert_eq!(variations(true).len(), 3);
    }
}
