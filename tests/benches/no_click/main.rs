//! The camera without a click, on drawn matches, on inputs that must fail and on real frames: how often it is right, wrong,
//! undecided or silent. Printed as Markdown.
//!
//! Not a divan bench: what counts is the share of right answers, the times beside it.
//! `cargo bench --bench no_click [-- drawn refused spread real clips] [--matches N] [--from K] [--frames N] [--keep DIR]`; the real frames are those of
//! `TOUCHLINE_DATA`. With `--two-clicks` drawn matches are found from two clicks each. With `--keep` drawn pictures stay in a folder and are used again.
#![allow(missing_docs, clippy::unwrap_used, clippy::print_stdout, reason = "a bench says what failed by failing")]

mod answers;
mod drawing;
mod matches;
mod real;
mod refused;
mod spread;

use answers::Tally;
use std::path::PathBuf;

/// Drawn matches where no other number is asked for.
const MATCHES: usize = 30;

fn main() {
    let arguments: Vec<String> = std::env::args().skip(1).filter(|argument| argument != "--bench").collect();
    let value = |flag: &str| {
        let at = arguments.iter().position(|argument| argument == flag)?;
        arguments.get(at + 1).cloned()
    };
    let number = |flag: &str, otherwise: usize| value(flag).map_or(otherwise, |text| text.parse().unwrap());
    let sections = ["drawn", "refused", "spread", "real", "clips"];
    let none_asked = !arguments.iter().any(|argument| sections.contains(&argument.as_str()));
    let wants = |name: &str| none_asked || arguments.iter().any(|argument| argument == name);
    let kept = value("--keep").map(PathBuf::from);
    let scratch = tempfile::tempdir().unwrap();
    let pictures = kept.as_deref().unwrap_or(scratch.path());
    let (from, count) = (number("--from", 0), number("--matches", MATCHES));

    let mut all = Tally::default();
    if wants("drawn") {
        all.add(&matches::drawn(
            pictures,
            from..from + count,
            number("--frames", matches::FRAMES),
            arguments.iter().any(|argument| argument == "--two-clicks"),
        ));
    }
    if wants("refused") {
        let count = number("--matches", refused::INPUTS.len()).min(refused::INPUTS.len().saturating_sub(from));
        all.add(&refused::refused(pictures, from..from + count));
    }
    if wants("spread") {
        all.add(&spread::spread(pictures));
    }
    match std::env::var_os("TOUCHLINE_DATA").map(PathBuf::from) {
        None => println!("\nreal frames are skipped: TOUCHLINE_DATA names no folder of them"),
        Some(data) => {
            if wants("real") {
                all.add(&real::matches(&data));
                all.add(&real::others(&data));
            }
            if wants("clips") {
                all.add(&real::clips(&data));
            }
        }
    }
    println!("\nIn all: {all}");
}
