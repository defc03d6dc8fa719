//! The house stands as `src/lib.rs` draws it: floors, fences, no circles, one wgpu.

mod examples;
mod plan;
mod source_map;

use plan::{Fence, Pair, Plan, broken_fences, circles};
use source_map::SourceMap;
use std::collections::BTreeSet;
use std::fs;
use std::path::{Path, PathBuf};
use std::sync::LazyLock;

/// Rooms of one floor of which one uses the other.
const PAIRS: &[Pair] = &[
    ("evaluate", "calibrate", "an estimate's clicks are scored as observations"),
    ("proposals", "calibrate", "a reference's clicks are its observations"),
];

/// What may be named only in some rooms. Modules for tests may name anything.
const FENCES: &[Fence] = &[
    (&["egui"], &["ui"], "egui stays in ui"),
    (&["eframe"], &["ui"], "eframe stays in ui"),
    (&["rfd"], &["ui"], "dialogs stay in ui"),
    (&["wgpu"], &["render", "ui"], "wgpu stays in render and ui"),
    (&["opencv"], &["features", "media", "track"], "OpenCV stays behind the rooms that convert to its pixels"),
    (&["std", "thread"], &["jobs/worker.rs", "jobs/trainer/mod.rs"], "there is one way to start a thread"),
    (&["std", "sync", "mpsc"], &[], "orders and reports go through a worker's mailbox"),
    (&["std", "fs"], FILES, "files stay in the rooms that keep something in them"),
    (&["anyhow"], &["cli"], "libraries return errors of their own"),
];

/// Rooms that read and write files, and single files elsewhere that still do.
const FILES: &[&str] = &[
    "files",
    "store",
    "media",
    "exchange",
    "features/cache.rs",
    "cli",
    "jobs",
    "experiments/given.rs",
    "experiments/homographies/read.rs",
    "experiments/sets/published.rs",
];

/// The package's folder.
fn package() -> &'static Path {
    Path::new(env!("CARGO_MANIFEST_DIR"))
}

fn read(file: &Path) -> Option<String> {
    fs::read_to_string(package().join(file)).ok()
}

/// The library's sources; paths are relative to the package.
pub fn library() -> &'static SourceMap {
    static LIBRARY: LazyLock<SourceMap> = LazyLock::new(|| SourceMap::read(Path::new("src/lib.rs"), &read));
    &LIBRARY
}

fn plan() -> Plan {
    Plan::read(&read(Path::new("src/lib.rs")).unwrap())
}

fn assert_none(found: &[String]) {
    assert!(found.is_empty(), "{} found:\n{}", found.len(), found.join("\n"));
}

#[test]
fn every_room_is_on_the_plan_and_every_room_of_the_plan_is_there() {
    assert_none(&plan().rooms_apart(library()));
}

#[test]
fn a_room_uses_only_rooms_below_it() {
    assert_none(&plan().broken_floors(library(), PAIRS));
}

#[test]
fn modules_beside_each_other_do_not_use_each_other_in_a_circle() {
    assert_none(&circles(library()));
}

#[test]
fn what_is_fenced_stays_in_its_rooms() {
    assert_none(&broken_fences(library(), FENCES));
}

#[test]
fn every_file_belongs_to_a_module() {
    let program = SourceMap::read(Path::new("src/main.rs"), &read);
    let read: BTreeSet<&PathBuf> = library().files.iter().chain(&program.files).collect();
    let mut folders = vec![PathBuf::from("src")];
    let mut lost = Vec::new();
    while let Some(folder) = folders.pop() {
        for entry in fs::read_dir(package().join(&folder)).unwrap() {
            let path = folder.join(entry.unwrap().file_name());
            if package().join(&path).is_dir() {
                folders.push(path);
            } else if path.extension().is_some_and(|extension| extension == "rs") && !read.contains(&path) {
                lost.push(format!("{}: no module declares it", path.display()));
            }
        }
    }
    lost.sort();
    assert_none(&lost);
}

/// Where the harness is our own, the attribute removes a test without a word.
#[test]
fn tests_that_need_parts_are_listed_not_marked() {
    let mut marked = Vec::new();
    for folder in ["tests/external", "tests/window"] {
        for entry in fs::read_dir(package().join(folder)).unwrap() {
            let file = Path::new(folder).join(entry.unwrap().file_name());
            for (number, line) in read(&file).unwrap_or_default().lines().enumerate() {
                if line.trim() == "#[test]" {
                    marked.push(format!("{}:{}: list it in TESTS", file.display(), number + 1));
                }
            }
        }
    }
    assert_none(&marked);
}

#[test]
fn the_lock_file_holds_one_wgpu() {
    let lock = read(Path::new("Cargo.lock")).unwrap();
    for name in ["wgpu", "egui", "nalgebra"] {
        let count = lock.lines().filter(|line| *line == format!("name = \"{name}\"")).count();
        assert_eq!(count, 1, "Cargo.lock holds {count} versions of {name}");
    }
}
