//! A few rough clicks in a clip as people share it: how many frames of the main camera get their
//! cameras, and how far off these are.
//!
//! `cargo bench --bench rough_clicks [-- --seeds N] [--from K] [--keep DIR] [--verbose]`. Each clip
//! is 640×360 at 500 kbit/s: the main camera, a close-up, the main camera again. An annotator
//! clicks four landmarks in each of three frames, ±1.5 px, and asks for the painted lines.
#![allow(
    missing_docs,
    clippy::unwrap_used,
    clippy::print_stdout,
    reason = "a bench says what failed by failing"
)]

#[path = "../../benches/arguments.rs"]
#[allow(dead_code, reason = "other benches have sections")]
mod arguments;
#[path = "../../benches/no_click/drawing.rs"]
#[allow(dead_code, reason = "other benches draw folders of pictures")]
mod drawing;
mod scaled_camera;
mod video_document;

use arguments::Arguments;
use drawing::{CAMERA, SIZE, Shot, shots};
use image::imageops::{FilterType, resize};
use rand::{RngExt as _, SeedableRng as _};
use rand_distr::StandardNormal;
use rand_pcg::Pcg64Mcg;
use rayon::prelude::*;
use scaled_camera::scaled_camera;
use std::ops::Range;
use std::path::{Path, PathBuf};
use std::process::{Command, Stdio};
use std::time::Instant;
use touchline::calibrate::clips;
use touchline::camera::{Ptz, PtzCamera};
use touchline::document::{Click, Document, FieldSpec, document_to_string};
use touchline::field::{FieldModel, Landmark, builtin};
use touchline::geometry::{ImagePoint, ImageSize, quantile};
use touchline::markings::project_landmarks;
use touchline::media::{CachedReader, FrameReader, FrameSource, KEPT_BYTES};
use touchline::pipelines::{TrackingEvent, TrackingOptions, track_clips};
use touchline::progress::Progress;
use touchline::synthetic::{Preset, ShootOptions, StadiumOptions, stadium};
use touchline_laboratory::corners_apart_px;
use video_document::document_of_video;

/// The size of the shared video, two thirds of what is drawn.
const SHARED: ImageSize = ImageSize::new(640, 360);
const SHARED_SCALE: f64 = SHARED.width as f64 / SIZE.width as f64;

/// The frames of each shot: the main camera, a close-up, the main camera.
const FRAMES: usize = 400;
const CLOSE_UP: Range<usize> = 180..240;

/// What an annotator clicks.
const CLICKED_FRAMES: usize = 3;
const CLICKS_PER_FRAME: usize = 4;
const CLICK_SIGMA_PX: f64 = 1.5;

/// A frame is right if no corner of its picture is off by more than this, px at 1920 px width.
const RIGHT_PX: f64 = 10.0;
/// A confidence is certain from the first on, and doubtful below the second.
const CERTAIN: f64 = 0.9;
const DOUBTFUL: f64 = 0.5;

fn main() {
    let arguments = Arguments::of_process();
    let scratch = tempfile::tempdir().unwrap();
    let folder = arguments
        .value("--keep")
        .map_or_else(|| scratch.path().to_owned(), PathBuf::from);
    let from = arguments.number("--from", 1) as u64;
    let seeds = arguments.number("--seeds", 5) as u64;
    println!(
        "| seed | frames | tracked | right | corners off, median, 90 % (px) | right, stated < 50 % \
         | certain and wrong | close-up frames with a camera | position off, m | seconds |"
    );
    println!("|---|---|---|---|---|---|---|---|---|---|");
    for seed in from..from + seeds {
        run(&folder, seed, arguments.is_set("--verbose"));
    }
}

/// Draws, clicks, tracks and reports one clip.
fn run(folder: &Path, seed: u64, is_verbose: bool) {
    std::fs::create_dir_all(folder).unwrap();
    let field = builtin("soccer").unwrap().default_model().unwrap();
    let shots = shots_of(&field, seed);
    let name = format!("shared-{seed}.mp4");
    if !folder.join(&name).exists() {
        draw(&field, &shots, &folder.join(&name), seed);
    }
    let truth: Vec<PtzCamera> = shots
        .iter()
        .map(|shot| scaled_camera(&shot.camera, SHARED_SCALE, [0.0; 2]))
        .collect();
    let FrameSource::Video(info) = FrameSource::open(&folder.join(&name)).unwrap() else {
        unreachable!("{name} is a video")
    };
    let mut document = document_of_video(&name, &info, FieldSpec::new("soccer"), 1);
    click(&mut document, &truth, &field, seed);
    let text = document_to_string(&document).unwrap();
    std::fs::write(folder.join(format!("clicked-{seed}.json")), text).unwrap();

    let begun = Instant::now();
    let clips = clips(document.at(folder), None);
    let options = TrackingOptions {
        refine_base: true,
        ..TrackingOptions::default()
    };
    let progress = Progress::new(|event| {
        if is_verbose {
            say(&event);
        }
        std::ops::ControlFlow::Continue(())
    });
    let mut reader = CachedReader::new(FrameReader::new(), KEPT_BYTES);
    track_clips(
        &mut document,
        folder,
        &clips,
        &mut reader,
        &options,
        &mut Vec::new(),
        &progress,
    )
    .unwrap();
    report(&document, &truth, seed, begun.elapsed().as_secs_f64());
}

fn say(event: &TrackingEvent) {
    match event {
        TrackingEvent::Tracked(_, tracked) => {
            let stops = tracked.stops.iter();
            let stops: Vec<String> = stops
                .map(|stop| format!("{} {}/{}", stop.picture, stop.agreeing, stop.seen))
                .collect();
            let (frames, painted) = (tracked.frames.len(), tracked.painted);
            eprintln!(
                "tracked {frames}, on paint {painted}, points {:.2} px; stops {stops:?}",
                tracked.sigma_px
            );
        }
        TrackingEvent::Refined(_, seen) => eprintln!("refined {seen:?}"),
        TrackingEvent::Progress(_) => {}
        event => eprintln!("{event:?}"),
    }
}

/// The pictures of the clip. In the close-up the camera shows grass and a player or two between the
/// markings of the far half.
fn shots_of(field: &FieldModel, seed: u64) -> Vec<Shot> {
    let scene = stadium(&StadiumOptions::new(field.clone(), seed));
    let shoot = ShootOptions {
        step_s: 0.04,
        distortion_at_1280: Preset::Hard.shoot().distortion_at_1280,
        ..Preset::Paper.shoot()
    };
    let base = shoot.main_camera(SIZE);
    let mut shots = shots(&scene, &base, &shoot, FRAMES, seed);
    for (index, shot) in shots[CLOSE_UP].iter_mut().enumerate() {
        let ptz = Ptz::from_degrees(-9.0 + 0.01 * index as f64, -12.4, 14_000.0);
        shot.camera = PtzCamera::new(base, ptz);
    }
    shots
}

/// Draws the pictures and encodes them as people share them.
fn draw(field: &FieldModel, shots: &[Shot], video: &Path, seed: u64) {
    let scene = stadium(&StadiumOptions::new(field.clone(), seed));
    let pictures = tempfile::tempdir().unwrap();
    shots.par_iter().enumerate().for_each(|(index, shot)| {
        let drawn = scene.render(&shot.camera, SIZE, &shot.options).image;
        let shared = resize(&drawn, SHARED.width, SHARED.height, FilterType::Triangle);
        let name = format!("{index:04}.png");
        shared.save(pictures.path().join(name)).unwrap();
    });
    let status = Command::new("ffmpeg")
        .args([
            "-hide_banner",
            "-loglevel",
            "error",
            "-y",
            "-framerate",
            "25",
            "-i",
        ])
        .arg(pictures.path().join("%04d.png"))
        .args(["-c:v", "libx264", "-pix_fmt", "yuv420p", "-b:v", "500k"])
        .arg(video)
        .stdin(Stdio::null())
        .status()
        .unwrap();
    assert!(status.success(), "{}", video.display());
}

/// Clicks landmarks of the ground in the frames of the main camera that lie farthest apart in pan
/// among those that show enough.
fn click(document: &mut Document, truth: &[PtzCamera], field: &FieldModel, seed: u64) {
    let mut random = Pcg64Mcg::seed_from_u64(seed);
    // What an annotator would choose: frames with four landmarks that do not lie on one line.
    let shows_enough = |index: &usize| {
        let seen = landmarks_seen(&truth[*index], field);
        let on_one_line = |axis: usize| {
            let first = seen.first().map(|(landmark, _)| landmark.nominal_m[axis]);
            let is_near = |at_m: f64| first.is_some_and(|first_m| (at_m - first_m).abs() < 3.0);
            let apart = seen.iter().filter(|(one, _)| !is_near(one.nominal_m[axis]));
            apart.count() < 2
        };
        seen.len() >= CLICKS_PER_FRAME && !on_one_line(0) && !on_one_line(1)
    };
    let mut showing: Vec<usize> = (0..truth.len())
        .filter(|index| !CLOSE_UP.contains(index))
        .filter(shows_enough)
        .collect();
    let pan = |index: &usize| truth[*index].ptz().pan.degrees();
    showing.sort_by(|a, b| pan(a).total_cmp(&pan(b)));
    assert!(
        showing.len() >= CLICKED_FRAMES,
        "too few frames show four landmarks"
    );
    for number in 0..CLICKED_FRAMES {
        let index = showing[number * (showing.len() - 1) / (CLICKED_FRAMES - 1)];
        let mut seen = landmarks_seen(&truth[index], field);
        // Spread over the picture: each next one is the farthest from those that are clicked.
        let mut chosen = vec![seen.swap_remove(0)];
        while chosen.len() < CLICKS_PER_FRAME {
            let nearest = |at: ImagePoint| {
                let distances = chosen.iter().map(|(_, other)| at.distance_px(*other));
                distances.fold(f64::INFINITY, f64::min)
            };
            let farthest = (0..seen.len())
                .max_by(|a, b| nearest(seen[*a].1).total_cmp(&nearest(seen[*b].1)))
                .unwrap();
            chosen.push(seen.swap_remove(farthest));
        }
        for (landmark, at) in chosen {
            let mut off = || CLICK_SIGMA_PX * random.sample::<f64, _>(StandardNormal);
            let at = ImagePoint::new(at.x + off(), at.y + off());
            let click = Click::landmark(landmark.id.clone(), at);
            document.frames[index].clicks.push(click);
        }
    }
}

/// The landmarks of the ground that a camera shows, with their places in the picture.
fn landmarks_seen<'a>(
    camera: &PtzCamera,
    field: &'a FieldModel,
) -> Vec<(&'a Landmark, ImagePoint)> {
    project_landmarks(field, camera, SHARED, 0.0)
        .into_iter()
        .map(|seen| (&field.landmarks[seen.landmark], seen.image))
        .filter(|(landmark, _)| landmark.nominal_m.z == 0.0)
        .collect()
}

fn report(document: &Document, truth: &[PtzCamera], seed: u64, seconds: f64) {
    let of_camera = (0..truth.len()).filter(|index| !CLOSE_UP.contains(index));
    let confidence = |index: usize| {
        let solution = document.frames[index].solution.as_ref();
        solution.and_then(|solution| solution.confidence)
    };
    let (mut off, mut right, mut doubted, mut certain_and_wrong) = (Vec::new(), 0, 0, 0);
    let right_px = RIGHT_PX * SHARED.scale_from_1920();
    for index in of_camera.clone() {
        let Some(camera) = document.ptz_camera(&document.frames[index]) else {
            continue;
        };
        let worst = corners_apart_px(&truth[index], &camera, SHARED)
            .into_iter()
            .fold(0.0, f64::max);
        off.push(worst);
        if worst <= right_px {
            right += 1;
            doubted += usize::from(confidence(index) < Some(DOUBTFUL));
        } else {
            certain_and_wrong += usize::from(confidence(index) >= Some(CERTAIN));
        }
    }
    off.sort_by(f64::total_cmp);
    let is_carried = |index: &usize| document.frames[*index].ptz.is_some();
    let close_up = CLOSE_UP.filter(is_carried).count();
    let base = document
        .camera(&CAMERA.into())
        .and_then(touchline::document::Camera::base);
    let position_off = base.map_or(f64::NAN, |base| {
        (base.position_m - truth[0].base().position_m).norm()
    });
    println!(
        "| {seed} | {} | {} | {right} | {:.2}, {:.2} | {doubted} | {certain_and_wrong} \
         | {close_up} | {position_off:.2} | {seconds:.0} |",
        of_camera.clone().count(),
        off.len(),
        quantile(&off, 0.5),
        quantile(&off, 0.9),
    );
}
