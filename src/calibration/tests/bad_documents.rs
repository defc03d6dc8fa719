//! Broken documents: each gets its exact message, none panics, none is touched.

use proptest::prelude::*;
use std::fs;
use std::path::Path;
use touchline_calibration::calibrate::check_values;
use touchline_documents::document::{Document, document_from_bytes, document_to_string};
use touchline_documents::store::{open, read};

/// A sound document.
pub const SAMPLE: &str = include_str!("../../documents/tests/samples/document-v1.json");

/// The sample with one text replaced by another.
fn with(from: &str, into: &str) -> Vec<u8> {
    assert!(SAMPLE.contains(from), "{from}");
    SAMPLE.replacen(from, into, 1).into_bytes()
}

/// The sample with many entries in a list of its first frame, the last of which is wrong; or with
/// many unknown keys before it.
fn long(key: &str, entry: &str, wrong: &str, count: usize) -> Vec<u8> {
    let entries = format!("{entry}, ").repeat(count);
    with(
        "\"comment\"",
        &format!("\"{key}\": [{entries}{wrong}], \"comment\""),
    )
}

#[test]
fn what_is_wrong_at_the_end_of_long_lists_is_found_soon() {
    let repeat = "{\"landmark\": \"centre_mark\", \"image_px\": [1, 2], \"round\": 1}";
    let wrong = "{\"landmark\": \"centre_mark\", \"image_px\": [1, 2], \"round\": -1}";
    let said = |bytes: &[u8]| document_from_bytes(bytes).unwrap_err().to_string();
    let found = said(&long("repeats", repeat, wrong, 3000));
    assert!(
        found.starts_with("frames[0].repeats[3000].round (images/0001.jpg): invalid value"),
        "{found}"
    );
    let far = said(&long("repeats", repeat, wrong, 100_000));
    assert!(
        far.starts_with("frames[0].repeats[100000].round (images/0001.jpg): invalid value"),
        "{far}"
    );
    let keys = (0..100_000)
        .map(|number| format!("\"x{number}\": 0, "))
        .collect::<Vec<_>>()
        .concat();
    let unknown = said(&with(
        "\"comment\"",
        &format!("{keys}\"comment\": 5, \"x\""),
    ));
    assert!(
        unknown.starts_with("frames[0].comment (images/0001.jpg): invalid type: integer `5`"),
        "{unknown}"
    );
}

/// (what is broken, the bytes, the message after the path)
fn broken() -> Vec<(&'static str, Vec<u8>, &'static str)> {
    let truncated = SAMPLE.as_bytes()[..SAMPLE.len() / 2].to_vec();
    let not_utf8 = [
        &SAMPLE.as_bytes()[..400],
        b"\xff\xfe",
        &SAMPLE.as_bytes()[400..],
    ]
    .concat();
    let nested = format!("{}{}", "[".repeat(100_000), "]".repeat(100_000)).into_bytes();
    let reflection = "[[1.0, 0.0, 0.0], [0.0, 0.0, 1.0], [0.0, 1.0, 0.0]]";
    let rotation = "[[1.0, 0.0, 0.0], [0.0, 0.0, -1.0], [0.0, 1.0, 0.0]]";
    vec![
        (
            "zero bytes",
            Vec::new(),
            "the file is empty; a document is expected",
        ),
        (
            "blanks",
            b" \n\t".to_vec(),
            "the file is empty; a document is expected",
        ),
        (
            "truncated",
            truncated,
            "not valid JSON: EOF while parsing a string at line 27 column 20",
        ),
        (
            "not UTF-8",
            not_utf8,
            "not UTF-8 text (byte 400); a document is a JSON file",
        ),
        (
            "a picture",
            b"\x89PNG\r\n\x1a\n".to_vec(),
            "it is a picture, and a document is a JSON file; `touchline new FOLDER --frames \
             ITS_FOLDER --field SPORT` makes a project of pictures",
        ),
        (
            "nested too deeply",
            nested,
            "lists and objects lie more than 100 deep within each other at line 1; flatten what is there",
        ),
        (
            "a word that a terminal obeys",
            with("\"close_up\"", "\"\\u001b[2J\""),
            "frames[1].reason (images/0002.jpg): unknown variant `\\u{1b}[2J`, expected one of `close_up`, `replay`, `other_camera`, `graphic`, `blur`, `too_little_field` at line 49 column 126",
        ),
        (
            "another JSON",
            b"{\"a\": 1}".to_vec(),
            "not a touchline document: `format` is missing, expected \"touchline\"",
        ),
        (
            "an array",
            b"[]".to_vec(),
            "not a touchline document: `format` is missing, expected \"touchline\"",
        ),
        (
            "another format",
            with("\"touchline\"", "\"coco\""),
            "not a touchline document: `format` is \"coco\", expected \"touchline\"",
        ),
        (
            "a format that a terminal obeys",
            with("\"touchline\"", "\"co\u{7f}co\""),
            "not a touchline document: `format` is \"co\\u{7f}co\", expected \"touchline\"",
        ),
        (
            "a newer version",
            with("\"version\": 1", "\"version\": 2"),
            "the document has version 2, this program reads up to 1; update touchline to open it",
        ),
        (
            "a version in words",
            with("\"version\": 1", "\"version\": \"one\""),
            "`version` is \"one\", expected a whole number from 1 on",
        ),
        (
            "version zero",
            with("\"version\": 1", "\"version\": 0"),
            "`version` is 0, expected a whole number from 1 on",
        ),
        (
            "a newer version of another shape",
            with("\"version\": 1", "\"version\": 7, \"frames\": {}"),
            "the document has version 7, this program reads up to 1; update touchline to open it",
        ),
        (
            "NaN",
            with("444.68", "NaN"),
            "not valid JSON: expected a value (JSON has no NaN and no Infinity) at line 32 column 51",
        ),
        (
            "a number beyond f64",
            with("444.68", "1e999"),
            "not valid JSON: number out of range at line 32 column 55",
        ),
        (
            "a negative frame index",
            with("412", "-1"),
            "frames[0].video.frame_index (images/0001.jpg): invalid value: integer `-1`, expected u64 at line 25 column 55",
        ),
        (
            "frames missing",
            with("\"frames\"", "\"pictures\""),
            "the document: missing field `frames` at line 53 column 1",
        ),
        (
            "frames as an object",
            with("\"frames\": [", "\"frames\": {}, \"x\": ["),
            "frames: invalid type: map, expected a sequence at line 21 column 12",
        ),
        (
            "cameras as text",
            with("\"cameras\": [", "\"cameras\": \"main\", \"x\": ["),
            "cameras: invalid type: string \"main\", expected a sequence at line 7 column 19",
        ),
        (
            "a status that is none",
            with("\"reference\"", "\"maybe\""),
            "frames[0].status (images/0001.jpg): unknown variant `maybe`, expected one of `new`, `draft`, `suggested`, `reference`, `rejected` at line 28 column 23",
        ),
        (
            "a reason that is none",
            with("\"close_up\"", "\"boring\""),
            "frames[1].reason (images/0002.jpg): unknown variant `boring`, expected one of `close_up`, `replay`, `other_camera`, `graphic`, `blur`, `too_little_field` at line 49 column 123",
        ),
        (
            "a click with one coordinate",
            with("[440.63, 690.25]", "[440.63]"),
            "frames[0].clicks[1].image_px (images/0001.jpg): invalid length 1, expected an array of length 2 at line 33 column 54",
        ),
        (
            "a click with a word",
            with("[440.63, 690.25]", "[440.63, \"690\"]"),
            "frames[0].clicks[1].image_px (images/0001.jpg): invalid type: string \"690\", expected f64 at line 33 column 60",
        ),
        (
            "a click without coordinates",
            with("\"image_px\": [444.68, 789.18]", "\"at\": 3"),
            "frames[0].clicks[0] (images/0001.jpg): missing field `image_px` at line 32 column 46",
        ),
        (
            "a click with two names",
            with("\"by\"", "\"landmark\": \"centre_mark\", \"by\""),
            "frames[0].clicks[1] (images/0001.jpg): a click names both the landmark \"centre_mark\" and the line \"halfway_line\" at line 34 column 8",
        ),
        (
            "check in words",
            with("\"check\": true", "\"check\": \"yes\""),
            "frames[0].clicks[2].check (images/0001.jpg): invalid type: string \"yes\", expected a boolean at line 34 column 99",
        ),
        (
            "a reflection",
            with(rotation, reflection),
            "cameras[0].base_from_world (main): the matrix is a reflection, not a rotation (its determinant is negative) at line 13 column 76",
        ),
        (
            "no rotation",
            with(
                rotation,
                "[[1.0, 0.0, 0.0], [0.0, 0.1, -1.0], [0.0, 1.0, 0.0]]",
            ),
            "cameras[0].base_from_world (main): the matrix is not a rotation: its rows are off by 1.00e-1, allowed is 1e-3 at line 13 column 77",
        ),
        (
            "a matrix of two rows",
            with(rotation, "[[1.0, 0.0, 0.0], [0.0, 0.0, -1.0]]"),
            "cameras[0].base_from_world (main): invalid length 2, expected an array of length 3 at line 13 column 60",
        ),
        (
            "a picture of no size",
            with("[1280, 720]", "[1280, 0]"),
            "cameras[1].image_size_px (second): a picture of 1280x0 px: each side must be 1 to 65535 at line 19 column 48",
        ),
        (
            "a picture of negative size",
            with("[1280, 720]", "[1280, -720]"),
            "cameras[1].image_size_px (second): invalid value: integer `-720`, expected u32 at line 19 column 50",
        ),
        (
            "a focal length of zero",
            with("2410.0", "0"),
            "frames[0].ptz.focal_px (images/0001.jpg): must be positive, not 0 at line 37 column 64",
        ),
        (
            "a curve without a value",
            with("\"value\": -0.02, ", ""),
            "cameras[0].distortion.k1 (main): missing field `value` at line 14 column 85",
        ),
        (
            "a parameter in words",
            with("\"length_m\": 105.0", "\"length_m\": \"long\""),
            "field.params.length_m: invalid type: string \"long\", expected f64 at line 6 column 81",
        ),
        (
            "a template missing",
            with("\"template\": \"soccer\", ", ""),
            "field: missing field `template` at line 6 column 96",
        ),
        (
            "a mask of three numbers",
            with("[600, 400, 40, 90]", "[600, 400, 40]"),
            "frames[0].masks_px (images/0001.jpg): invalid length 3, expected an array of length 4 at line 36 column 33",
        ),
        (
            "a key twice",
            with(
                "\"status\": \"new\"",
                "\"status\": \"new\", \"status\": \"draft\"",
            ),
            "frames[2] (/elsewhere/0003.jpg): duplicate field `status` at line 50 column 113",
        ),
        (
            "a covariance of words",
            with("1.1e-5", "\"small\""),
            "frames[0].solution.covariance (images/0001.jpg): invalid type: string \"small\", expected f64 at line 39 column 31",
        ),
        (
            "a disputed click below zero",
            with("\"disputed\": [1]", "\"disputed\": [-1]"),
            "frames[0].solution.disputed (images/0001.jpg): invalid value: integer `-1`, expected usize at line 43 column 23",
        ),
    ]
}

#[test]
fn every_broken_document_gets_its_message_and_is_not_touched() {
    let folder = tempfile::tempdir().unwrap();
    let mut wrong = Vec::new();
    for (what, bytes, expected) in broken() {
        let path = folder.path().join("project.json");
        fs::write(&path, &bytes).unwrap();
        let path = path.canonicalize().unwrap();
        let message = read(folder.path()).unwrap_err().to_string();
        let message = message
            .strip_prefix(&format!("{}: ", path.display()))
            .unwrap_or(&message);
        if message != expected {
            wrong.push(format!("(\"{what}\", {message:?})"));
        }
        assert!(open(folder.path()).is_err(), "{what}");
        assert_eq!(fs::read(&path).unwrap(), bytes, "{what}");
    }
    assert!(wrong.is_empty(), "\n{}", wrong.join("\n"));
}

#[test]
fn what_is_no_file_is_named() {
    let folder = tempfile::tempdir().unwrap();
    let folder = folder.path().canonicalize().unwrap();
    let message = |path: &Path| {
        read(path)
            .unwrap_err()
            .to_string()
            .replace(&folder.display().to_string(), "DIR")
    };
    let nothing = "DIR/nothing.json does not exist; give a project folder, its project.json or a dataset file";
    assert_eq!(message(&folder.join("nothing.json")), nothing);
    assert_eq!(
        message(&folder),
        "the folder DIR holds no project.json; `touchline new` makes a project"
    );
    fs::create_dir(folder.join("project.json")).unwrap();
    let not_a_file =
        "DIR/project.json is not a file; give a project folder, its project.json or a dataset file";
    assert_eq!(message(&folder), not_a_file);
    #[cfg(unix)]
    {
        let device =
            "/dev/null is not a file; give a project folder, its project.json or a dataset file";
        assert_eq!(message(Path::new("/dev/null")), device);
    }
}

#[test]
fn a_broken_document_with_a_backup_names_it() {
    let folder = tempfile::tempdir().unwrap();
    let folder = folder.path().canonicalize().unwrap();
    fs::write(folder.join("project.json"), "").unwrap();
    fs::write(folder.join("project.json.bak"), SAMPLE).unwrap();
    let message = read(&folder).unwrap_err().to_string();
    let expected = format!(
        "; the version before it is {}",
        folder.join("project.json.bak").display()
    );
    assert!(message.ends_with(&expected), "{message}");
}

#[test]
fn a_newer_journal_is_refused_and_left() {
    let folder = tempfile::tempdir().unwrap();
    fs::write(folder.path().join("project.json"), SAMPLE).unwrap();
    drop(open(folder.path()).unwrap());
    let journal = folder.path().join("project.json.journal");
    let json = format!(
        "{{\"journal\":{{\"version\":2,\"document_sha256\":\"{}\"}}}}",
        "0".repeat(64)
    );
    let line = format!(
        "{:08x} {:08x} {json}\n",
        json.len(),
        crc32fast::hash(json.as_bytes())
    );
    fs::write(&journal, &line).unwrap();
    let message = open(folder.path()).unwrap_err().to_string();
    assert!(
        message.ends_with("has version 2, newer than this program; update touchline to open it"),
        "{message}"
    );
    assert_eq!(fs::read_to_string(&journal).unwrap(), line);
}

proptest! {
    #[test]
    fn any_bytes_are_refused_without_panic(bytes in prop::collection::vec(any::<u8>(), 0..200)) {
        prop_assert!(document_from_bytes(&bytes).is_err());
    }

    #[test]
    fn a_damaged_document_is_read_or_refused_but_never_panics(
        at in 0usize..SAMPLE.len(), length in 0usize..40, patch in "[0-9a-z\"{}\\[\\],:.eE+-]{0,12}",
    ) {
        let end = (at + length).min(SAMPLE.len());
        let bytes = [&SAMPLE.as_bytes()[..at], patch.as_bytes(), &SAMPLE.as_bytes()[end..]].concat();
        if let Ok(document) = document_from_bytes(&bytes) {
            let text = document_to_string(&document).unwrap();
            prop_assert_eq!(document_from_bytes(text.as_bytes()).unwrap(), document_with_generator(document));
            let _ = check_values(document_from_bytes(&bytes).unwrap().at(Path::new("")));
        }
    }
}

fn document_with_generator(mut document: Document) -> Document {
    document.generator = touchline_documents::document::generator();
    document
}
