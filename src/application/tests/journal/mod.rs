//! Nothing a person did is lost: journal, atomic store, locks, the saver, and a program that is
//! killed.

mod killed;
#[cfg(unix)]
mod links_and_pipes;
mod recovery;
mod saver;
mod saving;

use std::path::{Path, PathBuf};
use tempfile::TempDir;
use touchline_core::geometry::{ImagePoint, ImageSize};
use touchline_documents::document::{Click, Document, Edit, FieldSpec, Frame};
use touchline_documents::store::{Access, DocumentStore as _, Location, Opened, Store, open};

fn document(frames: usize) -> Document {
    let mut document = Document::new(FieldSpec::new("soccer"));
    let frame = |index| {
        Frame::from_image(
            &format!("images/{index:04}.jpg"),
            "main".into(),
            ImageSize::new(1280, 720),
        )
    };
    document.frames = (0..frames).map(|index| frame(index).into()).collect();
    document
}

fn new_project(frames: usize) -> (TempDir, PathBuf) {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("match");
    drop(
        Store::create(
            &Location::for_new_document(&path.join("")).unwrap(),
            &document(frames),
        )
        .unwrap(),
    );
    (folder, path)
}

fn open_project(path: &Path) -> (Project, Document) {
    let Opened {
        document,
        access,
        recovery,
        ..
    } = open(path).unwrap();
    match access {
        Access::Writable(store) => (
            Project {
                message: recovery.message(),
                recovered: recovery.edits.len(),
                store,
            },
            document,
        ),
        Access::ReadOnly(reason) => panic!("read-only: {reason}"),
    }
}

struct Project {
    store: Store,
    recovered: usize,
    message: Option<String>,
}

/// Clicks once more, journals it, and returns the document after it.
fn click(store: &mut Store, before: &Document, number: usize) -> Document {
    let mut after = before.clone();
    let index = number % after.frames.len();
    after.frames[index]
        .clicks
        .push(Click::without_name(ImagePoint::new(number as f64, 0.5)));
    store
        .append(&[Edit::between(before, &after, &format!("Click {number}"))])
        .unwrap();
    after
}

fn total_clicks(document: &Document) -> usize {
    document.frames.iter().map(|frame| frame.clicks.len()).sum()
}
