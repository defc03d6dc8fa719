//! Nothing a person did is lost: journal, atomic store, locks, the saver, and a program that is
//! killed.

mod killed;
#[cfg(unix)]
mod links_and_pipes;
mod recovery;
mod saver;
mod saving;

use crate::headless::project_of;
use std::path::{Path, PathBuf};
use tempfile::TempDir;
use touchline_core::geometry::ImagePoint;
use touchline_core::testing::HD;
use touchline_documents::document::{Click, Document, Edit};
use touchline_documents::store::{Access, Opened, Store, open};
use touchline_documents::testing::{WithFrames, soccer_document};

fn document(frames: usize) -> Document {
    let names = (0..frames).map(|index| format!("images/{index:04}.jpg"));
    soccer_document().with_pictures(names, HD)
}

fn new_project(frames: usize) -> (TempDir, PathBuf) {
    project_of(&document(frames))
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
