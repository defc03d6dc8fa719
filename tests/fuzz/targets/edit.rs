//! An edit as a journal has it, made on a document.
#![no_main]

use libfuzzer_sys::{fuzz_mutator, fuzz_target, fuzzer_mutate};
use std::sync::LazyLock;
use touchline::document::{Document, Edit, document_from_bytes, document_to_string};
use touchline_fuzz::{mutate, one_line, run_in_bounds};

static DOCUMENT: LazyLock<Document> = LazyLock::new(|| {
    document_from_bytes(include_bytes!("../../../src/documents/tests/samples/document-v1.json")).expect("the document is read")
});

fuzz_mutator!(|data: &mut [u8], size: usize, max_size: usize, seed: u32| {
    mutate(data, 0, size, max_size, seed, fuzzer_mutate)
});

fuzz_target!(|data: &[u8]| {
    let Ok(edit) = run_in_bounds(data, || serde_json::from_slice::<Edit>(data)) else { return };
    let text = serde_json::to_string(&edit).expect("what is read is written");
    let again: Edit = serde_json::from_str(&text).unwrap_or_else(|error| panic!("{error}\n{text}"));
    assert_eq!(again, edit, "what is written is read as the same");
    let mut document = DOCUMENT.clone();
    match run_in_bounds(data, || edit.apply(&mut document)) {
        Ok(()) => {
            let text = document_to_string(&document).expect("an edited document is written");
            let read = document_from_bytes(text.as_bytes()).unwrap_or_else(|error| panic!("{error}\n{text}"));
            // It names the program that wrote it.
            document.generator.clone_from(&read.generator);
            assert_eq!(read, document, "what is written is read as the same");
        }
        Err(mismatch) => {
            one_line(&mismatch, data);
            assert_eq!(document, *DOCUMENT, "an edit that does not fit changes nothing");
        }
    }
});
