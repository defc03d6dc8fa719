//! A document: what is read is written, and read again as the same.
#![no_main]

use libfuzzer_sys::{fuzz_mutator, fuzz_target, fuzzer_mutate};
use touchline::document::{document_from_bytes, document_to_string};
use touchline_fuzz::{mutate, one_line, run_in_bounds};

fuzz_mutator!(|data: &mut [u8], size: usize, max_size: usize, seed: u32| {
    mutate(data, 0, size, max_size, seed, fuzzer_mutate)
});

fuzz_target!(|data: &[u8]| {
    let mut document = match run_in_bounds(data, || document_from_bytes(data)) {
        Ok(document) => document,
        Err(error) => return one_line(&error, data),
    };
    let text = document_to_string(&document).expect("what is read is written");
    let again = document_from_bytes(text.as_bytes()).unwrap_or_else(|error| panic!("{error}\n{text}"));
    // It names the program that wrote it.
    document.generator.clone_from(&again.generator);
    assert_eq!(again, document, "what is written is read as the same");
    assert_eq!(document_to_string(&again).ok().as_ref(), Some(&text), "and written as the same");
});
