//! A journal beside a document: checksummed lines, some of them damaged. What is not whole is left
//! out and said.
#![no_main]

use libfuzzer_sys::{fuzz_mutator, fuzz_target, fuzzer_mutate};
use std::fs;
use std::path::PathBuf;
use std::sync::LazyLock;
use touchline::document::{document_from_bytes, document_to_string};
use touchline::media::sha256_of_bytes;
use touchline::store::{Location, read};
use touchline_fuzz::{Folder, mutate, one_line, run_in_bounds};

/// The document that the journal is beside; its hash stands in a journal as `HASH`.
const DOCUMENT: &str = include_str!("../../../src/documents/tests/samples/document-v1.json");

static PLACE: LazyLock<(Folder, PathBuf, PathBuf, String)> = LazyLock::new(|| {
    let folder = Folder::new();
    let document = folder.file("project.json", DOCUMENT.as_bytes());
    let journal = Location::find(&document).expect("the document is found").journal();
    (folder, document, journal, sha256_of_bytes(DOCUMENT.as_bytes()))
});

fuzz_mutator!(|data: &mut [u8], size: usize, max_size: usize, seed: u32| {
    // One of its lines as JSON, or all as bytes.
    let ends: Vec<usize> = (0..size).filter(|&at| data[at] == b'\n').map(|at| at + 1).collect();
    let from = ends.get(seed as usize % (ends.len() + 1)).copied().unwrap_or(0);
    mutate(data, from, size, max_size, seed, fuzzer_mutate)
});

fuzz_target!(|data: &[u8]| {
    let (_folder, document, path, hash) = &*PLACE;
    // Lines get their length and checksum, but for those that begin with `!`.
    let text = data.split_inclusive(|&byte| byte == b'\n').flat_map(|line| match line {
        [b'!', raw @ ..] => raw.to_vec(),
        _ => {
            let json = String::from_utf8_lossy(line.strip_suffix(b"\n").unwrap_or(line)).replace("HASH", hash);
            format!("{:08x} {:08x} {json}\n", json.len(), crc32fast::hash(json.as_bytes())).into_bytes()
        }
    });
    fs::write(path, text.collect::<Vec<u8>>()).expect("a journal can be written");
    match run_in_bounds(data, || read(document)) {
        Ok((_, replayed, recovery)) => {
            if let Some(message) = recovery.message() {
                one_line(&message, data);
            }
            let text = document_to_string(&replayed).expect("what is replayed is written");
            document_from_bytes(text.as_bytes()).unwrap_or_else(|error| panic!("{error}\n{text}"));
        }
        Err(error) => one_line(&error, data),
    }
});
