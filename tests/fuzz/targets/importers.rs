//! Every importer: the first byte says which, the rest is the file that most is said of, in the
//! place of a sample's.
#![no_main]

use libfuzzer_sys::{fuzz_mutator, fuzz_target, fuzzer_mutate};
use std::sync::LazyLock;
use touchline::document::{document_from_bytes, document_to_string};
use touchline_fuzz::samples::{Sample, formats};
use touchline_fuzz::{Folder, mutate, one_line, run_in_bounds};

static SAMPLES: LazyLock<(Folder, Vec<Sample>)> =
    LazyLock::new(|| (Folder::new(), formats().map(Sample::of).collect()));

fuzz_mutator!(|data: &mut [u8], size: usize, max_size: usize, seed: u32| {
    mutate(data, 1, size, max_size, seed, fuzzer_mutate)
});

fuzz_target!(|data: &[u8]| {
    let Some((&first, bytes)) = data.split_first() else { return };
    let (folder, samples) = &*SAMPLES;
    let sample = &samples[usize::from(first) % samples.len()];
    let mut files = sample.files.clone();
    for (name, content) in &mut files {
        if name == sample.main() {
            *content = bytes.to_vec();
        }
    }
    match run_in_bounds(data, || sample.import(&files, folder.path())) {
        Ok(imported) => {
            let text = document_to_string(&imported.document);
            let text = text.unwrap_or_else(|error| panic!("{}: {error}", sample.format));
            let read = document_from_bytes(text.as_bytes());
            read.unwrap_or_else(|error| panic!("{}: the document does not open: {error}\n{text}", sample.format));
        }
        Err(error) => one_line(&error, data),
    }
});
