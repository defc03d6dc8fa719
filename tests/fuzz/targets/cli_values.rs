//! A command's arguments, one a line: what is wrong with them is said in one line. Nothing is run.
#![no_main]

use libfuzzer_sys::fuzz_target;
use touchline::cli::usage_message;
use touchline_fuzz::{one_line, run_in_bounds};

fuzz_target!(|text: &str| {
    if let Some(said) = run_in_bounds(text.as_bytes(), || usage_message(text.lines())) {
        one_line(&said, text.as_bytes());
    }
});
