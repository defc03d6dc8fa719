//! `--force` replaces files of the names that a command writes. Whatever else lies in a folder is
//! there afterwards, for every command and format.

use crate::drawn::draw;
use crate::program::touchline;
use std::collections::BTreeMap;
use std::fs;
use std::path::Path;
use tempfile::TempDir;
use touchline::exchange::{Direction, Format, FormatOption};

/// The options that formats may want, with a value.
const OPTIONS: [(FormatOption, &str); 6] = [
    (FormatOption::Projected, ""),
    (FormatOption::Fps, "25"),
    (FormatOption::SensorMm, "9.59"),
    (FormatOption::MatchId, "m"),
    (FormatOption::StartTime, "2026-03-01T18:59:30Z"),
    (FormatOption::Perspective, "broadcast"),
];

/// Those of them that a format takes, as arguments.
fn options_of(format: Format) -> String {
    let taken = OPTIONS
        .iter()
        .filter(|(option, _)| format.takes(*option, Direction::Export));
    let taken = taken.map(|(option, value)| format!("--{} {value} ", option.name()));
    taken.collect()
}

/// A drawn match in `match`.
fn drawn_match() -> TempDir {
    let folder = tempfile::tempdir().unwrap();
    draw(folder.path(), "--frames 3 --size 320x180");
    folder
}

/// Folders that a command may be pointed at by mistake: another project, and somebody's own files.
const VICTIMS: [&str; 2] = ["project", "home"];

/// Makes one of them anew.
fn make_victim(folder: &Path, victim: &str) {
    let at = |name: &str| folder.join(victim).join(name);
    let _ = fs::remove_dir_all(folder.join(victim));
    fs::create_dir_all(at("images")).unwrap();
    for image in ["0001.jpg", "0002.jpg", "0003.jpg"] {
        fs::write(
            at("images").join(image),
            format!("a picture of another match, {image}"),
        )
        .unwrap();
    }
    fs::write(at("notes.txt"), "mine").unwrap();
    if victim == "project" {
        fs::copy(folder.join("match/project.json"), at("project.json")).unwrap();
        fs::write(at("project.json.orphan-1"), "edits").unwrap();
    }
}

/// Every file below a folder and its bytes.
fn files(folder: &Path) -> BTreeMap<String, Vec<u8>> {
    let mut found = BTreeMap::new();
    let mut open = vec![folder.to_path_buf()];
    while let Some(next) = open.pop() {
        for entry in fs::read_dir(next).unwrap() {
            let path = entry.unwrap().path();
            if path.is_dir() {
                open.push(path);
            } else {
                found.insert(
                    path.strip_prefix(folder)
                        .unwrap()
                        .to_string_lossy()
                        .into_owned(),
                    fs::read(path).unwrap(),
                );
            }
        }
    }
    found
}

/// Runs a command on a new victim, and asserts that every content that was in its folder still is.
fn assert_nothing_lost(folder: &Path, victim: &str, command: &str) {
    make_victim(folder, victim);
    let before = files(&folder.join(victim));
    let ran = touchline(folder, command);
    let after = files(&folder.join(victim));
    for (name, bytes) in &before {
        assert!(
            after.values().any(|other| other == bytes),
            "{command}: {victim}/{name} is gone; {}",
            ran.stderr
        );
    }
    let left = fs::read_dir(folder)
        .unwrap()
        .map(|entry| entry.unwrap().file_name().into_string().unwrap());
    let temporary: Vec<String> = left
        .filter(|name| name.starts_with(".touchline-"))
        .collect();
    assert!(temporary.is_empty(), "{command}: {temporary:?}");
}

#[test]
fn an_export_of_every_format_leaves_what_it_did_not_write() {
    let folder = drawn_match();
    for format in Format::all().filter(|format| format.exports()) {
        // Takes make folders of what is one file; one such format stands for all.
        let takes: &[&str] = if format == Format::Csv {
            &["", "--takes"]
        } else {
            &[""]
        };
        for takes in takes {
            let options = options_of(format);
            let export =
                format!("export match/truth.json --format {format} {options} {takes} --force -o");
            for victim in VICTIMS {
                assert_nothing_lost(folder.path(), victim, &format!("{export} {victim}"));
                assert_nothing_lost(
                    folder.path(),
                    victim,
                    &format!("{export} {victim}/project.json"),
                );
            }
            // Over an earlier export it goes through, and beside somebody's file it does not.
            let own = format!("own-{format}{takes}");
            let first = touchline(folder.path(), &format!("{export} {own}"));
            assert_eq!(first.code, 0, "{format} {takes}: {}", first.stderr);
            let again = touchline(folder.path(), &format!("{export} {own}"));
            assert_eq!(again.code, 0, "{format} {takes}: {}", again.stderr);
            if folder.path().join(&own).is_dir() {
                fs::write(folder.path().join(&own).join("labels.txt"), "mine").unwrap();
                let refused = touchline(folder.path(), &format!("{export} {own}"));
                assert_eq!(refused.code, 2, "{format} {takes}: {}", refused.stderr);
                let says = format!(
                    "{own} holds labels.txt, which would be lost; move it away, or give another folder"
                );
                assert!(
                    refused.stderr.trim_end().ends_with(&says),
                    "{}",
                    refused.stderr
                );
            }
        }
    }
}

#[test]
fn every_other_command_leaves_what_it_did_not_write() {
    let folder = drawn_match();
    for command in [
        "export match/truth.json --dataset TO --force",
        "synth --frames 3 --size 320x180 -o TO --force",
        "solve match/truth.json -o TO --force",
        "snap match/truth.json -o TO --force",
        "track match/truth.json -o TO --force",
        "refine-base match/truth.json -o TO --force",
        "calibrate match/project.json -o TO --force",
        "train match/truth.json -o TO --force",
        "relocalize match/truth.json match/images -o TO --force",
        "new TO --frames match/images --field soccer --force",
        "merge match/project.json match/project.json match/truth.json -o TO --force",
        "split match --frames 2 -o TO",
        "import match/truth.json --format json -o TO --force",
        "evaluate match/truth.json match/truth.json --report TO --force",
        "fields soccer --render TO --force",
        "render match/truth.json --frame 0 -o TO --force",
    ] {
        for victim in VICTIMS {
            assert_nothing_lost(folder.path(), victim, &command.replace("TO", victim));
        }
    }
    for command in [
        "evaluate match/truth.json match/truth.json -o project/project.json --force",
        "render match/truth.json --frame 0 -o project/project.json --force",
        "train match/truth.json -o project/project.json --force",
    ] {
        assert_nothing_lost(folder.path(), "project", command);
    }
}
