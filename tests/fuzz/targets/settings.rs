//! The user's settings: numbers are brought into their ranges, and stay there.
#![no_main]

use libfuzzer_sys::{fuzz_mutator, fuzz_target, fuzzer_mutate};
use touchline::app::Settings;
use touchline_fuzz::{mutate, run_in_bounds};

fuzz_mutator!(|data: &mut [u8], size: usize, max_size: usize, seed: u32| {
    mutate(data, 0, size, max_size, seed, fuzzer_mutate)
});

fuzz_target!(|data: &[u8]| {
    let Ok(text) = std::str::from_utf8(data) else { return };
    if let Ok(settings) = run_in_bounds(data, || Settings::from_json(text)) {
        let written = serde_json::to_string(&settings).expect("settings are written");
        let again = Settings::from_json(&written).unwrap_or_else(|error| panic!("{error}\n{written}"));
        assert_eq!(again, settings, "what is written is read as the same");
    }
});
