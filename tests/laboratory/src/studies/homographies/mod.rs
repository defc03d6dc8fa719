//! Published homographies of broadcast frames: how well our camera model fits them, and how many
//! frames share a base.

mod fit;
mod read;

pub use read::holds_homographies;

use crate::progress::{Progress, step_counter};
use crate::report::Report;
use crate::{ExperimentError, ExperimentOptions};
use fit::{Fitted, Sampled, SharedBase, groups, under_one_base};
use rayon::prelude::*;
use read::{Homographies, SIZE, read_homographies};
use std::path::Path;
use touchline::geometry::Mat3;
use touchline::report::figure::{Axis, Figure, Line, Mark, Series};
use touchline::report::{Cell, Table};
use touchline::score::{PlaneView, Summary};

/// Limits of the root mean square distance within which a frame agrees with a base, px.
const WITHIN_PX: [f64; 4] = [1.0, 2.0, 5.0, 10.0];
/// The limit for the figures' groups: about the click noise of annotators at this width.
const SHOWN_PX: f64 = 2.0;
/// A quick run uses every n-th frame.
const QUICK_STRIDE: usize = 8;

/// A frame, the camera fitted to its homography, and the scores of the fit.
struct Scored {
    name: String,
    sampled: Sampled,
    fitted: Fitted,
    iou_part: f64,
    iou_whole: f64,
}

/// Runs the experiment on the homographies in a folder.
///
/// # Errors
/// A file cannot be read, or no homography can be that of a camera.
pub fn run(
    options: &ExperimentOptions,
    folder: &Path,
    progress: Progress,
) -> Result<Report, ExperimentError> {
    let mut read = read_homographies(folder)?;
    if options.quick {
        read.frames = read.frames.into_iter().step_by(QUICK_STRIDE).collect();
    }
    // Each frame is fitted once; bases are sought for two kinds of data at each limit.
    let steps = read.frames.len() + 2 * WITHIN_PX.len();
    let step = step_counter(steps, progress);
    let of_frame = |(name, image_from_ground): &(String, _)| {
        let scored = score(&read, name, image_from_ground);
        step();
        scored
    };
    // In the order of the set, on which `neighbours` depends.
    let scored: Vec<Scored> = read.frames.par_iter().filter_map(of_frame).collect();
    if scored.is_empty() {
        let reason =
            "no homography shows the pitch as a camera with square pixels would".to_owned();
        return Err(ExperimentError::Given {
            path: folder.to_path_buf(),
            reason,
        });
    }

    let mut report = Report::new("homographies", "Homographies: our camera, and a fixed base");
    let [length, width] = read.template_yd;
    report.text(&format!(
        "{} published homographies of the World Cup 2014 set (Homayounfar, Fidler, Urtasun, CVPR 2017), template {length} × \
         {width} yards; no pictures. A homography has eight degrees of freedom, our camera without a base seven: position, \
         rotation, focal length; square pixels, the principal point in the middle, no distortion. It is fitted to points of the \
         picture that show the pitch, on a grid of 16 × 9; {} of the homographies are such that a camera can see them. IoU: the \
         fitted camera against the homography, polygons clipped exactly.",
        read.frames.len(),
        scored.len()
    ));
    report.table(
        "fit",
        "The camera fitted to each homography.",
        fit_table(&scored),
    );
    report.data("frames", "Every frame.", frame_table(&scored));
    // Residuals of the fitted cameras, and under one base for all frames.
    let residuals: Vec<f64> = scored.iter().map(|scored| scored.fitted.rms_px).collect();
    let shared_residual = Axis::log("distance from the homography, root mean square (px)");
    let share = || Axis::linear("share of frames").within(0.0, 1.0);
    let sampled: Vec<Sampled> = scored.iter().map(|scored| scored.sampled.clone()).collect();
    let fitted: Vec<Fitted> = scored.iter().map(|scored| scored.fitted).collect();
    let one_base = under_one_base(&sampled, &fitted);
    let figure = Figure::new("", shared_residual, share())
        .with(Series::cumulative(
            "own camera",
            1,
            &residuals,
            residuals.len(),
        ))
        .with(
            Series::cumulative("one base for all", 2, &one_base, one_base.len())
                .with_line(Line::Dashed),
        );
    report.figure(
        "residuals",
        "Share of homographies within a distance: of the camera fitted to each alone, and of the best pan, tilt and focal \
         length under one base for all (the median of the positions, a level head).",
        figure,
    );
    report.text(
        "What is left with seven degrees of freedom is not the mathematics: drawn homographies of a camera are fitted to below \
         a thousandth of a pixel. The published ones were made by people's clicks without a camera in mind, on lenses that \
         bend, pitches that are higher in the middle and of another size than the template; each takes its share of the eighth \
         degree of freedom.",
    );
    // Bases are sought twice: to explain the homographies, and to explain the fitted cameras.
    let by_camera: Vec<Sampled> = scored
        .iter()
        .map(|scored| scored.sampled.as_seen_by(&scored.fitted.camera))
        .collect();
    let sought = |what: &'static str, sampled: &[Sampled]| -> Vec<BaseGroups> {
        // The comparison that needs no grouping: a single base for the whole set.
        let one_base = under_one_base(sampled, &fitted);
        let of = |within_px: f64| {
            let groups = groups(&read.field, sampled, &fitted, within_px);
            step();
            BaseGroups {
                what,
                within_px,
                one_base: one_base
                    .iter()
                    .filter(|rms_px| **rms_px <= within_px)
                    .count(),
                groups,
            }
        };
        WITHIN_PX.into_iter().map(of).collect()
    };
    let mut found = sought("homography", &sampled);
    found.extend(sought("own camera", &by_camera));
    report.text(
        "A fixed base: the frames are of several matches in several stadiums, and the set does not say which. So bases are \
         sought: every frame's own position, with a level head and with its own lean, is tried as the base of all frames within 12 m of it; a frame \
         agrees if pan, tilt and focal length alone bring it within a distance of its homography, or of the camera fitted to \
         that (where the homography itself is no camera's, only the second says something of the base). The position that most \
         frames agree with is adjusted to them together, they are taken out, and so on. Cameras of different stadiums may \
         agree by chance, so the groups say at most how many frames share a base; frames without a partner may be of a match \
         that the set has once.",
    );
    report.table(
        "groups",
        "Frames that one base explains.",
        group_table(&found, fitted.len()),
    );
    let shown = found
        .iter()
        // The last of the two kinds: groups that explain the fitted cameras.
        .rfind(|found| found.within_px == SHOWN_PX)
        .map_or(&[][..], |found| &found.groups);
    report.figure(
        "positions",
        &format!(
            "Where the cameras stand, from above (the field's middle is 0, 0; its far side is up). Groups: bases that two \
             frames or more agree with within {SHOWN_PX} px of their own cameras."
        ),
        positions(&fitted, shown),
    );
    // A test of the groups that they were not made for: frames of a match lie together in the set.
    let (beside, chance) = neighbours(shown, fitted.len());
    let order = Figure::new(
        "",
        Axis::linear("place in the set"),
        Axis::linear("across (m)"),
    )
    .with(Series::new("frames", 1, camera_y_points(&fitted, 0..fitted.len())).with_line(Line::None))
    .with(
        Series::new(
            "frames of groups",
            2,
            camera_y_points(&fitted, shown.iter().flat_map(|g| g.frames.iter().copied())),
        )
        .with_line(Line::None)
        .with_mark(Mark::Cross),
    );
    report.figure(
        "order",
        &format!(
            "How far back the cameras stand, in the order of the set. Of the frames of groups {:.0} % stand beside one of their \
             own group in that order; by chance it would be {:.0} %: matches lie together in the set, and the groups are more \
             than chance.",
            100.0 * beside,
            100.0 * chance
        ),
        order,
    );
    Ok(report)
}

/// Fits a camera to a homography and scores it. None if no camera can have this homography.
fn score(read: &Homographies, name: &str, image_from_ground: &Mat3) -> Option<Scored> {
    let view = PlaneView::new(image_from_ground, SIZE)?;
    let sampled = Sampled::new(&view, &read.field)?;
    let fitted = sampled.fit_camera(&read.field)?;
    let estimate = PlaneView::from_camera(&fitted.camera, SIZE)?;
    Some(Scored {
        name: name.to_owned(),
        // A homography that shows nothing of the pitch has no score.
        iou_part: view.iou_part(&read.field, &estimate)?,
        iou_whole: view.iou_whole(&read.field, &estimate),
        sampled,
        fitted,
    })
}

/// Statistics of the fit over all frames.
fn fit_table(scored: &[Scored]) -> Table {
    let mut table = Table::new(&[
        ("measure", "measure"),
        ("frames", "frames"),
        ("mean", "mean"),
        ("median", "median"),
        ("worst_tenth", "worst tenth from"),
        ("worst_twentieth", "worst 5 % from"),
        ("worst", "worst"),
    ]);
    for (name, of, more_is_better) in [
        (
            "IoU_part",
            (|scored| scored.iou_part) as fn(&Scored) -> f64,
            true,
        ),
        ("IoU_whole", |scored| scored.iou_whole, true),
        (
            "distance, root mean square (px)",
            |scored| scored.fitted.rms_px,
            false,
        ),
    ] {
        // Negated where more is better, so that the upper percentiles are the worst ones.
        let sign = if more_is_better { -1.0 } else { 1.0 };
        let values: Vec<f64> = scored.iter().map(|scored| sign * of(scored)).collect();
        let Some(summary) = Summary::from_values(&values, 0) else {
            continue;
        };
        let mut row: Vec<Cell> = vec![name.into(), summary.count.into()];
        row.extend(
            [
                summary.mean,
                summary.median,
                summary.p90,
                summary.p95,
                summary.max,
            ]
            .map(|v| (sign * v).into()),
        );
        table.push(row);
    }
    table
}

/// A table with a row for each frame.
fn frame_table(scored: &[Scored]) -> Table {
    let mut table = Table::new(&[
        ("frame", "frame"),
        ("rms_px", "distance, root mean square (px)"),
        ("iou_part", "IoU_part"),
        ("iou_whole", "IoU_whole"),
        ("x_m", "camera, along (m)"),
        ("y_m", "across (m)"),
        ("z_m", "up (m)"),
    ]);
    for scored in scored {
        let at = scored.fitted.camera.base().position_m;
        let numbers = [
            scored.fitted.rms_px,
            scored.iou_part,
            scored.iou_whole,
            at.x,
            at.y,
            at.z,
        ];
        let mut row = vec![Cell::from(scored.name.as_str())];
        row.extend(numbers.map(Cell::Number));
        table.push(row);
    }
    table
}

/// The position of each frame in the set (from 1), and its camera's y, m.
fn camera_y_points(fitted: &[Fitted], frames: impl Iterator<Item = usize>) -> Vec<[f64; 2]> {
    frames
        .map(|frame| [(frame + 1) as f64, fitted[frame].camera.base().position_m.y])
        .collect()
}

/// Of the frames in groups, the share with a neighbour in the set's order that belongs to the same
/// group; and the expected share for random orders.
fn neighbours(groups: &[SharedBase], frames: usize) -> (f64, f64) {
    let mut group_of = vec![None; frames];
    for (number, group) in groups.iter().enumerate() {
        for &frame in &group.frames {
            group_of[frame] = Some(number);
        }
    }
    let beside = |frame: usize| {
        let same =
            |other: Option<usize>| other.and_then(|other| *group_of.get(other)?) == group_of[frame];
        same(frame.checked_sub(1)) || same(Some(frame + 1))
    };
    let members: usize = groups.iter().map(|group| group.frames.len()).sum();
    let counted = (0..frames)
        .filter(|&frame| group_of[frame].is_some() && beside(frame))
        .count();
    // A frame has two neighbours; each belongs to the frame's group with probability (size − 1) /
    // (frames − 1).
    let others = frames.saturating_sub(1).max(1) as f64;
    let by_chance = |group: &SharedBase| {
        // The two neighbours are taken as independent, and the ends of the set, which have one, are
        // neglected.
        let miss = 1.0 - (group.frames.len() - 1) as f64 / others;
        group.frames.len() as f64 * (1.0 - miss * miss)
    };
    let of = members.max(1) as f64;
    (
        counted as f64 / of,
        groups.iter().map(by_chance).sum::<f64>() / of,
    )
}

/// The groups for one kind of data and one limit.
struct BaseGroups {
    what: &'static str,
    within_px: f64,
    one_base: usize,
    groups: Vec<SharedBase>,
}

/// Numbers of groups and of frames in them, for each limit.
fn group_table(found: &[BaseGroups], frames: usize) -> Table {
    let mut table = Table::new(&[
        ("what", "agree with their"),
        ("within_px", "within (px)"),
        ("one_base", "one base for all: frames"),
        ("groups", "bases of two frames or more"),
        ("frames", "frames that share one"),
        ("share", "share of all"),
        ("largest", "frames of the largest"),
    ]);
    for BaseGroups {
        what,
        within_px,
        one_base,
        groups,
    } in found
    {
        let shared: usize = groups.iter().map(|group| group.frames.len()).sum();
        table.push(vec![
            (*what).into(),
            (*within_px).into(),
            (*one_base).into(),
            groups.len().into(),
            shared.into(),
            (shared as f64 / frames.max(1) as f64).into(),
            groups.first().map_or(0, |group| group.frames.len()).into(),
        ]);
    }
    table
}

/// The positions of the cameras and of the groups' bases, from above.
fn positions(fitted: &[Fitted], groups: &[SharedBase]) -> Figure {
    let alone = fitted
        .iter()
        .map(|fitted| fitted.camera.base().position_m)
        .map(|at| [at.x, at.y]);
    let shared = groups
        .iter()
        .map(|group| [group.base.position_m.x, group.base.position_m.y]);
    Figure::new(
        "",
        Axis::linear("along the field (m)"),
        Axis::linear("across (m)"),
    )
    .with(Series::new("frames", 1, alone.collect()).with_line(Line::None))
    .with(
        Series::new("groups", 2, shared.collect())
            .with_line(Line::None)
            .with_mark(Mark::Cross),
    )
}
