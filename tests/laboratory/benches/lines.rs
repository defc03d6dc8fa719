//! Cameras from the lines of one picture: how many pictures are solved, how much of what people
//! drew the cameras explain, whether what they state holds, and how long it takes.
//!
//! `cargo bench --bench lines -- [real] [drawn] [--cameras N] [--crown] [--worst N]`. `real` reads
//! `sn22-lines/lines` in `TOUCHLINE_DATA`: pictures of 960 × 540 px with lines in SoccerNet's form,
//! each of a camera of its own. `drawn` draws cameras all around the field with lenses, rolls and
//! principal points from the priors, and points on their lines with 1.5 px of noise.
#![allow(
    clippy::unwrap_used,
    clippy::print_stdout,
    missing_docs,
    reason = "a bench prints, and fails by stopping"
)]

#[path = "../../benches/arguments.rs"]
mod arguments;

use arguments::Arguments;
use rand::{RngExt, SeedableRng};
use rand_distr::{Distribution, Normal};
use rand_pcg::Pcg64Mcg;
use rayon::prelude::*;
use std::path::PathBuf;
use std::time::Instant;
use touchline::calibrate::observations;
use touchline::camera::{BaseAngles, CameraBase, Ptz, PtzCamera, StatedLens};
use touchline::document::Frame;
use touchline::exchange::{Format, ImportOptions, import};
use touchline::field::{FieldElement, FieldModel, builtin};
use touchline::geometry::{Angle, ImageSize, Vec2, Vec3, quantile};
use touchline::score::{AnnotatedLine, FieldView, MarkingMatch, annotated_lines};
use touchline::solve::from_lines::{
    CameraFromLines, FromLinesError, FromLinesOptions, LinePicture, camera_from_lines,
};
use touchline::solve::{Observation, base::BasePriors};

const SIZE: ImageSize = ImageSize::new(960, 540);

/// Lines are left out in this many folds.
const FOLDS: usize = 5;

/// Noise of drawn points, px.
const NOISE_PX: f64 = 1.5;

/// χ² of two degrees of freedom: 68.27 %.
const WITHIN_68: f64 = 2.2957;

fn main() {
    let arguments = Arguments::of_process();
    let sections = ["real", "drawn"];
    let options = FromLinesOptions {
        fits_crown: arguments.is_set("--crown"),
        ..FromLinesOptions::default()
    };
    if arguments.wants("real", &sections) {
        real(&options, arguments.number("--worst", 0));
    }
    if arguments.wants("drawn", &sections) {
        drawn_cameras(&options, arguments.number("--cameras", 200));
    }
}

fn flat_soccer() -> FieldModel {
    let template = builtin("soccer").unwrap();
    template
        .model(&std::collections::BTreeMap::new(), 0.0)
        .unwrap()
}

fn solve(
    field: &FieldModel,
    points: &[Observation],
    options: &FromLinesOptions,
) -> Result<CameraFromLines, FromLinesError> {
    let picture = LinePicture {
        field,
        observations: points,
        image_size: SIZE,
        lens: StatedLens::default(),
    };
    camera_from_lines(&picture, options)
}

/// The points of a frame by line.
fn lines_of(points: &[Observation]) -> Vec<AnnotatedLine> {
    let mut lines: Vec<AnnotatedLine> = Vec::new();
    for point in points {
        let Some(FieldElement::Line(line)) = point.element else {
            continue;
        };
        match lines.iter_mut().find(|known| known.line == line) {
            Some(known) => known.points.push(point.image),
            None => lines.push(AnnotatedLine {
                line,
                points: vec![point.image],
            }),
        }
    }
    lines
}

/// What became of one picture.
struct PictureOutcome {
    name: String,
    lines: usize,
    /// Lines with every point within 5 px, and JaC at 5, 10 and 20 px.
    near: usize,
    jaccard: [f64; 3],
    solved: Result<CameraFromLines, FromLinesError>,
    milliseconds: f64,
    /// For each point of a line that was left out: its distance from the line in stated sigmas.
    left_out_sigmas: Vec<f64>,
}

fn real(options: &FromLinesOptions, worst: usize) {
    let folder = PathBuf::from(std::env::var_os("TOUCHLINE_DATA").unwrap());
    let reading = ImportOptions {
        size: Some(SIZE),
        skip_unmapped: true,
        ..ImportOptions::default()
    };
    let lines = folder.join("sn22-lines/lines");
    let document = import(&lines, Format::SoccerNetLines, &reading)
        .unwrap()
        .document;
    let field = flat_soccer();
    let mut rows: Vec<PictureOutcome> = document
        .frames
        .par_iter()
        .map(|frame| measure(frame, &field, options))
        .collect();
    let sum = |count: fn(&PictureOutcome) -> usize| rows.iter().map(count).sum::<usize>();
    let solved = rows.iter().filter(|row| row.solved.is_ok()).count();
    let (all, near) = (sum(|row| row.lines), sum(|row| row.near));
    println!(
        "{solved} of {} pictures solved; {:.1} % of {all} lines within 5 px",
        rows.len(),
        100.0 * near as f64 / all as f64
    );
    let jaccard =
        |index: usize| rows.iter().map(|row| row.jaccard[index]).sum::<f64>() / rows.len() as f64;
    println!(
        "JaC@5 {:.3}, JaC@10 {:.3}, JaC@20 {:.3}",
        jaccard(0),
        jaccard(1),
        jaccard(2)
    );
    let renamed = rows.iter().filter(|row| {
        let camera = row.solved.as_ref();
        camera.is_ok_and(|camera| camera.identity.is_some())
    });
    println!("{} pictures with other names", renamed.count());
    let mut times: Vec<f64> = rows.iter().map(|row| row.milliseconds).collect();
    times.sort_by(f64::total_cmp);
    println!(
        "time of a picture: median {:.1} ms, 95 % {:.1} ms",
        quantile(&times, 0.5),
        quantile(&times, 0.95)
    );
    let sigmas: Vec<f64> = rows
        .iter()
        .flat_map(|row| row.left_out_sigmas.iter().copied())
        .collect();
    let within = |limit: f64| {
        let count = sigmas.iter().filter(|sigmas| **sigmas < limit).count();
        100.0 * count as f64 / sigmas.len() as f64
    };
    println!(
        "{} points of lines left out: {:.1} % within one stated sigma, {:.1} % two, {:.1} % three",
        sigmas.len(),
        within(1.0),
        within(2.0),
        within(3.0)
    );
    rows.sort_by_key(|row| std::cmp::Reverse(row.lines - row.near));
    for row in rows.iter().take(worst) {
        let camera = match &row.solved {
            Ok(camera) => format!(
                "{:.0} px at {:.1?}, scatter {:.1}",
                camera.ptz.focal_px,
                camera.base.position_m.as_slice(),
                camera.scatter
            ),
            Err(error) => error.to_string(),
        };
        println!(
            "{}: {} of {} lines near; {camera}",
            row.name, row.near, row.lines
        );
    }
}

/// Solves a frame, scores its camera, and solves it again without each fold of its lines.
fn measure(frame: &Frame, field: &FieldModel, options: &FromLinesOptions) -> PictureOutcome {
    let points = observations(frame, field).unwrap();
    let annotated = lines_of(&points);
    let start = Instant::now();
    let solved = solve(field, &points, options);
    let milliseconds = start.elapsed().as_secs_f64() * 1e3;
    let mut row = PictureOutcome {
        name: frame.image.clone().unwrap_or_default(),
        lines: annotated.len(),
        near: 0,
        jaccard: [0.0; 3],
        solved,
        milliseconds,
        left_out_sigmas: sigmas_of_left_out_points(field, &points, &annotated, options),
    };
    if let Ok(found) = &row.solved {
        let on_ground = with_crown(field, found.crown_m);
        let view = FieldView {
            field: &on_ground,
            camera: &found.camera(),
        };
        let matched = MarkingMatch::compare(&on_ground, &annotated, view, SIZE);
        row.near = matched
            .plain
            .worst_px
            .iter()
            .filter(|worst| **worst < 5.0)
            .count();
        row.jaccard = [5.0, 10.0, 20.0].map(|limit| matched.jaccard(limit));
    }
    row
}

fn with_crown(field: &FieldModel, crown_m: f64) -> FieldModel {
    FieldModel {
        crown_m,
        ..field.clone()
    }
}

/// The distances of the points of each line from the camera of the lines of the other folds, in
/// stated sigmas.
fn sigmas_of_left_out_points(
    field: &FieldModel,
    points: &[Observation],
    annotated: &[AnnotatedLine],
    options: &FromLinesOptions,
) -> Vec<f64> {
    let mut sigmas = Vec::new();
    for fold in 0..FOLDS {
        let is_left_out = |point: &Observation| {
            let on_line =
                |line: &AnnotatedLine| point.element == Some(FieldElement::Line(line.line));
            annotated
                .iter()
                .position(on_line)
                .is_some_and(|index| index % FOLDS == fold)
        };
        let split: Vec<Observation> = points
            .iter()
            .map(|point| {
                if is_left_out(point) {
                    point.hold_out()
                } else {
                    *point
                }
            })
            .collect();
        let Ok(found) = solve(field, &split, options) else {
            continue;
        };
        let on_ground = with_crown(field, found.crown_m);
        for point in split.iter().filter(|point| point.check) {
            let Some(point) = point
                .element
                .and_then(|line| point.with_element(&on_ground, line))
            else {
                continue;
            };
            let sigma_px = found.distance_sigma_px(&on_ground, &point);
            if let Some((off_px, sigma_px)) = point.distance_px(&found.camera()).zip(sigma_px) {
                sigmas.push(off_px / sigma_px);
            }
        }
    }
    sigmas
}

/// A part of the bowl: ranges of x, y and z, m, in which cameras stand.
struct Part {
    name: &'static str,
    x_m: [f64; 2],
    y_m: [f64; 2],
    z_m: [f64; 2],
}

const PARTS: [Part; 5] = [
    Part {
        name: "main stand",
        x_m: [-15.0, 15.0],
        y_m: [-95.0, -48.0],
        z_m: [8.0, 28.0],
    },
    Part {
        name: "other side",
        x_m: [-15.0, 15.0],
        y_m: [48.0, 90.0],
        z_m: [8.0, 25.0],
    },
    Part {
        name: "behind a goal",
        x_m: [70.0, 110.0],
        y_m: [-25.0, 25.0],
        z_m: [6.0, 25.0],
    },
    Part {
        name: "corner",
        x_m: [-80.0, -55.0],
        y_m: [-55.0, -38.0],
        z_m: [5.0, 20.0],
    },
    Part {
        name: "low, at the touchline",
        x_m: [-40.0, 40.0],
        y_m: [-46.0, -38.0],
        z_m: [2.5, 6.0],
    },
];

/// A drawn camera with the points that were drawn on its lines.
struct DrawnPicture {
    truth: PtzCamera,
    points: Vec<Observation>,
}

fn draw(part: &Part, field: &FieldModel, random: &mut Pcg64Mcg) -> DrawnPicture {
    let normal = Normal::new(0.0, 1.0).unwrap();
    let priors = BasePriors::default();
    let mut within = |[from, upto]: [f64; 2]| from + (upto - from) * random.random::<f64>();
    let position_m = Vec3::new(within(part.x_m), within(part.y_m), within(part.z_m));
    let looks_at_m = Vec3::new(within([-48.0, 48.0]), within([-25.0, 30.0]), 0.0);
    let shows_m = within([20.0, 55.0]);
    let along = looks_at_m - position_m;
    let focal_px = f64::from(SIZE.width) * along.norm() / shows_m;
    let mut scattered = |sigma: f64| sigma * normal.sample(random);
    let angles = BaseAngles {
        roll: Angle::from_degrees(scattered(0.4)),
        ..BaseAngles::default()
    };
    let principal_px = Vec2::new(scattered(10.0), scattered(10.0));
    let mut distortion = priors.usual_lens(SIZE);
    distortion.value += scattered(priors.k1.1);
    let base = CameraBase {
        distortion,
        ..CameraBase::new(
            position_m,
            angles.base_from_world(),
            SIZE.centre().translate(principal_px),
        )
    };
    let ptz = Ptz {
        pan: Angle::from_radians(along.x.atan2(along.y)),
        tilt: Angle::from_radians(along.z.atan2(along.xy().norm())),
        focal_px,
    };
    let truth = PtzCamera::new(base, ptz);
    let mut points = Vec::new();
    for line in annotated_lines(field, &truth, SIZE) {
        for point in line.points {
            let noise_px = Vec2::new(scattered(NOISE_PX), scattered(NOISE_PX));
            let name = field.lines[line.line].id.as_str();
            let image = point.translate(noise_px);
            points.push(Observation::from_line(field, name, image, SIZE, points.len()).unwrap());
        }
    }
    DrawnPicture { truth, points }
}

/// How far a camera is off where the field's landmarks are seen: the largest distance, px, and
/// whether the truth lies within the stated 68 % region at each.
fn errors(field: &FieldModel, truth: &PtzCamera, found: &CameraFromLines) -> (f64, Vec<bool>) {
    let camera = found.camera();
    let (mut largest_px, mut within) = (0.0_f64, Vec::new());
    for landmark in &field.landmarks {
        let at = field.landmark_in_world(landmark);
        let Some(shown) = truth
            .image_from_world(at)
            .ok()
            .filter(|pixel| SIZE.contains(*pixel))
        else {
            continue;
        };
        let Ok(image) = camera.image_from_world(at) else {
            largest_px = f64::INFINITY;
            continue;
        };
        let off = image.offset_from(shown);
        largest_px = largest_px.max(off.norm());
        let covariance = found.uncertainty.overlay_at_world(&camera, at);
        let inverse = covariance.and_then(nalgebra::Matrix2::try_inverse);
        within.extend(inverse.map(|inverse| off.dot(&(inverse * off)) < WITHIN_68));
    }
    (largest_px, within)
}

fn drawn_cameras(options: &FromLinesOptions, cameras: usize) {
    let field = flat_soccer();
    println!("| place | solved | too few lines | median | 95 % | over 20 px | within 68 % |");
    println!("|---|---|---|---|---|---|---|");
    for part in &PARTS {
        let one = |seed: usize| {
            let mut random = Pcg64Mcg::seed_from_u64(seed as u64);
            let picture = draw(part, &field, &mut random);
            let found = solve(&field, &picture.points, options);
            found.map(|found| errors(&field, &picture.truth, &found))
        };
        let found: Vec<_> = (0..cameras).into_par_iter().map(one).collect();
        let too_few = found.iter().filter(|found| {
            use FromLinesError::{Parallel, TooFewLines};
            matches!(found, Err(TooFewLines { .. } | Parallel { .. }))
        });
        let too_few = too_few.count();
        let solved: Vec<_> = found.iter().flatten().collect();
        let mut off_px: Vec<f64> = solved.iter().map(|(off_px, _)| *off_px).collect();
        off_px.sort_by(f64::total_cmp);
        let within: Vec<bool> = solved
            .iter()
            .flat_map(|(_, within)| within.clone())
            .collect();
        println!(
            "| {} | {} of {cameras} | {too_few} | {:.1} px | {:.1} px | {} | {:.1} % |",
            part.name,
            solved.len(),
            quantile(&off_px, 0.5),
            quantile(&off_px, 0.95),
            off_px.iter().filter(|off_px| **off_px > 20.0).count(),
            100.0 * within.iter().filter(|within| **within).count() as f64 / within.len() as f64
        );
    }
}
