//! The camera without a click, on drawn matches, on inputs that must fail and on real frames: how
//! often it is right, wrong, undecided or silent. Printed as Markdown.
//!
//! Not a divan bench: what counts is the share of right answers, the times beside it.
//! `cargo bench --bench no_click [-- drawn bowl refused spread real clips wild] [--matches N] [--from K] [--frames N] [--keep DIR] [--gate]`;
//! the real frames are those of `TOUCHLINE_DATA`. With `--two-clicks` drawn matches are found from
//! two clicks each. With `--keep` drawn pictures stay in a folder and are used again. With `--gate`
//! it fails where a section is below its rate, which is stated beside its inputs.
#![allow(
    missing_docs,
    clippy::unwrap_used,
    clippy::print_stdout,
    reason = "a bench says what failed by failing"
)]

mod answers;
#[path = "../arguments.rs"]
mod arguments;
mod bowl;
mod drawing;
mod gate;
mod matches;
mod real;
mod refused;
mod scaled_camera;
mod spread;
mod wild;

use answers::Tally;
use arguments::Arguments;
use gate::{Gate, Rate};
use std::path::PathBuf;
use std::process::ExitCode;

fn main() -> ExitCode {
    let arguments = Arguments::of_process();
    let sections = [
        "drawn", "bowl", "refused", "spread", "real", "clips", "wild",
    ];
    let wants = |name: &str| arguments.wants(name, &sections);
    let kept = arguments.value("--keep").map(PathBuf::from);
    let scratch = tempfile::tempdir().unwrap();
    let pictures = kept.as_deref().unwrap_or(scratch.path());
    let (from, count) = (
        arguments.number("--from", 0),
        arguments.number("--matches", matches::RATE.tried),
    );

    let mut all = Tally::default();
    let mut gate = Gate::default();
    let mut answered = |section: &str, tally: &Tally, rate: &Rate| {
        all.add(tally);
        gate.compare(section, tally, rate);
    };
    if wants("drawn") {
        let frames = arguments.number("--frames", matches::FRAMES);
        let drawn = matches::drawn_matches(
            pictures,
            from..from + count,
            frames,
            arguments.is_set("--two-clicks"),
        );
        if !arguments.is_set("--two-clicks") {
            answered("drawn", &drawn.without_clicks, &matches::RATE);
        }
        if drawn.two_clicks.num_tried() > 0 {
            answered(
                "drawn, with two clicks",
                &drawn.two_clicks,
                &matches::TWO_CLICKS_RATE,
            );
        }
    }
    if wants("bowl") {
        let drawn = bowl::clips(pictures, from..from + count);
        answered("bowl", &drawn.without_clicks, &bowl::RATE);
        if drawn.two_clicks.num_tried() > 0 {
            answered("bowl, with two clicks", &drawn.two_clicks, &bowl::RATE);
        }
    }
    if wants("refused") {
        let count = arguments
            .number("--matches", refused::INPUTS.len())
            .min(refused::INPUTS.len().saturating_sub(from));
        answered(
            "refused",
            &refused::bad_inputs(pictures, from..from + count),
            &refused::RATE,
        );
    }
    if wants("spread") {
        answered("spread", &spread::spread(pictures), &spread::RATE);
    }
    match std::env::var_os("TOUCHLINE_DATA").map(PathBuf::from) {
        None => {
            println!("\nreal frames are skipped: TOUCHLINE_DATA names no folder of them");
            // Who names them wants to know how they are answered.
            for section in ["real", "clips", "wild"]
                .into_iter()
                .filter(|name| arguments.is_set(name))
            {
                answered(section, &Tally::default(), &real::MATCHES_RATE);
            }
        }
        Some(data) => {
            if wants("real") {
                answered("real", &real::matches(&data), &real::MATCHES_RATE);
                answered("real, others", &real::others(&data), &real::OTHERS_RATE);
            }
            if wants("clips") {
                answered("clips", &real::clips(&data), &real::CLIPS_RATE);
            }
            if wants("wild") {
                answered("wild", &wild::clips(&data), &wild::RATE);
            }
        }
    }
    println!("\nIn all: {all}");
    if !arguments.is_set("--gate") {
        return ExitCode::SUCCESS;
    }
    let (lines, failed) = gate.verdict();
    println!("\n{lines}");
    if failed {
        ExitCode::FAILURE
    } else {
        ExitCode::SUCCESS
    }
}
