//! Keys of commands, and keys assigned.
#![no_main]

use libfuzzer_sys::{fuzz_mutator, fuzz_target, fuzzer_mutate};
use touchline::app::{Chord, Command, Keymap};
use touchline_fuzz::{mutate, one_line, run_in_bounds};

fuzz_mutator!(|data: &mut [u8], size: usize, max_size: usize, seed: u32| {
    mutate(data, 0, size, max_size, seed, fuzzer_mutate)
});

fuzz_target!(|data: &[u8]| {
    if let Ok(keymap) = run_in_bounds(data, || serde_json::from_slice::<Keymap>(data)) {
        let written = serde_json::to_string(&keymap).expect("keys are written");
        let again: Keymap = serde_json::from_str(&written).unwrap_or_else(|error| panic!("{error}\n{written}"));
        assert_eq!(again, keymap, "what is written is read as the same");
        for command in Command::all() {
            let _ = keymap.tooltip(command);
        }
    }
    let Ok(text) = std::str::from_utf8(data) else { return };
    match text.parse::<Chord>() {
        Ok(chord) => {
            let written = String::from(chord.clone());
            assert_eq!(written.parse(), Ok(chord.clone()), "a key is read as it was written");
            let mut keymap = Keymap::default();
            keymap.assign(Command::ZoomToFit, chord.clone());
            assert_eq!(keymap.chords(Command::ZoomToFit), [chord]);
        }
        Err(error) => one_line(&error, data),
    }
});
