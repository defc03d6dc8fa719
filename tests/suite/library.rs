//! What the library promises those who write against it: results that can be written down, and a
//! surface that grows on purpose.

use crate::architecture::CRATES;
use std::collections::BTreeSet;
use std::fs;
use std::path::{Path, PathBuf};
use touchline::geometry::{ImagePoint, ImageSize};
use touchline::solve::{Observation, SolveContext, solve_frame};
use touchline_core::testing::{base_at, soccer};

/// Rooms of the program: public for its binary and tests only.
const HIDDEN: [&str; 8] = [
    "app", "cli", "jobs", "render", "report", "scene", "testing", "ui",
];
/// A crate of the program, hidden as a whole.
const HIDDEN_CRATE: &str = "src/season";
/// Everything else that can be named from outside, a line each.
const LISTING: &str = "tests/suite/samples/public_items.txt";

#[test]
fn a_solved_frame_is_written_with_its_units() {
    let (field, size) = (soccer(), ImageSize::new(1920, 1080));
    let base = base_at([0.0, -62.0, 17.0], size);
    let clicks = [
        Observation::from_landmark(
            &field,
            "centre_mark",
            ImagePoint::new(444.7, 789.2),
            size,
            0,
        )
        .unwrap(),
        Observation::from_landmark(
            &field,
            "halfway_far",
            ImagePoint::new(455.1, 351.0),
            size,
            1,
        )
        .unwrap(),
    ];
    let solved = solve_frame(&base, &clicks, &SolveContext::new(size)).unwrap();
    let written = serde_json::to_value(&solved).unwrap();
    assert_eq!(written["ptz"]["pan_deg"], solved.ptz.pan.degrees());
    assert_eq!(written["ptz"]["focal_px"], solved.ptz.focal_px);
    assert_eq!(written["covariance"][0][2], solved.covariance[(0, 2)]);
    assert_eq!(written["residuals"][1]["click"], 1);
    assert!(
        !solved.warnings.is_empty(),
        "two clicks 438 px apart are warned of"
    );
    for (warning, told) in written["warnings"]
        .as_array()
        .unwrap()
        .iter()
        .zip(&solved.warnings)
    {
        assert_eq!(warning["code"], told.code.as_str());
    }
    let written = serde_json::to_value(base).unwrap();
    assert_eq!(
        written["base_from_world"][1][2],
        base.base_from_world[(1, 2)]
    );
    assert_eq!(
        written["principal_point_px"],
        serde_json::json!([960.0, 540.0])
    );
}

/// The names that a room's own file and its public modules hand out.
fn collect_names(file: &Path, path: &str, into: &mut BTreeSet<String>) {
    let text = fs::read_to_string(file).unwrap();
    let text: String = text
        .lines()
        .filter(|line| !line.trim_start().starts_with("//"))
        .collect::<Vec<_>>()
        .join("\n");
    let folder = if file.ends_with("mod.rs") {
        file.parent().unwrap().to_owned()
    } else {
        file.with_extension("")
    };
    // What is hidden from the documentation is for the other crates of the program alone.
    let text = text.replace("#[doc(hidden)]\npub ", "#[doc(hidden)]\nhidden ");
    for statement in text.split("\npub ").skip(1) {
        let (kind, rest) = statement.split_once(' ').unwrap();
        match kind {
            "use" => {
                let (from, _) = rest.split_once(';').unwrap();
                let names = from
                    .split_once('{')
                    .map_or_else(|| from.rsplit("::").next().unwrap(), |(_, names)| names);
                for name in names
                    .trim_end_matches('}')
                    .split(',')
                    .map(str::trim)
                    .filter(|name| !name.is_empty())
                {
                    into.insert(format!("{path}::{}", name.rsplit(' ').next().unwrap()));
                }
            }
            "mod" => {
                let name = rest.split(';').next().unwrap();
                let candidates: [PathBuf; 2] = [
                    folder.join(format!("{name}.rs")),
                    folder.join(name).join("mod.rs"),
                ];
                let file = candidates.iter().find(|file| file.is_file()).unwrap();
                collect_names(file, &format!("{path}::{name}"), into);
            }
            _ => {
                let declared = rest
                    .trim_start_matches("fn ")
                    .trim_start_matches("unsafe fn ");
                let name: String = declared
                    .chars()
                    .take_while(|c| c.is_alphanumeric() || *c == '_')
                    .collect();
                into.insert(format!("{path}::{name}"));
            }
        }
    }
}

/// A new name is a promise: it is made by writing it into the listing, `UPDATE_PUBLIC_ITEMS=1` does
/// that.
#[test]
fn nothing_becomes_public_by_accident() {
    let root = Path::new(env!("CARGO_MANIFEST_DIR"));
    let mut found = BTreeSet::new();
    for folder in CRATES.iter().filter(|folder| **folder != HIDDEN_CRATE) {
        let folder = root.join(folder);
        let plan = fs::read_to_string(folder.join("lib.rs")).unwrap();
        for room in plan
            .lines()
            .filter_map(|line| line.strip_prefix("pub mod ")?.strip_suffix(';'))
        {
            if !HIDDEN.contains(&room) {
                collect_names(&folder.join(room).join("mod.rs"), room, &mut found);
            }
        }
    }
    let listing = root.join(LISTING);
    if std::env::var_os("UPDATE_PUBLIC_ITEMS").is_some() {
        let names: Vec<&str> = found.iter().map(String::as_str).collect();
        fs::write(&listing, names.join("\n") + "\n").unwrap();
    }
    let known = fs::read_to_string(&listing).unwrap();
    let known: BTreeSet<String> = known.lines().map(ToOwned::to_owned).collect();
    let (more, less): (Vec<_>, Vec<_>) = (
        found.difference(&known).collect(),
        known.difference(&found).collect(),
    );
    assert!(
        more.is_empty() && less.is_empty(),
        "{LISTING} lacks {more:#?} and has {less:#?} in excess"
    );
}
