//! A project is divided, its owner goes on, others work in packages and in copies, and all is joined
//! again and again: no edit is lost or replaced without a word. `TOUCHLINE_SEQUENCES=10000` makes
//! more of it; each sequence follows from its number.

use rand::{Rng, RngExt};
use std::collections::BTreeSet;
use std::path::Path;
use touchline::document::{
    Click, Document, document_from_bytes, document_to_string, merge, split_into_packages,
};
use touchline::exchange::restore_version;
use touchline::geometry::{ImagePoint, ImageSize};
use touchline_core::testing::seeded::rng;
use touchline_documents::testing::{a_match, new_frame};

const SIZE: ImageSize = ImageSize::new(64, 48);

fn sequences() -> usize {
    std::env::var("TOUCHLINE_SEQUENCES").map_or(150, |number| number.parse().unwrap())
}

/// The edits that are in a document: each is a click with a number of its own.
fn edits_in(document: &Document) -> BTreeSet<u32> {
    let clicks = document.frames.iter().flat_map(|frame| &frame.clicks);
    clicks.map(|click| click.image.x as u32).collect()
}

/// What people do, each edit with the next number.
struct People<R: Rng> {
    random: R,
    edits: u32,
    new_frames: u32,
}

impl<R: Rng> People<R> {
    /// Edits a document a few times; may add a frame or change the place of the camera.
    fn work_in(&mut self, document: &mut Document, most: usize) {
        for _ in 0..self.random.random_range(0..=most) {
            let before = document.clone();
            match self.random.random_range(0..12) {
                0 => {
                    self.new_frames += 1;
                    let name = format!("new/{}.jpg", self.new_frames);
                    let frame = new_frame(&name, SIZE);
                    let at = self.random.random_range(0..=document.frames.len());
                    document.frames.insert(at, frame.into());
                    self.click(document, at);
                }
                1 => {
                    self.edits += 1;
                    document.cameras[0]
                        .extra
                        .insert("edit".to_owned(), self.edits.into());
                }
                _ if document.frames.is_empty() => {}
                _ => {
                    let at = self.random.random_range(0..document.frames.len());
                    self.click(document, at);
                }
            }
            document.count_edits_since(&before);
        }
    }

    fn click(&mut self, document: &mut Document, at: usize) {
        self.edits += 1;
        let point = ImagePoint::new(f64::from(self.edits), 1.0);
        document.frames[at].clicks.push(Click::without_name(point));
    }
}

/// A document as it is read again from its file.
fn read_again(document: &Document) -> Document {
    document_from_bytes(document_to_string(document).unwrap().as_bytes()).unwrap()
}

/// Joins versions with the owner's project, as the command does. Edits of frames and cameras that
/// are named as conflicts count as said.
fn join(project: &Document, versions: &[Document], said: &mut BTreeSet<u32>) -> Document {
    let mut merged = project.without_suggestions();
    for version in versions {
        let restored = restore_version(project.at(Path::new(".")), version).unwrap();
        let joined = merge(&restored.common, &merged, &restored.version);
        for name in &joined.conflicts {
            let frames = restored.version.frames.iter();
            let named = frames.filter(|frame| frame.name() == *name);
            for frame in named {
                said.extend(frame.clicks.iter().map(|click| click.image.x as u32));
            }
        }
        merged = joined.document;
    }
    merged
}

#[test]
fn no_edit_is_lost_where_the_project_goes_on() {
    let (mut conflicts, mut made) = (0, 0);
    for number in 0..sequences() {
        let mut people = People {
            random: rng(&format!("a project that goes on {number}")),
            edits: 0,
            new_frames: 0,
        };

        let mut project = a_match(SIZE);
        for index in 0..people.random.random_range(1..8) {
            let name = format!("images/{index}.jpg");
            project.frames.push(new_frame(&name, SIZE).into());
        }
        let mut packages: Vec<Document> = Vec::new();
        for round in 0..4 {
            // Packages of an earlier round may still be out, and are handed in later.
            if packages.is_empty() || people.random.random_range(0..3) == 0 {
                let count = people.random.random_range(1..5);
                packages = split_into_packages(&read_again(&project), count);
            }
            let copy = project.clone();
            for package in &mut packages {
                people.work_in(package, 3);
                *package = read_again(package);
            }
            people.work_in(&mut project, 4);
            let before = edits_in(&project);
            let mut versions = packages.clone();
            // A copy of the state before, in which another person did something once.
            if people.random.random_range(0..2) == 0 {
                let mut copy = copy;
                people.work_in(&mut copy, 1);
                versions.push(copy);
            }
            let came: BTreeSet<u32> = versions.iter().flat_map(edits_in).collect();
            let mut said = BTreeSet::new();
            let merged = join(&project, &versions, &mut said);
            let now = edits_in(&merged);
            let what = format!("sequence {number}, round {round}");
            let lost: Vec<_> = before.difference(&now).collect();
            assert!(lost.is_empty(), "{what}: the owner's {lost:?} were lost");
            let unsaid: Vec<_> = came
                .iter()
                .filter(|edit| !now.contains(edit) && !said.contains(edit))
                .collect();
            assert!(unsaid.is_empty(), "{what}: {unsaid:?} were left out unsaid");
            conflicts += said.difference(&now).count();
            made += came.len() + before.len();
            project = merged;
        }
    }
    assert!(
        conflicts > 0 && made > 5 * conflicts,
        "{conflicts} of {made}"
    );
}
