//! The house stands as `src/lib.rs` draws it: floors, fences and one wgpu.

use std::fs;
use std::path::{Path, PathBuf};

/// Rooms by floor, the ground floor first. A room uses only rooms on lower floors.
const FLOORS: &[&[&str]] = &[
    &["geometry"],
    &["camera", "field", "media"],
    &["markings"],
    &["solve", "score", "features"],
    &["document", "relocalize", "paint", "synthetic"],
    &["calibrate", "evaluate", "exchange", "proposals", "report", "scene", "store"],
    &["app", "experiments"],
    &["jobs", "render"],
    &["ui", "cli"],
];

/// Rooms on one floor that use each other all the same: (who, whom, why).
const NEIGHBOURS: &[(&str, &str, &str)] =
    &[("evaluate", "calibrate", "an estimate's clicks are scored as observations")];

/// What may be named only in some rooms: (text, rooms, why).
const FENCES: &[(&str, &[&str], &str)] = &[
    ("egui::", &["ui"], "egui stays in ui"),
    ("eframe::", &["ui"], "eframe stays in ui"),
    ("rfd::", &["ui"], "dialogs stay in ui"),
    ("wgpu::", &["render", "ui"], "wgpu stays in render and ui"),
    ("opencv::", &["features", "media", "track", "relocalize"], "OpenCV stays at its boundary functions"),
    ("std::thread", &["jobs"], "threads stay in jobs"),
    ("thread::spawn", &["jobs"], "threads stay in jobs"),
    ("thread::Builder", &["jobs"], "threads stay in jobs"),
    ("anyhow::", &["cli"], "libraries return errors of their own"),
];

fn floor_of(room: &str) -> Option<usize> {
    FLOORS.iter().position(|rooms| rooms.contains(&room))
}

fn sources() -> Vec<(PathBuf, String)> {
    fn walk(folder: &Path, into: &mut Vec<PathBuf>) {
        let mut entries: Vec<_> = fs::read_dir(folder).unwrap().map(|entry| entry.unwrap().path()).collect();
        entries.sort();
        for path in entries {
            if path.is_dir() {
                walk(&path, into);
            } else if path.extension().is_some_and(|extension| extension == "rs") {
                into.push(path);
            }
        }
    }
    let mut paths = Vec::new();
    walk(&Path::new(env!("CARGO_MANIFEST_DIR")).join("src"), &mut paths);
    paths
        .into_iter()
        .map(|path| {
            let text = fs::read_to_string(&path).unwrap();
            (path.strip_prefix(env!("CARGO_MANIFEST_DIR")).unwrap().to_path_buf(), text)
        })
        .collect()
}

/// The room a file belongs to: the folder below `src`, or none for `lib.rs` and `main.rs`.
fn room_of(path: &Path) -> Option<String> {
    let mut parts = path.iter().skip(1).map(|part| part.to_string_lossy().into_owned());
    let first = parts.next()?;
    parts.next().map(|_| first)
}

/// The code of a line, without comments.
fn code(line: &str) -> &str {
    let trimmed = line.trim_start();
    if trimmed.starts_with("//") { "" } else { line.split(" // ").next().unwrap_or(line) }
}

/// The rooms that a text names through `crate::`, with the line of each.
fn rooms_used(text: &str) -> Vec<(usize, String)> {
    let mut used = Vec::new();
    let clean = text.lines().map(code).collect::<Vec<_>>().join("\n");
    for (at, _) in clean.match_indices("crate::") {
        let line = clean[..at].matches('\n').count() + 1;
        let rest = &clean[at + "crate::".len()..];
        if let Some(group) = rest.strip_prefix('{') {
            let mut depth = 0;
            let mut name = String::new();
            let mut names = Vec::new();
            for c in group.chars() {
                match c {
                    '{' => depth += 1,
                    '}' if depth == 0 => break,
                    '}' => depth -= 1,
                    ',' if depth == 0 => names.push(std::mem::take(&mut name)),
                    _ if depth == 0 => name.push(c),
                    _ => {}
                }
            }
            names.push(name);
            for name in names {
                used.push((line, identifier(name.trim())));
            }
        } else {
            used.push((line, identifier(rest)));
        }
    }
    used
}

fn identifier(text: &str) -> String {
    text.chars().take_while(|c| c.is_alphanumeric() || *c == '_').collect()
}

#[test]
fn a_room_uses_only_rooms_below_it() {
    let mut broken = Vec::new();
    for (path, text) in sources() {
        let Some(room) = room_of(&path) else { continue };
        let Some(floor) = floor_of(&room) else {
            broken.push(format!("{}: the room {room:?} stands on no floor", path.display()));
            continue;
        };
        for (line, used) in rooms_used(&text) {
            if used == room || NEIGHBOURS.iter().any(|(who, whom, _)| *who == room && *whom == used) {
                continue;
            }
            match floor_of(&used) {
                Some(other) if other < floor => {}
                Some(other) => broken
                    .push(format!("{}:{line}: {room} (floor {floor}) uses {used} (floor {other})", path.display())),
                None => broken.push(format!("{}:{line}: crate::{used} is not a room", path.display())),
            }
        }
    }
    assert!(broken.is_empty(), "{}", broken.join("\n"));
}

#[test]
fn what_is_fenced_stays_in_its_rooms() {
    let mut broken = Vec::new();
    for (path, text) in sources() {
        let room = room_of(&path).unwrap_or_default();
        for (number, line) in text.lines().enumerate() {
            for (fenced, rooms, why) in FENCES {
                let at_boundary = code(line)
                    .match_indices(fenced)
                    .any(|(at, _)| at == 0 || !is_name_character(code(line).as_bytes()[at - 1]));
                if at_boundary && !rooms.contains(&room.as_str()) {
                    broken.push(format!("{}:{}: {fenced} ({why})", path.display(), number + 1));
                }
            }
        }
    }
    assert!(broken.is_empty(), "{}", broken.join("\n"));
}

fn is_name_character(byte: u8) -> bool {
    byte.is_ascii_alphanumeric() || byte == b'_'
}

#[test]
fn every_room_is_on_the_plan() {
    let plan = fs::read_to_string(Path::new(env!("CARGO_MANIFEST_DIR")).join("src/lib.rs")).unwrap();
    for (path, _) in sources() {
        let Some(room) = room_of(&path) else { continue };
        assert!(plan.contains(&format!("`{room}`")), "src/lib.rs does not mention the room {room}");
    }
}

#[test]
fn the_lock_file_holds_one_wgpu() {
    let lock = fs::read_to_string(Path::new(env!("CARGO_MANIFEST_DIR")).join("Cargo.lock")).unwrap();
    for name in ["wgpu", "egui", "nalgebra"] {
        let count = lock.lines().filter(|line| *line == format!("name = \"{name}\"")).count();
        assert_eq!(count, 1, "Cargo.lock holds {count} versions of {name}");
    }
}
