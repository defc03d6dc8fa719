//! Drawn matches that several tests look at: drawn once, kept as long as the program stays as it is.

use crate::program::touchline;
use std::fs;
use std::path::{Path, PathBuf};
use std::time::UNIX_EPOCH;
use touchline::document::{Camera, Click, Document, FrameStatus};
use touchline::geometry::Vec2;
use touchline::store::read;
use touchline_core::testing::ground_landmarks;
use touchline_core::testing::seeded::{self, normal};
use touchline_documents::testing::{load, save};

/// Draws a match into `match` of a folder as `touchline synth` does with these arguments.
pub fn draw(folder: &Path, arguments: &str) {
    let kept = kept_folder().join(arguments.replace(|letter: char| !letter.is_alphanumeric(), "-"));
    if !kept.is_dir() {
        let fresh = tempfile::tempdir_in(kept.parent().unwrap()).unwrap();
        touchline(fresh.path(), &format!("synth -o match {arguments}")).done();
        // Another test may have drawn it meanwhile.
        if fs::rename(fresh.path().join("match"), &kept).is_err() {
            assert!(kept.is_dir());
        }
    }
    copy_files(&kept, &folder.join("match"));
}

/// A drawn match: every second frame is a reference in `references.json`, the others are new in
/// `ask.json`; `truth.json` has all.
#[cfg_attr(
    not(feature = "opencv"),
    allow(dead_code, reason = "a forest wants OpenCV's features")
)]
pub fn drawn_match(folder: &Path) {
    draw(folder, "--frames 10 --seed 3 --size 640x360 --preset easy");
    let folder = folder.join("match");
    let truth = load(folder.join("truth.json"));
    let (mut references, mut ask) = (truth.clone(), truth);
    for index in 0..references.frames.len() {
        let (reference, asked) = (&mut *references.frames[index], &mut *ask.frames[index]);
        reference.status = if index % 2 == 0 {
            FrameStatus::Reference
        } else {
            FrameStatus::New
        };
        asked.clicks.clear();
        if index % 2 == 1 {
            asked.status = FrameStatus::New;
            asked.ptz = None;
            asked.solution = None;
        } else {
            asked.status = FrameStatus::Reference;
        }
    }
    save(folder.join("references.json"), &references);
    save(folder.join("ask.json"), &ask);
}

/// A drawn match in a new folder: the folder and the exact document.
pub fn exact_match(place: &Path) -> (PathBuf, Document) {
    draw(place, "--frames 6 --seed 5 --size 960x540 --preset easy");
    let folder = place.join("match");
    let (_, truth, _) = read(&folder.join("truth.json")).unwrap();
    (folder, truth)
}

/// The same, and the document without cameras and with clicks that scatter.
pub fn clicked_match(place: &Path) -> (PathBuf, Document, Document) {
    let (folder, truth) = exact_match(place);
    let mut rng = seeded::rng("painted_lines_and_clicks_together");
    let mut clicked = truth.clone();
    for camera in &mut clicked.cameras {
        *camera = Camera::new("main".into(), truth.frames[0].image_size).into();
    }
    let field = truth.field.model(&folder).unwrap();
    for (frame, was) in clicked.frames.iter_mut().zip(&truth.frames) {
        let camera = truth.ptz_camera(was).unwrap();
        (frame.ptz, frame.solution) = (None, None);
        for (_, landmark, exact) in ground_landmarks(&field, &camera) {
            let image = exact.translate(Vec2::new(normal(&mut rng), normal(&mut rng)) * 0.8);
            if was.image_size.contains(image) {
                frame
                    .clicks
                    .push(Click::landmark(landmark.id.clone(), image));
            }
        }
    }
    (folder, truth, clicked)
}

/// Where drawn matches of this program are kept; those of earlier ones are gone.
fn kept_folder() -> PathBuf {
    let about = fs::metadata(env!("CARGO_BIN_EXE_touchline")).unwrap();
    let changed = about.modified().unwrap().duration_since(UNIX_EPOCH);
    let name = format!("{}-{}", about.len(), changed.unwrap().as_nanos());
    let all = Path::new(env!("CARGO_TARGET_TMPDIR")).join("drawn");
    let kept = all.join(name);
    fs::create_dir_all(&all).unwrap();
    if fs::create_dir(&kept).is_ok() {
        let others = fs::read_dir(&all)
            .unwrap()
            .map(|entry| entry.unwrap().path());
        for other in others.filter(|path| *path != kept) {
            fs::remove_dir_all(other).unwrap_or_default();
        }
    }
    kept
}

fn copy_files(from: &Path, to: &Path) {
    fs::create_dir_all(to).unwrap();
    for entry in fs::read_dir(from).unwrap().map(Result::unwrap) {
        let copy = to.join(entry.file_name());
        if entry.file_type().unwrap().is_dir() {
            copy_files(&entry.path(), &copy);
        } else {
            fs::copy(entry.path(), copy).unwrap();
        }
    }
}
