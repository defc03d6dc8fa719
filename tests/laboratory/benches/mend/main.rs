//! Cameras of other programs, mended: how many frames are right before and after, and how often the
//! result was certain and wrong. Printed as Markdown.
//!
//! `cargo bench --bench mend [-- drawn scattered mirrored size mixed real] [--seeds N] [--frames N] [--keep DIR]`;
//! the real clips are those of `TOUCHLINE_DATA`. Drawn clips have exact truth; for real ones it is
//! the program's own answer without clicks, where the paint supports it. With `--keep` drawn
//! pictures stay in a folder and are used again.
#![allow(
    missing_docs,
    clippy::unwrap_used,
    clippy::print_stdout,
    reason = "a bench says what failed by failing"
)]

#[path = "../../../benches/arguments.rs"]
mod arguments;
#[path = "../../../benches/no_click/drawing.rs"]
mod drawing;
mod given;
mod mixed;
#[path = "../video_document.rs"]
mod video_document;

use arguments::Arguments;
use drawing::{CAMERA, Drawn, draw, shots};
use given::{Faults, GOOD, SCATTERED, give};
use mixed::{CLOSE_UP, mixed_clip};
use std::collections::BTreeSet;
use std::path::{Path, PathBuf};
use std::time::Instant;
use touchline::document::{CameraId, Document, FieldSpec, document_to_string};
use touchline::markings::{ProjectedLandmark, project_landmarks};
use touchline::media::{FrameReader, FrameSource, VideoInfo};
use touchline::pipelines::{MatchLabels, MatchOptions, MendOptions, label_match, mend};
use touchline::progress::Progress;
use touchline::store::read;
use touchline::synthetic::{Preset, ShootOptions, StadiumOptions, stadium};
use video_document::document_of_video;

/// A frame is right if its lines lie within this distance of the truth, px.
const RIGHT_PX: f64 = 3.0;
/// Wrong and stated with at least this confidence is certain and wrong.
const CERTAIN: f64 = 0.9;
/// Beyond this distance a certain frame is wrong, px at 1920 px width: what the confidence states.
const WRONG_PX: f64 = 10.0;

/// The clips of `TOUCHLINE_DATA` that are mended.
const REAL: [&str; 2] = ["germany-italy", "estudiantes-patronato"];

fn main() {
    let arguments = Arguments::of_process();
    let sections = ["drawn", "scattered", "mirrored", "size", "mixed", "real"];
    let wants = |name: &str| arguments.wants(name, &sections);
    let scratch = tempfile::tempdir().unwrap();
    let folder = arguments
        .value("--keep")
        .map_or_else(|| scratch.path().to_owned(), PathBuf::from);
    let (seeds, is_verbose) = (
        arguments.number("--seeds", 3) as u64,
        arguments.is_set("--verbose"),
    );
    println!(
        "| clip | seed | frames | right before | right after | left | certain and wrong | median, worst px | seconds |"
    );
    println!("|---|---|---|---|---|---|---|---|---|");
    for (name, frames, faults) in [
        ("drawn", 200, GOOD),
        ("scattered", 750, SCATTERED),
        (
            "mirrored",
            200,
            Faults {
                mirrored: true,
                ..GOOD
            },
        ),
    ] {
        if !wants(name) {
            continue;
        }
        let frames = arguments.number("--frames", frames);
        for seed in 1..=seeds {
            let pictures = folder.join(format!("{frames}-{seed}"));
            let drawn = drawn_clip(&pictures, frames, FieldSpec::new("soccer"), seed);
            report(name, seed, &drawn, &pictures, &faults, is_verbose);
        }
    }
    for seed in (1..=seeds).filter(|_| wants("size")) {
        let frames = arguments.number("--frames", 200);
        let pictures = folder.join(format!("size-{frames}-{seed}"));
        let size = [("length_m", 101.0), ("width_m", 65.0)];
        let size = size.map(|(name, value)| (name.to_owned(), value));
        let field = FieldSpec::with_params("soccer", size.into_iter().collect());
        let drawn = drawn_clip(&pictures, frames, field, seed);
        report("size", seed, &drawn, &pictures, &GOOD, is_verbose);
    }
    for seed in (1..=seeds).filter(|_| wants("mixed")) {
        let pictures = folder.join(format!("mixed-{seed}"));
        let drawn = mixed_clip(&pictures, seed);
        let faults = Faults {
            close_up: [CLOSE_UP.start, CLOSE_UP.end],
            ..GOOD
        };
        report("mixed", seed, &drawn, &pictures, &faults, is_verbose);
    }
    if let Some(data) = std::env::var_os("TOUCHLINE_DATA").filter(|_| wants("real")) {
        for clip in REAL {
            let data = Path::new(&data);
            let known = real_clip(data, clip, &folder);
            for seed in 1..=seeds {
                report(clip, seed, &known, data, &GOOD, is_verbose);
            }
        }
    }
}

/// A drawn clip of 25 frames a second by a strong lens.
fn drawn_clip(folder: &Path, frames: usize, field: FieldSpec, seed: u64) -> Drawn {
    let model = field.model(Path::new("")).unwrap();
    let scene = stadium(&StadiumOptions::new(model, seed));
    let shoot = ShootOptions {
        step_s: 0.04,
        ..Preset::Hard.shoot()
    };
    let base = shoot.main_camera(drawing::SIZE);
    let taken = shots(&scene, &base, &shoot, frames, seed);
    draw(folder, &[(&scene, &taken)], 75, field)
}

/// A real clip with the cameras that the program finds without a click.
fn real_clip(data: &Path, clip: &str, folder: &Path) -> Drawn {
    let video = format!("wild/{clip}.mp4");
    let FrameSource::Video(info) = FrameSource::open(&data.join(&video)).unwrap() else {
        unreachable!("{video} is a video")
    };
    let known = folder.join(format!("{clip}.json"));
    let document = if known.exists() {
        read(&known).unwrap().1.relocate(folder, data)
    } else {
        let document = found_without_clicks(data, clip, &video, &info);
        let kept = document.clone().relocate(data, folder);
        std::fs::write(&known, document_to_string(&kept).unwrap()).unwrap();
        document
    };
    let truth = document
        .frames
        .iter()
        .map(|frame| document.ptz_camera(frame).unwrap())
        .collect();
    Drawn { document, truth }
}

/// The frames of a clip whose cameras the program finds without a click and is certain of.
fn found_without_clicks(data: &Path, clip: &str, video: &str, info: &VideoInfo) -> Document {
    let mut document = document_of_video(video, info, FieldSpec::new("soccer"), 1);
    let labels = label_match(
        &mut document,
        data,
        &CameraId::from(CAMERA),
        &mut FrameReader::new(),
        &MatchOptions::default(),
        &Progress::default(),
    );
    assert!(
        matches!(labels, Ok(MatchLabels::Labelled(_))),
        "{clip}: no camera"
    );
    document.frames.retain(|frame| {
        let solution = frame.solution.as_ref();
        frame.ptz.is_some() && solution.and_then(|known| known.confidence) >= Some(CERTAIN)
    });
    document
}

fn report(name: &str, seed: u64, drawn: &Drawn, folder: &Path, faults: &Faults, is_verbose: bool) {
    let mut document = drawn.document.clone();
    // Whoever gives cameras, or imports them, takes the usual size for granted.
    document.field = FieldSpec::new("soccer");
    let [from, to] = faults.close_up;
    let close_up = from..to;
    give(&mut document, &drawn.truth, faults, seed);
    let before = right(&document, drawn);
    let begun = Instant::now();
    let options = MendOptions::default();
    let result = mend(
        &mut document,
        folder,
        &mut FrameReader::new(),
        &options,
        &Progress::default(),
    );
    let seconds = begun.elapsed().as_secs_f64();
    let mended = match result {
        Ok(mended) => mended,
        Err(error) => {
            println!(
                "| {name} | {seed} | {} | {before} | {error} |",
                drawn.truth.len()
            );
            return;
        }
    };
    for error in &mended.common {
        eprintln!("{name} {seed}: {error}");
    }
    for camera in &mended.not_aligned {
        eprintln!("{name} {seed}: {camera}");
    }
    if is_verbose {
        let bases = drawn.document.cameras.iter().chain(&document.cameras);
        for camera in bases {
            eprintln!(
                "{:?}",
                camera.base().map(|base| (base.position_m, base.distortion))
            );
        }
        eprintln!("{:?}", mended.tally());
    }
    let in_close_up = close_up.clone();
    let with_camera = in_close_up.filter(|index| document.frames[*index].ptz.is_some());
    if !close_up.is_empty() {
        let cameras: BTreeSet<_> = document.frames.iter().map(|frame| &frame.camera).collect();
        let (cameras, wrong) = (cameras.len(), with_camera.count());
        eprintln!("{name} {seed}: {cameras} cameras, {wrong} frames of the close-up with a camera");
    }
    let mut off: Vec<f64> = (0..drawn.truth.len())
        .filter(|index| !close_up.contains(index))
        .filter_map(|index| off_px(&document, drawn, index))
        .collect();
    off.sort_by(f64::total_cmp);
    let is_certain_and_wrong = |index: &usize| {
        let frame = &document.frames[*index];
        let confidence = frame
            .solution
            .as_ref()
            .and_then(|solution| solution.confidence);
        let wrong_px = WRONG_PX * frame.image_size.scale_from_1920();
        confidence >= Some(CERTAIN)
            && off_px(&document, drawn, *index).is_some_and(|off| off > wrong_px)
    };
    if is_verbose {
        for (index, frame) in mended.frames.iter().enumerate() {
            let off = off_px(&document, drawn, index);
            if off.is_none_or(|off| off > RIGHT_PX) {
                eprintln!(
                    "{index}: {:?} {off:?} moved {:?}",
                    frame.outcome, frame.moved_px
                );
            }
        }
    }
    println!(
        "| {name} | {seed} | {} | {before} | {} | {} | {} | {:.2}, {:.1} | {seconds:.0} |",
        drawn.truth.len(),
        right(&document, drawn),
        mended.tally().left,
        (0..drawn.truth.len()).filter(is_certain_and_wrong).count(),
        off.get(off.len() / 2).copied().unwrap_or(f64::NAN),
        off.last().copied().unwrap_or(f64::NAN),
    );
}

fn right(document: &Document, known: &Drawn) -> usize {
    let is_right =
        |index: &usize| off_px(document, known, *index).is_some_and(|off| off <= RIGHT_PX);
    (0..known.truth.len()).filter(is_right).count()
}

/// The largest distance between the landmarks that the true camera sees in the picture and where the
/// document's camera has them, each on the field of its document, px. None without a camera, or
/// where no landmark is seen.
fn off_px(document: &Document, known: &Drawn, index: usize) -> Option<f64> {
    let frame = &document.frames[index];
    let now = document.ptz_camera(frame)?;
    let (field, size) = (
        document.field.model(Path::new("")).unwrap(),
        frame.image_size,
    );
    let true_field = known.document.field.model(Path::new("")).unwrap();
    let seen = project_landmarks(&true_field, &known.truth[index], size, 0.0);
    let off_px = |seen: &ProjectedLandmark| {
        let world = field.landmark_in_world(&field.landmarks[seen.landmark]);
        let now = now.image_from_world(world);
        now.map_or(f64::INFINITY, |now| now.distance_px(seen.image))
    };
    seen.iter().map(off_px).reduce(f64::max)
}
