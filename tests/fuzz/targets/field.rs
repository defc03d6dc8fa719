//! A field template, filled in for the extremes of its parameters.
#![no_main]

use libfuzzer_sys::{fuzz_mutator, fuzz_target, fuzzer_mutate};
use std::collections::BTreeMap;
use touchline::field::Template;
use touchline_fuzz::{mutate, one_line, run_in_bounds};

fuzz_mutator!(|data: &mut [u8], size: usize, max_size: usize, seed: u32| {
    mutate(data, 0, size, max_size, seed, fuzzer_mutate)
});

fuzz_target!(|data: &[u8]| {
    let Ok(text) = std::str::from_utf8(data) else { return };
    match run_in_bounds(data, || Template::from_json(text, "a.json")) {
        Ok(template) => drop(template.model(&BTreeMap::new(), 0.0).expect("an accepted template can be filled in")),
        Err(error) => one_line(&error, data),
    }
});
