//! Relocalizing sequences with other sequences as references, and games with their own frames:
//! tables 2 and 3 of the paper.

use crate::calibme::with_most;
use crate::inputs::{Masks, Sets};
use crate::progress::Progress;
use crate::report::contrast::{Contrast, Statement};
use crate::report::paper::{
    SEQUENCE_FRAMES, Stated as StatedMean, TABLE_2, TABLE_2_AVERAGE, TABLE_3,
};
use crate::report::{Report, Stated};
use crate::scoring::answers::{FrameAnswer, Tally, by_name, frame_table, tally_table};
use crate::scoring::forests::ForestKind;
use crate::scoring::overlays::overlays;
use crate::scoring::sheet::sheet;
use crate::sets::{FrameSet, SetKind};
use crate::{ExperimentError, SharedInputs};
use touchline::report::{Cell, Table};

/// Half a unit of the last digit of the paper's mean `IoU`.
const ROUNDING: f64 = 0.005;

/// Adds a paragraph that describes the frames.
pub fn introduce(report: &mut Report, sets: &[FrameSet], words: &str) {
    let Some(set) = sets.first() else { return };
    // Sets of one experiment are drawn alike but for the seed, so that the first describes all.
    let seeds = match sets.len() {
        1 => String::new(),
        seeds => format!(", drawn with each of {seeds} seeds"),
    };
    report.text(format!("Frames: {}{seeds}. {} {words}", set.title, set.protocol).trim_end());
}

/// Says whose frames an experiment uses again. Drawn ones are described where they are introduced.
pub fn introduce_again(report: &mut Report, sets: &[FrameSet], experiment: &str, words: &str) {
    if sets.iter().all(|set| set.kind == SetKind::Drawn) {
        report.text(format!("Frames: those of *{experiment}*. {words}").trim_end());
    } else {
        introduce(report, sets, words);
    }
}

/// The sets that share a diagram, with their names: the highlights, and the World Cup's games if
/// they are of the same kind. A user's own frames stand in both places and are used once.
///
/// # Errors
/// The frames cannot be drawn or read.
pub fn sets_of_one_kind(
    inputs: &SharedInputs,
    progress: Progress,
) -> Result<Vec<(&'static str, Sets)>, ExperimentError> {
    let kind = inputs.highlights(progress)?[0].kind;
    if kind == SetKind::Own {
        return Ok(vec![("own frames", Sets::Highlights)]);
    }
    let mut sets = vec![("highlights", Sets::Highlights)];
    // Published and drawn frames share no diagram.
    if inputs.worldcup(progress)?[0].kind == kind {
        sets.push(("World Cup", Sets::WorldCup));
    }
    Ok(sets)
}

/// Describes the setting of the synthetic highlights.
const DRAWN_HIGHLIGHTS: &str = "The setting is the paper's: the base of its published sequence \
    (behind a corner, 6.4 m up), a field of 118 × 70 yards, and for each sequence the ranges of \
    pan, tilt and focal length of table 2; sequences 1 and 2 show one game, 3 and 4 another. \
    Players are not masked. The base is exactly known, and there are no cuts, flags, smoke, rain \
    or moving shadows. What changes from frame to frame and from game to game is in \
    `assumptions`.";

/// Four sequences of 29 frames, each relocalized with the other three as references (the paper's
/// `highlights`).
pub fn highlights(inputs: &SharedInputs, progress: Progress) -> Result<Report, ExperimentError> {
    let sets = inputs.highlights(progress)?;
    let kind = sets[0].kind;
    let heading = if kind == SetKind::Own {
        "Sequences: relocalized with other sequences"
    } else {
        "Highlights: table 2"
    };
    let mut report = Report::new("highlights", &sets[0].heading(heading));
    introduce(&mut report, sets, "");
    let mut paper: Vec<[StatedMean; 2]> = TABLE_2
        .iter()
        .map(|sequence| [sequence.calib_me, sequence.theirs])
        .collect();
    // In the order of the rows: the sequences, then all.
    paper.push(TABLE_2_AVERAGE);
    match kind {
        SetKind::Drawn => report.text(DRAWN_HIGHLIGHTS),
        SetKind::Published => report.text(&format!(
            "The paper's table 2 has {SEQUENCE_FRAMES} frames in each of four sequences."
        )),
        // The paper's numbers are of its own frames.
        SetKind::Own => paper.clear(),
    }
    tables(&mut report, inputs, Sets::Highlights, &paper, progress)?;
    if kind == SetKind::Drawn {
        claims_of_table_2(&mut report);
    }
    Ok(report)
}

/// Two games of 42 and 33 frames, half of them for training (the paper's `worldcup`).
pub fn worldcup(inputs: &SharedInputs, progress: Progress) -> Result<Report, ExperimentError> {
    let sets = inputs.worldcup(progress)?;
    let kind = sets[0].kind;
    let mut report = Report::new("worldcup", &sets[0].heading("World Cup: table 3"));
    introduce(&mut report, sets, "");
    let paper: Vec<[StatedMean; 2]> = TABLE_3.iter().map(|(.., stated)| *stated).collect();
    let paper = if kind == SetKind::Own {
        &[][..]
    } else {
        &paper
    };
    tables(&mut report, inputs, Sets::WorldCup, paper, progress)?;
    if kind == SetKind::Drawn {
        let reasons = [
            "drawn with the game's own camera, from published homographies",
            "drawn with the camera of another game of the tournament",
        ];
        for ((game, _, [calib_me, theirs]), reason) in TABLE_3.into_iter().zip(reasons) {
            let (place, game) = (format!("Table 3, {game}"), Some(game));
            claim_level(&mut report, &place, game, theirs, reason);
            // The lead has its own claim, because the level depends on the frames and the lead on
            // the method.
            let lead = Stated::difference(theirs.mean, calib_me.mean);
            claim_lead(&mut report, &place, game, lead);
        }
    }
    Ok(report)
}

/// Adds the claims that compare the synthetic highlights with table 2.
fn claims_of_table_2(report: &mut Report) {
    let [calib_me, theirs] = TABLE_2_AVERAGE;
    let reason = "a mean of accuracy there (.88 ± .06 in sequence 1), of refusals here: nearly every answer is exact";
    claim_level(report, "Table 2, average", None, theirs, reason);
    let lead = Stated::difference(theirs.mean, calib_me.mean);
    claim_lead(report, "Table 2, average", None, lead);
    let five_against_five = |way: &str| {
        Contrast::over_frames("iou_part")
            .plus(&[("way", &with_most(way))])
            .minus(&[("way", &with_most("calibme"))])
    };
    Statement::new(
        "Table 2, average: IoU above CalibMe's if the forest has the same five references",
        Stated::Nothing,
        "the paper compares five references with all; a part of its lead is their number",
    )
    .test(report, &on_both(five_against_five));
    // The lead of the mean of the sequences other than the third.
    let others = TABLE_2.map(|sequence| sequence.theirs.mean);
    let mean_of_others = (others[0] + others[1] + others[3]) / 3.0;
    let lead_of_others = |way: &str| {
        [1, 2, 4].into_iter().fold(
            Contrast::over_frames("iou_part").minus(&[("way", way), ("sequence", "sequence 3")]),
            |contrast, other| {
                let sequence = format!("sequence {other}");
                contrast.add(1.0 / 3.0, &[("way", way), ("sequence", &sequence)])
            },
        )
    };
    Statement::new(
        "Table 2: sequence 3 is weakest, as a part of its pan range is in no training sequence (its IoU below the mean of the others)",
        Stated::difference(mean_of_others, others[2]),
        "drawn with the table's pan ranges, so the cause is the paper's by construction",
    )
    .test(report, &on_both(lead_of_others));
}

/// Adds the claim about a mean `IoU`, of one game or of all frames.
fn claim_level(
    report: &mut Report,
    place: &str,
    game: Option<&str>,
    theirs: StatedMean,
    reason: &str,
) {
    let mean = |way: &str| Contrast::over_frames("iou_part").plus(&rows(way, game));
    let words = format!("{place}: mean IoU");
    Statement::new(&words, Stated::Level(theirs.mean, ROUNDING), reason)
        .test(report, &on_both(mean));
}

/// Adds the claim that the forest of all references is better than `CalibMe` with five.
fn claim_lead(report: &mut Report, place: &str, game: Option<&str>, lead: Stated) {
    let calibme = with_most("calibme");
    let lead_of = |way: &str| {
        Contrast::over_frames("iou_part")
            .plus(&rows(&name_untested(way), game))
            .minus(&rows(&calibme, game))
    };
    let words = format!("{place}: IoU above CalibMe's");
    let reason = "CalibMe here: five references by farthest points, a homography (*baselines* has five at random); no answer is tested on either side";
    Statement::new(&words, lead, reason).test(report, &on_both(lead_of));
}

/// The rows of a method, in one game or in all.
fn rows<'a>(way: &'a str, game: Option<&'a str>) -> Vec<(&'static str, &'a str)> {
    let game = game.map(|game| ("sequence", game));
    std::iter::once(("way", way)).chain(game).collect()
}

/// The name of a forest's answers without the test of their confidence.
fn name_untested(way: &str) -> String {
    format!("{way} untested")
}

/// A measurement on both forests, the paper's first.
pub fn on_both(contrast: impl Fn(&str) -> Contrast) -> [(&'static str, Contrast); 2] {
    ForestKind::PAPER_FIRST.map(|kind| (kind.key(), contrast(kind.key())))
}

/// Adds tables and the contact sheet of all test frames.
fn tables(
    report: &mut Report,
    inputs: &SharedInputs,
    which: Sets,
    paper: &[[StatedMean; 2]],
    progress: Progress,
) -> Result<(), ExperimentError> {
    let sets = inputs.sets(which, progress)?;
    let mut ways: Vec<(String, Vec<FrameAnswer>)> = Vec::new();
    for kind in ForestKind::PAPER_FIRST {
        let answers = inputs.answers(which, kind, Masks::AsTheyAre, progress)?;
        ways.push((kind.key().to_owned(), answers.to_vec()));
        // The camera before the test is in each answer, so that nothing is computed again.
        let tested_off = answers.iter().map(FrameAnswer::without_test).collect();
        ways.push((name_untested(kind.key()), tested_off));
        if inputs.are_drawn(which, progress)? {
            let masked = inputs.answers(which, kind, Masks::Masked, progress)?;
            ways.push((format!("{} masked", kind.key()), masked.to_vec()));
        }
    }
    let chosen = inputs.calibme(which, progress)?;
    ways.extend(
        chosen
            .iter()
            .map(|way| (way.way.clone(), way.answers.clone())),
    );
    report.table(
        "summary",
        "*untested*: without the test of whether an answer is to be trusted; *masked*: without \
         the features on players; a number: so many references, chosen by farthest points, \
         instead of all.",
        summary(&sets[0], &ways, paper),
    );
    let answers = inputs.answers(which, ForestKind::Published, Masks::AsTheyAre, progress)?;
    // Labels of synthetic frames are exact, so overlays would add nothing.
    if !inputs.are_drawn(which, progress)? {
        overlays(report, &sets[0], answers, &by_name(&sets[0], answers));
    }
    let each = ways.iter().map(|(way, answers)| (way, &answers[..]));
    report.data("frames", "Every frame, by method.", frame_table(sets, each));
    if let Some(png) = sheet(sets, answers)? {
        report.picture(
            "sheet",
            "Two wrong, two refused and two right answers of the published forest, as far as \
             there are; orange: by the answer, blue: by the true camera.",
            png,
        );
    }
    Ok(())
}

/// A row for each method over all frames; of both forests also one for each sequence, beside the
/// paper's numbers.
fn summary(
    set: &FrameSet,
    ways: &[(String, Vec<FrameAnswer>)],
    paper: &[[StatedMean; 2]],
) -> Table {
    let (mut tallies, mut stated) = (Vec::new(), Vec::new());
    for (way, answers) in ways {
        let parts = by_name(set, answers);
        // Rows by sequence for the two forests as they are; other methods have one row, or the
        // table would be too long to read.
        let by_part = ForestKind::BOTH.iter().any(|kind| kind.key() == way);
        for (number, (part, answers)) in parts.iter().enumerate() {
            let is_all = number + 1 == parts.len();
            if !is_all && !by_part {
                continue;
            }
            // `paper` has `CalibMe` first, the paper's method second.
            let method = usize::from(!way.starts_with("calibme"));
            let beside = paper.get(number).filter(|_| by_part || method == 0);
            stated.push(beside.map_or(Cell::Empty, |stated| stated[method].describe().into()));
            let tally = Tally::from_answers(answers.iter().copied());
            tallies.push((Cell::from(format!("{way}, {part}")), tally));
        }
    }
    let table = tally_table(("method", "method, sequence"), &tallies);
    if paper.is_empty() {
        return table;
    }
    table.with_column("paper", "paper: IoU ± SD", stated)
}
