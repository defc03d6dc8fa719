//! Arbitrary bytes and damaged valid files: no panic, little memory, and what is imported is a
//! document that opens.

use crate::json_values::{hostile_values, replace_value};
use crate::memory::{MOST, alone, peak};
use crate::samples::{Sample, samples};
use proptest::collection::vec;
use proptest::prelude::*;
use proptest::test_runner::{Config, TestRunner};
use serde_json::Value;
use touchline_documents::document::{document_from_bytes, document_to_string};

/// What is put into texts.
const TOKENS: [&str; 30] = [
    "NaN",
    "nan",
    "inf",
    "-1",
    "0",
    "1e308",
    "-1e308",
    "1e999",
    "1e-320",
    "99999999999999999999",
    "65536",
    "4294967296",
    "\"",
    "{",
    "[",
    "}",
    "]",
    ",",
    ";",
    ":",
    "\n",
    "\r\n",
    "\t",
    "\0",
    "../",
    "..\\",
    "/etc/passwd",
    "é",
    "\u{feff}",
    "<!--",
];

/// Imports files in the place of a sample's.
fn try_import(sample: &Sample, main: Vec<u8>, folder: &std::path::Path) {
    let mut files = sample.files.clone();
    files
        .iter_mut()
        .find(|(name, _)| name == sample.main())
        .unwrap()
        .1 = main;
    let (result, bytes) = peak(|| {
        let imported = sample.import(&files, folder).ok()?;
        Some(document_to_string(&imported.document))
    });
    assert!(bytes <= MOST, "{}: {} MiB", sample.format, bytes >> 20);
    if let Some(text) = result {
        let text = text.unwrap_or_else(|error| {
            panic!("{}: the document cannot be written: {error}", sample.format)
        });
        document_from_bytes(text.as_bytes()).unwrap_or_else(|error| {
            panic!(
                "{}: the document does not open: {error}\n{text}",
                sample.format
            )
        });
    }
}

#[test]
fn every_sample_is_imported() {
    let _alone = alone();
    let folder = tempfile::tempdir().unwrap();
    for sample in samples() {
        let format = sample.format;
        let imported = sample.import(&sample.files, folder.path());
        let imported = imported.unwrap_or_else(|error| panic!("{format}: {error}"));
        assert!(!imported.document.frames.is_empty(), "{format}");
    }
}

/// Draws `cases` damaged files of every format.
fn each_format<S: Strategy>(
    cases: u32,
    damage: impl Fn(&Sample) -> Option<S>,
    apply: impl Fn(&Sample, S::Value) -> Option<Vec<u8>>,
) where
    S::Value: Clone,
{
    let _alone = alone();
    let folder = tempfile::tempdir().unwrap();
    for sample in samples() {
        let format = sample.format;
        let Some(strategy) = damage(&sample) else {
            continue;
        };
        let ran = TestRunner::new(Config::with_cases(cases)).run(&strategy, |drawn| {
            if let Some(bytes) = apply(&sample, drawn) {
                try_import(&sample, bytes, folder.path());
            }
            Ok(())
        });
        ran.unwrap_or_else(|failure| panic!("{format}: {failure}"));
    }
}

#[test]
fn arbitrary_bytes_are_refused() {
    each_format(
        150,
        |_| Some(vec(any::<u8>(), 0..3000)),
        |_, bytes| Some(bytes),
    );
}

/// A change of bytes: where (as a share), what, how much.
type Change = (f64, u8, usize, u8);

fn change_bytes(mut bytes: Vec<u8>, changes: &[Change]) -> Vec<u8> {
    for &(share, kind, size, byte) in changes {
        let at = (share * bytes.len() as f64) as usize;
        let end = (at + size).min(bytes.len());
        let token = TOKENS[size % TOKENS.len()];
        match kind % 7 {
            0 if at < bytes.len() => bytes[at] = byte,
            1 if at < bytes.len() => bytes[at] ^= 1 << (byte % 8),
            2 => drop(bytes.drain(at..end)),
            3 => {
                let copy = bytes[at..end].to_vec();
                drop(bytes.splice(at..at, copy));
            }
            4 => bytes.truncate(at),
            _ => drop(bytes.splice(at..end.min(at + token.len()), token.bytes())),
        }
    }
    bytes
}

#[test]
fn valid_files_with_changed_bytes_are_read_or_refused() {
    let change = || (0.0..1.0_f64, any::<u8>(), 0..60_usize, any::<u8>());
    each_format(
        300,
        |_| Some(vec(change(), 1..6)),
        |sample, changes| Some(change_bytes(sample.bytes(sample.main()).to_vec(), &changes)),
    );
}

#[test]
fn values_of_json_files_in_the_place_of_others_are_read_or_refused() {
    let values = hostile_values();
    let kinds = values.len() + 4;
    each_format(
        400,
        |sample| {
            let is_json = serde_json::from_str::<Value>(sample.text_or_empty().lines().next()?)
                .is_ok()
                || serde_json::from_str::<Value>(&sample.text_or_empty()).is_ok();
            is_json.then(|| vec((0.0..1.0_f64, 0..kinds), 1..4))
        },
        |sample, changes| {
            let text = sample.text();
            let mut parts: Vec<Value> = match serde_json::from_str(&text) {
                Ok(value) => vec![value],
                Err(_) => text
                    .lines()
                    .filter_map(|line| serde_json::from_str(line).ok())
                    .collect(),
            };
            for (share, kind) in changes {
                let part = kind % parts.len();
                replace_value(&mut parts[part], share, values.get(kind));
            }
            Some(
                parts
                    .iter()
                    .map(ToString::to_string)
                    .collect::<Vec<_>>()
                    .join("\n")
                    .into_bytes(),
            )
        },
    );
}
