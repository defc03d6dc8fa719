//! Documents of a long match: opening, writing, journaling and undoing with 10,000 frames.
#![allow(
    missing_docs,
    clippy::unwrap_used,
    clippy::panic,
    reason = "a bench says what failed by failing"
)]

use divan::Bencher;
use std::path::PathBuf;
use tempfile::TempDir;
use touchline::camera::{Ptz, Radial};
use touchline::document::{
    Camera, Click, Document, Edit, FieldSpec, Frame, FramePtz, FrameStatus, History, Solution,
    Step, document_from_bytes, document_to_string,
};
use touchline::geometry::{ImagePoint, ImageSize, Mat3};
use touchline::store::{Access, Location, open, write_document};

const FRAMES: usize = 10_000;
const LANDMARKS: [&str; 6] = [
    "centre_mark",
    "halfway_far",
    "penalty_area_far_right_front",
    "penalty_arc_near_right",
    "corner_far_right",
    "centre_circle_right",
];

/// What undo keeps shows as `max alloc`.
#[global_allocator]
static ALLOCATOR: divan::AllocProfiler = divan::AllocProfiler::system();

/// A whole match at 50 frames a second.
const MATCH: usize = 300_000;

fn main() {
    divan::main();
}

/// A match in which every frame has six clicks, a `ptz` and a solution.
fn document() -> Document {
    document_of(FRAMES)
}

fn document_of(frames: usize) -> Document {
    let size = ImageSize::new(1920, 1080);
    let mut document = Document::new(FieldSpec::new("soccer"));
    document
        .cameras
        .push(Camera::new("main".into(), size).into());
    for index in 0..frames {
        let mut frame = Frame::from_image(&format!("images/{index:06}.jpg"), "main".into(), size);
        let at = |click: usize| {
            ImagePoint::new(
                (index * 7 + click * 311) as f64 % 1919.3,
                (index * 3) as f64 % 1079.1,
            )
        };
        frame.clicks = LANDMARKS
            .iter()
            .enumerate()
            .map(|(click, name)| Click::landmark((*name).into(), at(click)))
            .collect();
        frame.sha256 = Some(format!("{index:064x}"));
        frame.status = FrameStatus::Reference;
        let ptz = Ptz::from_degrees(
            index as f64 * 0.003_217,
            -11.233_71,
            2400.0 + index as f64 / 7.0,
        );
        frame.ptz = Some(FramePtz::new(ptz, Some(Radial::k1(0.066_123))));
        frame.solution = Some(Solution {
            covariance: Some(Mat3::from_fn(|row, column| {
                ((row + column) as f64).sin() / 1e3
            })),
            rms_px: Some(1.234_567),
            ..Solution::default()
        });
        document.frames.push(frame.into());
    }
    document
}

fn project() -> (TempDir, PathBuf) {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("match");
    write_document(
        &Location::for_new_document(&path.join("")).unwrap(),
        &document(),
        false,
    )
    .unwrap();
    (folder, path)
}

/// Reads the file, checks its hash, takes the lock, looks at the journal.
#[divan::bench]
fn open_project(bencher: Bencher) {
    let (_folder, path) = project();
    bencher.bench(|| open(&path).unwrap());
}

#[divan::bench]
fn parse(bencher: Bencher) {
    let text = document_to_string(&document()).unwrap();
    bencher
        .counter(divan::counter::BytesCount::of_str(&text))
        .bench(|| document_from_bytes(text.as_bytes()).unwrap());
}

#[divan::bench]
fn write(bencher: Bencher) {
    let document = document();
    bencher.bench(|| document_to_string(&document).unwrap());
}

/// A click moves: a step of undo, the edit for the journal.
#[divan::bench]
fn edit_and_undo(bencher: Bencher) {
    let mut document = document();
    let mut history = History::default();
    bencher.bench_local(|| {
        let before = document.clone();
        history.begin(&document, Step::on_document("Move"));
        document.frames[5000].clicks[0].image.x += 1.0;
        history.commit(&document);
        let edit = Edit::between(&before, &document, "Move");
        history.undo(&mut document);
        edit
    });
}

/// An edit, flushed to disk.
#[divan::bench]
fn journal_edit(bencher: Bencher) {
    let (_folder, path) = project();
    let opened = open(&path).unwrap();
    let Access::Writable(mut store) = opened.access else {
        panic!("read-only")
    };
    let mut after = opened.document.clone();
    after.frames[5000].clicks[0].image.x += 1.0;
    let edit = Edit::between(&opened.document, &after, "Move");
    bencher.bench_local(|| store.append(std::slice::from_ref(&edit)).unwrap());
}

/// Saves a document of 100,000 frames, with as many steps of undo.
#[divan::bench(args = [0, 500], sample_count = 3, sample_size = 1)]
fn save_a_long_video_with_steps(bencher: Bencher, steps: usize) {
    let (_folder, path, mut document, mut history) = long_video(steps);
    let Access::Writable(mut store) = open(&path).unwrap().access else {
        panic!("read-only")
    };
    let none = History::default();
    bencher.bench_local(|| {
        // What is on disk already is not written again.
        step(&mut document, &mut history, 0);
        store
            .save(&document, if steps > 0 { &history } else { &none })
            .unwrap();
    });
}

/// Opens such a document; what its history takes shows in `max alloc`.
#[divan::bench(args = [0, 500], sample_count = 3, sample_size = 1)]
fn open_a_long_video_with_steps(bencher: Bencher, steps: usize) {
    let (_folder, path, ..) = long_video(steps);
    bencher.bench_local(|| open(&path).unwrap());
}

/// A project of 100,000 frames that was saved after as many steps.
fn long_video(steps: usize) -> (TempDir, PathBuf, Document, History<Document>) {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("match");
    let (mut document, mut history) = (document_of(100_000), History::default());
    write_document(
        &Location::for_new_document(&path.join("")).unwrap(),
        &document,
        false,
    )
    .unwrap();
    let Access::Writable(mut store) = open(&path).unwrap().access else {
        panic!("read-only")
    };
    (0..steps).for_each(|number| step(&mut document, &mut history, number * 199));
    store.save(&document, &history).unwrap();
    (folder, path, document, history)
}

/// A click moves.
fn step(document: &mut Document, history: &mut History<Document>, position: usize) {
    history.begin(document, Step::on_document("Move"));
    document.frames[position].clicks[0].image.x += 1.0;
    document.frames[position].revision += 1;
    history.commit(document);
}

/// What undo takes of a whole match.
#[divan::bench]
fn clone_of_a_match(bencher: Bencher) {
    let document = document_of(MATCH);
    bencher.bench(|| document.clone());
}

/// Five hundred edits with their steps of undo and their records for the journal.
#[divan::bench(sample_count = 5, sample_size = 1)]
fn five_hundred_edits_of_a_match(bencher: Bencher) {
    let document = document_of(MATCH);
    bencher
        .with_inputs(|| document.clone())
        .bench_local_values(|mut document| {
            let mut history = History::default();
            for edit in 0..500 {
                let position = edit * 599;
                let before = document.clone();
                history.begin(&document, Step::on_document("Move"));
                document.frames[position].clicks[0].image.x += 1.0;
                history.commit(&document);
                document.count_edits_since(&before);
                divan::black_box(Edit::between(&before, &document, "Move"));
            }
            (document, history)
        });
}
