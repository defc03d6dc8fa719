//! The house stands as each crate's `lib.rs` draws it. Which crate uses which is Cargo's to say;
//! here is what it cannot: the floors within a crate, no circles, fences, one wgpu.

mod counters;
mod examples;
mod growth;
mod plan;
mod source_map;

use counters::{Counted, Counters, worst};
use growth::{Source, Static, fields_of, long_enums, unlisted_statics, widely_named};
use plan::{Fence, Pair, Plan, broken_fences, circles};
use source_map::SourceMap;
use std::collections::BTreeSet;
use std::fs;
use std::path::{Path, PathBuf};
use std::sync::LazyLock;

/// The crates by their folders, lowest first.
pub const CRATES: [&str; 8] = [
    "src/core",
    "src/vision",
    "src/documents",
    "src/calibration",
    "src/season",
    "src/application",
    "src/python",
    "src",
];

/// Rooms of one floor of which one uses the other.
const PAIRS: &[Pair] = &[
    (
        "autocalibrate",
        "calibrate",
        "a base that it finds is adjusted to paint and recorded as any other",
    ),
    (
        "evaluate",
        "calibrate",
        "an estimate's clicks are scored as observations",
    ),
    (
        "proposals",
        "calibrate",
        "a reference's clicks are its observations",
    ),
];

/// What may be named only in some rooms of a crate that depends on it. Modules for tests may name
/// anything.
const FENCES: &[Fence] = &[
    (&["egui"], &["ui"], "egui stays in ui"),
    (&["pyo3"], &["python"], "Python stays in python"),
    (
        &["wgpu"],
        &["application/render", "ui"],
        "wgpu stays in render and ui",
    ),
    (
        &["nalgebra"],
        &["core", "vision", "documents", "calibration"],
        "the program does no mathematics of its own",
    ),
    (
        &["opencv"],
        &["vision/features", "vision/media", "vision/track"],
        "OpenCV stays behind the rooms that convert to its pixels",
    ),
    (
        &["std", "thread"],
        &[
            "application/jobs/worker.rs",
            "application/jobs/trainer/mod.rs",
        ],
        "there is one way to start a thread",
    ),
    (
        &["std", "sync", "mpsc"],
        &[],
        "orders and reports go through a worker's mailbox",
    ),
    (
        &["std", "fs"],
        FILES,
        "files stay in the rooms that keep something in them",
    ),
    (
        &["anyhow"],
        &["cli"],
        "libraries return errors of their own",
    ),
];

/// Rooms that read and write files, and single files elsewhere that still do.
const FILES: &[&str] = &[
    "core/files",
    "vision/media",
    "documents/store",
    "documents/exchange",
    "application/jobs",
    "cli",
    "season",
];

/// Statics whose value changes while the program runs; every other state has an owner.
const STATICS: &[Static] = &[
    // Whether the thread catches its own panics: the hook for panics is one for all threads.
    ("src/application/jobs/background.rs", "IS_HERE"),
    // Numbers the states of documents, so that none repeats in a process.
    ("src/documents/document/model/frames_version.rs", "LAST"),
    // OpenCV's number of threads is one for the whole process.
    ("src/vision/features/sift.rs", "ONE_THREAD"),
    // The threads of the process: a process that was forked has none of them.
    ("src/python/progress.rs", "POOL"),
    // The videos that were examined: each is examined once, whoever opens it.
    ("src/vision/media/video/known.rs", "KNOWN"),
];

/// An operation is named in its own file, in the list of operations, and where the window shows it.
const FILES_OF_OPERATION: usize = 4;

/// Actions, and each kind of them, can be read at a glance.
const MOST_ACTIONS: usize = 60;
/// Effects.
const MOST_EFFECTS: usize = 16;
/// Fields of the session.
const MOST_FIELDS: usize = 20;

/// What the figures of legibility may not exceed: what was reached. Lower them where the sources
/// get better.
const MOST_CODE_LINES_PER_COMMENT: usize = 21;
const MOST_CLOSURES_PER_10_000_LINES: usize = 26;
const MOST_SHORT_FILES: usize = 44;
const MOST_LONG_LINES: usize = 610;
const MOST_PARTICIPLES: usize = 0;
const MOST_DIALECT: usize = 324;

/// A figure that may not grow: what it counts, its value, the most that is allowed, and its count in
/// one file.
type Limit = (&'static str, usize, usize, fn(&Counters) -> usize);

/// Files of Rust in one folder, at most: more are sorted into rooms that each hold one idea.
const MOST_FILES_IN_A_FOLDER: usize = 25;

/// The workspace's folder.
fn workspace() -> &'static Path {
    Path::new(env!("CARGO_MANIFEST_DIR"))
}

fn read(file: &Path) -> Option<String> {
    fs::read_to_string(workspace().join(file)).ok()
}

/// The sources of each crate; paths are relative to the workspace.
pub fn crates() -> &'static [SourceMap] {
    static MAPS: LazyLock<Vec<SourceMap>> = LazyLock::new(|| {
        CRATES
            .iter()
            .map(|folder| SourceMap::read(&Path::new(folder).join("lib.rs"), &read))
            .collect()
    });
    &MAPS
}

/// The floors that the `lib.rs` of each crate draws, and its sources.
fn plans() -> impl Iterator<Item = (Plan, &'static SourceMap)> {
    CRATES.iter().zip(crates()).map(|(folder, map)| {
        (
            Plan::read(&read(&Path::new(folder).join("lib.rs")).unwrap()),
            map,
        )
    })
}

fn assert_none(found: &[String]) {
    assert!(
        found.is_empty(),
        "{} found:\n{}",
        found.len(),
        found.join("\n")
    );
}

#[test]
fn every_room_is_on_the_plan_and_every_room_of_the_plan_is_there() {
    assert_none(
        &plans()
            .flat_map(|(plan, map)| plan.rooms_apart(map))
            .collect::<Vec<_>>(),
    );
}

#[test]
fn a_room_uses_only_rooms_below_it() {
    assert_none(
        &plans()
            .flat_map(|(plan, map)| plan.broken_floors(map, PAIRS))
            .collect::<Vec<_>>(),
    );
}

#[test]
fn modules_beside_each_other_do_not_use_each_other_in_a_circle() {
    assert_none(&crates().iter().flat_map(circles).collect::<Vec<_>>());
}

#[test]
fn what_is_fenced_stays_in_its_rooms() {
    assert_none(&broken_fences(crates(), FENCES));
}

/// The files of some crates, without those for tests.
fn sources(of: &[&str]) -> Vec<Source> {
    let maps = CRATES
        .iter()
        .zip(crates())
        .filter(|(folder, _)| of.contains(folder));
    let files: BTreeSet<&PathBuf> = maps
        .flat_map(|(_, map)| map.modules.values().map(|module| &module.file))
        .collect();
    files
        .into_iter()
        .map(|file| (file.clone(), read(file).unwrap()))
        .collect()
}

#[test]
fn an_operation_is_named_in_few_files() {
    let folder = Path::new("src/application/app/operations");
    assert_none(&widely_named(
        folder,
        &sources(&["src/application", "src"]),
        FILES_OF_OPERATION,
    ));
}

#[test]
fn actions_effects_and_the_session_stay_short() {
    let sources = sources(&["src/application"]);
    let is_action =
        |name: &str| name.ends_with("Action") || ["Navigation", "DiskReport"].contains(&name);
    let mut long = long_enums(&sources, is_action, MOST_ACTIONS);
    long.extend(long_enums(&sources, |name| name == "Effect", MOST_EFFECTS));
    let session = read(Path::new("src/application/app/window_state/session.rs")).unwrap();
    let fields = fields_of(&session, "Session").len();
    if fields == 0 || fields > MOST_FIELDS {
        long.push(format!("Session has {fields} fields, not {MOST_FIELDS}"));
    }
    assert_none(&long);
}

#[test]
fn the_sources_stay_as_legible_as_they_are() {
    // Each file is counted once: that takes as long as reading all of them.
    let files: Vec<Counted> = sources(&CRATES)
        .iter()
        .map(|source| (source.0.clone(), Counters::of_file(source)))
        .collect();
    let is_library = |path: &Path| {
        ["src/core", "src/vision", "src/documents", "src/calibration"]
            .iter()
            .any(|folder| path.starts_with(folder))
    };
    let whole: Counters = files.iter().map(|(_, counters)| counters).sum();
    let rooms: Counters = files
        .iter()
        .filter(|(path, _)| is_library(path))
        .map(|(_, counters)| counters)
        .sum();
    println!("The library: {rooms}.\nThe whole: {whole}.");
    let comments = rooms.code_lines_per_comment();
    let mut worse = Vec::new();
    if comments > MOST_CODE_LINES_PER_COMMENT {
        worse.push(format!(
            "{comments} lines of code a comment in the library, not {MOST_CODE_LINES_PER_COMMENT}"
        ));
    }
    let closures = whole.closures_per_10_000_lines();
    let limits: [Limit; 5] = [
        (
            "named closures in 10,000 lines",
            closures,
            MOST_CLOSURES_PER_10_000_LINES,
            |file| file.named_closures,
        ),
        ("short files", whole.short_files, MOST_SHORT_FILES, |file| {
            file.short_files
        }),
        ("long lines", whole.long_lines, MOST_LONG_LINES, |file| {
            file.long_lines
        }),
        (
            "functions named by a bare participle",
            whole.participles,
            MOST_PARTICIPLES,
            |file| file.participles,
        ),
        ("words of dialect", whole.dialect, MOST_DIALECT, |file| {
            file.dialect
        }),
    ];
    for (what, now, most, count) in limits {
        if now > most {
            let files = worst(&files, count, 5);
            worse.push(format!("{now} {what}, not {most}; most are in\n{files}"));
        }
    }
    assert_none(&worse);
}

#[test]
fn a_folder_of_sources_is_read_at_a_glance() {
    let mut folders = vec![PathBuf::from("src"), PathBuf::from("tests")];
    let mut crowded = Vec::new();
    while let Some(folder) = folders.pop() {
        let mut files = 0;
        for entry in fs::read_dir(workspace().join(&folder)).unwrap() {
            let path = folder.join(entry.unwrap().file_name());
            if workspace().join(&path).is_dir() {
                // What Cargo builds beside the fuzz targets is no source.
                if !path.ends_with("target") {
                    folders.push(path);
                }
            } else {
                files += usize::from(path.extension().is_some_and(|ending| ending == "rs"));
            }
        }
        if files > MOST_FILES_IN_A_FOLDER {
            let folder = folder.display();
            crowded.push(format!(
                "{folder} has {files} Rust files, not {MOST_FILES_IN_A_FOLDER}"
            ));
        }
    }
    crowded.sort();
    assert_none(&crowded);
}

#[test]
fn the_window_has_three_sizes_of_type_and_they_are_stated_in_one_place() {
    let sizes = [
        "FontId::proportional(",
        "FontId::monospace(",
        "FontId::new(",
        ".size(",
    ];
    let mut written = Vec::new();
    for (file, text) in sources(&["src"]) {
        if !file.starts_with("src/ui") || file.starts_with("src/ui/controls/theme") {
            continue;
        }
        for (line, code) in text.lines().enumerate() {
            let is_number = |start: &str| {
                let after = code.split(start).skip(1);
                after
                    .into_iter()
                    .any(|rest| rest.starts_with(|c: char| c.is_ascii_digit()))
            };
            // The size of a spinner is no size of type.
            if sizes.into_iter().any(is_number) && !code.contains("Spinner") {
                written.push(format!("{}:{}: {}", file.display(), line + 1, code.trim()));
            }
        }
    }
    assert_none(&written);
}

#[test]
fn statics_that_change_are_on_the_list() {
    assert_none(&unlisted_statics(&sources(&CRATES), STATICS));
}

#[test]
fn every_file_belongs_to_a_module() {
    let program = SourceMap::read(Path::new("src/main.rs"), &read);
    let read: BTreeSet<&PathBuf> = crates()
        .iter()
        .chain([&program])
        .flat_map(|map| &map.files)
        .collect();
    let mut folders = vec![PathBuf::from("src")];
    let mut lost = Vec::new();
    while let Some(folder) = folders.pop() {
        for entry in fs::read_dir(workspace().join(&folder)).unwrap() {
            let path = folder.join(entry.unwrap().file_name());
            if workspace().join(&path).is_dir() {
                // Tests and benchmarks of a crate are programs of their own; what they begin with is
                // compiled for them alone.
                if !["tests", "benches", "testing"]
                    .iter()
                    .any(|own| path.ends_with(own))
                {
                    folders.push(path);
                }
            } else if path.extension().is_some_and(|extension| extension == "rs")
                && !read.contains(&path)
                // A build script is a program of its own.
                && !path.ends_with("build.rs")
            {
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
        for entry in fs::read_dir(workspace().join(folder)).unwrap() {
            let file = Path::new(folder).join(entry.unwrap().file_name());
            for (number, line) in read(&file).unwrap_or_default().lines().enumerate() {
                if line.trim() == "#[test]" {
                    marked.push(format!(
                        "{}:{}: list it in TESTS",
                        file.display(),
                        number + 1
                    ));
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
        let count = lock
            .lines()
            .filter(|line| *line == format!("name = \"{name}\""))
            .count();
        assert_eq!(count, 1, "Cargo.lock holds {count} versions of {name}");
    }
}
