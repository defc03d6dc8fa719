//! Relocalizing sequences with other sequences as references, and games with their own frames:
//! tables 2 and 3 of the paper.

use super::answers::{
    FrameAnswer, TALLY_EXPLAINED, Tally, by_name, difference, frame_table, tally_table,
};
use super::forests::ForestKind;
use super::inputs::{Masks, Sets};
use super::overlays::overlays;
use super::paper::{SEQUENCE_FRAMES, Stated, TABLE_2, TABLE_2_AVERAGE, TABLE_2_SECONDS, TABLE_3};
use super::progress::Progress;
use super::sets::{FrameSet, SetKind};
use super::{ExperimentError, SharedInputs};
use touchline_core::geometry::AngleRange;
use touchline_core::geometry::quantile;
use touchline_documents::report::figure::{Axis, Figure, Series};
use touchline_documents::report::{Cell, Report, SheetFrame, Table, Verdict, contact_sheet};
use touchline_vision::media::FrameReader;

/// Number of frames on the contact sheet.
const SHEET_FRAMES: usize = 6;

/// Adds a paragraph that describes the frames.
pub fn introduce(report: &mut Report, sets: &[FrameSet], words: &str) {
    let Some(set) = sets.first() else { return };
    let seeds = match sets.len() {
        1 => String::new(),
        seeds => format!(", drawn with each of {seeds} seeds"),
    };
    report.text(format!("Frames: {}{seeds}. {} {words}", set.title, set.protocol).trim_end());
}

/// Describes the setting of the synthetic highlights.
const DRAWN_HIGHLIGHTS: &str = "The setting is the paper's: the base of its published sequence (behind a corner, 6.4 m up), a field of 118 × 70 \
    yards, for each sequence the ranges of pan, tilt and focal length of its table 2, each reached; sequences 1 and 2 are of one game, 3 and 4 of \
    another. Spectators lean and stand up from frame to frame, one in ten is another person in each sequence and nine in ten in the other game; a \
    quarter of the boards (in the other game .6) are drawn again, exposure changes by .35 stops between sequences (σ). Motion blur, a lens \
    not quite sharp, noise and JPEG 60 as in broadcast frames. **Players are not masked**; the column *masked* leaves out the \
    features in their boxes and on the score graphic. What a drawn stadium lacks against a real one: turf and stands \
    are static apart from this, there are no cuts, flags, smoke, rain or moving shadows, and the base is exactly known.";

/// Describes the setting of the synthetic games.
const DRAWN_WORLD_CUP: &str = "The paper does not state the cameras of its World Cup frames. Here each game has a stadium and a main camera of its own \
    (66 m from the middle, 18 m up), focal length 1300 to 4200 px; spectators, boards, exposure and picture as for the highlights, players \
    not masked.";

/// Four sequences of 29 frames, each relocalized with the other three as references (the paper's
/// `highlights`).
pub fn highlights(inputs: &SharedInputs, progress: Progress) -> Result<Report, ExperimentError> {
    let sets = inputs.highlights(progress)?;
    let kind = sets[0].kind;
    let heading = if kind == SetKind::Own {
        "Sequences: asked of other sequences"
    } else {
        "Highlights: table 2"
    };
    let mut report = Report::new("highlights", &sets[0].heading(heading));
    introduce(&mut report, sets, "");
    let mut paper: Vec<[Stated; 2]> = TABLE_2
        .iter()
        .map(|sequence| [sequence.calib_me, sequence.theirs])
        .collect();
    paper.push(TABLE_2_AVERAGE);
    match kind {
        SetKind::Drawn => report.text(DRAWN_HIGHLIGHTS),
        SetKind::Published => {
            report.text(&format!(
                "The paper's table 2 has {SEQUENCE_FRAMES} frames in each of four sequences."
            ));
        }
        SetKind::Own => paper.clear(),
    }
    let all = tables(&mut report, inputs, Sets::Highlights, &paper, progress)?;
    if let (SetKind::Drawn, Some([default, published, masked])) = (kind, all) {
        claims_of_table_2(&mut report, inputs, &default, &published, &masked, progress)?;
    }
    Ok(report)
}

/// Two games of 42 and 33 frames, half of them for training (the paper's `worldcup`).
pub fn worldcup(inputs: &SharedInputs, progress: Progress) -> Result<Report, ExperimentError> {
    let sets = inputs.worldcup(progress)?;
    let mut report = Report::new("worldcup", &sets[0].heading("World Cup: table 3"));
    introduce(&mut report, sets, "");
    let mut paper: Vec<[Stated; 2]> = TABLE_3.iter().map(|(.., stated)| *stated).collect();
    // The paper has no average of the games.
    if sets[0].kind == SetKind::Drawn {
        report.text(DRAWN_WORLD_CUP);
    } else if sets[0].kind == SetKind::Own {
        paper.clear();
    }
    let all = tables(&mut report, inputs, Sets::WorldCup, &paper, progress)?;
    if let Some([default, published, _]) = all.filter(|_| sets[0].kind == SetKind::Drawn) {
        let theirs = TABLE_3
            .map(|(name, _, [_, theirs])| format!("{name} {}", theirs.describe()))
            .join(", ");
        let stated = TABLE_3
            .iter()
            .map(|(.., [_, theirs])| theirs.mean)
            .sum::<f64>()
            / TABLE_3.len() as f64;
        // The paper rounds to two decimals.
        report.claim(
            Verdict::above(default.iou_interval, stated - 0.005),
            &format!("Table 3, IoU: {theirs}"),
            &format!(
                "default forest {}, --published {}",
                default.describe(),
                published.describe()
            ),
            "drawn games from a main camera; the paper does not state its cameras",
        );
    }
    Ok(report)
}

/// Adds the claims that compare the synthetic highlights with table 2.
fn claims_of_table_2(
    report: &mut Report,
    inputs: &SharedInputs,
    default: &Tally,
    published: &Tally,
    masked: &Tally,
    progress: Progress,
) -> Result<(), ExperimentError> {
    let [calib_me, theirs] = TABLE_2_AVERAGE;
    let reaches = Verdict::above(default.iou_interval, theirs.mean);
    report.claim(
        reaches,
        &format!("Table 2, IoU over four sequences: {} (CalibMe {})", theirs.describe(), calib_me.describe()),
        &format!(
            "default forest {}, masked {:.2}, --published {}",
            default.describe(),
            masked.iou_mean,
            published.describe()
        ),
        if reaches == Verdict::Confirmed {
            "drawn frames are sharper and steadier than the paper's, and their base is exact"
        } else {
            "narrow views show little but spectators and boards, of which nine in ten and .6 are others in the other game"
        },
    );
    let sets = inputs.highlights(progress)?;
    let answers = inputs.answers(
        Sets::Highlights,
        ForestKind::Default,
        Masks::AsTheyAre,
        progress,
    )?;
    let mut by_sequence = by_name(&sets[0], answers);
    by_sequence.retain(|(name, _)| *name != "all");
    let ious = by_sequence
        .iter()
        .map(|(_, answers)| format!("{:.2}", Tally::of(answers.iter().copied()).iou_mean));
    let shown = ious.collect::<Vec<_>>().join(", ");
    let Some((_, third)) = by_sequence.get(2) else {
        return Ok(());
    };
    // The smallest lead of the other sequences over sequence 3, by mean `IoU`.
    let others = by_sequence
        .iter()
        .enumerate()
        .filter(|(number, _)| *number != 2)
        .map(|(_, (_, answers))| answers);
    let ahead = others.map(|answers| {
        difference(answers.iter().copied(), third.iter().copied(), |tally| {
            tally.iou_mean
        })
    });
    let least = ahead
        .min_by(|a, b| (a[0] + a[1]).total_cmp(&(b[0] + b[1])))
        .unwrap_or([f64::NAN; 2]);
    report.claim(
        Verdict::above(least, 0.0),
        "Sequence 3 is weakest: a part of its pan range is in no training sequence",
        &format!("IoU of sequences 1 to 4: {shown}"),
        "",
    );
    Ok(())
}

/// Adds tables, figures and the contact sheet of all test frames. For synthetic sets, returns the
/// tallies of all frames: default forest, published forest, and default forest with masks.
fn tables(
    report: &mut Report,
    inputs: &SharedInputs,
    which: Sets,
    paper: &[[Stated; 2]],
    progress: Progress,
) -> Result<Option<[Tally; 3]>, ExperimentError> {
    let sets = inputs.sets(which, progress)?;
    let is_drawn = inputs.are_drawn(which, progress)?;
    report.text(TALLY_EXPLAINED);
    report.text(ForestKind::EXPLAINED);
    let (mut ways, mut all) = (Vec::new(), Vec::new());
    for kind in ForestKind::BOTH {
        let answers = inputs.answers(which, kind, Masks::AsTheyAre, progress)?;
        let tallies = tallies(&sets[0], answers);
        all.extend(tallies.last().map(|(_, tally)| *tally));
        ways.push((kind.key().to_owned(), answers));
        let mut table = tally_table(("sequence", "sequence"), &tallies);
        if is_drawn {
            let masked = inputs.answers(which, kind, Masks::Masked, progress)?;
            let masked_tallies = self::tallies(&sets[0], masked);
            all.extend(masked_tallies.last().map(|(_, tally)| *tally));
            let means = masked_tallies
                .iter()
                .map(|(_, tally)| Cell::Fixed(tally.iou_mean, 3));
            table = table.with_column("masked_iou_mean", "masked: IoU", means);
            ways.push((format!("{}, masked", kind.key()), masked));
        }
        let stated = |method: usize| {
            paper
                .iter()
                .map(move |stated| Cell::from(stated[method].describe()))
        };
        if !paper.is_empty() {
            table = table.with_column("paper", "paper: IoU ± SD", stated(1));
            table = table.with_column("paper_calibme", "paper: CalibMe", stated(0));
        }
        report.table(
            &format!("sequences-{}", kind.key()),
            &format!("By sequence: {}.", kind.describe()),
            table,
        );
    }
    let answers = inputs.answers(which, ForestKind::Default, Masks::AsTheyAre, progress)?;
    let parts = by_name(&sets[0], answers);
    // Labels of synthetic frames are exact, so overlays would add nothing.
    if !is_drawn {
        overlays(report, &sets[0], answers, &parts);
    }
    let mut table = Table::new(&[
        ("sequence", "sequence"),
        ("pan_deg", "pan (°)"),
        ("tilt_deg", "tilt (°)"),
        ("focal_px", "focal length (px)"),
    ]);
    let ranges = parts.iter().filter(|(name, _)| *name != "all");
    ranges
        .map(|(name, answers)| ranges_row(sets, name, answers))
        .for_each(|row| table.push(row));
    if is_drawn && which == Sets::Highlights {
        let paper = TABLE_2.iter().map(|stated| {
            let range = |[from, to]: [f64; 2]| format!("{from:.0} to {to:.0}");
            format!(
                "{}; {}; {}",
                range(stated.pan_deg),
                range(stated.tilt_deg),
                range(stated.focal_px)
            )
            .into()
        });
        table = table.with_column("paper", "paper: pan; tilt; focal length at 1280 px", paper);
    }
    report.table("ranges", "Where the frames look.", table);
    report.figure(
        "views",
        "Fields of view of the frames asked (cumulative).",
        view_distribution(answers),
    );
    report.data(
        "frames",
        "Every frame asked, by seed, forest and masks.",
        frame_table(sets, ways),
    );
    report.time_table(
        "steps-times",
        "One frame, features found already; other frames were asked at the same time.",
        step_times(answers, which),
    );
    if let Some(png) = contact_sheet(&worst_to_best(sets, answers)?)? {
        report.picture(
            "sheet",
            "Six frames from the worst to the best by the default forest: the answer's lines over the picture; from above what the picture shows \
             by the true camera (blue) and by the answer (orange).",
            png,
        );
    }
    Ok(match all[..] {
        [default, masked, published, _] => Some([default, published, masked]),
        _ => None,
    })
}

fn tallies(set: &FrameSet, answers: &[FrameAnswer]) -> Vec<(Cell, Tally)> {
    let parts = by_name(set, answers);
    parts
        .iter()
        .map(|(name, answers)| ((*name).into(), Tally::of(answers.iter().copied())))
        .collect()
}

/// Median and 90 % times of the two steps for one frame, beside the paper's.
fn step_times(answers: &[FrameAnswer], which: Sets) -> Table {
    let mut times = Table::new(&[
        ("step", "step"),
        ("median_ms", "median (ms)"),
        ("p90_ms", "90 % (ms)"),
    ]);
    for (step, of) in [
        (
            "asking the forest",
            (|answer: &FrameAnswer| answer.predict_ms) as fn(&FrameAnswer) -> f64,
        ),
        ("finding the camera", |answer| answer.pose_ms),
    ] {
        let mut values: Vec<f64> = answers.iter().map(of).collect();
        values.sort_by(f64::total_cmp);
        times.push(vec![
            step.into(),
            quantile(&values, 0.5).into(),
            quantile(&values, 0.9).into(),
        ]);
    }
    if which == Sets::Highlights {
        let [calib_me, theirs] = TABLE_2_SECONDS.map(|seconds| Cell::Number(1e3 * seconds));
        times.push(vec!["paper: theirs, a frame".into(), theirs, Cell::Empty]);
        times.push(vec![
            "paper: CalibMe, a frame".into(),
            calib_me,
            Cell::Empty,
        ]);
    }
    times
}

/// Six test frames, evenly spread from the worst to the best.
fn worst_to_best<'a>(
    sets: &'a [FrameSet],
    answers: &[FrameAnswer],
) -> Result<Vec<SheetFrame<'a>>, ExperimentError> {
    let mut order: Vec<&FrameAnswer> = answers.iter().collect();
    let iou = |answer: &FrameAnswer| answer.found.map_or(-1.0, |found| found.iou.unwrap_or(0.0));
    order.sort_by(|a, b| iou(a).total_cmp(&iou(b)));
    let tiles = SHEET_FRAMES.min(order.len());
    let chosen = (0..tiles).map(|tile| order[tile * (order.len() - 1) / (tiles - 1).max(1)]);
    let mut reader = FrameReader::new();
    let sheet_frame = |answer: &FrameAnswer| {
        let known = &sets[answer.repeat].frames[answer.frame];
        let caption = match answer.found {
            Some(found) => format!(
                "view {:.0}°, IoU {:.4}",
                answer.view_deg,
                found.iou.unwrap_or(f64::NAN)
            ),
            None => format!("view {:.0}°, not found", answer.view_deg),
        };
        Ok(SheetFrame {
            picture: known.picture(&mut reader)?,
            caption,
            field: &known.field,
            truth: known.truth,
            estimate: answer.found.map(|found| found.camera),
        })
    };
    chosen.map(sheet_frame).collect()
}

/// The ranges of pan, tilt and focal length of a sequence.
fn ranges_row(sets: &[FrameSet], name: &str, answers: &[&FrameAnswer]) -> Vec<Cell> {
    let range = |of: &dyn Fn(&FrameAnswer) -> f64, digits: usize| -> Cell {
        let values = answers.iter().map(|answer| of(answer));
        let (low, high) = values.fold((f64::INFINITY, f64::NEG_INFINITY), |(l, h), v| {
            (l.min(v), h.max(v))
        });
        format!("{low:.digits$} to {high:.digits$}").into()
    };
    let ptz = |answer: &FrameAnswer| sets[answer.repeat].frames[answer.frame].truth.ptz();
    let pans = AngleRange::smallest(answers.iter().map(|answer| ptz(answer).pan))
        .unwrap_or(AngleRange::FULL);
    vec![
        name.into(),
        format!(
            "{:.1} to {:.1}",
            pans.start().degrees(),
            pans.end().wrapped().degrees()
        )
        .into(),
        range(&|answer| ptz(answer).tilt.degrees(), 1),
        range(&|answer| ptz(answer).focal_px, 0),
    ]
}

fn view_distribution(answers: &[FrameAnswer]) -> Figure {
    let views: Vec<f64> = answers.iter().map(|answer| answer.view_deg).collect();
    Figure::new(
        "",
        Axis::linear("horizontal field of view (°)"),
        Axis::linear("share of frames").within(0.0, 1.0),
    )
    .with(Series::cumulative("", 1, &views, views.len()))
}
