//! Carrying from one known camera where the lens of every frame is known: how far the rotation of
//! each frame is off, degrees.
//!
//! Clips of 50 frames a second are drawn that follow the focal lengths, principal points and
//! distortions of measured broadcast lenses, with players as occlusion. The lenses, and the
//! position and rotation of each first frame, are read from `lenses-worldcup/*.npz` in the folder
//! that `TOUCHLINE_DATA` names. The files state no rotation after the first frame, so a drawn
//! operator turns the camera, about the pan axis that the import takes.
//!
//! `cargo bench --bench known_lens -- [--shots N] [--from N] [--frames N] [--keep FOLDER] [--preset NAME]`
#![allow(
    missing_docs,
    clippy::unwrap_used,
    clippy::panic,
    reason = "a bench says what failed by failing"
)]

#[allow(dead_code, reason = "other benches have sections")]
#[path = "../../benches/arguments.rs"]
mod arguments;

use arguments::Arguments;
use image::codecs::jpeg::JpegEncoder;
use rayon::prelude::*;
use std::collections::BTreeMap;
use std::path::{Path, PathBuf};
use std::time::Instant;
use touchline::calibrate::{ClipEvidence, TrackClipOptions, clips, track_clip};
use touchline::camera::{Ptz, PtzCamera};
use touchline::document::{Document, FieldSize, FieldSpec, Frame};
use touchline::exchange::{Format, ImportOptions, import};
use touchline::geometry::{ImageSize, Mat3};
use touchline::media::FrameReader;
use touchline::progress::Progress;
use touchline::synthetic::{PathStep, Preset, ShootOptions, StadiumOptions, camera_path, stadium};

/// The pictures of the set.
const SIZE: ImageSize = ImageSize::new(1920, 1080);
/// Seconds between frames.
const STEP_S: f64 = 0.02;

fn main() {
    let arguments = Arguments::of_process();
    let Some(data) = std::env::var_os("TOUCHLINE_DATA").map(PathBuf::from) else {
        println!("skipped: TOUCHLINE_DATA names no folder with lenses-worldcup");
        return;
    };
    let mut files: Vec<PathBuf> = std::fs::read_dir(data.join("lenses-worldcup"))
        .unwrap()
        .map(|entry| entry.unwrap().path())
        .collect();
    files.retain(|file| file.extension().is_some_and(|ending| ending == "npz"));
    files.sort();
    let preset = arguments
        .value("--preset")
        .map_or(Preset::Paper, |name| name.parse().unwrap());
    let shoot = ShootOptions {
        step_s: STEP_S,
        ..preset.shoot()
    };
    let temporary = tempfile::tempdir().unwrap();
    let folder = arguments
        .value("--keep")
        .map_or_else(|| temporary.path().to_path_buf(), PathBuf::from);

    println!(
        "rotation off by, degrees          mean   median      95 %      max     last   focal, px  seconds"
    );
    let mut all: BTreeMap<&str, Vec<f64>> = BTreeMap::new();
    for (seed, file) in files
        .iter()
        .enumerate()
        .skip(arguments.number("--from", 0))
        .take(arguments.number("--shots", files.len()))
    {
        let name = file.file_stem().unwrap().to_string_lossy().into_owned();
        let clip = Clip::draw(
            file,
            &folder.join(&name),
            seed as u64,
            arguments.number("--frames", 200),
            &shoot,
        );
        for (way, options) in ways() {
            let begun = Instant::now();
            let errors = clip.tracking_errors(&options);
            let mean = errors.mean_deg();
            println!(
                "{name} {way:14} {} {:8.1}",
                errors.row(),
                begun.elapsed().as_secs_f64()
            );
            all.entry(way).or_default().push(mean);
        }
    }
    for (way, means) in all {
        println!(
            "mean over {} shots, {way:14} {:.4}",
            means.len(),
            means.iter().sum::<f64>() / means.len() as f64
        );
    }
}

/// What is compared.
fn ways() -> [(&'static str, TrackClipOptions); 3] {
    let usual = TrackClipOptions::default();
    [
        ("focal known", usual),
        (
            "without paint",
            TrackClipOptions {
                paint_every: 0,
                ..usual
            },
        ),
        (
            "focal sought",
            TrackClipOptions {
                seek_focal: true,
                ..usual
            },
        ),
    ]
}

/// A drawn clip and its exact cameras.
struct Clip {
    document: Document,
    truth: Vec<PtzCamera>,
    folder: PathBuf,
}

impl Clip {
    /// Draws the pictures that the folder lacks.
    fn draw(lenses: &Path, folder: &Path, seed: u64, count: usize, shoot: &ShootOptions) -> Self {
        let mut field = FieldSpec::new("soccer");
        field.params =
            BTreeMap::from([("length_m".to_owned(), 105.0), ("width_m".to_owned(), 68.0)]);
        field.size = Some(FieldSize::Confirmed);
        let options = ImportOptions {
            field: field.clone(),
            ..ImportOptions::default()
        };
        let mut document = import(lenses, Format::Fifa, &options).unwrap().document;
        let frames = document.frames.iter().take(count).enumerate();
        document.frames = frames
            .map(|(index, frame)| in_pictures(frame, index).into())
            .collect();

        let known = document.cameras[0].base().unwrap();
        let first = document.frames[0].ptz.as_ref().unwrap().ptz();
        let scene = stadium(&StadiumOptions::new(
            field.model(Path::new("")).unwrap(),
            seed,
        ));
        let path = camera_path(&scene, &known, SIZE, shoot, count);
        let pointed = |(frame, step): (&Frame, &PathStep)| {
            let ptz = Ptz {
                pan: first.pan + step.ptz.pan.turn_from(path[0].ptz.pan),
                tilt: first.tilt + (step.ptz.tilt - path[0].ptz.tilt),
                focal_px: frame.lens.as_ref().unwrap().focal_px,
            };
            PtzCamera::new(frame.base_from(&known), ptz)
        };
        let frames: Vec<&Frame> = document.frames.iter().map(|frame| &**frame).collect();
        let truth: Vec<PtzCamera> = frames.iter().copied().zip(&path).map(pointed).collect();

        std::fs::create_dir_all(folder).unwrap();
        (0..truth.len()).into_par_iter().for_each(|index| {
            let picture = folder.join(picture_name(index));
            if picture.exists() {
                return;
            }
            let mut bytes = Vec::new();
            let drawn = scene.render(
                &truth[index],
                SIZE,
                &shoot.frame(index, &path[index], SIZE, seed),
            );
            JpegEncoder::new_with_quality(&mut bytes, shoot.jpeg_quality)
                .encode_image(&drawn.image)
                .unwrap();
            std::fs::write(picture, bytes).unwrap();
        });
        Self {
            document,
            truth,
            folder: folder.to_path_buf(),
        }
    }

    /// How far the frames are off after tracking.
    fn tracking_errors(&self, options: &TrackClipOptions) -> Errors {
        let at = self.document.at(&self.folder);
        let field = at.model_of(&self.document.field).unwrap();
        let clip = &clips(at, None)[0];
        let mut reader = FrameReader::new();
        let mut evidence = ClipEvidence::default();
        let progress = Progress::default();
        let tracked = track_clip(
            at,
            clip,
            &field,
            &mut reader,
            options,
            &mut evidence,
            &progress,
        )
        .unwrap();
        let mut errors = Errors {
            missed: tracked.missed.len(),
            ..Errors::default()
        };
        for frame in &tracked.frames {
            let base = self.document.frames[frame.place].base_from(&tracked.base);
            let (found, truth) = (PtzCamera::new(base, frame.ptz), &self.truth[frame.place]);
            errors
                .rotation_deg
                .push(angle_deg(&found.cam_from_world(), &truth.cam_from_world()));
            errors
                .focal_px
                .push((found.ptz().focal_px - truth.ptz().focal_px).abs());
        }
        errors
    }
}

fn picture_name(index: usize) -> String {
    format!("{index:05}.jpg")
}

/// A frame whose picture is a file.
fn in_pictures(frame: &Frame, index: usize) -> Frame {
    let made = Frame::from_image(&picture_name(index), frame.camera.clone(), frame.image_size);
    let (lens, ptz, solution) = (
        frame.lens.clone(),
        frame.ptz.clone(),
        frame.solution.clone(),
    );
    Frame {
        lens,
        ptz,
        solution,
        status: frame.status,
        ..made
    }
}

/// The angle of the turn from one rotation to another, degrees.
fn angle_deg(one: &Mat3, other: &Mat3) -> f64 {
    // Of a turn by θ the skew part has the norm √2 sin θ; the trace would lose small angles.
    let turn = one * other.transpose();
    let skew = (turn - turn.transpose()) * 0.5;
    (skew.norm() / 2f64.sqrt()).min(1.0).asin().to_degrees()
}

/// How far the frames of a clip are off.
#[derive(Default)]
struct Errors {
    rotation_deg: Vec<f64>,
    focal_px: Vec<f64>,
    missed: usize,
}

impl Errors {
    fn mean_deg(&self) -> f64 {
        self.rotation_deg.iter().sum::<f64>() / self.rotation_deg.len() as f64
    }

    fn row(&self) -> String {
        let mut sorted = self.rotation_deg.clone();
        sorted.sort_by(f64::total_cmp);
        let at = |share: f64| sorted[(share * (sorted.len() - 1) as f64) as usize];
        let focal_px = self.focal_px.iter().sum::<f64>() / self.focal_px.len() as f64;
        let last = self.rotation_deg.last().copied().unwrap_or(f64::NAN);
        let row = format!(
            "{:9.4}{:9.4}{:9.4}{:9.4}{last:9.4} {focal_px:10.2}",
            self.mean_deg(),
            at(0.5),
            at(0.95),
            at(1.0)
        );
        if self.missed > 0 {
            format!("{row} ({} frames missed)", self.missed)
        } else {
            row
        }
    }
}
