//! How well the base is found through lenses as broadcasts have them: frame by frame they distort,
//! bend and move their principal point as a provider measured it, and no model of ours has quite
//! these curves.
//!
//! `cargo bench --profile dev --bench lenses`, with the folder of the measured lenses in
//! `TOUCHLINE_DATA`. Forty frames a shot look over the pitch from where its camera stood. A row
//! says how far the ground lies off in all frames: by every landmark in view clicked with 1 px of
//! noise, and by paint seen along the lines.
#![allow(
    clippy::unwrap_used,
    clippy::print_stdout,
    missing_docs,
    reason = "a bench prints, and fails by stopping"
)]

use rand::{RngExt, SeedableRng};
use rand_distr::{Distribution, Normal};
use rand_pcg::Pcg64Mcg;
use rayon::prelude::*;
use std::path::{Path, PathBuf};
use touchline::camera::{BaseAngles, CameraBase, Ptz, PtzCamera};
use touchline::document::FrameLens;
use touchline::exchange::{Format, ImportOptions, import};
use touchline::field::{FieldModel, builtin};
use touchline::geometry::{Angle, ImagePoint, ImageSize, Vec2, Vec3};
use touchline::markings::{SampleOptions, sample_lines};
use touchline::progress::Progress;
use touchline::solve::base::{
    BaseEstimate, BaseOptions, CameraClicks, FrameClicks, estimate_base, estimate_base_on_paint,
};
use touchline::solve::{Observation, SolveContext, solve_frame};

const SIZE: ImageSize = ImageSize::new(1920, 1080);

/// Frames of each shot.
const FRAMES: usize = 40;

/// 1-σ of a click, px.
const CLICK_PX: f64 = 1.0;

/// 1-σ of the middle of a line's paint in a picture, and how far apart places along a line are
/// seen, px.
const PAINT_PX: f64 = 0.5;
const PAINT_EVERY_PX: f64 = 25.0;

/// A camera that a provider calibrated: where it stood, and its lens in each frame.
struct Shot {
    name: String,
    position_m: Vec3,
    lenses: Vec<FrameLens>,
}

impl Shot {
    fn read(file: &Path) -> Self {
        let document = import(file, Format::Fifa, &ImportOptions::default())
            .unwrap()
            .document;
        Self {
            name: file.file_stem().unwrap().to_string_lossy().into_owned(),
            position_m: document.cameras[0].position_m.unwrap(),
            lenses: document
                .frames
                .iter()
                .filter_map(|frame| frame.lens.clone())
                .collect(),
        }
    }
}

fn shots(folder: &Path) -> Vec<Shot> {
    let mut files: Vec<PathBuf> = std::fs::read_dir(folder)
        .unwrap()
        .map(|entry| entry.unwrap().path())
        .collect();
    files.retain(|file| file.extension().is_some_and(|ending| ending == "npz"));
    files.sort();
    files.iter().map(|file| Shot::read(file)).collect()
}

/// A frame as it was drawn.
struct Drawn {
    camera: PtzCamera,
    clicks: Vec<Observation>,
    paint: Vec<Observation>,
}

struct Draw {
    rng: Pcg64Mcg,
}

impl Draw {
    fn noisy(&mut self, at: ImagePoint, sigma_px: f64) -> ImagePoint {
        let normal = Normal::new(0.0, sigma_px).unwrap();
        at.translate(Vec2::new(
            normal.sample(&mut self.rng),
            normal.sample(&mut self.rng),
        ))
    }

    /// Frames spread over a shot, each aimed at a place of the pitch so that it shows some
    /// landmarks.
    fn frames(&mut self, shot: &Shot, field: &FieldModel) -> Vec<Drawn> {
        let nth = |frame: usize| &shot.lenses[frame * (shot.lenses.len() - 1) / (FRAMES - 1)];
        (0..FRAMES)
            .map(|frame| self.frame(nth(frame), shot.position_m, field))
            .collect()
    }

    fn frame(&mut self, lens: &FrameLens, position_m: Vec3, field: &FieldModel) -> Drawn {
        let angles = BaseAngles {
            roll: Angle::from_degrees(0.3),
            ..BaseAngles::default()
        };
        let base = lens.base_with(&CameraBase::new(
            position_m,
            angles.base_from_world(),
            SIZE.centre(),
        ));
        loop {
            let aim = Vec3::new(
                self.rng.random_range(-45.0..45.0),
                self.rng.random_range(-25.0..25.0),
                0.0,
            );
            let towards = base.base_from_world * (aim - position_m);
            let pan = towards.x.atan2(towards.z);
            let tilt = (-towards.y).atan2(towards.x.hypot(towards.z));
            let ptz = Ptz::from_degrees(pan.to_degrees(), tilt.to_degrees(), lens.focal_px);
            let camera = PtzCamera::new(base, ptz);
            let clicks = self.clicks(&camera, field);
            if clicks.len() >= 3 {
                return Drawn {
                    camera,
                    clicks,
                    paint: self.paint(&camera, field),
                };
            }
        }
    }

    fn clicks(&mut self, camera: &PtzCamera, field: &FieldModel) -> Vec<Observation> {
        let mut clicks = Vec::new();
        for landmark in field
            .landmarks
            .iter()
            .filter(|landmark| landmark.nominal_m.z == 0.0)
        {
            let Ok(seen) = camera.image_from_world(field.landmark_in_world(landmark)) else {
                continue;
            };
            if SIZE.contains(seen) {
                let seen = self.noisy(seen, CLICK_PX);
                clicks.extend(Observation::from_landmark(
                    field,
                    landmark.id.as_str(),
                    seen,
                    SIZE,
                    clicks.len(),
                ));
            }
        }
        clicks
    }

    fn paint(&mut self, camera: &PtzCamera, field: &FieldModel) -> Vec<Observation> {
        let every = SampleOptions {
            spacing_px: PAINT_EVERY_PX,
            ..SampleOptions::default()
        };
        let samples = sample_lines(field, camera, SIZE, &every);
        let seen = samples.iter().enumerate().filter_map(|(place, sample)| {
            Observation::from_paint(
                field,
                sample.line,
                self.noisy(sample.image, PAINT_PX),
                PAINT_PX,
                place,
            )
        });
        seen.collect()
    }
}

/// How far the ground is off in all frames, px, sorted. `found` has a frame's camera, if it was
/// found; `crown_m` goes with them.
fn ground_errors(
    found: &[Option<PtzCamera>],
    crown_m: f64,
    frames: &[Drawn],
    field: &FieldModel,
) -> Vec<f64> {
    let mut errors = Vec::new();
    for (drawn, camera) in frames.iter().zip(found) {
        let Some(camera) = camera else { continue };
        for (column, row) in (0..12).flat_map(|column| (0..7).map(move |row| (column, row))) {
            let at = ImagePoint::new(
                80.0 + 160.0 * f64::from(column),
                77.0 + 154.0 * f64::from(row),
            );
            let on_field =
                |at: &Vec3| at.x.abs() <= 0.5 * field.length_m && at.y.abs() <= 0.5 * field.width_m;
            let Some(ground) = drawn.camera.plane_from_image(at, 0.0).filter(on_field) else {
                continue;
            };
            let crowned =
                |crown_m: f64| ground - Vec3::z() * (crown_m * field.crown().drop_share(ground.y));
            let pair = camera.image_from_world(crowned(crown_m));
            let (Ok(found_px), Ok(true_px)) =
                (pair, drawn.camera.image_from_world(crowned(field.crown_m)))
            else {
                continue;
            };
            errors.push(found_px.offset_from(true_px).norm());
        }
    }
    errors.sort_by(f64::total_cmp);
    errors
}

/// How far the ground is off in a shot, px, sorted.
struct Errors {
    model: String,
    px: Vec<f64>,
}

impl Errors {
    fn at(&self, share: f64) -> f64 {
        self.px
            .get((self.px.len() as f64 * share) as usize)
            .copied()
            .unwrap_or(f64::NAN)
    }
}

fn cameras_of(found: &BaseEstimate) -> Vec<Option<PtzCamera>> {
    found
        .frames
        .iter()
        .map(|fit| Some(PtzCamera::new(found.base, (*fit)?.ptz)))
        .collect()
}

/// By the same clicks where base and lens of every frame are known: what the clicks' own noise
/// does.
fn with_known_lenses(frames: &[Drawn], field: &FieldModel) -> Errors {
    let solve = |drawn: &Drawn| {
        let solved =
            solve_frame(drawn.camera.base(), &drawn.clicks, &SolveContext::new(SIZE)).ok()?;
        Some(PtzCamera::new(*drawn.camera.base(), solved.ptz))
    };
    let cameras: Vec<Option<PtzCamera>> = frames.iter().map(solve).collect();
    Errors {
        model: String::new(),
        px: ground_errors(&cameras, field.crown_m, frames, field),
    }
}

fn clicks_of(observations: Vec<Observation>) -> FrameClicks {
    FrameClicks {
        observations,
        start: None,
    }
}

/// The base by every landmark in view, clicked.
fn by_clicks(frames: &[Drawn], field: &FieldModel) -> BaseEstimate {
    let clicks: Vec<FrameClicks> = frames
        .iter()
        .map(|drawn| clicks_of(drawn.clicks.clone()))
        .collect();
    estimate_base(
        &CameraClicks::with_centred_principal_point(field, &clicks, SIZE),
        None,
        &BaseOptions::default(),
        &Progress::default(),
    )
    .unwrap()
}

/// The base by the paint alone, from cameras that the clicks gave.
fn by_paint(frames: &[Drawn], start: &BaseEstimate, field: &FieldModel) -> BaseEstimate {
    let ptz: Vec<Option<Ptz>> = start
        .frames
        .iter()
        .map(|fit| fit.map(|fit| fit.ptz))
        .collect();
    let nothing = vec![FrameClicks::default(); frames.len()];
    let painted: Vec<FrameClicks> = frames
        .iter()
        .map(|drawn| clicks_of(drawn.paint.clone()))
        .collect();
    let unclicked = CameraClicks::with_centred_principal_point(field, &nothing, SIZE);
    estimate_base_on_paint(
        &unclicked,
        &painted,
        (&start.base, &ptz),
        &BaseOptions::default(),
        &Progress::default(),
    )
    .unwrap()
}

/// How far the ground is off with a base and the cameras of its frames.
fn errors_of(found: &BaseEstimate, frames: &[Drawn], field: &FieldModel) -> Errors {
    let px = ground_errors(&cameras_of(found), found.crown_m, frames, field);
    Errors {
        model: found.model.to_string(),
        px,
    }
}

fn main() {
    let Some(data) = std::env::var_os("TOUCHLINE_DATA") else {
        println!("TOUCHLINE_DATA names no folder: the measured lenses are not there");
        return;
    };
    let field = builtin("soccer").unwrap().default_model().unwrap();
    let field = FieldModel {
        crown_m: 0.13,
        ..field
    };
    let rows: Vec<(String, [Errors; 3])> = shots(&Path::new(&data).join("lenses-worldcup"))
        .par_iter()
        .enumerate()
        .map(|(seed, shot)| {
            let frames = Draw {
                rng: Pcg64Mcg::seed_from_u64(seed as u64),
            }
            .frames(shot, &field);
            let clicked = by_clicks(&frames, &field);
            let painted = by_paint(&frames, &clicked, &field);
            let [clicks, paint] =
                [&clicked, &painted].map(|found| errors_of(found, &frames, &field));
            (
                shot.name.clone(),
                [clicks, paint, with_known_lenses(&frames, &field)],
            )
        })
        .collect();
    println!(
        "| shot | clicks: median, 95 % px | lenses known | model | paint: median, 95 % px | model |"
    );
    println!("|---|---|---|---|---|---|");
    for (name, [clicks, paint, known]) in &rows {
        let [by_clicks, by_known, by_paint] = [clicks, known, paint]
            .map(|errors| format!("{:.2}, {:.2}", errors.at(0.5), errors.at(0.95)));
        println!(
            "| {name} | {by_clicks} | {by_known} | {} | {by_paint} | {} |",
            clicks.model, paint.model
        );
    }
    let of_all = |which: usize| {
        let mut px: Vec<f64> = rows.iter().map(|row| row.1[which].at(0.95)).collect();
        px.sort_by(f64::total_cmp);
        (px[px.len() / 2], px[px.len() - 1])
    };
    for (what, which) in [("clicks", 0), ("clicks with known lenses", 2), ("paint", 1)] {
        let (middle, worst) = of_all(which);
        println!(
            "{what}: 95 % {middle:.2} px in the middle one of the shots, {worst:.2} px in the worst"
        );
    }
}
