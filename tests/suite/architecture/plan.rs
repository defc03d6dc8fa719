//! The plan of a crate as its `lib.rs` draws it, and how the sources depart from it.

use super::source_map::{Module, Names, SourceMap};
use std::collections::{BTreeMap, BTreeSet};
use std::fmt::Write as _;

/// Rooms of one floor that may see each other: (who uses, what, why).
pub type Pair = (&'static str, &'static str, &'static str);

/// What may be named only in some places: (a path of another crate, folders or files below `src`,
/// why).
pub type Fence = (
    &'static [&'static str],
    &'static [&'static str],
    &'static str,
);

/// Rooms and their floors.
#[derive(Debug)]
pub struct Plan {
    floors: BTreeMap<String, usize>,
}

impl Plan {
    /// Reads the table of a `lib.rs`: `//! | floor | rooms |`, each room in backticks outside
    /// parentheses.
    pub fn read(lib: &str) -> Self {
        let mut floors = BTreeMap::new();
        for line in lib.lines() {
            let mut cells = line
                .strip_prefix("//! |")
                .into_iter()
                .flat_map(|row| row.split('|'));
            let Some(floor) = cells.next().and_then(|cell| cell.trim().parse().ok()) else {
                continue;
            };
            for room in names_outside_parentheses(cells.next().unwrap_or_default()) {
                let before = floors.insert(room.clone(), floor);
                assert!(before.is_none(), "the plan names the room {room} twice");
            }
        }
        assert!(!floors.is_empty(), "there is no table of floors");
        Self { floors }
    }

    /// Rooms of the plan that are not there, and rooms that are not on the plan.
    pub fn rooms_apart(&self, map: &SourceMap) -> Vec<String> {
        // A module within `lib.rs` itself is a page of documentation.
        let root = &map.modules[&Names::new()].file;
        let rooms = map
            .modules
            .iter()
            .filter(|(path, module)| path.len() == 1 && module.file != *root);
        let built: BTreeSet<&String> = rooms.map(|(path, _)| &path[0]).collect();
        let drawn: BTreeSet<&String> = self.floors.keys().collect();
        let missing = drawn
            .difference(&built)
            .map(|room| format!("{} names the room `{room}`: there is none", root.display()));
        let unknown = built
            .difference(&drawn)
            .map(|room| format!("{} does not name the room `{room}`", root.display()));
        missing.chain(unknown).collect()
    }

    /// Rooms that use what is not below them, with file and line; and stated pairs that nothing
    /// needs.
    pub fn broken_floors(&self, map: &SourceMap, pairs: &[Pair]) -> Vec<String> {
        let mut broken = Vec::new();
        let mut needed = BTreeSet::new();
        for (path, module) in &map.modules {
            let Some(room) = path.first() else { continue };
            for named in &module.inside {
                let owner = map.owner(&named.path);
                let rooms: BTreeSet<&String> = [named.path.first(), owner.first()]
                    .into_iter()
                    .flatten()
                    .collect();
                for used in rooms.into_iter().filter(|used| *used != room) {
                    let (Some(above), Some(below)) = (self.floors.get(room), self.floors.get(used))
                    else {
                        continue;
                    };
                    let stated = pairs
                        .iter()
                        .find(|(user, of, _)| user == room && of == used);
                    if let Some(pair) = stated.filter(|_| above == below) {
                        needed.insert(pair);
                    } else if below >= above {
                        let at = place(module, named.line);
                        broken.push(format!(
                            "{at}: {room} (floor {above}) uses {used} (floor {below})"
                        ));
                    }
                }
            }
        }
        let here = |(user, used, _): &&Pair| {
            self.floors.contains_key(*user) && self.floors.contains_key(*used)
        };
        let unneeded = pairs
            .iter()
            .filter(here)
            .filter(|pair| !needed.contains(pair));
        broken.extend(
            unneeded.map(|(user, used, _)| format!("{user} uses {used}: stated, but nothing does")),
        );
        broken
    }
}

/// What is named outside its fence, with file and line; and places within a fence that do not name
/// it.
pub fn broken_fences(maps: &[SourceMap], fences: &[Fence]) -> Vec<String> {
    let mut broken = Vec::new();
    for (fenced, places, why) in fences {
        let mut unused: BTreeSet<&&str> = places.iter().collect();
        for module in maps.iter().flat_map(|map| map.modules.values()) {
            let file = module.file.to_string_lossy().replace('\\', "/");
            let within = |place: &str| {
                let rest = file
                    .strip_prefix("src/")
                    .and_then(|file| file.strip_prefix(place));
                rest.is_some_and(|rest| rest.is_empty() || rest == ".rs" || rest.starts_with('/'))
            };
            let found = module.outside.iter().filter(|named| {
                named.path.len() >= fenced.len()
                    && named
                        .path
                        .iter()
                        .zip(*fenced)
                        .all(|(name, fenced)| name == fenced)
            });
            for named in found {
                match places.iter().find(|place| within(place)) {
                    Some(place) => drop(unused.remove(place)),
                    None => broken.push(format!(
                        "{}: {} ({why})",
                        place(module, named.line),
                        named.path.join("::")
                    )),
                }
            }
        }
        broken.extend(
            unused
                .iter()
                .map(|place| format!("src/{place} may name {}, but does not", fenced.join("::"))),
        );
    }
    broken
}

/// Modules beside each other that use each other in a circle, each circle with the lines that close
/// it.
pub fn circles(map: &SourceMap) -> Vec<String> {
    // Beside each other: the same module is above them. A folder counts with everything in it.
    let mut uses: BTreeMap<Names, BTreeMap<Names, BTreeMap<Names, String>>> = BTreeMap::new();
    for (path, module) in &map.modules {
        for named in &module.inside {
            let owner = map.owner(&named.path);
            let common = path.iter().zip(&owner).take_while(|(a, b)| a == b).count();
            if common == 0 || path.len() == common || owner.len() == common {
                continue;
            }
            let line = format!(
                "{} names {}",
                place(module, named.line),
                named.path.join("::")
            );
            let beside = uses.entry(path[..common].to_vec()).or_default();
            let from = beside.entry(path[..=common].to_vec()).or_default();
            from.entry(owner[..=common].to_vec()).or_insert(line);
        }
    }
    uses.values().flat_map(circles_among).collect()
}

/// The strongly connected parts of more than one module.
fn circles_among(uses: &BTreeMap<Names, BTreeMap<Names, String>>) -> Vec<String> {
    let reached = |from: &Names| {
        let mut reached = BTreeSet::new();
        let mut next: Vec<&Names> = uses
            .get(from)
            .into_iter()
            .flat_map(BTreeMap::keys)
            .collect();
        while let Some(module) = next.pop() {
            if reached.insert(module.clone()) {
                next.extend(uses.get(module).into_iter().flat_map(BTreeMap::keys));
            }
        }
        reached
    };
    let reach: BTreeMap<&Names, BTreeSet<Names>> = uses
        .keys()
        .map(|module| (module, reached(module)))
        .collect();
    let mut told = BTreeSet::new();
    let mut circles = Vec::new();
    for (module, reached) in &reach {
        let circle: BTreeSet<&Names> = reached
            .iter()
            .filter(|other| reach.get(other).is_some_and(|back| back.contains(*module)))
            .collect();
        if circle.is_empty() || !told.insert(circle.clone()) {
            continue;
        }
        let names: Vec<String> = circle.iter().map(|path| path.join("::")).collect();
        let mut text = format!("circle: {}", names.join(", "));
        for from in &circle {
            for (_, line) in uses[*from].iter().filter(|(to, _)| circle.contains(to)) {
                let _ = write!(text, "\n    {line}");
            }
        }
        circles.push(text);
    }
    circles
}

fn place(module: &Module, line: usize) -> String {
    format!("{}:{line}", module.file.display())
}

fn names_outside_parentheses(text: &str) -> Vec<String> {
    let mut depth = 0;
    let outside: String = text
        .chars()
        .filter(|letter| {
            match letter {
                '(' => depth += 1,
                ')' => depth -= 1,
                _ => {}
            }
            depth == 0
        })
        .collect();
    outside
        .split('`')
        .skip(1)
        .step_by(2)
        .map(ToOwned::to_owned)
        .collect()
}
