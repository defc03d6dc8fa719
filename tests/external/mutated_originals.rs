//! Files of other programs, each with one thing changed in its structure: a value of another kind, a
//! part missing, twice or in another place, the end cut off.
//!
//! Nothing may panic, what is imported must open again, and a frame that the change does not
//! concern must keep its camera, or the import must say something that it does not say of the file
//! as it was published. `TOUCHLINE_MUTATIONS=1000` makes so many of each file in place of a few.

use crate::parts::{Test, frames_folder, tests};
use rand::{RngExt, SeedableRng};
use rand_pcg::Pcg64Mcg;
use serde_json::Value;
use std::collections::BTreeMap;
use std::fs;
use std::path::{Path, PathBuf};
use touchline::document::{Document, FieldSpec, document_from_bytes, document_to_string};
use touchline::exchange::{
    ExchangeError, Format, GroundPlan, HomographyOptions, ImportOptions, Imported, MatrixDirection,
    PointModel, import,
};
use touchline::geometry::{ImagePoint, ImageSize, Vec3};
use touchline_documents::exchange::{PointLayout, import_points};

pub const TESTS: &[Test] = tests![
    [Frames] changed_files_of_others_move_no_camera_in_silence;
];

/// Mutations of each file, where the environment names no number.
const FEW: usize = 25;

/// How a published file is read.
struct Original {
    name: &'static str,
    read: Read,
    options: ImportOptions,
}

enum Read {
    Cameras(Format),
    Points(PointLayout),
}

fn originals() -> Vec<Original> {
    let hd = ImportOptions {
        size: Some(ImageSize::new(1280, 720)),
        ..ImportOptions::default()
    };
    let of = |name, format, options| Original {
        name,
        read: Read::Cameras(format),
        options,
    };
    let homographies = |plan| ImportOptions {
        homographies: HomographyOptions {
            plan: Some(plan),
            direction: Some(MatrixDirection::PitchFromImage),
            ..HomographyOptions::default()
        },
        ..hd.clone()
    };
    let undistorted = ImportOptions {
        undistorted: true,
        sensor_width_mm: Some(36.0),
        ..hd.clone()
    };
    let model = PointModel {
        name: "model".to_owned(),
        min_probability: 0.0,
    };
    vec![
        of(
            "opentrackio-recommended_static.json",
            Format::OpenTrackIo,
            undistorted.clone(),
        ),
        of(
            "opentrackio-recommended_dynamic.json",
            Format::OpenTrackIo,
            undistorted.clone(),
        ),
        of(
            "opentrackio-complete_static.json",
            Format::OpenTrackIo,
            undistorted.clone(),
        ),
        of(
            "opentrackio-complete_dynamic.json",
            Format::OpenTrackIo,
            undistorted.clone(),
        ),
        of(
            "basketball-deepsport-val.json",
            Format::DeepSport,
            ImportOptions {
                field: FieldSpec::new("basketball_fiba"),
                ..ImportOptions::default()
            },
        ),
        of(
            "badminton-shuttleset-homography.csv",
            Format::Homographies,
            ImportOptions {
                field: FieldSpec::new("badminton"),
                ..homographies(GroundPlan::ShuttleSet)
            },
        ),
        of(
            "basketball-osu-M1.npy",
            Format::Homographies,
            homographies(GroundPlan::CornerMetres),
        ),
        of("lens-canon-frames.csv", Format::Lens, hd.clone()),
        of("lens-venice-frames.csv", Format::Lens, undistorted),
        of(
            "soccer-sportslabkit-keypoints.json",
            Format::Points,
            hd.clone(),
        ),
        of(
            "soccer-pnlcalib-sn23-test_pred.zip",
            Format::PnlCalib,
            ImportOptions::default(),
        ),
        Original {
            name: "soccer-pnlcalib-wc14-2d-test_pred.zip",
            read: Read::Points(PointLayout::PnlCalib),
            options: ImportOptions {
                model: Some(model),
                ..hd
            },
        },
    ]
}

fn has_ending(name: &str, ending: &str) -> bool {
    Path::new(name)
        .extension()
        .is_some_and(|known| known == ending)
}

impl Original {
    fn import(&self, path: &Path) -> Result<Imported, ExchangeError> {
        match self.read {
            Read::Cameras(format) => import(path, format, &self.options),
            Read::Points(layout) => import_points(path, layout, &self.options),
        }
    }

    /// The published file in a folder, an archive unpacked; the path to import, and its files.
    fn place(&self, folder: &Path) -> Option<(PathBuf, Vec<PathBuf>)> {
        let path = frames_folder().join("originals").join(self.name);
        if !has_ending(self.name, "zip") {
            let copy = folder.join(self.name);
            fs::copy(path, &copy).unwrap();
            if self.name.starts_with("opentrackio-complete") {
                without_scales(&copy);
            }
            return Some((copy.clone(), vec![copy]));
        }
        let arguments = ["-q", path.to_str()?, "-d", folder.to_str()?];
        let ran = std::process::Command::new("unzip").args(arguments).status();
        ran.ok().filter(std::process::ExitStatus::success)?;
        let files = fs::read_dir(folder)
            .unwrap()
            .map(|entry| entry.unwrap().path());
        let mut files: Vec<PathBuf> = files.filter(|file| file.is_file()).collect();
        files.sort();
        Some((folder.to_path_buf(), files))
    }
}

/// Takes the scales of a crane and its arm out of a file, which is refused with them.
pub fn without_scales(path: &Path) {
    let mut sample: Value = serde_json::from_slice(&fs::read(path).unwrap()).unwrap();
    for transform in sample["transforms"].as_array_mut().unwrap() {
        transform.as_object_mut().unwrap().remove("scale");
    }
    fs::write(path, format!("{sample:#}")).unwrap();
}

/// What a document says of a frame: where it shows some points, and its points.
type Shown = (Vec<Option<ImagePoint>>, String);

fn shown(document: &Document) -> BTreeMap<String, Shown> {
    let points = [
        Vec3::zeros(),
        Vec3::new(6.0, 4.0, 0.0),
        Vec3::new(-6.0, -4.0, 2.0),
    ];
    let frames = document.frames.iter().map(|frame| {
        let pixels = document.ptz_camera(frame).map_or_else(Vec::new, |camera| {
            let at = points.map(|point| camera.image_from_world(point).ok());
            at.to_vec()
        });
        let lens = frame.lens.as_ref().map(|lens| lens.focal_px);
        let clicks: Vec<_> = frame
            .clicks
            .iter()
            .map(|click| (click.target.clone(), click.image))
            .collect();
        (frame.name(), (pixels, format!("{lens:?} {clicks:?}")))
    });
    frames.collect()
}

/// Whether a frame shows something else. Cameras of one place share its mean, so that one frame
/// less moves the others by hundredths of a pixel.
fn is_moved((before, labels): &Shown, (now, other_labels): &Shown) -> bool {
    const SAME_PX: f64 = 0.1;
    let is_same = |pair: (&Option<ImagePoint>, &Option<ImagePoint>)| match pair {
        (Some(one), Some(other)) => one.distance_px(*other) < SAME_PX,
        (one, other) => one.is_none() && other.is_none(),
    };
    labels != other_labels || before.len() != now.len() || !before.iter().zip(now).all(is_same)
}

/// Every place in a value, as the path to it.
fn paths(value: &Value, here: &mut Vec<String>, all: &mut Vec<Vec<String>>) {
    all.push(here.clone());
    let inner: Vec<(String, &Value)> = match value {
        Value::Object(map) => map
            .iter()
            .map(|(key, value)| (key.clone(), value))
            .collect(),
        Value::Array(items) => items
            .iter()
            .enumerate()
            .map(|(index, value)| (index.to_string(), value))
            .collect(),
        _ => Vec::new(),
    };
    for (key, value) in inner {
        here.push(key);
        paths(value, here, all);
        here.pop();
    }
}

fn value_at<'a>(value: &'a mut Value, path: &[String]) -> &'a mut Value {
    path.iter().fold(value, |value, key| match value {
        Value::Array(items) => &mut items[key.parse::<usize>().unwrap()],
        other => &mut other[key.as_str()],
    })
}

/// What was changed, in words, and whether the frames that it concerns may show something else: a
/// part that is missing, or stands at another place, is another valid file.
struct Change {
    what: String,
    is_other_file: bool,
}

/// JSON with one place changed.
fn change_json(text: &str, rng: &mut Pcg64Mcg) -> Option<(Vec<u8>, Change)> {
    let mut value: Value = serde_json::from_str(text).ok()?;
    let mut all = Vec::new();
    paths(&value, &mut Vec::new(), &mut all);
    let path = all[rng.random_range(0..all.len())].clone();
    let kind = rng.random_range(0..9_u32);
    let (last, above) = path.split_last()?;
    let what = format!("{kind} at {}", path.join("."));
    let is_other_file = kind >= 6;
    match kind {
        0 => *value_at(&mut value, &path) = Value::Null,
        1 => *value_at(&mut value, &path) = Value::String("wide".to_owned()),
        2 => *value_at(&mut value, &path) = Value::Bool(true),
        3 => *value_at(&mut value, &path) = Value::Array(Vec::new()),
        4 => *value_at(&mut value, &path) = serde_json::json!({ "a": 1 }),
        5 => *value_at(&mut value, &path) = serde_json::json!(1e300),
        6 => match value_at(&mut value, above) {
            Value::Array(items) => drop(items.remove(last.parse().unwrap())),
            Value::Object(map) => drop(map.remove(last)),
            _ => return None,
        },
        7 => match value_at(&mut value, above) {
            Value::Array(items) => {
                let item = items[last.parse::<usize>().unwrap()].clone();
                items.push(item);
            }
            Value::Object(map) => {
                let item = map.remove(last).unwrap();
                map.insert(format!("{last} "), item);
            }
            _ => return None,
        },
        _ => match value_at(&mut value, above) {
            Value::Array(items) => items.reverse(),
            _ => return None,
        },
    }
    let changed = Change {
        what,
        is_other_file,
    };
    Some((value.to_string().into_bytes(), changed))
}

/// A table with a field, a row or a column changed.
fn change_table(text: &str, rng: &mut Pcg64Mcg) -> (Vec<u8>, Change) {
    let mut rows: Vec<Vec<String>> = text.lines().map(split_outside_quotes).collect();
    let row = rng.random_range(0..rows.len());
    let column = rng.random_range(0..rows[row].len());
    let kind = rng.random_range(0..8_u32);
    match kind {
        0 => rows[row][column].clear(),
        1 => "wide".clone_into(&mut rows[row][column]),
        2 => "NaN".clone_into(&mut rows[row][column]),
        3 => "\"[[1, 2], 3]\"".clone_into(&mut rows[row][column]),
        4 => drop(rows[row].remove(column)),
        5 => drop(rows.remove(row)),
        6 => {
            let copy = rows[row].clone();
            rows.push(copy);
        }
        _ => rows[1..].reverse(),
    }
    let lines: Vec<String> = rows.iter().map(|row| row.join(",")).collect();
    let changed = Change {
        what: format!("{kind} at row {row}, column {column}"),
        is_other_file: kind >= 5,
    };
    (lines.join("\n").into_bytes(), changed)
}

fn split_outside_quotes(line: &str) -> Vec<String> {
    let mut fields = vec![String::new()];
    let mut is_quoted = false;
    for letter in line.chars() {
        is_quoted ^= letter == '"';
        if letter == ',' && !is_quoted {
            fields.push(String::new());
        } else if let Some(last) = fields.last_mut() {
            last.push(letter);
        }
    }
    fields
}

/// Bytes with a piece missing, twice, or other.
fn change_bytes(bytes: &[u8], rng: &mut Pcg64Mcg) -> (Vec<u8>, Change) {
    let mut bytes = bytes.to_vec();
    let at = rng.random_range(0..bytes.len());
    let end = (at + rng.random_range(1..40)).min(bytes.len());
    let kind = rng.random_range(0..3_u32);
    match kind {
        0 => bytes.truncate(at),
        1 => drop(bytes.drain(at..end)),
        _ => {
            let copy = bytes[at..end].to_vec();
            drop(bytes.splice(at..at, copy));
        }
    }
    let changed = Change {
        what: format!("bytes: {kind} at {at}"),
        is_other_file: true,
    };
    (bytes, changed)
}

/// The frames of `now` that were there before and show something else.
fn moved_frames<'a>(
    before: &BTreeMap<String, Shown>,
    now: &'a BTreeMap<String, Shown>,
) -> Vec<&'a String> {
    let moved = now.iter().filter(|(name, shows)| {
        before
            .get(*name)
            .is_some_and(|known| is_moved(known, shows))
    });
    moved.map(|(name, _)| name).collect()
}

fn changed_files_of_others_move_no_camera_in_silence() {
    let wanted = std::env::var("TOUCHLINE_MUTATIONS").ok();
    let count = wanted.map_or(FEW, |count| count.parse().unwrap());
    let mut silent = Vec::new();
    for original in originals() {
        let place = tempfile::tempdir().unwrap();
        let Some((path, files)) = original.place(place.path()) else {
            eprintln!("no unzip: {} was not tried", original.name);
            continue;
        };
        let published = original.import(&path).ok();
        let before = published.as_ref().map(|read| shown(&read.document));
        let (mut read, mut refused, mut said) = (0, 0, 0);
        for seed in 0..count {
            let mut rng = Pcg64Mcg::seed_from_u64(seed as u64);
            let file = &files[rng.random_range(0..files.len())];
            let bytes = fs::read(file).unwrap();
            let text = String::from_utf8(bytes.clone()).unwrap_or_default();
            let in_structure = rng.random_range(0..10_u32) > 0;
            let is_table = has_ending(original.name, "csv");
            let changed = match (in_structure, is_table) {
                (true, true) => Some(change_table(&text, &mut rng)),
                (true, false) => change_json(&text, &mut rng),
                (false, _) => None,
            };
            let (other, change) = changed.unwrap_or_else(|| change_bytes(&bytes, &mut rng));
            fs::write(file, &other).unwrap();
            let imported = original.import(&path);
            fs::write(file, &bytes).unwrap();
            let imported = match imported {
                Ok(imported) => imported,
                Err(error) => {
                    let error = error.to_string();
                    assert!(!error.is_empty() && !error.contains('\n'), "{error:?}");
                    refused += 1;
                    continue;
                }
            };
            read += 1;
            let text = document_to_string(&imported.document).unwrap();
            document_from_bytes(text.as_bytes()).unwrap();
            let (Some(published), Some(before)) = (&published, &before) else {
                continue;
            };
            if (&imported.notes, &imported.failures) != (&published.notes, &published.failures) {
                said += 1;
                continue;
            }
            let now = shown(&imported.document);
            let moved = moved_frames(before, &now);
            // One entry of a valid file may say something else than before; two may not.
            let most = usize::from(change.is_other_file);
            if moved.len() > most {
                silent.push(format!(
                    "{} {seed}, {} ({}): {} frames, such as {}",
                    original.name,
                    change.what,
                    file.file_name().unwrap().display(),
                    moved.len(),
                    moved[0]
                ));
            }
        }
        println!(
            "{}: {count} changes, {refused} refused, {read} read, of {said} something is said; \
             {} moved in silence so far",
            original.name,
            silent.len()
        );
    }
    assert!(silent.is_empty(), "{}: {silent:#?}", silent.len());
}
