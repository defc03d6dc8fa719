//! How drawn broadcasts are taken apart: their shots, what these show, their cameras.
//!
//! Each FOLDER of the command line is one of `touchline synth --broadcast`. Its shots are searched
//! here; where `FOLDER/found` has the project that `touchline calibrate` made of the video, that is
//! compared in their place, with its cameras. Figures: broadcast-clips.md.
#![allow(
    missing_docs,
    clippy::unwrap_used,
    clippy::panic,
    reason = "a bench says what failed by failing"
)]

use std::collections::{BTreeMap, BTreeSet};
use std::num::NonZeroUsize;
use std::ops::ControlFlow;
use std::path::{Path, PathBuf};
use touchline::camera::PtzCamera;
use touchline::document::{
    CameraId, Document, FieldSpec, Shot, ShotContent, ShotEnd, ShotKind, document_from_frames,
    shots_of_frames,
};
use touchline::field::{FieldLine, FieldModel};
use touchline::geometry::ImageSize;
use touchline::media::{FrameReader, FrameSource, Video};
use touchline::pipelines::{MatchEvent, MatchOptions, label_match};
use touchline::progress::Progress;
use touchline::store::read;

/// A transition is found if both ends are this near, frames; a cut must be exact.
const NEAR: u64 = 3;
/// A camera counts from this many shots of the field and frames (20 s) on.
const LEAST_SHOTS: u32 = 3;
const LEAST_FRAMES: u32 = 500;
/// Confidence of a certain frame; largest error of a right and least of a wrong one, of the worst
/// place of a painted line in view, px at 1920 px width.
const CERTAIN: f64 = 0.95;
const RIGHT_PX: f64 = 5.0;
const WRONG_PX: f64 = 10.0;

/// Counts by what they are of: good ones, and all.
type Counts = BTreeMap<String, [u32; 2]>;

fn main() {
    let mut counts = Counts::new();
    let mut found = [0; 2];
    for folder in std::env::args().skip(1).filter(|word| word != "--bench") {
        let folder = PathBuf::from(folder);
        println!("{}", folder.display());
        let (_, truth, _) = read(&folder.join("truth.json")).unwrap();
        let project = folder.join("found/project.json");
        let document = if project.is_file() {
            let (_, document, _) = read(&project).unwrap();
            compare_cameras(&truth, &document, &mut counts);
            document
        } else {
            search_shots(&folder)
        };
        compare_shots(&truth, &document, &mut counts, &mut found);
    }
    for (name, [good, all]) in &counts {
        println!("{name}: {good} of {all}");
    }
    for (name, found) in ["cuts", "transitions"].into_iter().zip(found) {
        let [good, all] = counts.get(name).copied().unwrap_or_default();
        let f1 = 2.0 * f64::from(good) / f64::from((all + found).max(1));
        println!("{name}: {found} found, F1 {f1:.3}");
    }
}

fn count(counts: &mut Counts, name: &str, is_good: bool) {
    let [good, all] = counts.entry(name.to_owned()).or_default();
    *good += u32::from(is_good);
    *all += 1;
}

/// The shots of a video, before any camera is searched.
fn search_shots(folder: &Path) -> Document {
    let video = Video::open(&folder.join("broadcast.mp4")).unwrap();
    let source = FrameSource::Video(video.info().clone());
    let field = FieldSpec::new("soccer");
    let every = NonZeroUsize::MIN;
    let mut document =
        document_from_frames(&source, folder, field, every, &Progress::default()).document;
    let camera = document.frames[0].camera.clone();
    let progress = Progress::new(|event| match event {
        MatchEvent::Shots { .. } => ControlFlow::Break(()),
        _ => ControlFlow::Continue(()),
    });
    let options = MatchOptions {
        find_shots: true,
        ..MatchOptions::default()
    };
    let mut reader = FrameReader::new();
    let stopped = label_match(
        &mut document,
        folder,
        &camera,
        &mut reader,
        &options,
        &progress,
    );
    assert!(stopped.is_err());
    document
}

/// The frames of a shot: the first and the last.
fn ends(shot: &Shot) -> [u64; 2] {
    [&shot.from, &shot.to].map(|end| match end {
        ShotEnd::VideoFrame(number) => *number,
        ShotEnd::Frame(id) => panic!("a shot ends at {id:?}"),
    })
}

/// What a shot is in truth: its subject or the style of its transition.
fn true_name(shot: &Shot) -> &str {
    let truth = &shot.extra["truth"];
    let name = truth.get("transition").or_else(|| truth.get("shows"));
    name.and_then(|name| name.as_str()).unwrap()
}

fn shots_of(document: &Document, kind: ShotKind) -> Vec<&Shot> {
    // The video's beginning is no cut.
    let shots = document
        .shots
        .iter()
        .skip(usize::from(kind == ShotKind::Cut));
    shots.filter(|shot| shot.kind == kind).collect()
}

fn compare_shots(truth: &Document, document: &Document, counts: &mut Counts, found: &mut [u32; 2]) {
    let starts = |document| -> BTreeSet<u64> {
        let cuts = shots_of(document, ShotKind::Cut).into_iter();
        cuts.map(|shot| ends(shot)[0]).collect()
    };
    let cuts = [truth, document].map(starts);
    for cut in &cuts[0] {
        count(counts, "cuts", cuts[1].contains(cut));
    }
    println!("  cuts missed {:?}", &cuts[0] - &cuts[1]);
    println!("  cuts where none is {:?}", &cuts[1] - &cuts[0]);
    let spans = shots_of(document, ShotKind::Transition);
    let spans: Vec<[u64; 2]> = spans.into_iter().map(ends).collect();
    found[0] += cuts[1].len() as u32;
    found[1] += spans.len() as u32;
    for shot in shots_of(truth, ShotKind::Transition) {
        let [first, last] = ends(shot);
        let is_near =
            |span: &[u64; 2]| span[0].abs_diff(first) <= NEAR && span[1].abs_diff(last) <= NEAR;
        let is_found = spans.iter().any(is_near);
        for name in ["transitions", true_name(shot)] {
            count(counts, name, is_found);
        }
        if !is_found {
            let overlaps = |span: &&[u64; 2]| span[0] <= last && span[1] >= first;
            let beside: Vec<_> = spans.iter().filter(overlaps).collect();
            println!("  {} {first} to {last}: {beside:?}", true_name(shot));
        }
    }
    for shot in truth
        .shots
        .iter()
        .filter(|shot| shot.kind != ShotKind::Transition)
    {
        let [first, last] = ends(shot);
        // The found shot in which its middle lies.
        let middle = first.midpoint(last);
        let at = document.shots.iter().find(|found| ends(found)[1] >= middle);
        let is_right = at.is_some_and(|found| found.content == shot.content);
        for name in ["kinds", true_name(shot)] {
            count(counts, name, is_right);
        }
        if !is_right {
            println!(
                "  {} {first} to {last} is taken for another kind",
                true_name(shot)
            );
        }
    }
}

/// The largest distance of painted lines in view from where they are, px at 1920 px width; each
/// camera looks at the field that it was found with.
fn worst_px(
    [truth, found]: [(&PtzCamera, &FieldModel); 2],
    ImageSize { width, height }: ImageSize,
) -> f64 {
    const SAMPLES: u32 = 40;
    let (width, height) = (f64::from(width), f64::from(height));
    let mut worst: f64 = 0.0;
    for (line, drawn) in truth.1.lines.iter().zip(&found.1.lines) {
        for step in 0..=SAMPLES {
            let along = f64::from(step) / f64::from(SAMPLES);
            let place = |(camera, field): (&PtzCamera, &FieldModel), line: &FieldLine| {
                let nominal_m = line.paint_centre.point_at(along);
                camera.image_from_world(field.world_from_nominal(nominal_m))
            };
            let Ok(there) = place(truth, line) else {
                continue;
            };
            if (0.0..=width).contains(&there.x) && (0.0..=height).contains(&there.y) {
                let off = place(found, drawn).map(|here| here.distance_px(there));
                worst = worst.max(off.unwrap_or(width));
            }
        }
    }
    worst * 1920.0 / width
}

fn compare_cameras(truth: &Document, document: &Document, counts: &mut Counts) {
    // Of each true camera: shots, frames, answered, right; of each shot its true camera and the one
    // that most of its frames got.
    let mut cameras: BTreeMap<&str, [u32; 4]> = BTreeMap::new();
    let mut names: BTreeMap<usize, (&str, BTreeMap<&str, u32>)> = BTreeMap::new();
    let true_field = truth.field.model(Path::new("")).unwrap();
    let cameras_found = document.cameras.iter();
    let fields: BTreeMap<CameraId, FieldModel> = cameras_found
        .map(|camera| {
            let field = document.field_of_camera(&camera.id).model(Path::new(""));
            (camera.id.clone(), field.unwrap())
        })
        .collect();
    for ((frame, shot), found) in truth
        .frames
        .iter()
        .zip(shots_of_frames(truth))
        .zip(&document.frames)
    {
        let shot = shot.unwrap();
        let is_field = truth.shots[shot].content == Some(ShotContent::Field);
        let confidence = found
            .solution
            .as_ref()
            .and_then(|solution| solution.confidence);
        let is_certain = found.ptz.is_some() && confidence.is_some_and(|share| share >= CERTAIN);
        let Some(exact) = truth.ptz_camera(frame).filter(|_| is_field) else {
            count(counts, "certain without a field", is_certain);
            continue;
        };
        let camera = cameras.entry(frame.camera.as_str()).or_default();
        let of_shot = names.entry(shot).or_insert_with(|| {
            camera[0] += 1;
            (frame.camera.as_str(), BTreeMap::new())
        });
        camera[1] += 1;
        if let Some(answer) = document.ptz_camera(found) {
            let of_found = &fields[&found.camera];
            let off = worst_px(
                [(&exact, &true_field), (&answer, of_found)],
                frame.image_size,
            );
            camera[2] += 1;
            camera[3] += u32::from(off <= RIGHT_PX);
            *of_shot.1.entry(found.camera.as_str()).or_default() += 1;
            count(counts, "certain and wrong", is_certain && off > WRONG_PX);
        }
    }
    for (name, [shots, frames, answered, right]) in cameras {
        println!("  {name}: {shots} shots, {frames} frames, {answered} answered, {right} right");
        if shots >= LEAST_SHOTS && frames >= LEAST_FRAMES {
            count(counts, "cameras", 2 * right > frames);
            count(counts, "cameras answered", answered > 0);
        }
    }
    let most = |(_, seen): &(&str, BTreeMap<&str, u32>)| {
        seen.iter()
            .max_by_key(|(_, frames)| **frames)
            .map(|(name, _)| (*name).to_owned())
    };
    let shots: Vec<_> = names
        .values()
        .filter_map(|shot| Some((shot.0, most(shot)?)))
        .collect();
    for (at, (camera, name)) in shots.iter().enumerate() {
        for (other, other_name) in &shots[..at] {
            let pair = if camera == other {
                "one camera"
            } else {
                "two cameras"
            };
            count(counts, &format!("shots of {pair} tied"), name == other_name);
        }
    }
}
